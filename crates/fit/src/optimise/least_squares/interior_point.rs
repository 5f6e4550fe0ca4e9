//! The interior-point method, wrapping clarabel; no other file uses it.

pub(super) use clarabel::solver::SolverStatus;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, ZeroConeT};
use nalgebra::DMatrix;

/// minimise ½ Σ qᵢ xᵢ² + c·x subject to A x = b in the first rows, A x ≤ b in the others.
pub(super) struct Program<'a> {
    /// q.
    pub(super) curvature: &'a [f64],
    /// c.
    pub(super) slope: &'a [f64],
    /// A; zeros are not stored.
    pub(super) system: &'a DMatrix<f64>,
    /// b.
    pub(super) right: &'a [f64],
    /// Number of equations among the rows.
    pub(super) equations: usize,
}

impl Program<'_> {
    /// x, the multipliers of all rows, and the status; `None` if the method could not start.
    pub(super) fn solve(&self) -> Option<(Vec<f64>, Vec<f64>, SolverStatus)> {
        let n = self.curvature.len();
        let diagonal = CscMatrix::new(n, n, (0..=n).collect(), (0..n).collect(), self.curvature.to_vec());
        let cones = [ZeroConeT(self.equations), NonnegativeConeT(self.right.len() - self.equations)];
        let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
        let system = sparse(self.system);
        let mut solver =
            DefaultSolver::new(&diagonal, self.slope, &system, self.right, &cones, settings).ok()?;
        solver.solve();
        Some((solver.solution.x, solver.solution.z, solver.solution.status))
    }
}

/// Compressed columns without the zeros.
fn sparse(matrix: &DMatrix<f64>) -> CscMatrix<f64> {
    let mut starts = vec![0];
    let (mut row_indices, mut values) = (Vec::new(), Vec::new());
    for column in matrix.column_iter() {
        for (i, &value) in column.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            row_indices.push(i);
            values.push(value);
        }
        starts.push(values.len());
    }
    CscMatrix::new(matrix.nrows(), matrix.ncols(), starts, row_indices, values)
}
