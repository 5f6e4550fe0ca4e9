//! How a step ended.

use crate::equilibrium::Remedies;

/// How a step ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// As it should.
    Done,
    /// Its equation is not solved to the tolerance, and the best state is taken; or an explicit integrator has made energy
    /// out of nothing, as it does where the cloth has become too stiff for its step.
    NotConverged,
    /// It led to numbers that are not finite: nothing has moved.
    NotFinite,
}

/// The outcome of one step.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// How it ended.
    pub status: Status,
    /// Newton steps; 0 of an explicit integrator.
    pub newton_iterations: usize,
    /// Iterations of conjugate gradients.
    pub linear_iterations: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// Largest imbalance of a node in the step's equation, N; 0 of an explicit integrator and of a linearised step.
    pub imbalance: f64,
    /// What was done beside plain Newton steps.
    pub remedies: Remedies,
}
