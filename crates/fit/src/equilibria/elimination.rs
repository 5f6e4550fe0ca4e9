//! Eliminates the unknowns that a frame has of its own, such as the pose of a table's edge, from its residuals.
//!
//! ```text
//! r(k, ν) = measured − simulated        N = ∂ simulated/∂ν, J = ∂ simulated/∂k
//! N = Q R      residual P r, derivative P J, P = I − Q Qᵀ      δν = R⁻¹ Qᵀ (r − J δk)
//! ```
//!
//! Where Qᵀ r = 0, r is the smallest over all ν at k, and P J has the slope of its square. Source: Golub and Pereyra
//! 1973; Kaufman 1975.

use nalgebra::{DMatrix, DVector};

/// Relative eigenvalue of the scaled NᵀN below which a direction of ν is not seen.
const UNSEEN: f64 = 1e-12;

/// A frame's rows without its own unknowns.
pub(super) struct Eliminated {
    /// Residual, and its derivatives by the curves' control values in further columns.
    pub(super) rows: DMatrix<f64>,
    /// δν for unchanged curves.
    pub(super) step: DVector<f64>,
    /// dν/dk at the smallest residual.
    pub(super) by_value: DMatrix<f64>,
    /// Number of directions eliminated.
    pub(super) rank: usize,
    /// Norm of the part of the residual that δν removes.
    pub(super) removed: f64,
}

/// * `rows` — residual in the first column, J in the others
/// * `own` — N
pub(super) fn eliminate(mut rows: DMatrix<f64>, own: &DMatrix<f64>) -> Eliminated {
    let scale = DVector::from_iterator(own.ncols(), own.column_iter().map(|column| 1.0 / column.norm()));
    let scale = scale.map(|scale| if scale.is_finite() { scale } else { 0.0 });
    let scaled = own * DMatrix::from_diagonal(&scale);
    let eigen = (scaled.transpose() * &scaled).symmetric_eigen();
    let largest = eigen.eigenvalues.amax();
    let roots =
        eigen.eigenvalues.map(|value| if value > UNSEEN * largest { 1.0 / value.sqrt() } else { 0.0 });
    let rank = roots.iter().filter(|&&root| root > 0.0).count();
    // Q = N S V Λ^(−½), and ν = S V Λ^(−½) Qᵀ r.
    let back = DMatrix::from_diagonal(&scale) * eigen.eigenvectors * DMatrix::from_diagonal(&roots);
    let basis = own * &back;
    let along = basis.transpose() * &rows;
    rows -= &basis * &along;
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
        let found = eliminate(rows.clone(), &own);
        assert_eq!(found.rank, 2);
        let both = DMatrix::from_fn(30, 2, |i, j| own[(i, j)]);
        let solved = both.clone().svd(true, true).solve(&rows, 1e-14).unwrap();
        assert!((&rows - &both * &solved - &found.rows).amax() < 1e-12);
        let left = rows.column(0) - &own * &found.step;
        assert!((left - found.rows.column(0)).amax() < 1e-12);
        let slope = rows.column(1) + &own * found.by_value.column(0);
        assert!((slope - found.rows.column(1)).amax() < 1e-12);
    }
}
