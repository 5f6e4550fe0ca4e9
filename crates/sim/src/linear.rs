//! Sparse symmetric systems: ordering, Cholesky factorisation, solution. The only file that names faer.
//!
//! The symbolic factorisation is made once for a pattern, the numeric one at every step, into memory that is kept.
//! Everything runs on the calling thread: cloth this small gains from many frames at once, not from a parallel factor.

use crate::conjugate_gradient::ConjugateGradient;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, amd};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};
use nalgebra::Vector3;

/// Larger sheets are dissected: of 101×101 nodes a factor then costs about two thirds as much, of fewer nodes about the same.
const DISSECTED: usize = 2000;

/// Parts no larger than this are not cut further.
const LEAF: usize = 100;

/// Order of a sheet's nodes that keeps the factor sparse.
///
/// * `neighbours` — of every node, ascending, without itself
/// * `places` — where the nodes are at rest, m
/// * returns — node at each place
pub(crate) fn order(neighbours: &[Vec<usize>], places: &[Vector3<f64>]) -> Vec<usize> {
    let all = (0..places.len()).collect();
    if places.len() <= DISSECTED { minimum_degree(neighbours, all) } else { dissect(neighbours, places, all) }
}

/// Nested dissection: a cut across the longer side comes after the two parts that it leaves, which are cut likewise.
///
/// Source: George 1973.
fn dissect(neighbours: &[Vec<usize>], places: &[Vector3<f64>], mut part: Vec<usize>) -> Vec<usize> {
    if part.len() <= LEAF {
        return minimum_degree(neighbours, part);
    }
    let extent = |axis: usize| {
        let along = part.iter().map(|&node| places[node][axis]);
        along.clone().fold(f64::MIN, f64::max) - along.fold(f64::MAX, f64::min)
    };
    let axis = if extent(0) >= extent(1).max(extent(2)) { 0 } else { 1 + usize::from(extent(2) > extent(1)) };
    part.sort_by(|&a, &b| places[a][axis].total_cmp(&places[b][axis]));
    let mut is_far = vec![false; places.len()];
    let far = part.split_off(part.len() / 2);
    far.iter().for_each(|&node| is_far[node] = true);
    let (cut, near): (Vec<usize>, Vec<usize>) =
        part.into_iter().partition(|&node| neighbours[node].iter().any(|&other| is_far[other]));
    let mut order = dissect(neighbours, places, near);
    order.extend(dissect(neighbours, places, far));
    order.extend(cut);
    order
}

/// Order of a part of a graph by approximate minimum degree.
fn minimum_degree(neighbours: &[Vec<usize>], mut part: Vec<usize>) -> Vec<usize> {
    part.sort_unstable();
    let size = part.len();
    let within = |&other: &usize| part.binary_search(&other).ok();
    let graph: Vec<Vec<usize>> =
        part.iter().map(|&node| neighbours[node].iter().filter_map(within).collect()).collect();
    let pattern = pattern(&graph);
    let mut memory = MemBuffer::new(amd::order_scratch::<usize>(size, pattern.compute_nnz()));
    let (mut order, mut place) = (vec![0; size], vec![0; size]);
    match amd::order(
        &mut order,
        &mut place,
        pattern.as_ref(),
        amd::Control::default(),
        MemStack::new(&mut memory),
    ) {
        Ok(_) => order.into_iter().map(|index| part[index]).collect(),
        // Any order is right, only slower.
        Err(_) => part,
    }
}

fn pattern(columns: &[Vec<usize>]) -> SymbolicSparseColMat<usize> {
    let mut starts = vec![0];
    starts.extend(columns.iter().scan(0, |sum, column| {
        *sum += column.len();
        Some(*sum)
    }));
    SymbolicSparseColMat::new_checked(columns.len(), columns.len(), starts, None, columns.concat())
}

/// The lower triangle of a symmetric sparse matrix, column by column, and the symbolic part of its factorisation.
#[derive(Debug)]
pub(crate) struct Pattern {
    lower: SymbolicSparseColMat<usize>,
    symbolic: SymbolicCholesky<usize>,
}

