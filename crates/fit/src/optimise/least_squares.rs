//! Linear least squares under linear inequalities: one linearised step of a fit, under the rows of its curve.
//!
//! ```text
//! minimise ½‖J p − y‖²   subject to   A p ≥ b,   lower ≤ p ≤ upper
//! ```
//!
//! The columns are scaled to unit length, the system is reduced to a triangle, an interior-point method finds the
//! active rows, and the problem is solved again to rounding with these held. Optimality is measured here, not taken
//! from the method: see [`Kkt`]. No ridge is added. Directions that the data do not see are left to a second
//! objective (smoothness) and a third (least length), each minimised only among the minimisers of the previous one,
//! so that neither changes the fit to the data, even with active rows.

mod active_set;
mod dense;
mod interior_point;
mod kkt;
mod minimiser;
mod nearest;
mod scaled;

pub use dense::{RANK_TOLERANCE, Triangle};
pub use kkt::Kkt;

use nalgebra::{DMatrix, DVector};
use scaled::Scaled;
use std::fmt;

/// The largest [`Kkt`] figure that counts as solved. Polished solutions lie near 1e-15, interior-point ones near
/// 1e-8.
pub const OPTIMAL: f64 = 1e-10;

/// A least-squares problem under linear inequalities.
#[derive(Debug, Clone)]
pub struct LeastSquares {
    /// J, one row per measurement, one column per unknown. Zero columns are allowed.
    pub jacobian: DMatrix<f64>,
    /// y.
    pub target: DVector<f64>,
    /// A, dense, one inequality per row.
    pub rows: DMatrix<f64>,
    /// b; −∞ switches a row off.
    pub bounds: DVector<f64>,
    /// Lower side of the box, −∞ for none.
    pub lower: DVector<f64>,
    /// Upper side of the box, +∞ for none.
    pub upper: DVector<f64>,
    /// Preference where the data see nothing; without it the shortest step (in scaled unknowns).
    pub smoothing: Option<Smoothing>,
}

/// Smoothness of the total point k + p, only along directions that the data do not see.
///
/// ```text
/// minimise ‖S (k + p)‖   among the minimisers of ‖J p − y‖       Nᵀ Sᵀ S (k + p) = 0 where no row is active
/// ```
#[derive(Debug, Clone)]
pub struct Smoothing {
    /// S, for instance second differences.
    pub roughness: DMatrix<f64>,
    /// k, the start of the step p; zero if p is the point itself.
    pub point: DVector<f64>,
}

/// A bound on the solution: a row of A or a side of the box.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub enum Bound {
    /// This row of A.
    Row(usize),
    /// The lower side of this unknown.
    Lower(usize),
    /// The upper side of this unknown.
    Upper(usize),
}

/// An active inequality.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Active {
    /// The bound.
    pub bound: Bound,
    /// Decrease of ½‖J p − y‖² per unit by which the bound is relaxed; 0 for a bound that only the secondary
    /// objectives press on.
    pub multiplier: f64,
}

/// Status of a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Status {
    /// All conditions of optimality hold to [`OPTIMAL`].
    Optimal,
    /// They hold only to this accuracy.
    Inaccurate {
        /// The largest KKT figure.
        kkt: f64,
    },
    /// The inequalities contradict one another.
    Infeasible,
    /// The problem contains NaN or infinite numbers.
    NotFinite,
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Optimal => write!(f, "solved"),
            Self::Inaccurate { kkt } => {
                write!(f, "the optimality conditions hold only to {kkt:.1e}, not to {OPTIMAL:.0e}")
            }
            Self::Infeasible => write!(f, "the inequalities contradict one another"),
            Self::NotFinite => write!(f, "the least-squares problem contains NaN or infinite numbers"),
        }
    }
}

