//! What is simulated and compared, and how.

use super::observation::Objective;
use crate::optimise::robust::Robust;
use cloth_sim::equilibrium::Settings;
use cloth_sim::material::Curves;

/// Where the equilibria of the outer loop start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SolveStart {
    /// At the frame's last equilibrium, moved ahead by the sensitivities; where that fails, at the replica's own start, and
    /// then by load steps.
    #[default]
    LastEquilibrium,
    /// At the measured shape of the frame, every time; where none was measured, at the replica's own start. No second try.
    ///
    /// Source: Miguel et al. 2012, §5.1.
    Measured,
}

/// What is simulated, and how.
#[derive(Debug, Clone)]
pub struct Task {
    /// What is compared.
    pub objective: Objective,
    /// The curves of the components that are not unknown.
    pub known: Curves,
    /// How equilibria are found.
    pub settings: Settings,
    /// Where they start.
    pub start: SolveStart,
    /// How far a residual counts in full.
    pub robust: Option<Robust>,
}
