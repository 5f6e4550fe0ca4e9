//! Stiffness curves: stiffness against strain as a Hermite spline through control points.
//!
//! ```text
//! σ(ε) = k(ε) ε,   k a cubic Hermite spline through (εᵢ, kᵢ)
//! slopes  mᵢ = (kᵢ₊₁ − kᵢ₋₁)/(εᵢ₊₁ − εᵢ₋₁) inside, one-sided at the two ends
//! beyond the last control point   σ = σₙ + Tₙ (ε − εₙ),   Tₙ = kₙ + εₙ mₙ
//! below zero                      see NegativeStrain
//! ```
//!
//! The slopes are linear in the control values, and so are stress, tangent and energy. At known strains, fitting the kᵢ
//! is therefore a linear problem, and [`stability_rows`] are linear constraints.
//!
//! Source: Miguel et al. 2012, §4.2 (Hermite stiffness, one control point = the linear model). Slopes, end and
//! compression rule are specific to this project: docs/model.md.

mod polynomial;
pub mod soundness;
mod spline;
mod stability;

pub use stability::stability_rows;

use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};
use spline::{LARGEST, check_strains, segment_rows, slope_row};

/// Stress at negative strain. Every rule except `Slack` keeps stress and tangent continuous at zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NegativeStrain {
    /// σ(−ε) = −σ(ε): shear and bending.
    Odd,
    /// σ = k₀ε: compression with the stiffness at zero, for engineering strains.
    Linear,
    /// σ = k₀[1 − (1 + 2ε)^(−½)]: the equivalent for Green strain; the nominal stress is k₀(λ − 1). Finite at collapse,
    /// where linear StVK would lose its stiffness at ε = −1/3.
    Green,
    /// σ = 0: tension only.
    Slack,
}

/// Stress and its derivative at one strain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// σ, N/m (bending: N).
    pub stress: f64,
    /// dσ/dε, in the units of stiffness.
    pub tangent: f64,
}

/// A cubic piece: k = c₀ + c₁t + c₂t² + c₃t³ with t = ε − start.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Segment {
    start: f64,
    coefficients: [f64; 4],
    /// Energy density at `start`.
    energy: f64,
}

impl Segment {
    fn stiffness(&self, t: f64) -> f64 {
        let [a, b, c, d] = self.coefficients;
        a + t * (b + t * (c + t * d))
    }

    fn slope(&self, t: f64) -> f64 {
        let [_, b, c, d] = self.coefficients;
        b + t * (2.0 * c + t * 3.0 * d)
    }

    /// Energy density at t: ∫ (start + t) k(t) dt from 0 to t, plus the energy at the start.
    fn energy(&self, t: f64) -> f64 {
        let [a, b, c, d] = self.coefficients;
        let first = t * (a + t * (b / 2.0 + t * (c / 3.0 + t * d / 4.0)));
        let second = t * t * (a / 2.0 + t * (b / 3.0 + t * (c / 4.0 + t * d / 5.0)));
        self.energy + self.start * first + second
    }
}

/// The data that define a curve. Serialised in this form and validated on deserialisation.
#[derive(Serialize, Deserialize)]
struct ControlPoints {
    strains: Vec<f64>,
    stiffnesses: Vec<f64>,
    negative: NegativeStrain,
}

impl From<StiffnessCurve> for ControlPoints {
    fn from(StiffnessCurve { strains, stiffnesses, negative, .. }: StiffnessCurve) -> Self {
        Self { strains, stiffnesses, negative }
    }
}

impl TryFrom<ControlPoints> for StiffnessCurve {
    type Error = Error;

    fn try_from(points: ControlPoints) -> Result<Self> {
        Self::new(points.strains, points.stiffnesses, points.negative)
    }
}

/// A stiffness curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(into = "ControlPoints", try_from = "ControlPoints")]
pub struct StiffnessCurve {
    strains: Vec<f64>,
    stiffnesses: Vec<f64>,
    negative: NegativeStrain,
    segments: Vec<Segment>,
    /// Energy density, stress and tangent at the last control point, or at zero if it is the only one.
    end: (f64, Response),
}