/// Result of a solve.
#[derive(Debug, Clone)]
#[must_use]
pub struct Solution {
    /// p; zero if the problem is not finite.
    pub point: DVector<f64>,
    /// Status of the solve.
    pub status: Status,
    /// Active bounds, in the order rows, lower sides, upper sides.
    pub active: Vec<Active>,
    /// The optimality conditions, measured at `point`.
    pub kkt: Kkt,
    /// Singular values of the column-scaled J, largest first.
    pub singular_values: DVector<f64>,
    /// Number of singular values above [`RANK_TOLERANCE`] times the largest.
    pub rank: usize,
    /// Directions of p that the data do not see: n×(n − rank), columns of unit length.
    pub null_vectors: DMatrix<f64>,
    /// ‖J_j‖, the lengths of the columns.
    pub column_norms: DVector<f64>,
}

impl LeastSquares {
    /// A problem without inequalities.
    pub fn new(jacobian: DMatrix<f64>, target: DVector<f64>) -> Self {
        let n = jacobian.ncols();
        Self {
            jacobian,
            target,
            rows: DMatrix::zeros(0, n),
            bounds: DVector::zeros(0),
            lower: DVector::from_element(n, f64::NEG_INFINITY),
            upper: DVector::from_element(n, f64::INFINITY),
            smoothing: None,
        }
    }

    /// Solves the problem.
    ///
    /// # Panics
    /// On inconsistent shapes.
    pub fn solve(&self) -> Solution {
        let n = self.jacobian.ncols();
        assert_eq!(
            self.jacobian.nrows(),
            self.target.len(),
            "a row of the Jacobian for every entry of the target"
        );
        assert_eq!(
            self.rows.shape(),
            (self.bounds.len(), n),
            "a row for every bound, a column for every unknown"
        );
        assert_eq!((self.lower.len(), self.upper.len()), (n, n), "a box side for every unknown");
        let column_norms = DVector::from_iterator(n, self.jacobian.column_iter().map(|column| column.norm()));
        if !self.is_finite() {
            return Solution::not_finite(column_norms);
        }
        let (names, rows, bounds) = self.inequalities();
        let data = Scaled::new(&self.jacobian, &self.target, &rows, &bounds);
        let (mut held, refused) = data.minimise();
        let leaning = match data.rank() < n {
            true => self.settle(&data, &mut held.point),
            false => Vec::new(),
        };
        let kkt = data.kkt(&held);
        let point = held.point.component_div(&data.norms);
        let mut active: Vec<Active> = (0..data.origin.len())
            .filter(|row| held.multipliers[*row] != 0.0 || leaning.contains(row))
            .map(|row| {
                let (origin, length) = data.origin[row];
                Active { bound: names[origin], multiplier: held.multipliers[row] / length }
            })
            .collect();
        active.sort_by_key(|active| active.bound);
        let status = match kkt.largest() {
            _ if data.impossible => Status::Infeasible,
            largest if largest <= OPTIMAL => Status::Optimal,
            _ if refused && kkt.primal > OPTIMAL => Status::Infeasible,
            kkt => Status::Inaccurate { kkt },
        };
        let (rank, null_vectors, singular_values) = (data.rank(), data.null_vectors(), data.spectrum.values);
        Solution { point, status, active, kkt, singular_values, rank, null_vectors, column_norms }
    }

    fn is_finite(&self) -> bool {
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let smoothing = self.smoothing.as_ref();
        finite(self.jacobian.as_slice())
            && finite(self.target.as_slice())
            && finite(self.rows.as_slice())
            && self.bounds.iter().all(|&bound| bound < f64::INFINITY)
            && self.lower.iter().all(|&side| side < f64::INFINITY)
            && self.upper.iter().all(|&side| side > f64::NEG_INFINITY)
            && smoothing.is_none_or(|s| finite(s.roughness.as_slice()) && finite(s.point.as_slice()))
    }

