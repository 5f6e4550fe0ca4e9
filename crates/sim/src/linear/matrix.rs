//! Sparse symmetric matrices: entry positions, and the reasons against a factorisation.

use faer::Side;
use faer::sparse::SymbolicSparseColMat;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};

/// The lower triangle of a symmetric sparse matrix, column by column, and its symbolic factorisation.
#[derive(Debug)]
pub(crate) struct Pattern {
    pub(super) lower: SymbolicSparseColMat<usize>,
    pub(super) symbolic: SymbolicCholesky<usize>,
}

impl Pattern {
    /// * `columns` — row indices from the diagonal down, ascending, diagonal first
    ///
    /// `None` if memory is insufficient.
    pub(crate) fn new(columns: &[Vec<usize>]) -> Option<Self> {
        let lower = structure(columns);
        // With the identity ordering, this version of faer reads only the upper triangle, whatever side it is given.
        let mut upper = vec![Vec::new(); columns.len()];
        for (column, rows) in columns.iter().enumerate() {
            rows.iter().for_each(|&row| upper[row].push(column));
        }
        let symbolic = factorize_symbolic_cholesky(
            structure(&upper).as_ref(),
            Side::Upper,
            SymmetricOrdering::Identity,
            // By default, this version factorises planar sheets column by column, half as fast at 51×51 nodes.
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..CholeskySymbolicParams::default()
            },
        );
        Some(Self { lower, symbolic: symbolic.ok()? })
    }

    /// Number of unknowns.
    pub(crate) fn size(&self) -> usize {
        self.lower.ncols()
    }

    /// Number of stored entries.
    pub(crate) fn entries(&self) -> usize {
        self.lower.compute_nnz()
    }

    /// Storage position of an entry of the lower triangle.
    pub(crate) fn position(&self, row: usize, column: usize) -> Option<usize> {
        let range = self.lower.col_range(column);
        let found = self.lower.row_idx()[range.clone()].binary_search(&row).ok()?;
        Some(range.start + found)
    }

    /// Storage position of a diagonal entry.
    pub(crate) fn diagonal(&self, column: usize) -> usize {
        // A column starts with its diagonal entry.
        self.lower.col_range(column).start
    }

    /// `product` = A x, for the symmetric A with these lower entries.
    pub(crate) fn multiply(&self, lower: &[f64], x: &[f64], product: &mut [f64]) {
        product.fill(0.0);
        let rows = self.lower.row_idx();
        for column in 0..self.size() {
            let range = self.lower.col_range(column);
            let factor = x[column];
            let mut sum = lower[range.start] * factor;
            let below = range.start + 1..range.end;
            for (&row, &value) in rows[below.clone()].iter().zip(&lower[below]) {
                product[row] += value * factor;
                sum += value * x[row];
            }
            product[column] += sum;
        }
    }
}

/// The matrix has a non-positive pivot or a non-finite entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct NotPositiveDefinite;

/// Positions of the entries, column by column.
pub(super) fn structure(columns: &[Vec<usize>]) -> SymbolicSparseColMat<usize> {
    let mut starts = vec![0];
    starts.extend(columns.iter().scan(0, |sum, column| {
        *sum += column.len();
        Some(*sum)
    }));
    SymbolicSparseColMat::new_checked(columns.len(), columns.len(), starts, None, columns.concat())
}
