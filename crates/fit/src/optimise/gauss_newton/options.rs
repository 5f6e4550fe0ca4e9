//! How steps are kept short, and when they end.

/// What is done about steps of the linear model that lead too far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Globalisation {
    /// Steps are kept within a region in which the linear model has proved itself.
    #[default]
    TrustRegion,
    /// The whole step, halved until the sum of squares does not grow. The first that lowers it by no more than the
    /// tolerance is the last.
    ///
    /// Source: Miguel et al. 2012, §5.1; differs in that the inequalities are met by the step itself.
    LineSearch,
}

/// When to stop and how to start. The defaults converge fully; a published protocol that stops below 1 % sets
/// `gain_tolerance: 0.01`.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// What is done about steps that lead too far. Default a trust region.
    pub globalisation: Globalisation,
    /// Steps tried at most, rejected ones included. Default 500.
    pub max_iterations: usize,
    /// Stops when a step that the region did not cut lowers the sum of squares by a smaller share, and the linear
    /// model promised no more: a step that falls short of its promise is no sign of a minimum. A line search asks for
    /// no promise. Default 1e-13.
    pub gain_tolerance: f64,
    /// Stops when the step is a smaller share of the point, both as ‖D ·‖. Default 1e-11.
    pub step_tolerance: f64,
    /// First Δ as a multiple of ‖D k‖ at the start (of 1 where that is zero). Default 1: the unknown that matters
    /// most may about double.
    pub initial_radius: f64,
    /// Steps with a smaller gain ratio are rejected. Default 1e-4.
    pub acceptance: f64,
    /// Whether a trial point is evaluated with its Jacobian at once (default), or only when it has been accepted.
    pub jacobian_at_trials: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            globalisation: Globalisation::TrustRegion,
            max_iterations: 500,
            gain_tolerance: 1e-13,
            step_tolerance: 1e-11,
            initial_radius: 1.0,
            acceptance: 1e-4,
            jacobian_at_trials: true,
        }
    }
}
