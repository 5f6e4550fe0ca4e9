//! Conjugate gradients with a diagonal preconditioner, for the sparse symmetric systems of time steps.
//!
//! ```text
//! P = diag(A)     stop at rᵀP⁻¹r ≤ γ² bᵀP⁻¹b     start at 0
//! ```
//!
//! Source: Baraff and Witkin 1998, §5.2; the matrix already contains their filter, see [`cloth::guide`](crate::cloth).

use super::matrix::{NotPositiveDefinite, Pattern};

/// Memory and settings of the iteration.
#[derive(Debug)]
pub(crate) struct ConjugateGradient {
    /// γ.
    tolerance: f64,
    max_iterations: usize,
    /// Lower entries of the matrix.
    lower: Vec<f64>,
    /// 1 / diagonal.
    inverse_diagonal: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
    /// Number of iterations.
    pub(crate) iterations: usize,
}

impl ConjugateGradient {
    pub(crate) fn new(pattern: &Pattern, tolerance: f64, max_iterations: usize) -> Self {
        let zeros = vec![0.0; pattern.size()];
        Self {
            tolerance,
            max_iterations,
            lower: vec![0.0; pattern.entries()],
            inverse_diagonal: zeros.clone(),
            residual: zeros.clone(),
            direction: zeros.clone(),
            product: zeros,
            iterations: 0,
        }
    }

    /// Takes the matrix with these lower entries.
    pub(crate) fn prepare(&mut self, pattern: &Pattern, lower: &[f64]) -> Result<(), NotPositiveDefinite> {
        self.lower.copy_from_slice(lower);
        for (column, inverse) in self.inverse_diagonal.iter_mut().enumerate() {
            let diagonal = lower[pattern.diagonal(column)];
            // Negated to catch NaN.
            if !(diagonal > 0.0) {
                return Err(NotPositiveDefinite);
            }
            *inverse = 1.0 / diagonal;
        }
        Ok(())
    }

    /// Replaces b by A⁻¹b, or by the last iterate at the iteration limit. A direction without positive curvature is an
    /// error, which leaves `b` undefined.
    pub(crate) fn solve(&mut self, pattern: &Pattern, b: &mut [f64]) -> Result<(), NotPositiveDefinite> {
        self.residual.copy_from_slice(b);
        b.fill(0.0);
        self.direction.fill(0.0);
        let mut size = self.preconditioned_square();
        let mut before = f64::INFINITY;
        let enough = self.tolerance * self.tolerance * size;
        for _ in 0..self.max_iterations {
            if !(size > enough) {
                break;
            }
            let turn = size / before;
            for ((d, r), p) in self.direction.iter_mut().zip(&self.residual).zip(&self.inverse_diagonal) {
                *d = p * r + turn * *d;
            }
            pattern.multiply(&self.lower, &self.direction, &mut self.product);
            let curvature: f64 = self.direction.iter().zip(&self.product).map(|(d, q)| d * q).sum();
            if !(curvature > 0.0) {
                return Err(NotPositiveDefinite);
            }
            let length = size / curvature;
            b.iter_mut().zip(&self.direction).for_each(|(x, d)| *x += length * d);
            self.residual.iter_mut().zip(&self.product).for_each(|(r, q)| *r -= length * q);
            before = size;
            size = self.preconditioned_square();
            self.iterations += 1;
        }
        if size.is_finite() { Ok(()) } else { Err(NotPositiveDefinite) }
    }

    fn preconditioned_square(&self) -> f64 {
        self.residual.iter().zip(&self.inverse_diagonal).map(|(r, p)| r * r * p).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pairs of unknowns, each with the matrix [d c; c d].
    fn pairs(d: f64, c: f64) -> (Pattern, Vec<f64>) {
        let columns: Vec<Vec<usize>> =
            (0..10).flat_map(|i| [vec![2 * i, 2 * i + 1], vec![2 * i + 1]]).collect();
        (Pattern::new(&columns).unwrap(), (0..10).flat_map(|_| [d, c, d]).collect())
    }

    #[test]
    fn two_eigenvalues_take_two_iterations() {
        let (pattern, lower) = pairs(2.0, 1.0);
        let mut gradients = ConjugateGradient::new(&pattern, 1e-12, 100);
        gradients.prepare(&pattern, &lower).unwrap();
        let exact: Vec<f64> = (0..20).map(|i| f64::from(i).sin()).collect();
        let mut b = vec![0.0; 20];
        pattern.multiply(&lower, &exact, &mut b);
        gradients.solve(&pattern, &mut b).unwrap();
        assert!(b.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-14));
        assert_eq!(gradients.iterations, 2);
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_an_error() {
        let (pattern, lower) = pairs(1.0, 2.0);
        let mut gradients = ConjugateGradient::new(&pattern, 1e-12, 100);
        gradients.prepare(&pattern, &lower).unwrap();
        assert!(gradients.solve(&pattern, &mut [1.0, -1.0].repeat(10)).is_err());
        assert!(gradients.prepare(&pattern, &[f64::NAN; 30]).is_err());
        assert!(gradients.prepare(&pattern, &[-1.0; 30]).is_err());
    }
}
