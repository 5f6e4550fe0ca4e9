//! The Cholesky factor of a sparse matrix.
//!
//! ```text
//! A = L Lᵀ
//! ```

use super::matrix::{NotPositiveDefinite, Pattern};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::LltRef;
use faer::{Conj, MatMut, Par, Side, Spec};

/// Numeric part of a factorisation, with all the memory it needs.
pub(crate) struct Factor {
    values: Vec<f64>,
    memory: MemBuffer,
    /// Number of factorisations.
    pub(super) count: usize,
}

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
    pub(super) fn factorise(&mut self, pattern: &Pattern, lower: &[f64]) -> Result<(), NotPositiveDefinite> {
        self.count += 1;
        // A NaN would give a factor full of NaN, reported as success.
        if !lower.iter().all(|value| value.is_finite()) {
            return Err(NotPositiveDefinite);
        }
        let matrix = SparseColMatRef::new(pattern.lower.as_ref(), lower);
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

    /// Solves in place for all right-hand sides stacked in `columns`.
    pub(super) fn solve(&mut self, pattern: &Pattern, columns: &mut [f64]) {
        let size = pattern.size();
        if size == 0 {
            return;
        }
        let sides = columns.len() / size;
        let request = pattern.symbolic.solve_in_place_scratch::<f64>(sides, Par::Seq);
        let mut larger;
        // Several right-hand sides at once are rare (once per frame), so only they allocate.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Laplacian of a path graph plus one.
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
}
