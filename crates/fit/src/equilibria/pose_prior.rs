//! Errors of a frame's clip poses before its forces are compared: their noise, and the shape of the sheet where it was
//! seen.
//!
//! ```text
//! r = N ν + e, per axis       residual of the seen points at exact poses, over their noise; N = ∂ simulated/∂ν
//! H = NᵀN                     information of the shape; of its own noise alone
//! m² = max(0, ‖e‖²/n − 1 − 2√(2/n)) (ς_x/ς)²          misfit: a smooth error of the shape, in deviations of a clip
//! g = H⁻¹ Nᵀ (correction)     what the grid makes of the poses: as much may be left
//! A = I + Σ (H⁻¹ + m² I + g gᵀ)⁻¹                     information of it, and of the noise of the poses, 0 ± 1
//! ν = mean + spread · μ       spread spreadᵀ = A⁻¹, μ = 0 ± 1
//! ```
//!
//! The shape of a cloth that the model does not meet thus says nothing, and the axes are judged apart: cloth that
//! narrows more than simulated still tells how far it was pulled. A shape says nothing before the grid's error is known.

use super::frames::Equilibria;
use super::observation::{Balance, Observation, coordinates};
use crate::twin::replica::Replica;
use nalgebra::{DMatrix, DVector};

/// Relative eigenvalue of H below which the shape does not see a direction.
const UNSEEN: f64 = 1e-12;

/// What is known of the errors of a frame's clip poses: normal, in standard deviations of their noise.
pub(super) struct PosePrior {
    /// Likeliest errors.
    pub(super) mean: DVector<f64>,
    /// Columns of independent errors, one standard deviation each.
    pub(super) spread: DMatrix<f64>,
    /// Derivative of the mean by the control values.
    pub(super) by_value: DMatrix<f64>,
    /// Error of the mean by as much of the grid's error as was corrected.
    pub(super) of_grid: DVector<f64>,
    /// Inverse of `spread`.
    to_deviations: DMatrix<f64>,
}

/// Points of a shape along one axis, in units of their noise.
struct AxisRows {
    /// Residual in the first column, derivatives of the simulated coordinate by the control values in the others.
    rows: DMatrix<f64>,
    /// Derivatives by the errors of the poses.
    own: DMatrix<f64>,
    /// Correction for the grid.
    of_grid: DVector<f64>,
}

impl Equilibria<'_> {
    /// What is known of the errors of a frame's clip poses, in equilibrium at errors `at`.
    ///
    /// * `values` — number of control values
    /// * `correction` — of the points for the grid, m; without it the shape says nothing
    pub(super) fn pose_prior(
        &self,
        replica: &Replica,
        balance: &Balance<'_>,
        values: usize,
        at: &DVector<f64>,
        correction: &[f64],
    ) -> PosePrior {
        let (Some(noise), Some(poses)) = (replica.position_noise, &replica.clip_poses) else {
            return PosePrior::of_noise(at.len(), values);
        };
        let seen = coordinates(balance.frame(), f64::INFINITY);
        let axes = if replica.planar { 0..2 } else { 0..3 };
        let of_axis = |axis: usize| -> Option<AxisRows> {
            let all = seen.iter().cloned().zip(correction.iter().copied());
            let along = all.filter(|(point, _)| point.axis() == Some(axis));
            let (points, correction): (Vec<Observation>, Vec<f64>) = along.unzip();
            // Fewer say less than the poses ask.
            (points.len() > at.len()).then(|| {
                let (rows, own) = self.rows(noise, &points, balance, values, &correction);
                let in_units =
                    points.iter().zip(&correction).map(|(point, of_grid)| of_grid / (point.spread * noise));
                AxisRows { rows, own, of_grid: DVector::from_iterator(points.len(), in_units) }
            })
        };
        let axes: Vec<AxisRows> = axes.filter_map(of_axis).collect();
        if axes.is_empty() {
            return PosePrior::of_noise(at.len(), values);
        }
        // Nodes that average the same vertices repeat them.
        let told: f64 = balance.frame().points.iter().map(|point| point.spread.powi(-2)).sum();
        let share = (replica.vertices as f64 / told).min(1.0);
        PosePrior::of_shape(at, &axes, share, noise / poses.noise())
    }
}

