//! Options of the outer loop: globalisation and tolerances.

/// Method that limits the steps of the linear model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Globalisation {
    /// Steps stay within a region in which the linear model predicts well.
    #[default]
    TrustRegion,
    /// The whole step, halved until the sum of squares does not grow. The search ends with the first step that lowers
    /// it by no more than the tolerance.
    ///
    /// Source: Miguel et al. 2012, §5.1; here the step itself satisfies the inequalities.
    LineSearch,
}

/// Start and stopping rules. The defaults converge fully; a published protocol that stops below 1 % sets
/// `gain_tolerance: 0.01`.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Method that limits steps. Default a trust region.
    pub globalisation: Globalisation,
    /// Maximum number of steps tried, including rejected ones. Default 500.
    pub max_iterations: usize,
    /// Stops when a step that the region did not cut lowers the sum of squares by a smaller share, and the linear
    /// model predicted no more: a step that falls short of its prediction is no sign of a minimum. A line search
    /// ignores the prediction. Default 1e-13.
    pub gain_tolerance: f64,
    /// Stops when the step is a smaller share of the point, both in the norm ‖D ·‖. Default 1e-11.
    pub step_tolerance: f64,
    /// First Δ as a multiple of ‖D k‖ at the start (of 1 if that is zero). Default 1: the dominant unknown may about
    /// double.
    pub initial_radius: f64,
    /// Steps with a smaller gain ratio are rejected. Default 1e-4.
    pub acceptance: f64,
    /// True (default) to compute the Jacobian at every trial point; false, only at accepted ones.
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
