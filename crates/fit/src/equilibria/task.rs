//! The task of a simulation: components, objective, solver settings.

use super::observation::Objective;
use crate::optimise::robust::Robust;
use cloth_sim::equilibrium::Settings;
use cloth_sim::material::Curves;

/// Start of the equilibria in the outer loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SolveStart {
    /// At the frame's last equilibrium, extrapolated by the sensitivities; if that fails, at the replica's own start,
    /// then by load steps.
    #[default]
    LastEquilibrium,
    /// At the frame's measured shape, every time; at the replica's own start if none was measured. No fallback.
    ///
    /// Source: Miguel et al. 2012, §5.1.
    Measured,
}

/// The task of a simulation.
#[derive(Debug, Clone)]
pub struct Task {
    /// The compared quantities.
    pub objective: Objective,
    /// The curves of the components that are not unknown.
    pub known: Curves,
    /// Settings of the equilibrium solver.
    pub settings: Settings,
    /// Start of the equilibria.
    pub start: SolveStart,
    /// Clips are where they were measured; else their poses err by their noise and are found with the curves.
    pub exact_clips: bool,
    /// Limit above which residuals get less weight.
    pub robust: Option<Robust>,
}
