//! Small dense factorisations: triangles of tall systems, singular values, and the split of a space by a set of rows.

use nalgebra::{DMatrix, DVector};

/// Singular values of the column-scaled system up to this share of the largest count as zero.
///
/// The triangle is accurate to some n·ε of its largest singular value, 1e-14; measured and simulated Jacobians repeat
/// to 1e-8 at best along any direction. Below 1e-10 there is no data.
pub const RANK_TOLERANCE: f64 = 1e-10;

/// Rows per reduction: with some forty columns the working block fits the cache.
const BLOCK: usize = 256;

/// Maximum number of Jacobi sweeps; convergence is quadratic and takes about ten.
const SWEEPS: usize = 60;

/// A least-squares system of any height, reduced to an upper triangle with the same minimiser.
///
/// ```text
/// ‖J p − y‖² = ‖R p − c‖² + rest²      [J y] = Q [R c; 0 rest]
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Triangle {
    /// R, n×n, upper triangular.
    pub matrix: DMatrix<f64>,
    /// c, n.
    pub target: DVector<f64>,
    /// The residual that no p can remove: its norm if the columns are independent.
    pub rest: f64,
}

impl Triangle {
    /// Reduces `[J y]` by blocks of rows (Householder): a hundred thousand rows cost one pass.
    ///
    /// # Panics
    /// If the matrix and the target differ in height.
    pub fn reduce(jacobian: &DMatrix<f64>, target: &DVector<f64>) -> Self {
        let (height, n) = jacobian.shape();
        assert_eq!(height, target.len(), "a row of the Jacobian for every entry of the target");
        let mut top = DMatrix::zeros(n + 1, n + 1);
        for first in (0..height).step_by(BLOCK) {
            let rows = BLOCK.min(height - first);
            let mut stack = DMatrix::zeros(n + 1 + rows, n + 1);
            stack.rows_mut(0, n + 1).copy_from(&top);
            stack.view_mut((n + 1, 0), (rows, n)).copy_from(&jacobian.rows(first, rows));
            stack.view_mut((n + 1, n), (rows, 1)).copy_from(&target.rows(first, rows));
            top = stack.qr().r();
        }
        Self {
            matrix: top.view((0, 0), (n, n)).into_owned(),
            target: top.view((0, n), (n, 1)).column(0).into_owned(),
            rest: top[(n, n)].abs(),
        }
    }
}

/// Singular values and right singular vectors, M V = U Σ, largest first.
///
/// By one-sided Jacobi rotations: accurate even for tiny singular values, which determine the rank. (The bidiagonal
/// method of the linear-algebra crate returns wrong values on some matrices, for one an all-ones 3×5.)
#[derive(Debug, Clone)]
pub(super) struct Spectrum {
    /// σ, largest first.
    pub(super) values: DVector<f64>,
    /// V, n×n, orthonormal columns.
    pub(super) right: DMatrix<f64>,
    /// U Σ, columns of length σ.
    left: DMatrix<f64>,
}

impl Spectrum {
    pub(super) fn of(matrix: &DMatrix<f64>) -> Self {
        let (height, n) = matrix.shape();
        let mut left = matrix.clone();
        let mut right = DMatrix::identity(n, n);
        for _ in 0..SWEEPS {
            let mut rotated = false;
            for p in 0..n {
                for q in p + 1..n {
                    rotated |= orthogonalise(&mut left, &mut right, p, q);
                }
            }
            if !rotated {
                break;
            }
        }
        let norms: Vec<f64> = (0..n).map(|j| left.column(j).norm()).collect();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&i, &j| norms[j].total_cmp(&norms[i]));
        Self {
            values: DVector::from_iterator(n, order.iter().map(|&j| norms[j])),
            right: DMatrix::from_fn(n, n, |i, j| right[(i, order[j])]),
            left: DMatrix::from_fn(height, n, |i, j| left[(i, order[j])]),
        }
    }

    /// Number of singular values above a threshold.
    pub(super) fn rank(&self, threshold: f64) -> usize {
        self.values.iter().filter(|&&value| value > threshold).count()
    }

    /// The shortest minimiser of ‖M v − y‖, with singular values up to the threshold taken as zero.
    pub(super) fn solve(&self, target: &DVector<f64>, threshold: f64) -> DVector<f64> {
        let mut solution = DVector::zeros(self.right.nrows());
        for j in 0..self.rank(threshold) {
            let coefficient = self.left.column(j).dot(target) / self.values[j] / self.values[j];
            solution.axpy(coefficient, &self.right.column(j), 1.0);
        }
        solution
    }
}

