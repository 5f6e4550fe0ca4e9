//! How a curve runs is not known before: constant, straight, or bent. All three are weighed by what the data say.
//!
//! ```text
//! k = (k₁ … k_P) = B θ      θ = (mean, trend, second differences), the mean is free
//! constant   θ = (θ₀)                        straight   θ = (θ₀, θ₁ ~ N(0, τ₁²))
//! bent       θ = (θ₀, θ₁ ~ N(0, τ₁²), θ₂ … ~ N(0, τ₂²))      ln τ ~ N(ln usual, WIDTH²)
//! evidence   −2 ln p(y | τ) = ln|AᵀA + D| − ln|D|₊ + min_θ (‖y − A θ‖² + θᵀ D θ)      A = J B, D = diag(0, τ₁⁻², τ₂⁻² …)
//! k̄ = Σ w k(τ)      C = Σ w (C(τ) + (k(τ) − k̄)(k(τ) − k̄)ᵀ)      w ∝ p(y | τ) p(τ), of straight ones a tenth
//! ```
//!
//! What the data do not tell apart stays in the band; what they do tell is as sharp as with the right number of points
//! known. Source: MacKay 1992 (evidence), Hoeting et al. 1999 (averages over models), Wahba 1983 (their bands).

use nalgebra::{DMatrix, DVector};

/// Usual change from end to end and usual second difference of five points, as shares of the stiffness.
const USUAL: [f64; 2] = [0.3, 0.05];

/// A straight course that is no constant is chance, and weighs a tenth of the others: else curves that bend too little to be
/// told from a straight one would lie outside their bands.
const STRAIGHT: f64 = 0.1;

/// Standard deviation of ln τ.
const WIDTH: f64 = 1.5;

/// Step of ln τ, and how many go either way.
const STEP: f64 = 0.5;
const REACH: i32 = 12;

/// The control values that remain possible.
#[derive(Debug, Clone)]
pub(super) struct Posterior {
    /// k̄.
    pub(super) mean: DVector<f64>,
    /// C.
    pub(super) covariance: DMatrix<f64>,
}

