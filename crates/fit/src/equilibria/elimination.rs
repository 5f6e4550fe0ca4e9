//! Eliminates the unknowns that a frame has of its own, the pose of a table's edge or of clips, from its residuals.
//!
//! ```text
//! r(k, ν) = measured − simulated        N = ∂ simulated/∂ν = U S Vᵀ, J = ∂ simulated/∂k
//! nothing known of ν    residual P r, derivative P J, P = I − U Uᵀ      δν = V S⁻¹ Uᵀ (r − J δk)
//! ν = 0 ± 1             residual W r, derivative W J, W = (I + N Nᵀ)^(−½)      ν = V S (I + S²)⁻¹ Uᵀ (r − J δk)
//! ```
//!
//! With r at ν = 0 in the second case, ‖W r‖² = min ‖r − N ν‖² + ‖ν‖². At the best ν the rows have the slope of the square
//! of what is left. Source: Golub and Pereyra 1973; Kaufman 1975.

use nalgebra::{DMatrix, DVector};

/// Relative eigenvalue of the scaled NᵀN below which a direction of ν is not seen.
const UNSEEN: f64 = 1e-12;

/// Knowledge of a frame's own unknowns without its measurements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Prior {
    /// Nothing.
    Flat,
    /// 0 ± 1.
    Unit,
}

/// A frame's rows without its own unknowns.
pub(super) struct Eliminated {
    /// Residual, and its derivatives by the curves' control values in further columns.
    pub(super) rows: DMatrix<f64>,
    /// δν for unchanged curves; ν itself under a prior.
    pub(super) step: DVector<f64>,
    /// dν/dk at the smallest residual.
    pub(super) by_value: DMatrix<f64>,
    /// Number of measurements used up.
    pub(super) rank: usize,
    /// Norm of the part of the residual along N.
    pub(super) removed: f64,
}

/// * `rows` — residual in the first column, J in the others
/// * `own` — N
pub(super) fn eliminate(mut rows: DMatrix<f64>, own: &DMatrix<f64>, prior: Prior) -> Eliminated {
    let unit = |column: f64| if prior == Prior::Unit { 1.0 } else { 1.0 / column };
    let scale = DVector::from_iterator(own.ncols(), own.column_iter().map(|column| unit(column.norm())));
    let scale = scale.map(|scale| if scale.is_finite() { scale } else { 0.0 });
    let scaled = own * DMatrix::from_diagonal(&scale);
    let eigen = (scaled.transpose() * &scaled).symmetric_eigen();
    let largest = eigen.eigenvalues.amax();
    let seen = |value: f64| value > UNSEEN * largest;
    let map = |of: &dyn Fn(f64) -> f64| eigen.eigenvalues.map(|s2| if seen(s2) { of(s2) } else { 0.0 });
    let (step, share) = match prior {
        Prior::Flat => (map(&|s2| 1.0 / s2.sqrt()), map(&|_| 1.0)),
        Prior::Unit => (map(&|s2| s2.sqrt() / (1.0 + s2)), map(&|s2| 1.0 - 1.0 / (1.0 + s2).sqrt())),
    };
    let rank = if prior == Prior::Flat { share.iter().filter(|&&share| share > 0.0).count() } else { 0 };
    let basis = scaled * &eigen.eigenvectors * DMatrix::from_diagonal(&map(&|s2| 1.0 / s2.sqrt()));
    let along = basis.transpose() * &rows;
    rows -= basis * DMatrix::from_diagonal(&share) * &along;
    let back = DMatrix::from_diagonal(&scale) * eigen.eigenvectors * DMatrix::from_diagonal(&step);
    let steps = back * &along;
    Eliminated {
        rows,
        step: steps.column(0).into_owned(),
        by_value: -steps.columns(1, steps.ncols() - 1),
        rank,
        removed: along.column(0).norm(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// r = a − k u − ν₁ v − ν₂ w: the smallest over ν by brute force.
    #[test]
    fn what_is_left_is_the_smallest_residual_over_the_own_unknowns() {
        let wave = |i: usize, f: f64| (f * i as f64 + 0.3 * f).sin();
        let rows = DMatrix::from_fn(30, 2, |i, j| wave(i, [1.1, 0.2][j]));
        let own = DMatrix::from_fn(30, 3, |i, j| [1.0, 1e4 * wave(i, 0.7), -2.0][j]);
        let found = eliminate(rows.clone(), &own, Prior::Flat);
        assert_eq!(found.rank, 2);
        let both = DMatrix::from_fn(30, 2, |i, j| own[(i, j)]);
        let solved = both.clone().svd(true, true).solve(&rows, 1e-14).unwrap();
        assert!((&rows - &both * &solved - &found.rows).amax() < 1e-12);
        let left = rows.column(0) - &own * &found.step;
        assert!((left - found.rows.column(0)).amax() < 1e-12);
        let slope = rows.column(1) + &own * found.by_value.column(0);
        assert!((slope - found.rows.column(1)).amax() < 1e-12);
    }

    /// ‖r − N ν‖² + ‖ν‖² by its normal equations.
    #[test]
    fn what_is_known_of_the_own_unknowns_holds_them_back() {
        let wave = |i: usize, f: f64| (f * i as f64 + 0.3 * f).sin();
        let rows = DMatrix::from_fn(12, 2, |i, j| 3.0 * wave(i, [1.1, 0.2][j]));
        let own = DMatrix::from_fn(12, 3, |i, j| [0.2, 5.0, 0.0][j] * wave(i, 0.7 + j as f64));
        let found = eliminate(rows.clone(), &own, Prior::Unit);
        let normal = own.transpose() * &own + DMatrix::identity(3, 3);
        let solved = normal.try_inverse().unwrap() * own.transpose() * &rows;
        assert!((solved.column(0) - &found.step).amax() < 1e-12);
        assert!((solved.column(1) + found.by_value.column(0)).amax() < 1e-12);
        let least = rows.transpose() * (&rows - &own * &solved);
        assert!((found.rows.transpose() * &found.rows - least).amax() < 1e-12);
        assert_eq!(found.rank, 0);
    }
}