impl Pattern {
    /// * `columns` — row indices ≥ the column's own, ascending, the diagonal first
    ///
    /// `None` if memory does not suffice.
    pub(crate) fn new(columns: &[Vec<usize>]) -> Option<Self> {
        let lower = pattern(columns);
        // With the identity ordering this version reads the upper triangle only, whatever side it is told.
        let mut upper = vec![Vec::new(); columns.len()];
        for (column, rows) in columns.iter().enumerate() {
            rows.iter().for_each(|&row| upper[row].push(column));
        }
        let symbolic = factorize_symbolic_cholesky(
            pattern(&upper).as_ref(),
            Side::Upper,
            SymmetricOrdering::Identity,
            // Left to choose, this version factorises sheets in the plane column by column, at 51×51 nodes half as fast.
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

    /// Where an entry of the lower triangle is stored.
    pub(crate) fn position(&self, row: usize, column: usize) -> Option<usize> {
        let range = self.lower.col_range(column);
        let found = self.lower.row_idx()[range.clone()].binary_search(&row).ok()?;
        Some(range.start + found)
    }

    /// Where a diagonal entry is stored.
    pub(crate) fn diagonal(&self, column: usize) -> usize {
        // Columns start with their diagonal.
        self.lower.col_range(column).start
    }

    /// `product` = A x, A symmetric with these lower entries.
    pub(crate) fn multiply(&self, lower: &[f64], x: &[f64], product: &mut [f64]) {
        product.fill(0.0);
        let rows = self.lower.row_idx();
        for column in 0..self.size() {
            let range = self.lower.col_range(column);
            let factor = x[column];
            let mut sum = lower[range.start] * factor;
            for (&row, &value) in rows[range.clone()].iter().zip(&lower[range]).skip(1) {
                product[row] += value * factor;
                sum += value * x[row];
            }
            product[column] += sum;
        }
    }

    fn as_ref(&self) -> SymbolicSparseColMatRef<'_, usize> {
        self.lower.as_ref()
    }
}

/// How linear systems are solved.
pub(crate) enum Linear {
    /// By factorisation.
    Direct(Factor),
    /// By conjugate gradients.
    Iterative(ConjugateGradient),
}

impl Linear {
    /// Makes the matrix with these lower entries ready.
    pub(crate) fn prepare(&mut self, pattern: &Pattern, lower: &[f64]) -> Result<(), NotPositiveDefinite> {
        match self {
            Self::Direct(factor) => factor.factorise(pattern, lower),
            Self::Iterative(gradients) => gradients.prepare(pattern, lower),
        }
    }

    /// Solves in place for as many right-hand sides as are stacked in `columns`.
    pub(crate) fn solve(
        &mut self,
        pattern: &Pattern,
        columns: &mut [f64],
    ) -> Result<(), NotPositiveDefinite> {
        match self {
            Self::Direct(factor) => {
                factor.solve(pattern, columns);
                Ok(())
            }
            Self::Iterative(gradients) => columns
                .chunks_exact_mut(pattern.size().max(1))
                .try_for_each(|column| gradients.solve(pattern, column)),
        }
    }

    /// The direction, of length 1, in which K is softest, and the stiffness there, by inverse iteration with
    /// K + μI, which is prepared. It ends when a negative stiffness is settled to 1 %.
    pub(crate) fn softest(&mut self, pattern: &Pattern, shift: f64, direction: &mut [f64]) -> f64 {
        direction.iter_mut().enumerate().for_each(|(index, d)| *d = irregular(index));
        normalise(direction);
        let mut before = direction.to_vec();
        let mut stiffness = f64::INFINITY;
        for _ in 0..INVERSE_ITERATIONS {
            before.copy_from_slice(direction);
            if self.solve(pattern, direction).is_err() {
                return f64::INFINITY;
            }
            let length = normalise(direction);
            let along: f64 = before.iter().zip(direction.iter()).map(|(a, b)| a * b).sum();
            let last = std::mem::replace(&mut stiffness, along / length - shift);
            if stiffness < 0.0 && (last - stiffness).abs() < 0.01 * stiffness.abs() {
                break;
            }
        }
        stiffness
    }

    /// How many factorisations were made.
    pub(crate) fn factorisations(&self) -> usize {
        match self {
            Self::Direct(factor) => factor.count,
            Self::Iterative(_) => 0,
        }
    }

    /// How many iterations of conjugate gradients were made.
    pub(crate) fn iterations(&self) -> usize {
        match self {
            Self::Direct(_) => 0,
            Self::Iterative(gradients) => gradients.iterations,
        }
    }
}

/// The numeric part of a factorisation, with all the memory it needs.
pub(crate) struct Factor {
    values: Vec<f64>,
    memory: MemBuffer,
    /// How many factorisations were made.
    count: usize,
}

/// The matrix has a pivot that is not positive, or an entry that is not finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct NotPositiveDefinite;

impl Factor {
    pub(crate) fn new(pattern: &Pattern) -> Self {
        let request = pattern.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        Self {
            values: vec![0.0; pattern.symbolic.len_val()],
            memory: MemBuffer::new(request.or(pattern.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq))),
            count: 0,
        }
    }

