//! One step: the linear model within the inequalities and the trust region, bent along the curvature of the last
//! step.
//!
//! The region is an ellipsoid, imposed by damping: minimise ‖J p − r‖² + μ ‖D p‖² with the smallest sufficient μ. A
//! box would join the inequalities at no cost, but it lets unknowns that the data hardly see run to its corners for a
//! negligible gain, and therefore fails on NIST's MGH17 from every radius tried.

use super::problem::LinearConstraints;
use super::state::State;
use crate::optimise::least_squares::{Active, LeastSquares, Smoothing, Solution, Status, Triangle};
use nalgebra::{DMatrix, DVector};

/// A step may exceed the radius by this factor, or fall short by its inverse; more precision gains nothing.
const WIDER: f64 = 1.1;

/// Maximum size of the bend, as a share of the step.
const BEND: f64 = 0.375;

/// Minimum cosine between two successive steps for the last one to predict the curvature along the next.
const ALIGNED: f64 = 0.8;

/// A trial step.
pub(super) struct Step {
    /// p.
    pub(super) step: DVector<f64>,
    /// ‖D p‖ of the part that the data see, before bending.
    pub(super) seen: f64,
    /// Relative decrease of the sum of squares predicted by the linear model, before bending.
    pub(super) promised: f64,
    /// The predicted decrease without the region.
    pub(super) whole_promise: f64,
    /// True if the region shortened the step.
    pub(super) cut: bool,
    /// Active rows.
    pub(super) active: Vec<Active>,
    /// Rank of J.
    pub(super) rank: usize,
    /// Status of the undamped problem.
    pub(super) status: Status,
}

impl Step {
    pub(super) fn new(
        state: &State,
        domain: &LinearConstraints,
        scale: &Scale,
        radius: f64,
        bend: Option<&Bend>,
    ) -> Self {
        let linear = state.linear(domain);
        let whole = linear.solve();
        let (rank, status) = (whole.rank, whole.status);
        let whole_promise = state.promise(&whole.point);
        let length = scale.norm(&whole.point);
        let cut = length > WIDER * radius;
        let (solution, damping) = match cut {
            true => shortened(&linear, scale, radius, length),
            false => (whole, 0.0),
        };
        let (seen, promised) = (scale.norm(&solution.point), state.promise(&solution.point));
        let mut step = solution.point;
        if let (true, Some(bend)) = (cut, bend) {
            step = bend.apply(step, state, &linear, scale, damping);
        }
        if let (Some(roughness), true) = (&domain.roughness, rank < step.len()) {
            // J p = J step, and the smoothest total within the region where the data see nothing.
            let widths = DVector::from_fn(step.len(), |j, _| (radius / scale.of(j)).max(step[j].abs()));
            let smoothest = LeastSquares {
                target: &linear.jacobian * &step,
                lower: -&widths,
                upper: widths,
                smoothing: Some(Smoothing { roughness: roughness.clone(), point: state.point.clone() }),
                ..linear
            };
            step = smoothest.solve().point;
        }
        Self { step, seen, promised, whole_promise, cut, active: solution.active, rank, status }
    }
}

/// ‖J p − r‖² + μ ‖D p‖² as a system of 2n rows.
fn damped(linear: &LeastSquares, scale: &Scale, damping: f64) -> LeastSquares {
    let n = linear.jacobian.ncols();
    let mut problem = linear.clone();
    problem.jacobian.resize_vertically_mut(2 * n, 0.0);
    problem.target.resize_vertically_mut(2 * n, 0.0);
    (0..n).for_each(|j| problem.jacobian[(n + j, j)] = damping.sqrt() * scale.of(j));
    problem
}

