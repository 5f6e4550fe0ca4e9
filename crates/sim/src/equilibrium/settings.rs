//! Settings of an equilibrium solve, and the criterion for equilibrium.

/// Settings of an equilibrium solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Minimisation method; default mixed Newton.
    pub method: Method,
    /// Criterion for a balanced state.
    pub tolerance: Tolerance,
    /// Maximum iterations of one minimisation; default 200. Leaving an unstable state takes two more minimisations. If
    /// the iterations run out, a restart from a softer or stiffer membrane takes at least four.
    pub max_iterations: usize,
    /// Leave an unstable state for one of lower energy; default true.
    pub escape: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: Method::MixedNewton,
            tolerance: Tolerance::Relative(1e-6),
            max_iterations: 200,
            escape: true,
        }
    }
}

/// Minimisation method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Mixed Newton, with Levenberg–Marquardt as a fallback.
    MixedNewton,
    /// The full Hessian + μI throughout, also for the sensitivities, as published. Stability is not checked: a balanced
    /// state counts as converged.
    ///
    /// Source: Miguel et al. 2012, §5.1; the choice of μ is specific to this project.
    LevenbergMarquardt,
}

/// Criterion for a balanced state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// Largest nodal imbalance at most this share of the typical force or weight at a node.
    Relative(f64),
    /// Norm of all imbalances at most this value, N; 10 µN as published.
    Absolute(f64),
}
