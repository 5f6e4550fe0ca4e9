//! Robust residuals: limit the weight of outliers.
//!
//! ```text
//! ρ(r) = 2c² (√(1 + (r/c)²) − 1)      pseudo-Huber: r² where small, 2c|r| where large
//! r̃ = sign(r) √ρ(r)                   so that Σ r̃² is the robust sum, and a least-squares method minimises it
//! ρ″/2 = (1 + (r/c)²)^(−3/2)          of which Gauss–Newton on r̃ has (dr̃/dr)²: far more where r is large, so that it creeps
//! ```
//!
//! Source: Hartley and Zisserman, Multiple View Geometry (2004), A6.8; Triggs et al., Bundle adjustment (2000), 4.3.

/// A pseudo-Huber function: residuals up to about its limit keep full weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Robust {
    /// c, in the units of the residuals.
    pub limit: f64,
}

impl Robust {
    /// r̃ and dr̃/dr.
    pub fn bend(&self, residual: f64) -> (f64, f64) {
        let ratio = residual / self.limit;
        let root = (1.0 + ratio * ratio).sqrt();
        // √(2(root − 1)) c = |r| √(2/(root + 1)), without cancellation.
        let share = (2.0 / (root + 1.0)).sqrt();
        (residual * share, 1.0 / (root * share))
    }

    /// √(ρ″/2) over dr̃/dr for a transformed residual r̃. A row of the Jacobian times this, with its residual over
    /// this, has the slope of Σ r̃² and its full curvature in r.
    pub fn curvature(&self, bent: f64) -> f64 {
        // ρ = r̃² gives √(1 + (r/c)²) without r.
        let root = 1.0 + 0.5 * (bent / self.limit).powi(2);
        (2.0 / (root * (root + 1.0))).sqrt()
    }

    /// dr/dr̃ √w for a transformed residual r̃, w = ρ′/2r: a row of the Jacobian times this, with its residual over this, is
    /// √w times the plain one. Such steps (iteratively reweighted least squares) never raise Σ ρ.
    pub fn weighted(&self, bent: f64) -> f64 {
        let root = 1.0 + 0.5 * (bent / self.limit).powi(2);
        (2.0 * root / (root + 1.0)).sqrt()
    }

    /// Mean of ρ over noise of standard deviation 1, by the trapezoidal rule: the remaining mean square.
    pub fn mean_of_noise(&self) -> f64 {
        let density = |z: f64| (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
        let step = 0.05;
        let rho = |z: f64| self.bend(z).0.powi(2);
        (-160..=160).map(|i| step * f64::from(i)).map(|z| step * density(z) * rho(z)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_residuals_count_in_full_and_large_ones_linearly() {
        let robust = Robust { limit: 3.0 };
        let (value, slope) = robust.bend(1e-4);
        assert!((value - 1e-4).abs() < 1e-12 && (slope - 1.0).abs() < 1e-8);
        let (value, _) = robust.bend(-3e4);
        assert!(value < 0.0 && (value * value / (2.0 * 3.0 * 3e4) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn noise_that_is_far_below_the_limit_counts_in_full() {
        assert!((Robust { limit: 1e3 }.mean_of_noise() - 1.0).abs() < 1e-5);
        // Of the series z² − z⁴/4c² + z⁶/8c⁴ − 5 z⁸/64 c⁶ the terms fall slowly: at c = 10 the next is below 1e-6.
        let expected = 1.0 - 3.0 / 400.0 + 15.0 / 8e4 - 5.0 * 105.0 / 64e6;
        assert!((Robust { limit: 10.0 }.mean_of_noise() - expected).abs() < 1e-6);
    }

    #[test]
    fn the_slope_is_the_derivative() {
        let robust = Robust { limit: 2.0 };
        for residual in [-7.0, -1.0, 0.3, 2.0, 40.0] {
            let h = 1e-6;
            let slope = (robust.bend(residual + h).0 - robust.bend(residual - h).0) / (2.0 * h);
            assert!((slope - robust.bend(residual).1).abs() < 1e-8);
        }
    }

    #[test]
    fn weighted_rows_are_those_of_the_plain_residual() {
        let robust = Robust { limit: 2.0 };
        for residual in [-7.0f64, -1.0, 0.3, 2.0, 40.0] {
            let weight = 1.0 / (1.0 + (residual / 2.0).powi(2)).sqrt();
            let (bent, slope) = robust.bend(residual);
            let share = robust.weighted(bent);
            assert!((bent / share - weight.sqrt() * residual).abs() < 1e-12);
            assert!((slope * share - weight.sqrt()).abs() < 1e-12);
        }
    }

    #[test]
    fn the_curvature_is_half_the_second_derivative() {
        let robust = Robust { limit: 2.0 };
        for residual in [-7.0, -1.0, 0.3, 2.0, 40.0] {
            let h = 1e-3;
            let rho = |r: f64| robust.bend(r).0.powi(2);
            let second = (rho(residual + h) - 2.0 * rho(residual) + rho(residual - h)) / (h * h);
            let (bent, slope) = robust.bend(residual);
            assert!((0.5 * second - (robust.curvature(bent) * slope).powi(2)).abs() < 1e-7);
        }
    }
}