impl StiffnessCurve {
    /// A curve through control points.
    ///
    /// * `strains` — ascending, the first 0 unless it is the only one
    /// * `stiffnesses` — one per strain, N/m (bending: N·m per the hinge's own strain)
    ///
    /// # Errors
    /// Empty lists or lists of unequal length; values that are not finite or exceed 1e50; strains that do not start at
    /// zero, or that do not ascend by at least 1e-50.
    pub fn new(strains: Vec<f64>, stiffnesses: Vec<f64>, negative: NegativeStrain) -> Result<Self> {
        check_strains(&strains)?;
        if stiffnesses.len() != strains.len() {
            return Err(Error::ShapeMismatch {
                what: "stiffnesses",
                expected: strains.len(),
                found: stiffnesses.len(),
            });
        }
        if let Some(point) = stiffnesses.iter().position(|k| !k.is_finite()) {
            return Err(Error::Curve { point, reason: "its stiffness is not finite" });
        }
        if let Some(point) = stiffnesses.iter().position(|k| k.abs() > LARGEST) {
            return Err(Error::Curve { point, reason: "its stiffness is beyond 1e50" });
        }
        let mut energy = 0.0;
        let mut segments: Vec<Segment> = Vec::with_capacity(strains.len());
        for (index, pair) in strains.windows(2).enumerate() {
            let coefficients = segment_rows(&strains, index)
                .map(|row| row.iter().zip(&stiffnesses).map(|(weight, k)| weight * k).sum());
            let segment = Segment { start: pair[0], coefficients, energy };
            energy = segment.energy(pair[1] - pair[0]);
            segments.push(segment);
        }
        let end = match segments.last() {
            // A straight line from zero: starting it at a distant point would cancel small strains.
            None => (0.0, Response { stress: 0.0, tangent: stiffnesses[0] }),
            Some(last) => {
                let strain = strains[strains.len() - 1];
                let (k, slope) = (stiffnesses[stiffnesses.len() - 1], last.slope(strain - last.start));
                (energy, Response { stress: k * strain, tangent: k + strain * slope })
            }
        };
        Ok(Self { strains, stiffnesses, negative, segments, end })
    }

    /// Constant stiffness: the linear model.
    ///
    /// # Errors
    /// A stiffness that is not finite.
    pub fn constant(stiffness: f64, negative: NegativeStrain) -> Result<Self> {
        Self::new(vec![0.0], vec![stiffness], negative)
    }

    /// Strains of the control points.
    pub fn strains(&self) -> &[f64] {
        &self.strains
    }

    /// Stiffnesses of the control points.
    pub fn stiffnesses(&self) -> &[f64] {
        &self.stiffnesses
    }

    /// Rule for negative strains.
    pub fn negative(&self) -> NegativeStrain {
        self.negative
    }

    /// Number of control points.
    pub fn len(&self) -> usize {
        self.strains.len()
    }

    /// Always false: a curve has at least one control point.
    pub fn is_empty(&self) -> bool {
        self.strains.is_empty()
    }

    /// Copies the curve with other stiffnesses.
    ///
    /// # Errors
    /// Those of [`StiffnessCurve::new`].
    pub fn with_stiffnesses(&self, stiffnesses: Vec<f64>) -> Result<Self> {
        Self::new(self.strains.clone(), stiffnesses, self.negative)
    }

    /// Stress and tangent at a strain.
    #[inline]
    pub fn response(&self, strain: f64) -> Response {
        if strain >= 0.0 {
            return self.positive(strain);
        }
        let k = self.stiffnesses[0];
        match self.negative {
            NegativeStrain::Odd => {
                let Response { stress, tangent } = self.positive(-strain);
                Response { stress: -stress, tangent }
            }
            NegativeStrain::Linear => Response { stress: k * strain, tangent: k },
            NegativeStrain::Green => {
                let stretch = (1.0 + 2.0 * strain).max(COLLAPSED).sqrt();
                Response { stress: k * (1.0 - 1.0 / stretch), tangent: k / (stretch * stretch * stretch) }
            }
            NegativeStrain::Slack => Response { stress: 0.0, tangent: 0.0 },
        }
    }

    /// Stress at a strain.
    pub fn stress(&self, strain: f64) -> f64 {
        self.response(strain).stress
    }

    /// Upper bound of dσ/dε from zero on; exact if the curve is steepest at a control point.
    pub fn greatest_tangent(&self) -> f64 {
        match stability_rows(&self.strains) {
            // Bernstein coefficients bound the tangent from above as well as from below.
            Ok(rows) => (rows * nalgebra::DVector::from_column_slice(&self.stiffnesses)).max(),
            Err(_) => self.end.1.tangent,
        }
    }

