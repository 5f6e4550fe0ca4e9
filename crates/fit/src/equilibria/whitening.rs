//! Whitens residuals for errors of held positions: these are measured too, and each error moves the whole free cloth,
//! hence many residuals.
//!
//! ```text
//! residual r = noise + N δ       N = ∂x/∂(place of a held line) = −K⁻¹ K_h,   δ ~ σ_h
//! Cov(r) = I + N̂ N̂ᵀ              N̂ = N σ_h/σ, in units of the noise
//! whitened:  (I + N̂ N̂ᵀ)^(−½) r = r − N̂ V diag((1 − (1+λ)^(−½))/λ) Vᵀ N̂ᵀ r       N̂ᵀN̂ = V diag(λ) Vᵀ
//! ```
//!
//! On a table the slope of the last held segment matters: unwhitened, an error of 0.015 mm in a line's mean would
//! tilt the sheet by 0.2 mm at its tip, more than the noise of any vertex.

use crate::twin::replica::{Replica, ReplicaFrame};
use cloth_sim::equilibrium::Solver;
use nalgebra::{DMatrix, SymmetricEigen};

/// Transforms the residuals of one frame to independent noise of equal size.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Whitening {
    modes: DMatrix<f64>,
    /// V diag(…) Vᵀ.
    shrink: DMatrix<f64>,
}

impl Whitening {
    /// * `modes` — N̂: one row per residual, one column per direction of a held position's error
    pub(crate) fn new(modes: DMatrix<f64>) -> Self {
        let SymmetricEigen { eigenvectors, eigenvalues } = (modes.transpose() * &modes).symmetric_eigen();
        let shares = eigenvalues.map(|value| {
            let value = value.max(0.0);
            // (1 − (1+λ)^(−½))/λ without cancellation.
            let root = (1.0 + value).sqrt();
            1.0 / (root * (1.0 + root))
        });
        let shrink = &eigenvectors * DMatrix::from_diagonal(&shares) * eigenvectors.transpose();
        Self { modes, shrink }
    }

    /// For the free nodes of a sheet on a table, from errors of the last held lines.
    pub(super) fn of_table(solver: &mut Solver<'_>, replica: &Replica, frame: &ReplicaFrame) -> Self {
        let unknowns = replica.cloth(frame).unknowns();
        let mut modes: Vec<f64> = solver.border().iter().map(|k| -k).collect();
        solver.solve_linear(&mut modes);
        let seen: Vec<(usize, usize)> = replica.seen_unknowns(frame).collect();
        let columns = modes.len() / unknowns.max(1);
        Self::new(DMatrix::from_fn(seen.len(), columns, |i, j| {
            let (unknown, coordinate) = seen[i];
            modes[j * unknowns + unknown] * replica.held_spread / replica.spread[coordinate / 3]
        }))
    }

    /// Whitens columns with one row per residual: residuals, or their derivatives.
    pub(crate) fn apply(&self, columns: &mut DMatrix<f64>) {
        let along = &self.shrink * (self.modes.transpose() * &*columns);
        *columns -= &self.modes * along;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whitened_covariance_is_the_identity() {
        let modes = DMatrix::from_fn(7, 2, |i, j| (1.3 * i as f64 + 2.1 * j as f64).sin() * 5.0);
        let whitening = Whitening::new(modes.clone());
        let mut root = DMatrix::identity(7, 7);
        whitening.apply(&mut root);
        let covariance = DMatrix::identity(7, 7) + &modes * modes.transpose();
        let white = &root * covariance * root.transpose();
        assert!((white - DMatrix::identity(7, 7)).amax() < 1e-12);
    }
}
