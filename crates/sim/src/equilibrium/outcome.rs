//! How a solve ended.

use super::remedies::Remedies;

/// How a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Status {
    /// A stable equilibrium; with Levenberg–Marquardt, any equilibrium.
    Converged,
    /// Balanced, but the stiffness matrix is not positive definite: the cloth would leave this state at a touch.
    Unstable,
    /// The iterations ran out.
    IterationLimit,
    /// No step made it better.
    Stalled,
    /// The start, or the curves there, are not finite.
    NotFinite,
    /// Tied groups are not parallel at the start, beyond a millionth of an edge: elements between them that are computed once
    /// for all would not be alike. So it is, by rounding, in a state thrown far away.
    NotParallel,
}

impl std::fmt::Display for Status {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Converged => "converged",
            Self::Unstable => "balanced but unstable",
            Self::IterationLimit => "the iterations ran out",
            Self::Stalled => "no step made the imbalance smaller",
            Self::NotFinite => "the start is not finite",
            Self::NotParallel => "tied groups of nodes are not parallel at the start",
        })
    }
}

/// What decided that a state is balanced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// The tolerance asked for.
    Tolerance,
    /// Rounding: forces cannot be computed more exactly at these coordinates.
    Rounding,
}

/// The outcome of a solve.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equilibrium {
    /// How it ended.
    pub status: Status,
    /// An unstable balance was met and left: the cloth bifurcates near here, so that another shape, and other
    /// sensitivities, are as good.
    pub escaped: bool,
    /// Which limit the imbalance is measured against.
    pub limit: Limit,
    /// Total energy, J.
    pub energy: f64,
    /// Largest imbalance of a free node, N (with an absolute tolerance: the norm over all).
    pub imbalance: f64,
    /// What it had to come below, N.
    pub tolerance: f64,
    /// Newton steps taken, on all sides of states that were left.
    pub iterations: usize,
    /// Factorisations made, those that check stability included.
    pub factorisations: usize,
    /// What was done beside plain Newton steps.
    pub remedies: Remedies,
}

impl Equilibrium {
    /// A stable equilibrium was found.
    pub fn converged(&self) -> bool {
        self.status == Status::Converged
    }
}
