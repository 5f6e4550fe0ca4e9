//! Outcome of a solve.

use super::remedies::Remedies;

/// Status of a solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Status {
    /// A stable equilibrium; with Levenberg–Marquardt, any equilibrium.
    Converged,
    /// Balanced, but the stiffness matrix is not positive definite: the smallest disturbance makes the cloth leave this
    /// state.
    Unstable,
    /// The iteration limit was reached.
    IterationLimit,
    /// No step reduced the imbalance.
    Stalled,
    /// The start, or the curves there, are not finite.
    NotFinite,
    /// Tied groups are not parallel at the start, beyond a millionth of an edge: the elements between them would differ
    /// from their single representative. Rounding causes this in a state with very large coordinates.
    NotParallel,
}

impl std::fmt::Display for Status {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Converged => "converged",
            Self::Unstable => "balanced but unstable",
            Self::IterationLimit => "the iterations ran out",
            Self::Stalled => "no step reduced the imbalance",
            Self::NotFinite => "the start is not finite",
            Self::NotParallel => "tied groups of nodes are not parallel at the start",
        })
    }
}

/// Limit that decided whether a state is balanced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// The requested tolerance.
    Tolerance,
    /// Rounding: forces cannot be computed more accurately at these coordinates.
    Rounding,
}

/// The outcome of a solve.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equilibrium {
    /// Status of the solve.
    pub status: Status,
    /// True if an unstable equilibrium was met and left: the cloth bifurcates nearby, and another shape with other
    /// sensitivities is equally valid.
    pub escaped: bool,
    /// The limit against which the imbalance is measured.
    pub limit: Limit,
    /// Total energy, J.
    pub energy: f64,
    /// Largest imbalance of a free node, N (with an absolute tolerance: the norm over all).
    pub imbalance: f64,
    /// Limit on the imbalance, N.
    pub tolerance: f64,
    /// Newton steps, including those on both sides of states that were left.
    pub iterations: usize,
    /// Factorisations, including stability checks.
    pub factorisations: usize,
    /// Numerical interventions.
    pub remedies: Remedies,
}

impl Equilibrium {
    /// True if a stable equilibrium was found.
    pub fn converged(&self) -> bool {
        self.status == Status::Converged
    }
}