/// Finds the damping for a step of about the radius, within a bracket: 1/‖D p(μ)‖ is nearly linear in μ (Hebden).
fn shortened(linear: &LeastSquares, scale: &Scale, radius: f64, length: f64) -> (Solution, f64) {
    let slope = linear.jacobian.tr_mul(&linear.target);
    // ‖D p(μ)‖ ≤ ‖D⁻¹ Jᵀ r‖ / μ where p = 0 is feasible.
    let most = (0..slope.len()).map(|j| slope[j] / scale.of(j)).fold(0.0, f64::hypot) / radius;
    let (mut low, mut high) = ((0.0, length), (most, None));
    let mut damping = most * (radius / length).max(1e-3);
    let mut solution = damped(linear, scale, damping).solve();
    for attempt in 0..40 {
        let found = scale.norm(&solution.point);
        if found > WIDER * radius {
            low = (damping, found);
        } else if found < radius / WIDER {
            high = (damping, Some(found));
        } else {
            break;
        }
        // Secant through both ends if both are known; every third time the geometric mean.
        damping = match high.1 {
            Some(shorter) if attempt % 3 != 2 => {
                let part = (1.0 / radius - 1.0 / low.1) / (1.0 / shorter - 1.0 / low.1);
                low.0 + (high.0 - low.0) * part
            }
            _ => (low.0.max(1e-12 * high.0) * high.0).sqrt(),
        };
        solution = damped(linear, scale, damping).solve();
    }
    (solution, damping)
}

/// Curvature along an accepted step v. The Jacobians at its two ends give it at no cost:
///
/// ```text
/// f″[v, v] ≈ (J(k + v) − J(k)) v
/// ```
///
/// A step p in about the same direction, p ≈ τ v, is bent by solving it again for the residual r − ½ τ² f″. In the
/// long curved valleys where Gauss–Newton is slow this halves the number of steps: over the 38 runs of NIST's lower
/// and average problems, 750 in all instead of 1350.
///
/// Source: Transtrum & Sethna, Improvements to the Levenberg-Marquardt algorithm (2012), geodesic acceleration; here
/// f″ comes from the last step instead of another evaluation.
pub(super) struct Bend {
    step: DVector<f64>,
    second: DVector<f64>,
}

impl Bend {
    pub(super) fn between(from: &State, to: &State) -> Self {
        let step = &to.point - &from.point;
        Self { second: (&to.jacobian - &from.jacobian) * &step, step }
    }

    fn apply(
        &self,
        straight: DVector<f64>,
        state: &State,
        linear: &LeastSquares,
        scale: &Scale,
        damping: f64,
    ) -> DVector<f64> {
        let (last, length) = (scale.norm(&self.step), scale.norm(&straight));
        let along: f64 =
            (0..straight.len()).map(|j| scale.of(j) * self.step[j] * scale.of(j) * straight[j]).sum();
        if along <= ALIGNED * last * length {
            return straight;
        }
        let ratio = along / last / last;
        let curved = &state.residual - 0.5 * ratio * ratio * &self.second;
        let Triangle { matrix, target, .. } = Triangle::reduce(&state.jacobian, &curved);
        let curved = LeastSquares { jacobian: matrix, target, ..linear.clone() };
        let aside = damped(&curved, scale, damping).solve().point - &straight;
        // Both ends satisfy the inequalities, hence every point between them.
        let share = (BEND * length / scale.norm(&aside)).min(1.0);
        straight + share * aside
    }
}

/// D: the largest length of each column so far.
pub(super) struct Scale(DVector<f64>);

impl Scale {
    pub(super) fn new(jacobian: &DMatrix<f64>) -> Self {
        Self(DVector::from_iterator(jacobian.ncols(), jacobian.column_iter().map(|column| column.norm())))
    }

    pub(super) fn widen(&mut self, jacobian: &DMatrix<f64>) {
        self.0 = self.0.sup(&Self::new(jacobian).0);
    }

    /// d_j; 1 for a column that has always been zero.
    fn of(&self, j: usize) -> f64 {
        if self.0[j] == 0.0 { 1.0 } else { self.0[j] }
    }

    /// ‖D p‖.
    pub(super) fn norm(&self, step: &DVector<f64>) -> f64 {
        (0..step.len()).map(|j| self.of(j) * step[j]).fold(0.0, f64::hypot)
    }

    /// ‖D k‖; 1 if it is zero.
    pub(super) fn norm_or_one(&self, point: &DVector<f64>) -> f64 {
        let norm = self.norm(point);
        if norm == 0.0 { 1.0 } else { norm }
    }
}