/// One description of the curve.
struct Possible {
    /// −2 ln of its weight.
    cost: f64,
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl Posterior {
    /// Weighs all descriptions by a linearised fit; `None` if it tells nothing of the mean.
    ///
    /// * `residual`, `jacobian` — in units of the noise, at `point`: three or more control values
    pub(super) fn new(
        residual: &DVector<f64>,
        jacobian: &DMatrix<f64>,
        point: &DVector<f64>,
    ) -> Option<Self> {
        let points = point.len();
        let level = point.mean().abs().max(f64::MIN_POSITIVE);
        let basis = basis(points)? * level;
        let seen = jacobian * &basis;
        let target = residual + jacobian * point;
        let (square, product) = (seen.transpose() * &seen, seen.transpose() * &target);
        let total = target.norm_squared();
        let possible = |taus: &[f64], unusual: f64| -> Option<Possible> {
            let count = taus.len() + 1;
            let mut matrix = square.view((0, 0), (count, count)).into_owned();
            taus.iter().enumerate().for_each(|(i, tau)| matrix[(i + 1, i + 1)] += tau.powi(-2));
            let cholesky = matrix.cholesky()?;
            let short = product.rows(0, count).into_owned();
            let theta = cholesky.solve(&short);
            let fit = total - short.dot(&theta);
            let prior: f64 = 2.0 * taus.iter().map(|tau| tau.ln()).sum::<f64>();
            let own = basis.columns(0, count);
            Some(Possible {
                cost: cholesky.ln_determinant() + prior + fit + unusual,
                mean: own * &theta,
                covariance: own * cholesky.inverse() * own.transpose(),
            })
        };
        let logs: Vec<f64> = (-REACH..=REACH).map(|step| STEP * f64::from(step)).collect();
        let all: f64 = logs.iter().map(|log| (-0.5 * (log / WIDTH).powi(2)).exp()).sum();
        // −2 ln p(τ), normalised.
        let unusual = |log: f64| (log / WIDTH).powi(2) + 2.0 * all.ln();
        let rare = -2.0 * STRAIGHT.ln();
        let finer = (4.0 / (points - 1) as f64).powi(2);
        let mut found: Vec<Possible> = possible(&[], 0.0).into_iter().collect();
        for trend in &logs {
            let tau = USUAL[0] * trend.exp();
            found.extend(possible(&[tau], unusual(*trend) + rare));
            for bend in &logs {
                let mut taus = vec![finer * USUAL[1] * bend.exp(); points - 1];
                taus[0] = tau;
                found.extend(possible(&taus, unusual(*trend) + unusual(*bend)));
            }
        }
        let least = found.iter().map(|possible| possible.cost).fold(f64::INFINITY, f64::min);
        let weight = |possible: &Possible| (-0.5 * (possible.cost - least)).exp();
        let all: f64 = found.iter().map(weight).sum();
        if !(all > 0.0 && all.is_finite()) {
            return None;
        }
        let mut posterior = Self { mean: DVector::zeros(points), covariance: DMatrix::zeros(points, points) };
        found.iter().for_each(|possible| posterior.mean += weight(possible) / all * &possible.mean);
        for possible in &found {
            let off = &possible.mean - &posterior.mean;
            posterior.covariance += weight(possible) / all * (&possible.covariance + &off * off.transpose());
        }
        Some(posterior)
    }
}

/// B: columns of the control values at a mean of 1, a trend of 1 from end to end, and second differences of 1.
fn basis(points: usize) -> Option<DMatrix<f64>> {
    let middle = 0.5 * (points - 1) as f64;
    let square: f64 = (0..points).map(|i| (i as f64 - middle).powi(2)).sum();
    let bends = second_differences(points);
    let theta = DMatrix::from_fn(points, points, |row, i| match row {
        0 => 1.0 / points as f64,
        // Least-squares slope times the length.
        1 => (i as f64 - middle) * (points - 1) as f64 / square,
        _ => bends[(row - 2, i)],
    });
    theta.try_inverse()
}

/// S: second differences of control values, one row each.
pub(super) fn second_differences(points: usize) -> DMatrix<f64> {
    DMatrix::from_fn(points - 2, points, |i, j| match j.wrapping_sub(i) {
        0 | 2 => 1.0,
        1 => -2.0,
        _ => 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{SeedableRng, rngs::StdRng};
    use rand_distr::{Distribution, StandardNormal};

    const POINTS: usize = 5;

    /// 200 fits of a curve of control values by noisy values between them: rms error, and share within the band.
    fn fits(noise: f64, exact: [f64; POINTS]) -> [f64; 2] {
        let exact = DVector::from_column_slice(&exact);
        let jacobian =
            DMatrix::from_fn(60, POINTS, |i, j| (1.0 - (i as f64 / 14.75 - j as f64).abs()).max(0.0));
        let point = DVector::from_element(POINTS, 1.0);
        let mut random = StdRng::seed_from_u64(3);
        let (mut square, mut inside) = (0.0, 0.0);
        for _ in 0..200 {
            let mut sample = |_, _| -> f64 { StandardNormal.sample(&mut random) };
            let residual = &jacobian * (&exact - &point) / noise + DVector::from_fn(60, &mut sample);
            let found = Posterior::new(&residual, &(&jacobian / noise), &point).unwrap();
            for j in 0..POINTS {
                let off = found.mean[j] - exact[j];
                square += off * off;
                inside += f64::from(u8::from(off.abs() < 1.96 * found.covariance[(j, j)].sqrt()));
            }
        }
        let all = (200 * POINTS) as f64;
        [(square / all).sqrt(), inside / all]
    }

    #[test]
    fn constant_straight_and_bent_curves_lie_in_their_bands() {
        let curves = [[1.0; 5], [0.8, 0.9, 1.0, 1.1, 1.2], [0.7, 0.95, 1.1, 1.15, 1.1]];
        for (noise, exact) in [0.01, 0.1].into_iter().flat_map(|noise| curves.map(|exact| (noise, exact))) {
            let [error, inside] = fits(noise, exact);
            assert!((0.93..0.99).contains(&inside), "{noise} {exact:?}: {error} {inside}");
        }
    }

    #[test]
    fn a_constant_is_found_as_well_as_if_that_were_known() {
        // Σ (k − 1)² = σ²/60 with one value, about 5 σ²/60 with five.
        for noise in [0.01f64, 0.1] {
            let [error, _] = fits(noise, [1.0; POINTS]);
            assert!(error < 1.2 * noise / 60f64.sqrt(), "{noise}: {error}");
        }
    }
}