    /// Secant stiffness σ/ε at a strain.
    pub fn stiffness(&self, strain: f64) -> f64 {
        if strain == 0.0 { self.stiffnesses[0] } else { self.stress(strain) / strain }
    }

    /// Energy density ∫σ dε from zero to a strain.
    pub fn energy(&self, strain: f64) -> f64 {
        if strain >= 0.0 {
            return self.positive_energy(strain);
        }
        let k = self.stiffnesses[0];
        match self.negative {
            NegativeStrain::Odd => self.positive_energy(-strain),
            NegativeStrain::Linear => 0.5 * k * strain * strain,
            // ε − √(1+2ε) + 1 = ½(λ − 1)², in a form without cancellation.
            NegativeStrain::Green => {
                let stretch = (1.0 + 2.0 * strain).max(COLLAPSED).sqrt();
                0.5 * k * (stretch - 1.0) * (stretch - 1.0)
            }
            NegativeStrain::Slack => 0.0,
        }
    }

    /// Writes ∂σ/∂kᵢ at a strain, for every control point, to `weights`.
    ///
    /// # Panics
    /// If the length of `weights` differs from the number of control points.
    pub fn weights(&self, strain: f64, weights: &mut [f64]) {
        assert_eq!(weights.len(), self.len(), "one weight per control point");
        weights.fill(0.0);
        if strain >= 0.0 {
            stress_row(&self.strains, strain, weights);
        } else if self.negative == NegativeStrain::Odd {
            stress_row(&self.strains, -strain, weights);
            weights.iter_mut().for_each(|weight| *weight = -*weight);
        } else {
            // In compression the stress is proportional to k₀ under every rule.
            weights[0] = match self.negative {
                NegativeStrain::Green => 1.0 - 1.0 / (1.0 + 2.0 * strain).max(COLLAPSED).sqrt(),
                NegativeStrain::Slack => 0.0,
                _ => strain,
            };
        }
    }

    /// Resamples the curve at equidistant control points over [0, `last`].
    ///
    /// # Errors
    /// A range that is not positive, or zero points.
    pub fn resampled(&self, points: usize, last: f64) -> Result<Self> {
        let strains = equidistant(points, last);
        let stiffnesses = strains.iter().map(|&strain| self.stiffness(strain)).collect();
        Self::new(strains, stiffnesses, self.negative)
    }

    fn positive(&self, strain: f64) -> Response {
        match self.segment(strain) {
            Some(segment) => {
                let t = strain - segment.start;
                let k = segment.stiffness(t);
                Response { stress: k * strain, tangent: k + strain * segment.slope(t) }
            }
            None => {
                let Response { stress, tangent } = self.end.1;
                let beyond = strain - self.straight_from();
                Response { stress: stress + tangent * beyond, tangent }
            }
        }
    }

    fn positive_energy(&self, strain: f64) -> f64 {
        match self.segment(strain) {
            Some(segment) => segment.energy(strain - segment.start),
            None => {
                let (energy, Response { stress, tangent }) = self.end;
                let beyond = strain - self.straight_from();
                energy + beyond * (stress + 0.5 * tangent * beyond)
            }
        }
    }

    /// Strain beyond which the curve is a straight line.
    fn straight_from(&self) -> f64 {
        if self.segments.is_empty() { 0.0 } else { self.strains[self.strains.len() - 1] }
    }

    /// The piece that contains a strain ≥ 0; `None` beyond the last control point.
    fn segment(&self, strain: f64) -> Option<&Segment> {
        self.segments.get(segment_at(&self.strains, strain)?)
    }
}

/// Smallest 1 + 2ε at which compression is evaluated. A collapsed triangle has 0, and rounding may go below.
const COLLAPSED: f64 = 1e-12;

/// `points` equidistant strains from 0 to `last`; a single point is at 0.
pub fn equidistant(points: usize, last: f64) -> Vec<f64> {
    match points {
        0 | 1 => vec![0.0; points],
        _ => (0..points).map(|i| last * i as f64 / (points - 1) as f64).collect(),
    }
}

/// The segment that contains a strain ≥ 0, upper end included; `None` beyond the last control point.
fn segment_at(strains: &[f64], strain: f64) -> Option<usize> {
    let index = strains[1..].partition_point(|&end| end < strain);
    // A NaN belongs to no segment.
    strains[1..].get(index).filter(|&&end| strain <= end).map(|_| index)
}