    /// Factorises the matrix with these lower entries.
    fn factorise(&mut self, pattern: &Pattern, lower: &[f64]) -> Result<(), NotPositiveDefinite> {
        self.count += 1;
        // A NaN would come back as a factor full of NaN, and as success.
        if !lower.iter().all(|value| value.is_finite()) {
            return Err(NotPositiveDefinite);
        }
        let matrix = SparseColMatRef::new(pattern.as_ref(), lower);
        pattern
            .symbolic
            .factorize_numeric_llt(
                &mut self.values,
                matrix,
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Spec::default(),
            )
            .map(|_| ())
            .map_err(|_| NotPositiveDefinite)
    }

    /// Solves for as many right-hand sides as are stacked in `columns`, in place.
    fn solve(&mut self, pattern: &Pattern, columns: &mut [f64]) {
        let size = pattern.size();
        if size == 0 {
            return;
        }
        let sides = columns.len() / size;
        let request = pattern.symbolic.solve_in_place_scratch::<f64>(sides, Par::Seq);
        let mut larger;
        // Several right-hand sides at once are rare (once a frame): only they get memory of their own.
        let memory = if sides > 1 {
            larger = MemBuffer::new(request);
            &mut larger
        } else {
            &mut self.memory
        };
        LltRef::new(&pattern.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(columns, size, sides),
            Par::Seq,
            MemStack::new(memory),
        );
    }
}

/// With a shift up to ten times the most negative stiffness, so many leave 3e-5 of what has no stiffness at all. A solve
/// is cheap beside a factorisation.
const INVERSE_ITERATIONS: usize = 100;

/// Divides by the length, and returns it.
fn normalise(vector: &mut [f64]) -> f64 {
    let length = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
    vector.iter_mut().for_each(|v| *v /= length);
    length
}

/// Irregular numbers in [−1, 1], the same on every machine: multiples of the golden ratio.
pub(crate) fn irregular(index: usize) -> f64 {
    2.0 * ((index + 1) as f64 * 0.618_033_988_749_895).fract() - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The path graph's Laplacian plus one.
    fn chain(size: usize) -> (Pattern, Vec<f64>) {
        let columns: Vec<Vec<usize>> = (0..size).map(|i| (i..(i + 2).min(size)).collect()).collect();
        let pattern = Pattern::new(&columns).unwrap();
        let values =
            columns.iter().flatten().zip(columns.iter().enumerate().flat_map(|(i, c)| vec![i; c.len()]));
        let values = values.map(|(&row, column)| if row == column { 3.0 } else { -1.0 }).collect();
        (pattern, values)
    }

    #[test]
    fn solves_several_right_hand_sides() {
        let (pattern, values) = chain(50);
        let mut factor = Factor::new(&pattern);
        factor.factorise(&pattern, &values).unwrap();
        let exact: Vec<f64> = (0..150).map(|i| (i as f64).sin()).collect();
        let mut sides: Vec<f64> = exact
            .chunks(50)
            .flat_map(|x| {
                (0..50).map(|i| {
                    3.0 * x[i] - if i > 0 { x[i - 1] } else { 0.0 } - if i < 49 { x[i + 1] } else { 0.0 }
                })
            })
            .collect();
        factor.solve(&pattern, &mut sides);
        assert!(sides.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-14));
    }

    #[test]
    fn says_when_a_matrix_is_not_positive_definite() {
        let (pattern, mut values) = chain(50);
        let mut factor = Factor::new(&pattern);
        values[20] = -3.0;
        assert!(factor.factorise(&pattern, &values).is_err());
        values[20] = f64::NAN;
        assert!(factor.factorise(&pattern, &values).is_err());
        assert_eq!(factor.count, 2);
    }

    #[test]
    fn an_order_is_a_permutation() {
        for side in [3, 60] {
            let sheet = (0..side * side).map(|node| (node % side, node / side));
            let around = |(column, row): (usize, usize)| {
                let left = column.checked_sub(1).map(|_| row * side + column - 1);
                let below = row.checked_sub(1).map(|_| row * side + column - side);
                let right = (column + 1 < side).then_some(row * side + column + 1);
                let above = (row + 1 < side).then_some(row * side + column + side);
                [below, left, right, above].into_iter().flatten().collect()
            };
            let neighbours: Vec<Vec<usize>> = sheet.clone().map(around).collect();
            let places: Vec<Vector3<f64>> =
                sheet.map(|(x, y)| Vector3::new(x as f64, y as f64, 0.0)).collect();
            let mut sorted = order(&neighbours, &places);
            sorted.sort_unstable();
            assert_eq!(sorted, (0..side * side).collect::<Vec<_>>());
        }
    }
}