impl PosePrior {
    /// Noise of the poses alone.
    fn of_noise(unknowns: usize, values: usize) -> Self {
        let identity = DMatrix::identity(unknowns, unknowns);
        Self {
            mean: DVector::zeros(unknowns),
            spread: identity.clone(),
            by_value: DMatrix::zeros(unknowns, values),
            of_grid: DVector::zeros(unknowns),
            to_deviations: identity,
        }
    }

    /// Noise of the poses and a shape.
    ///
    /// * `at` — errors at which the residuals were found
    /// * `axes` — the seen points
    /// * `share` — of the points that are independent
    /// * `noise` — noise of a point over that of a clip's place
    fn of_shape(at: &DVector<f64>, axes: &[AxisRows], share: f64, noise: f64) -> Self {
        let unknowns = at.len();
        let columns = axes.first().map_or(1, |axis| axis.rows.ncols());
        let mut information = DMatrix::identity(unknowns, unknowns);
        let mut pull = DMatrix::zeros(unknowns, columns);
        let mut grid_pull = DVector::zeros(unknowns);
        for AxisRows { rows, own, of_grid } in axes {
            let n = rows.nrows() as f64;
            let eigen = (own.transpose() * own).symmetric_eigen();
            let least = UNSEEN * eigen.eigenvalues.amax();
            let inverse = eigen.eigenvalues.map(|h| if h > least { 1.0 / h } else { 0.0 });
            let back = eigen.eigenvectors.transpose() * own.transpose();
            // The errors that meet the shape best, and their slopes.
            let along = &back * rows;
            let mut best = DMatrix::from_diagonal(&inverse) * &along;
            let met = best.column(0).dot(&along.column(0));
            best.set_column(0, &(best.column(0) + eigen.eigenvectors.transpose() * at));
            let of_grid = inverse.component_mul(&(back * of_grid));
            // What is left would be of size 1 by noise alone, give or take its own chance.
            let excess = (rows.column(0).norm_squared() - met) / n - 1.0 - 2.0 * (2.0 / n).sqrt();
            let misfit = excess.max(0.0) * noise * noise;
            let weight = |inverse: f64| if inverse > 0.0 { 1.0 / (inverse / share + misfit) } else { 0.0 };
            // (W⁻¹ + g gᵀ)⁻¹ after Sherman and Morrison 1950.
            let mut weights = DMatrix::from_diagonal(&inverse.map(weight));
            let weighted_grid = &weights * &of_grid;
            weights -= &weighted_grid * weighted_grid.transpose() / (1.0 + weighted_grid.dot(&of_grid));
            let weighted = &eigen.eigenvectors * weights;
            information += &weighted * eigen.eigenvectors.transpose();
            grid_pull += &weighted * of_grid;
            pull += weighted * best;
        }
        let eigen = information.symmetric_eigen();
        let root = eigen.eigenvalues.map(f64::sqrt);
        let spread = &eigen.eigenvectors * DMatrix::from_diagonal(&root.map(f64::recip));
        let to_deviations = DMatrix::from_diagonal(&root) * eigen.eigenvectors.transpose();
        let best = &spread * (spread.transpose() * pull);
        Self {
            mean: best.column(0).into_owned(),
            // A curve that moves a point takes over what the poses had to explain.
            by_value: -best.columns(1, columns - 1),
            of_grid: &spread * (spread.transpose() * grid_pull),
            spread,
            to_deviations,
        }
    }

