//! Least-squares polynomial through measured points.

use nalgebra::{DMatrix, DVector};

/// Σ cₖ tᵏ with t = (x − origin)/scale.
pub(super) struct Polynomial {
    origin: f64,
    scale: f64,
    coefficients: DVector<f64>,
    /// Covariance of the coefficients; `None` without degrees of freedom.
    covariance: Option<DMatrix<f64>>,
}

impl Polynomial {
    /// Fits points with a degree of at most one less than their number; `None` without two distinct abscissae.
    pub(super) fn through(points: &[[f64; 2]], degree: usize) -> Option<Self> {
        let (origin, last) = (points.first()?[0], points.last()?[0]);
        let scale = last - origin;
        let columns = points.len().min(degree + 1);
        let powers = DMatrix::from_fn(points.len(), columns, |row, power| {
            ((points[row][0] - origin) / scale).powi(power as i32)
        });
        if !powers.iter().all(|power| power.is_finite()) {
            return None;
        }
        let values = DVector::from_iterator(points.len(), points.iter().map(|point| point[1]));
        let coefficients = powers.clone().svd(true, true).solve(&values, 1e-12).ok()?;
        let left = points.len() - columns;
        let variance = (&values - &powers * &coefficients).norm_squared() / left.max(1) as f64;
        let covariance = (powers.transpose() * &powers).try_inverse().filter(|_| left > 0);
        Some(Self { origin, scale, coefficients, covariance: covariance.map(|inverse| inverse * variance) })
    }

    pub(super) fn at(&self, x: f64) -> f64 {
        let t = (x - self.origin) / self.scale;
        self.coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * t + coefficient)
    }

    pub(super) fn slope(&self, x: f64) -> f64 {
        let t = (x - self.origin) / self.scale;
        let terms = self.coefficients.iter().enumerate().skip(1).rev();
        terms.fold(0.0, |sum, (power, coefficient)| sum * t + power as f64 * coefficient) / self.scale
    }

    /// Distance from the first point to the last.
    pub(super) fn span(&self) -> f64 {
        self.scale
    }

    /// Standard deviation of the polynomial at `x`.
    pub(super) fn error(&self, x: f64) -> Option<f64> {
        let t = (x - self.origin) / self.scale;
        let powers = DVector::from_fn(self.coefficients.len(), |power, _| t.powi(power as i32));
        Some(powers.dot(&(self.covariance.as_ref()? * &powers)).max(0.0).sqrt())
    }

    /// Σ (value − polynomial)².
    pub(super) fn squares(&self, points: &[[f64; 2]]) -> f64 {
        points.iter().map(|&[x, value]| (value - self.at(x)).powi(2)).sum()
    }

    /// Abscissa where a parabola or line rises through a level; `None` if it does not.
    pub(super) fn rises_through(&self, level: f64) -> Option<f64> {
        let [c, b, a] = [0, 1, 2].map(|power| self.coefficients.get(power).copied().unwrap_or(0.0));
        let c = c - level;
        let slope = (b * b - 4.0 * a * c).sqrt();
        // The root with positive slope, without cancellation on either side of the vertex.
        let t = if b >= 0.0 { -2.0 * c / (b + slope) } else { (slope - b) / (2.0 * a) };
        (slope > 0.0 && t.is_finite()).then_some(self.origin + self.scale * t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_comes_back_and_so_do_its_roots() {
        // 3 (x − 2)(x − 5) rises through 0 at 5, through 30 at 7; its mirror image rises at 2.
        let parabola = |x: f64| 3.0 * (x - 2.0) * (x - 5.0);
        let points: Vec<[f64; 2]> = (0..9).map(f64::from).map(|x| [x, parabola(x)]).collect();
        let found = Polynomial::through(&points, 2).unwrap();
        assert!((found.at(11.0) - parabola(11.0)).abs() < 1e-9 && found.squares(&points) < 1e-18);
        assert!((found.slope(11.0) - 45.0).abs() < 1e-9);
        assert!((found.rises_through(0.0).unwrap() - 5.0).abs() < 1e-12);
        assert!((found.rises_through(30.0).unwrap() - 7.0).abs() < 1e-12);
        assert!(found.rises_through(-30.0).is_none());
        let mirrored: Vec<[f64; 2]> = points.iter().map(|[x, value]| [*x, -value]).collect();
        let found = Polynomial::through(&mirrored, 2).unwrap();
        assert!((found.rises_through(0.0).unwrap() - 2.0).abs() < 1e-12);
        let line = Polynomial::through(&[[1.0, 2.0], [3.0, 6.0]], 2).unwrap();
        assert!((line.rises_through(0.0).unwrap()).abs() < 1e-12);
        assert!(Polynomial::through(&[[1.0, 2.0], [1.0, 6.0]], 2).is_none());
        assert!(Polynomial::through(&[], 2).is_none());
    }
}