/// Adds the stress at a strain ≥ 0, as a row over the control values, to `row`.
fn stress_row(strains: &[f64], strain: f64, row: &mut [f64]) {
    let last = strains.len() - 1;
    if last == 0 {
        row[0] += strain;
        return;
    }
    // σ = k(ε)ε inside; beyond the end σₙ + Tₙ(ε − εₙ) = kₙε + εₙmₙ(ε − εₙ).
    match segment_at(strains, strain) {
        Some(segment) => {
            let t = strain - strains[segment];
            for (power, coefficients) in segment_rows(strains, segment).iter().enumerate() {
                let factor = strain * t.powi(power as i32);
                row.iter_mut().zip(coefficients).for_each(|(entry, c)| *entry += factor * c);
            }
        }
        None => {
            row[last] += strain;
            let factor = strains[last] * (strain - strains[last]);
            row.iter_mut().zip(slope_row(strains, last)).for_each(|(entry, m)| *entry += factor * m);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng, rngs::StdRng};

    fn random_curve(rng: &mut StdRng, negative: NegativeStrain) -> StiffnessCurve {
        let points = rng.random_range(1..6);
        let stiffnesses = (0..points).map(|_| 10f64.powf(rng.random_range(0.0..3.0))).collect();
        StiffnessCurve::new(equidistant(points, 0.3), stiffnesses, negative).unwrap()
    }

    const RULES: [NegativeStrain; 4] =
        [NegativeStrain::Odd, NegativeStrain::Linear, NegativeStrain::Green, NegativeStrain::Slack];

    #[test]
    fn energy_stress_tangent_and_weights_agree() {
        let mut rng = StdRng::seed_from_u64(1);
        for trial in 0..2000 {
            let curve = random_curve(&mut rng, RULES[trial % 4]);
            let strain: f64 = rng.random_range(-0.3..0.5);
            let h = 1e-5;
            // Differences across a kink of the tangent are of lower order: stay away from the control points.
            if curve.strains().iter().any(|knot| (strain.abs() - knot).abs() < 2.0 * h) {
                continue;
            }
            let scale = curve.stiffnesses().iter().fold(0.0, |a: f64, &b| a.max(b)) * 10.0;
            let Response { stress, tangent } = curve.response(strain);
            let difference = |f: &dyn Fn(f64) -> f64| (f(strain + h) - f(strain - h)) / (2.0 * h);
            assert!((difference(&|e| curve.energy(e)) - stress).abs() < 1e-6 * scale);
            assert!((difference(&|e| curve.stress(e)) - tangent).abs() < 1e-5 * scale);
            let mut weights = vec![0.0; curve.len()];
            curve.weights(strain, &mut weights);
            let sum: f64 = weights.iter().zip(curve.stiffnesses()).map(|(w, k)| w * k).sum();
            assert!((sum - stress).abs() <= 1e-12 * scale, "{sum} {stress}");
        }
    }

    #[test]
    fn stress_and_tangent_are_continuous_everywhere() {
        let mut rng = StdRng::seed_from_u64(2);
        for rule in [NegativeStrain::Odd, NegativeStrain::Linear, NegativeStrain::Green] {
            let curve = random_curve(&mut rng, rule);
            for &knot in curve.strains() {
                let [low, high] = [knot - 1e-13, knot + 1e-13].map(|strain| curve.response(strain));
                let scale = curve.stiffnesses().iter().sum::<f64>();
                assert!((low.stress - high.stress).abs() < 1e-10 * scale);
                assert!((low.tangent - high.tangent).abs() < 1e-8 * scale);
            }
        }
    }

    #[test]
    fn a_curve_passes_its_points_and_one_point_is_linear() {
        let curve =
            StiffnessCurve::new(vec![0.0, 0.1, 0.3], vec![5.0, 7.0, 1.0], NegativeStrain::Odd).unwrap();
        for (strain, k) in [(0.0, 5.0), (0.1, 7.0), (0.3, 1.0)] {
            assert!((curve.stiffness(strain) - k).abs() < 1e-12);
        }
        let linear = StiffnessCurve::constant(4.0, NegativeStrain::Linear).unwrap();
        for strain in [-0.4, 0.0, 0.2, 7.0] {
            assert_eq!(linear.stress(strain), 4.0 * strain);
            assert_eq!(linear.energy(strain), 2.0 * strain * strain);
        }
        // The position of a single control point has no effect.
        let far = StiffnessCurve::new(vec![1e6], vec![4.0], NegativeStrain::Linear).unwrap();
        assert_eq!((far.stress(1e-3), far.energy(1e-3)), (linear.stress(1e-3), linear.energy(1e-3)));
    }

    #[test]
    fn green_compression_is_linear_in_the_change_of_length() {
        let curve = StiffnessCurve::constant(3.0, NegativeStrain::Green).unwrap();
        for stretch in [0.1, 0.5, 0.9f64] {
            let green = 0.5 * (stretch * stretch - 1.0);
            assert!((stretch * curve.stress(green) - 3.0 * (stretch - 1.0)).abs() < 1e-12);
        }
        assert!(curve.response(-0.5).stress.is_finite() && curve.response(-0.6).tangent.is_finite());
    }

    #[test]
    fn the_greatest_tangent_is_a_bound_that_a_line_meets() {
        let mut rng = StdRng::seed_from_u64(3);
        for _ in 0..200 {
            let curve = random_curve(&mut rng, NegativeStrain::Odd);
            let bound = curve.greatest_tangent();
            let tangents = (0..=500).map(|i| curve.response(f64::from(i) * 1e-3).tangent);
            assert!(tangents.fold(f64::MIN, f64::max) <= bound * (1.0 + 1e-12));
        }
        assert_eq!(StiffnessCurve::constant(4.0, NegativeStrain::Odd).unwrap().greatest_tangent(), 4.0);
    }

    #[test]
    fn a_resampled_curve_passes_the_old_one_at_its_points() {
        let curve =
            StiffnessCurve::new(vec![0.0, 0.1, 0.3], vec![5.0, 7.0, 1.0], NegativeStrain::Green).unwrap();
        let again = curve.resampled(4, 0.6).unwrap();
        assert_eq!((again.strains(), again.negative()), (&equidistant(4, 0.6)[..], NegativeStrain::Green));
        for &strain in again.strains() {
            assert!((again.stress(strain) - curve.stress(strain)).abs() < 1e-14);
        }
        assert!(curve.resampled(0, 0.6).is_err() && curve.resampled(3, 0.0).is_err());
    }

    #[test]
    fn a_stiffness_belongs_to_every_strain() {
        let error = StiffnessCurve::new(vec![0.0, 0.1], vec![1.0], NegativeStrain::Odd).unwrap_err();
        assert!(matches!(error, Error::ShapeMismatch { expected: 2, found: 1, .. }), "{error}");
    }

    #[test]
    fn bad_control_points_are_named() {
        let point = |strains: &[f64], k: &[f64]| match StiffnessCurve::new(
            strains.to_vec(),
            k.to_vec(),
            NegativeStrain::Odd,
        )
        .unwrap_err()
        {
            Error::Curve { point, .. } => point,
            other => panic!("{other}"),
        };
        assert_eq!(point(&[], &[]), 0);
        assert_eq!(point(&[0.0, 0.1, 0.1], &[1.0; 3]), 2);
        assert_eq!(point(&[0.0, f64::NAN], &[1.0; 2]), 1);
        assert_eq!(point(&[0.1, 0.2], &[1.0; 2]), 0);
        assert_eq!(point(&[0.0, 0.2], &[1.0, f64::INFINITY]), 1);
        // Slopes and energies of these would overflow.
        assert_eq!(point(&[0.0, 1e-60], &[1.0; 2]), 1);
        assert_eq!(point(&[0.0, 1e60], &[1.0; 2]), 1);
        assert_eq!(point(&[0.0, 0.2], &[-1e60, 1.0]), 0);
    }

    #[test]
    fn the_farthest_control_points_allowed_keep_everything_finite() {
        for strains in [[0.0, 1e-50, 1e50], [0.0, 1e-50, 2e-50], [0.0, 5e49, 1e50]] {
            for k in [[1e50, -1e50, 1e50], [-1e50, 1e50, 1e50], [0.0, 1e50, -1e50]] {
                for negative in [NegativeStrain::Odd, NegativeStrain::Green, NegativeStrain::Linear] {
                    let curve = StiffnessCurve::new(strains.to_vec(), k.to_vec(), negative).unwrap();
                    for strain in strains.iter().flat_map(|e| [-e, 0.5 * e, *e, 2.0 * e]) {
                        let Response { stress, tangent } = curve.response(strain);
                        assert!(
                            [stress, tangent, curve.energy(strain)].iter().all(|value| value.is_finite())
                        );
                    }
                }
            }
        }
    }
}
