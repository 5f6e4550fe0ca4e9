//! How a command has ended.

/// How a command that could be carried out has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// As it should.
    Done,
    /// The check was made, and what was checked has a defect.
    Defective,
    /// With a result that is written, but marked as not converged.
    NotConverged,
}
