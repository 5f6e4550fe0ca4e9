//! The problem: residuals with their derivative, under linear inequalities.

use crate::optimise::least_squares::{LeastSquares, Status as StepStatus};
use crate::optimise::robust::Robust;
use nalgebra::{DMatrix, DVector};

/// A fitted model: residuals and their derivative at any point.
pub trait Residuals {
    /// An error that ends the fit (a missing file, misuse). A point that cannot be evaluated is not one: see
    /// [`Evaluation::Failed`].
    type Error;

    /// Evaluates at a point.
    ///
    /// Every trial point is evaluated once, with the Jacobian: the factorisation of an equilibrium also serves the
    /// sensitivities. If the Jacobian is expensive, see [`super::Options::jacobian_at_trials`].
    ///
    /// # Errors
    /// Ends the fit and is returned to the caller.
    fn evaluate(&mut self, point: &DVector<f64>, jacobian: bool) -> Result<Evaluation, Self::Error>;

    /// The robust transformation of the residuals and their Jacobian, constant during a fit; the steps use its
    /// curvature.
    fn robust(&self) -> Option<Robust> {
        None
    }
}

/// Result of an evaluation.
#[derive(Debug, Clone, PartialEq)]
pub enum Evaluation {
    /// Success. Non-finite numbers count as failure.
    Values {
        /// Measured − simulated, each divided by its noise.
        residual: DVector<f64>,
        /// ∂ simulated / ∂ point, divided by the same noise; needed only if requested.
        jacobian: Option<DMatrix<f64>>,
    },
    /// The model has no answer at this point, for instance no equilibrium: the step is rejected and the region
    /// shrinks.
    Failed {
        /// The reason, as a sentence.
        reason: String,
    },
}

/// The inequalities A k ≥ b, and the preference for directions that the data do not see.
#[derive(Debug, Clone)]
pub struct LinearConstraints {
    /// A.
    pub rows: DMatrix<f64>,
    /// b.
    pub bounds: DVector<f64>,
    /// S of [`Smoothing`](crate::optimise::least_squares::Smoothing): smooths the total point where the data see
    /// nothing. Without it such directions stay at their start.
    pub roughness: Option<DMatrix<f64>>,
}

impl LinearConstraints {
    /// All of n-space.
    pub fn everywhere(n: usize) -> Self {
        Self { rows: DMatrix::zeros(0, n), bounds: DVector::zeros(0), roughness: None }
    }

    /// A point itself, or the nearest one that satisfies the inequalities.
    ///
    /// # Errors
    /// No such point.
    pub fn nearest(&self, point: &DVector<f64>) -> Result<DVector<f64>, StepStatus> {
        let n = point.len();
        let slack = &self.rows * point - &self.bounds;
        if slack.iter().all(|&slack| slack >= 0.0) {
            return Ok(point.clone());
        }
        let mut nearest = LeastSquares::new(DMatrix::identity(n, n), point.clone());
        (nearest.rows, nearest.bounds) = (self.rows.clone(), self.bounds.clone());
        let solution = nearest.solve();
        match solution.status {
            StepStatus::Optimal | StepStatus::Inaccurate { .. } => Ok(solution.point),
            status => Err(status),
        }
    }

    /// Points of several domains, one below the other.
    pub fn together(domains: &[Self]) -> Self {
        let roughness: Vec<DMatrix<f64>> = domains
            .iter()
            .map(|domain| domain.roughness.clone().unwrap_or_else(|| DMatrix::zeros(0, domain.rows.ncols())))
            .collect();
        let roughness = block_diagonal(&roughness.iter().collect::<Vec<_>>());
        Self {
            rows: block_diagonal(&domains.iter().map(|domain| &domain.rows).collect::<Vec<_>>()),
            bounds: DVector::from_iterator(
                domains.iter().map(|domain| domain.bounds.len()).sum(),
                domains.iter().flat_map(|domain| domain.bounds.iter().copied()),
            ),
            roughness: (roughness.nrows() > 0).then_some(roughness),
        }
    }
}

fn block_diagonal(blocks: &[&DMatrix<f64>]) -> DMatrix<f64> {
    let size = |of: fn(&DMatrix<f64>) -> usize| blocks.iter().map(|block| of(block)).sum();
    let mut all = DMatrix::zeros(size(DMatrix::nrows), size(DMatrix::ncols));
    let (mut row, mut column) = (0, 0);
    for block in blocks {
        all.view_mut((row, column), block.shape()).copy_from(block);
        row += block.nrows();
        column += block.ncols();
    }
    all
}

pub(super) type Values = (DVector<f64>, Option<DMatrix<f64>>);

/// The values of an evaluation, or the reason for their absence.
pub(super) fn values(evaluation: Evaluation) -> Result<Values, String> {
    match evaluation {
        Evaluation::Failed { reason } => Err(reason),
        Evaluation::Values { residual, jacobian } => {
            let finite =
                residual.iter().chain(jacobian.iter().flat_map(DMatrix::iter)).all(|x| x.is_finite());
            match finite && residual.norm_squared().is_finite() {
                true => Ok((residual, jacobian)),
                false => Err("the residual or its derivative is not finite".to_owned()),
            }
        }
    }
}