    /// Errors as deviations from the mean.
    pub(super) fn deviations(&self, errors: &DVector<f64>) -> DVector<f64> {
        &self.to_deviations * (errors - &self.mean)
    }

    /// Errors from deviations.
    pub(super) fn errors(&self, deviations: &DVector<f64>) -> DVector<f64> {
        &self.mean + &self.spread * deviations
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 40 points that two poses and one control value move, at known errors and with a given residual beside them.
    fn axis(at: &DVector<f64>, truth: &DVector<f64>, beside: impl Fn(usize) -> f64) -> AxisRows {
        let wave = |i: usize, f: f64| (f * i as f64 + 0.3 * f).sin();
        let own = DMatrix::from_fn(40, 2, |i, j| [3.0, 0.4][j] * wave(i, 0.7 + j as f64));
        let residual = &own * (truth - at);
        let rows = DMatrix::from_fn(40, 2, |i, j| [residual[i] + beside(i), wave(i, 0.5)][j]);
        AxisRows { rows, own, of_grid: DVector::zeros(40) }
    }

    #[test]
    fn a_shape_that_is_met_tells_the_poses_by_its_normal_equations() {
        let (at, truth) = (DVector::from_vec(vec![0.5, -1.0]), DVector::from_vec(vec![2.0, 1.0]));
        let axes = [axis(&at, &truth, |i| 0.5 * (7.1 * i as f64).sin()), axis(&at, &truth, |_| 0.0)];
        let found = PosePrior::of_shape(&at, &axes, 0.8, 1.0);
        let mut normal = DMatrix::identity(2, 2);
        let mut right = DMatrix::zeros(2, 2);
        for AxisRows { rows, own, .. } in &axes {
            let mut rows = rows.clone();
            rows.set_column(0, &(rows.column(0) + own * &at));
            normal += 0.8 * own.transpose() * own;
            right += 0.8 * own.transpose() * rows;
        }
        let inverse = normal.try_inverse().unwrap();
        let expected = &inverse * right;
        assert!((&found.mean - expected.column(0)).amax() < 1e-12);
        assert!((&found.by_value + expected.columns(1, 1)).amax() < 1e-12);
        assert!((&found.spread * found.spread.transpose() - inverse).amax() < 1e-12);
        let errors = DVector::from_vec(vec![0.3, 0.7]);
        assert!((found.errors(&found.deviations(&errors)) - errors).amax() < 1e-12);
    }

    #[test]
    fn a_shape_that_is_not_met_says_nothing_along_that_axis() {
        let (at, truth) = (DVector::zeros(2), DVector::from_vec(vec![1.0, -1.0]));
        let off = |i: usize| 1e4 * (0.1 * i as f64).cos();
        let found = PosePrior::of_shape(&at, &[axis(&at, &truth, off)], 1.0, 1.0);
        assert!(found.mean.amax() < 0.01 && (&found.spread * found.spread.transpose())[(0, 0)] > 0.999);
        let axes = [axis(&at, &truth, off), axis(&at, &truth, |_| 0.0)];
        let found = PosePrior::of_shape(&at, &axes, 1.0, 1.0);
        assert!((found.mean[0] - 1.0).abs() < 0.01 && found.spread.amax() < 0.7);
    }

    #[test]
    fn poses_are_as_uncertain_as_what_the_grid_makes_of_them() {
        let (at, truth) = (DVector::zeros(2), DVector::from_vec(vec![1.0, -1.0]));
        let mut off = axis(&at, &truth, |_| 0.0);
        // A correction as if the first pose were off by 100 deviations.
        off.of_grid = 100.0 * off.own.column(0);
        let found = PosePrior::of_shape(&at, &[off], 1.0, 1.0);
        let variances = (&found.spread * found.spread.transpose()).diagonal();
        assert!(found.mean[0].abs() < 0.01 && variances[0] > 0.99 && variances[1] < 0.7);
        assert!(found.of_grid.amax() < 0.02);
    }
}
