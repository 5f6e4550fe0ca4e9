//! The minimiser of a scaled problem: unconstrained, or polished from the interior-point solution.

use super::active_set::polish;
use super::interior_point::{Program, SolverStatus};
use super::kkt::Held;
use super::scaled::{Scaled, unit_or};
use nalgebra::{DMatrix, DVector};

impl Scaled {
    /// The minimiser; true if the interior-point method found the rows contradictory.
    pub(super) fn minimise(&self) -> (Held, bool) {
        let free = self.spectrum.solve(&self.target, self.threshold);
        let multipliers = DVector::zeros(self.rows.nrows());
        if (0..self.rows.nrows()).all(|row| self.slack(row, &free) >= 0.0) {
            // The second solve removes the rounding of the first.
            let rounding = self.spectrum.solve(&(&self.target - &self.matrix * &free), self.threshold);
            let refined = &free + rounding;
            let feasible = (0..self.rows.nrows()).all(|row| self.slack(row, &refined) >= 0.0);
            return (Held { point: if feasible { refined } else { free }, multipliers }, false);
        }
        let (interior, status) = self.interior_point(&free);
        let refused = matches!(status, SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible);
        let mut start = if refused || self.kkt(&interior).largest().is_nan() {
            Held { point: DVector::zeros(self.columns()), multipliers }
        } else {
            interior
        };
        // A row is active if its multiplier exceeds its slack, each in its own unit.
        let (gradient, size) = (self.gradient_scale(&start.point), unit_or(start.point.amax()));
        let holds = |row: usize| start.multipliers[row] / gradient > self.slack(row, &start.point) / size;
        let (mut working, loose): (Vec<usize>, Vec<usize>) =
            (0..self.rows.nrows()).partition(|&row| holds(row));
        working.sort_by(|&i, &j| start.multipliers[j].total_cmp(&start.multipliers[i]));
        loose.into_iter().for_each(|row| start.multipliers[row] = 0.0);
        let polished = polish(self, &start.point, &working);
        let better = self.kkt(&polished).largest() <= self.kkt(&start).largest();
        (if better { polished } else { start }, refused)
    }

    /// The interior-point method on the small problem. The unknowns are scaled by the length of the solution, since
    /// its tolerances are absolute; a first answer far shorter than assumed is computed again.
    fn interior_point(&self, free: &DVector<f64>) -> (Held, SolverStatus) {
        let needed = self.bounds.iter().copied().fold(0.0, f64::max);
        let mut length = unit_or(free.amax().max(needed));
        let (mut held, mut status) = self.interior_point_in(length);
        for _ in 0..3 {
            let found = held.point.amax().max(needed);
            if status != SolverStatus::Solved || found == 0.0 || found > 1e-3 * length {
                break;
            }
            length = found;
            (held, status) = self.interior_point_in(length);
        }
        (held, status)
    }

    /// With q = ℓ x and t = R x, to avoid squaring R:
    ///
    /// ```text
    /// minimise ½ (ℓ/β) ‖t‖² − (c/β)·t   subject to   R x − t = 0,  G x ≥ h/ℓ      β = max(ℓ, ‖Rᵀc‖∞)
    /// ```
    fn interior_point_in(&self, length: f64) -> (Held, SolverStatus) {
        let (n, m) = (self.columns(), self.rows.nrows());
        let force = length.max(self.matrix.tr_mul(&self.target).amax());
        let curvature: Vec<f64> = (0..2 * n).map(|i| if i < n { 0.0 } else { length / force }).collect();
        let slope: Vec<f64> =
            (0..2 * n).map(|i| if i < n { 0.0 } else { -self.target[i - n] / force }).collect();
        let mut system = DMatrix::zeros(n + m, 2 * n);
        system.view_mut((0, 0), (n, n)).copy_from(&self.matrix);
        system.view_mut((0, n), (n, n)).fill_diagonal(-1.0);
        system.view_mut((n, 0), (m, n)).copy_from(&-&self.rows);
        let right: Vec<f64> =
            (0..n + m).map(|i| if i < n { 0.0 } else { -self.bounds[i - n] / length }).collect();
        let program =
            Program { curvature: &curvature, slope: &slope, system: &system, right: &right, equations: n };
        let Some((point, multipliers, status)) = program.solve() else {
            let held = Held { point: DVector::zeros(n), multipliers: DVector::zeros(m) };
            return (held, SolverStatus::NumericalError);
        };
        let point = DVector::from_fn(n, |j, _| point[j] * length);
        let multipliers = DVector::from_fn(m, |i, _| multipliers[n + i] * force);
        (Held { point, multipliers }, status)
    }
}