/// Rotates columns p and q until they are orthogonal; false if they are already.
fn orthogonalise(left: &mut DMatrix<f64>, right: &mut DMatrix<f64>, p: usize, q: usize) -> bool {
    let (alpha, beta) = (left.column(p).norm_squared(), left.column(q).norm_squared());
    let gamma = left.column(p).dot(&left.column(q));
    if gamma == 0.0 || gamma.abs() <= f64::EPSILON * alpha.sqrt() * beta.sqrt() {
        return false;
    }
    let zeta = (beta - alpha) / (2.0 * gamma);
    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let cosine = 1.0 / tangent.hypot(1.0);
    let sine = cosine * tangent;
    for matrix in [left, right] {
        for i in 0..matrix.nrows() {
            let (a, b) = (matrix[(i, p)], matrix[(i, q)]);
            matrix[(i, p)] = cosine * a - sine * b;
            matrix[(i, q)] = sine * a + cosine * b;
        }
    }
    true
}

/// The space split by independent rows `G`: their range and their null space.
///
/// ```text
/// Gᵀ = Y T      G Z = 0      [Y Z] orthonormal, T upper triangular
/// ```
pub(super) struct Split {
    pub(super) range: DMatrix<f64>,
    pub(super) null: DMatrix<f64>,
    triangle: DMatrix<f64>,
}

impl Split {
    /// Splits by the rows of `rows` with indices `chosen`.
    pub(super) fn by(rows: &DMatrix<f64>, chosen: &[usize]) -> Self {
        let (n, w) = (rows.ncols(), chosen.len());
        if w == 0 {
            return Self {
                range: DMatrix::zeros(n, 0),
                null: DMatrix::identity(n, n),
                triangle: DMatrix::zeros(0, 0),
            };
        }
        let factors = DMatrix::from_fn(n, w, |i, j| rows[(chosen[j], i)]).qr();
        let mut transposed = DMatrix::identity(n, n);
        factors.q_tr_mul(&mut transposed);
        let whole = transposed.transpose();
        // T is read off as Yᵀ Gᵀ, so that Y T = Gᵀ holds for any signs of the factorisation.
        let range = whole.columns(0, w).into_owned();
        let triangle = DMatrix::from_fn(w, w, |i, j| match i <= j {
            true => (0..n).map(|l| range[(l, i)] * rows[(chosen[j], l)]).sum(),
            false => 0.0,
        });
        Self { range, null: whole.columns(w, n - w).into_owned(), triangle }
    }

    /// The shortest s with G s = values; `None` if the rows are dependent.
    pub(super) fn shortest(&self, values: &DVector<f64>) -> Option<DVector<f64>> {
        Some(&self.range * self.triangle.tr_solve_upper_triangular(values)?)
    }

    /// The λ with Gᵀλ nearest to a gradient.
    pub(super) fn multipliers(&self, gradient: &DVector<f64>) -> Option<DVector<f64>> {
        self.triangle.solve_upper_triangular(&self.range.tr_mul(gradient))
    }
}

/// The subset of `candidates`, in their order, whose unit rows are independent of the preceding ones.
pub(super) fn independent(rows: &DMatrix<f64>, candidates: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut basis: Vec<DVector<f64>> = Vec::new();
    let mut chosen = Vec::new();
    for candidate in candidates {
        let mut row = rows.row(candidate).transpose();
        for _ in 0..2 {
            for direction in &basis {
                let along = direction.dot(&row);
                row.axpy(-along, direction, 1.0);
            }
        }
        let norm = row.norm();
        if basis.len() < rows.ncols() && norm > 1e-8 {
            basis.push(row / norm);
            chosen.push(candidate);
        }
    }
    chosen
}
