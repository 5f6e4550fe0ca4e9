//! What a nonlinear fit hands back: where it ended, why, and every step on the way.

use crate::optimise::least_squares::{Active, Status as StepStatus};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::fmt;

/// One tried step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Iteration {
    /// From 1.
    pub iteration: usize,
    /// Sum of squares after it: of the new point if accepted, else still of the old.
    pub sum_of_squares: f64,
    /// Share of the sum of squares that the step took away, negative if it added; `None` if the trial point could not
    /// be evaluated.
    pub gain: Option<f64>,
    /// Share that the linear model promised.
    pub promised: f64,
    /// Length of the step as a share of the point, both as ‖D ·‖.
    pub step: f64,
    /// Δ of this step, as a share of the point; infinite in a line search.
    pub radius: f64,
    /// Whether the step was kept.
    pub accepted: bool,
    /// Whether the linearised problem that it comes from was solved to the last digit.
    pub solved: bool,
    /// Rank of the Jacobian it was computed from.
    pub rank: usize,
    /// Rows of A that the step rests on.
    pub active: Vec<Active>,
}

/// How a fit ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Status {
    /// The sum of squares no longer falls.
    SmallGain {
        /// The tolerance met.
        tolerance: f64,
    },
    /// The point no longer moves.
    SmallStep {
        /// The tolerance met.
        tolerance: f64,
    },
    /// What is left to gain is below the noise of the residuals themselves (rounding, equilibria solved to a
    /// tolerance).
    Noise {
        /// The share of the sum of squares that the linear model still promises.
        promised: f64,
    },
    /// No step, however short, lowered the sum of squares as promised.
    Stalled {
        /// Why the last trial point could not be evaluated, if that was it.
        reason: Option<String>,
    },
    /// Too many steps.
    IterationLimit {
        /// The limit.
        limit: usize,
    },
    /// The start could not be evaluated.
    StartFailed {
        /// Why.
        reason: String,
    },
    /// A linearised step could not be solved, or the inequalities contradict one another.
    StepFailed {
        /// Why.
        status: StepStatus,
    },
}

impl Status {
    /// Whether the point is a minimum, to the tolerances.
    pub fn converged(&self) -> bool {
        matches!(self, Self::SmallGain { .. } | Self::SmallStep { .. } | Self::Noise { .. })
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SmallGain { tolerance } => {
                write!(f, "the residual fell by less than {tolerance:.0e} between two iterations")
            }
            Self::SmallStep { tolerance } => write!(f, "the parameters moved by less than {tolerance:.0e}"),
            Self::Noise { promised } => {
                write!(
                    f,
                    "what is left to gain, a share of {promised:.0e}, is below the noise of the residual"
                )
            }
            Self::Stalled { reason: None } => write!(f, "no step, however short, lowered the residual"),
            Self::Stalled { reason: Some(reason) } => {
                write!(f, "no step, however short, could be evaluated: {reason}")
            }
            Self::IterationLimit { limit } => write!(f, "not converged after {limit} iterations"),
            Self::StartFailed { reason } => write!(f, "the start could not be evaluated: {reason}"),
            Self::StepFailed { status } => write!(f, "the linearised step failed: {status}"),
        }
    }
}

/// What a fit found.
#[derive(Debug, Clone)]
#[must_use]
pub struct Outcome {
    /// The best point.
    pub point: DVector<f64>,
    /// The residual there; empty if the start could not be evaluated.
    pub residual: DVector<f64>,
    /// The Jacobian there; empty if the start could not be evaluated.
    pub jacobian: DMatrix<f64>,
    /// ‖residual‖², NaN if the start could not be evaluated.
    pub sum_of_squares: f64,
    /// Why it stopped.
    pub status: Status,
    /// Every step tried.
    pub iterations: Vec<Iteration>,
    /// The start broke an inequality, and was moved to the nearest point that breaks none.
    pub projected: bool,
}

impl Outcome {
    pub(super) fn at(
        point: DVector<f64>,
        residual: DVector<f64>,
        jacobian: DMatrix<f64>,
        status: Status,
        iterations: Vec<Iteration>,
    ) -> Self {
        let sum_of_squares = residual.norm_squared();
        Self { point, residual, jacobian, sum_of_squares, status, iterations, projected: false }
    }

    pub(super) fn unevaluated(point: DVector<f64>, status: Status) -> Self {
        let jacobian = DMatrix::zeros(0, point.len());
        let sum_of_squares = f64::NAN;
        Self {
            point,
            residual: DVector::zeros(0),
            jacobian,
            sum_of_squares,
            status,
            iterations: Vec::new(),
            projected: false,
        }
    }
}
