//! Sparse symmetric systems: ordering, factorisation, conjugate gradients. All use of faer is inside this module.
//!
//! The symbolic factorisation is computed once per pattern, the numeric one in every step, in reused memory. Everything
//! runs on the calling thread: at this size, solving many frames at once pays more than a parallel factorisation.

pub(crate) mod cholesky;
pub(crate) mod conjugate_gradient;
pub(crate) mod matrix;
pub(crate) mod ordering;

use crate::sequence::irregular;
use cholesky::Factor;
use conjugate_gradient::ConjugateGradient;
use matrix::{NotPositiveDefinite, Pattern};

/// Solver of linear systems.
pub(crate) enum Linear {
    /// By factorisation.
    Direct(Factor),
    /// By conjugate gradients.
    Iterative(ConjugateGradient),
}

impl Linear {
    /// Prepares the matrix with these lower entries.
    pub(crate) fn prepare(&mut self, pattern: &Pattern, lower: &[f64]) -> Result<(), NotPositiveDefinite> {
        match self {
            Self::Direct(factor) => factor.factorise(pattern, lower),
            Self::Iterative(gradients) => gradients.prepare(pattern, lower),
        }
    }

    /// Solves in place for all right-hand sides stacked in `columns`.
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

    /// Finds the unit direction in which K is softest, and returns the stiffness there, by inverse iteration with K +
    /// μI, which must be prepared. Stops when a negative stiffness has settled to 1 %.
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

    /// Number of factorisations.
    pub(crate) fn factorisations(&self) -> usize {
        match self {
            Self::Direct(factor) => factor.count,
            Self::Iterative(_) => 0,
        }
    }

    /// Number of conjugate gradient iterations.
    pub(crate) fn iterations(&self) -> usize {
        match self {
            Self::Direct(_) => 0,
            Self::Iterative(gradients) => gradients.iterations,
        }
    }
}

/// With a shift up to ten times the most negative stiffness, this many iterations leave 3e-5 of a component with zero
/// stiffness. A solve is cheap compared with a factorisation.
const INVERSE_ITERATIONS: usize = 100;

/// Normalises a vector and returns its length.
fn normalise(vector: &mut [f64]) -> f64 {
    let length = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
    vector.iter_mut().for_each(|v| *v /= length);
    length
}
