//! How equilibria are found, and when a state counts as balanced.

/// How equilibria are found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The method; default mixed Newton.
    pub method: Method,
    /// When a state counts as balanced.
    pub tolerance: Tolerance,
    /// Most iterations of one minimisation; default 200. Leaving an unstable state is two more of them, and where they run
    /// out, starting anew from a softer or stiffer membrane is four or more.
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

/// The iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Mixed Newton, Levenberg–Marquardt if that comes to nothing.
    MixedNewton,
    /// The full Hessian + μI throughout, for the sensitivities too, as published. Stability is not checked: what is balanced
    /// has converged.
    ///
    /// Source: Miguel et al. 2012, §5.1; how μ is chosen is ours.
    LevenbergMarquardt,
}

/// When a state counts as balanced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// Largest imbalance of a node at most this share of the typical force or weight at a node.
    Relative(f64),
    /// Norm of all imbalances at most this, N; 10 µN as published.
    Absolute(f64),
}
