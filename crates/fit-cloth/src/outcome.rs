//! Outcomes of completed commands.

/// The outcome of a command that ran to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Success.
    Done,
    /// A checked curve has a defect.
    Defective,
    /// The result is written and marked as not converged.
    NotConverged,
}
