//! A point of the search with its residual, its Jacobian, and the linear model there.

use super::problem::{LinearConstraints, Residuals, values};
use crate::optimise::least_squares::{LeastSquares, Triangle};
use crate::optimise::robust::Robust;
use nalgebra::{DMatrix, DVector};

/// An evaluated point.
pub(super) struct State {
    pub(super) point: DVector<f64>,
    pub(super) residual: DVector<f64>,
    pub(super) jacobian: DMatrix<f64>,
    pub(super) triangle: Triangle,
}

impl State {
    pub(super) fn new(
        point: DVector<f64>,
        residual: DVector<f64>,
        jacobian: DMatrix<f64>,
        robust: Option<Robust>,
    ) -> Self {
        let triangle = match robust {
            None => Triangle::reduce(&jacobian, &residual),
            Some(robust) => {
                let curvature = residual.map(|bent| robust.curvature(bent));
                let rows = DMatrix::from_fn(jacobian.nrows(), jacobian.ncols(), |i, j| {
                    curvature[i] * jacobian[(i, j)]
                });
                Triangle::reduce(&rows, &residual.component_div(&curvature))
            }
        };
        Self { point, residual, jacobian, triangle }
    }

    /// Relative decrease of the sum of squares for another residual. Computed as a product: a difference of sums that
    /// agree to ten digits would keep only six.
    pub(super) fn gain(&self, residual: &DVector<f64>) -> f64 {
        (&self.residual - residual).dot(&(&self.residual + residual)) / self.residual.norm_squared()
    }

    /// Relative decrease that the linear model predicts for a step.
    pub(super) fn promise(&self, step: &DVector<f64>) -> f64 {
        let moved = &self.triangle.matrix * step;
        moved.dot(&(2.0 * &self.triangle.target - &moved)) / self.residual.norm_squared()
    }

    /// The linear model of a step, with the inequalities.
    pub(super) fn linear(&self, domain: &LinearConstraints) -> LeastSquares {
        // At a point that rests on a row, the remainder of the row is the rounding of its terms: set to zero.
        let bounds = DVector::from_fn(domain.bounds.len(), |i, _| {
            let terms = (0..self.point.len()).map(|j| domain.rows[(i, j)] * self.point[j]);
            let (sum, size) =
                terms.fold((0.0, 0.0), |(sum, size), term: f64| (sum + term, size + term.abs()));
            let bound = domain.bounds[i] - sum;
            if bound.abs() <= 4.0 * f64::EPSILON * size { 0.0 } else { bound }
        });
        let Triangle { matrix, target, .. } = self.triangle.clone();
        LeastSquares { rows: domain.rows.clone(), bounds, ..LeastSquares::new(matrix, target) }
    }
}

/// The state at an accepted point, with its Jacobian, evaluated now if it was not before; or the reason why there is
/// none.
pub(super) fn accepted_state<P: Residuals>(
    problem: &mut P,
    point: DVector<f64>,
    residual: DVector<f64>,
    jacobian: Option<DMatrix<f64>>,
) -> Result<Result<State, String>, P::Error> {
    let jacobian = match jacobian {
        Some(jacobian) => Ok(jacobian),
        None => values(problem.evaluate(&point, true)?)
            .map(|(_, jacobian)| jacobian.unwrap_or_else(|| panic!("the Jacobian was asked for"))),
    };
    let robust = problem.robust();
    Ok(jacobian.map(|jacobian| State::new(point, residual, jacobian, robust)))
}
