//! The task of a simulation: components, objective, solver settings.

use crate::optimise::robust::Robust;
use cloth_sim::equilibrium::Settings;
use cloth_sim::material::{Component, Curves};
use serde::{Deserialize, Serialize};

/// The quantity that a stage compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Objective {
    /// The measured components of clip forces, N.
    Forces,
    /// The positions of the free nodes that were observed, m.
    Positions,
}

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
    /// The components that share the fitted curve.
    pub fitted: Vec<Component>,
    /// The compared quantity.
    pub objective: Objective,
    /// The curves of the other components.
    pub known: Curves,
    /// Settings of the equilibrium solver.
    pub settings: Settings,
    /// Start of the equilibria.
    pub start: SolveStart,
    /// Limit above which residuals get less weight.
    pub robust: Option<Robust>,
}
