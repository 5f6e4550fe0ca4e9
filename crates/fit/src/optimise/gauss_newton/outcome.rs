//! Outcome of a nonlinear fit: final point, status, and every step.

use crate::optimise::least_squares::{Active, Status as StepStatus};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::fmt;

/// One tried step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Iteration {
    /// From 1.
    pub iteration: usize,
    /// Sum of squares after the step: at the new point if accepted, else at the old one.
    pub sum_of_squares: f64,
    /// Relative decrease of the sum of squares, negative for an increase; `None` if the trial point could not be
    /// evaluated.
    pub gain: Option<f64>,
    /// Relative decrease predicted by the linear model.
    pub promised: f64,
    /// Length of the step as a share of the point, both in the norm ‖D ·‖.
    pub step: f64,
    /// Δ of this step, as a share of the point; infinite in a line search.
    pub radius: f64,
    /// True if the step was accepted.
    pub accepted: bool,
    /// True if the linearised problem of the step was solved to full accuracy.
    pub solved: bool,
    /// Rank of the Jacobian of the step.
    pub rank: usize,
    /// Rows of A active at the step.
    pub active: Vec<Active>,
}

/// Status of a fit at its end.
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
    /// The gain still possible is below the noise of the residuals themselves (rounding, equilibria solved to a
    /// tolerance).
    Noise {
        /// Relative decrease that the linear model still predicts.
        promised: f64,
    },
    /// The mean over constant, straight and bent curves no longer moves.
    MeanFound,
    /// No step, however short, lowered the sum of squares as predicted.
    Stalled {
        /// The error of the last trial point, if it could not be evaluated.
        reason: Option<String>,
    },
    /// The limit on steps was reached.
    IterationLimit {
        /// The limit.
        limit: usize,
    },
    /// The start could not be evaluated.
    StartFailed {
        /// The reason.
        reason: String,
    },
    /// A linearised step could not be solved, or the inequalities contradict one another.
    StepFailed {
        /// The reason.
        status: StepStatus,
    },
}

impl Status {
    /// True if the point is a minimum, within the tolerances.
    pub fn converged(&self) -> bool {
        matches!(self, Self::SmallGain { .. } | Self::SmallStep { .. } | Self::Noise { .. } | Self::MeanFound)
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
                write!(f, "the possible gain, a share of {promised:.0e}, is below the noise of the residual")
            }
            Self::MeanFound => write!(f, "the mean over constant, straight and bent curves is found"),
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

/// Result of a fit.
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
    /// Status at the end.
    pub status: Status,
    /// Every step tried.
    pub iterations: Vec<Iteration>,
    /// The start violated an inequality and was moved to the nearest point that satisfies all.
    pub projected: bool,
}

impl Outcome {
    pub(crate) fn at(
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