    /// Rows of A, then the finite sides of the box, as one system G p ≥ h.
    fn inequalities(&self) -> (Vec<Bound>, DMatrix<f64>, DVector<f64>) {
        let (m, n) = self.rows.shape();
        let lower =
            (0..n).filter(|&j| self.lower[j].is_finite()).map(|j| (Bound::Lower(j), j, 1.0, self.lower[j]));
        let upper =
            (0..n).filter(|&j| self.upper[j].is_finite()).map(|j| (Bound::Upper(j), j, -1.0, -self.upper[j]));
        let sides: Vec<_> = lower.chain(upper).collect();
        let names = (0..m).map(Bound::Row).chain(sides.iter().map(|side| side.0)).collect();
        let mut rows = DMatrix::zeros(m + sides.len(), n);
        rows.rows_mut(0, m).copy_from(&self.rows);
        let mut bounds = self.bounds.clone().resize_vertically(m + sides.len(), 0.0);
        for (i, (_, j, sign, bound)) in sides.into_iter().enumerate() {
            rows[(m + i, j)] = sign;
            bounds[m + i] = bound;
        }
        (names, rows, bounds)
    }

    /// Moves a (scaled) minimiser of the data within their null space: first to the smoothest point, then to the
    /// shortest step. Returns the scaled rows met on the way.
    fn settle(&self, data: &Scaled, point: &mut DVector<f64>) -> Vec<usize> {
        let n = data.columns();
        let mut basis = data.spectrum.right.columns(data.rank(), n - data.rank()).into_owned();
        let smoothness = self.smoothing.as_ref().map(|smoothing| {
            let mut roughness = smoothing.roughness.clone();
            roughness.column_iter_mut().zip(data.norms.iter()).for_each(|(mut column, &norm)| column /= norm);
            (roughness, -(&smoothing.roughness * &smoothing.point))
        });
        let length = (DMatrix::identity(n, n), DVector::zeros(n));
        let mut leaning = Vec::new();
        for (matrix, target) in smoothness.into_iter().chain([length]) {
            // Skips rows that the basis does not move, which cannot be met, and rows violated by rounding, which must
            // not push.
            let mut along = &data.rows * &basis;
            along.row_iter_mut().filter(|row| row.norm() <= 1e-12).for_each(|mut row| row.fill(0.0));
            let room = DVector::from_fn(along.nrows(), |row, _| data.slack(row, point).max(0.0));
            let level = Scaled::new(&(&matrix * &basis), &(target - &matrix * &*point), &along, &-room);
            let (held, _) = level.minimise();
            let step = &basis * held.point.component_div(&level.norms);
            let part = part_within(data, point, &step);
            *point += &step * part;
            let met = level.origin.iter().zip(held.multipliers.iter());
            leaning.extend(
                met.filter(|(_, multiplier)| part == 1.0 && **multiplier != 0.0).map(|((row, _), _)| *row),
            );
            if level.rank() == level.columns() {
                break;
            }
            basis = (basis * level.null_vectors()).qr().q();
        }
        leaning
    }
}

/// The part of a step up to the first row that it violates beyond rounding: an inexact secondary objective must not
/// break a row.
fn part_within(data: &Scaled, point: &DVector<f64>, step: &DVector<f64>) -> f64 {
    let end = point + step;
    let violated = (0..data.rows.nrows()).filter(|&row| data.violation(row, &end) > 0.1 * OPTIMAL);
    violated.map(|row| data.slack(row, point).max(0.0) / -data.along(row, step)).fold(1.0, f64::min)
}

impl Solution {
    fn not_finite(column_norms: DVector<f64>) -> Self {
        let n = column_norms.len();
        Self {
            point: DVector::zeros(n),
            status: Status::NotFinite,
            active: Vec::new(),
            kkt: Kkt { stationarity: f64::NAN, primal: f64::NAN, dual: f64::NAN, complementarity: f64::NAN },
            singular_values: DVector::zeros(n),
            rank: 0,
            null_vectors: DMatrix::identity(n, n),
            column_norms,
        }
    }
}

#[cfg(test)]
mod tests;
