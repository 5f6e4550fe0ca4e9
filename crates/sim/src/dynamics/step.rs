//! Outcome of a time step.

use crate::equilibrium::Remedies;

/// Status of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Completed.
    Done,
    /// The step's equation was not solved to the tolerance, and the best state is kept; or an explicit integrator
    /// gained energy, because the cloth has become too stiff for its step.
    NotConverged,
    /// The step led to non-finite numbers; nothing has moved.
    NotFinite,
}

/// The outcome of one step.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Status of the step.
    pub status: Status,
    /// Newton steps; 0 for an explicit integrator.
    pub newton_iterations: usize,
    /// Conjugate gradient iterations.
    pub linear_iterations: usize,
    /// Number of factorisations.
    pub factorisations: usize,
    /// Largest imbalance of a node in the step's equation, N; 0 for an explicit integrator and for a linearised step.
    pub imbalance: f64,
    /// Numerical interventions.
    pub remedies: Remedies,
}
