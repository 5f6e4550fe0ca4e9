//! What is simulated and compared, and how.

use crate::optimise::robust::Robust;
use cloth_sim::equilibrium::Settings;
use cloth_sim::material::{Component, Curves};
use serde::{Deserialize, Serialize};

/// What a stage compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Objective {
    /// The measured components of clip forces, N.
    Forces,
    /// The places of the free nodes that were seen, m.
    Positions,
}

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
    /// The components that share the fitted curve.
    pub fitted: Vec<Component>,
    /// What is compared.
    pub objective: Objective,
    /// The curves of the other components.
    pub known: Curves,
    /// How equilibria are found.
    pub settings: Settings,
    /// Where they start.
    pub start: SolveStart,
    /// How far a residual counts in full.
    pub robust: Option<Robust>,
}
