//! Uncertainty of a fitted curve: noise and misfit, covariance of the control values, bands on the stress.
//!
//! ```text
//! C = [σ² + (s² − σ²) n/p] (JᵀJ)⁻¹        band of σ(ε):  ± t √(wᵀ C w),   w = ∂σ/∂k
//! ```
//!
//! σ² is the noise of a measurement, s² = ‖r‖²/(n − p) the residual variance of n measurements after p parameters.
//! Noise is independent between measurements, so it averages out. Misfit (too few control points, hysteresis, a wrong
//! model) is shared by neighbouring measurements: n of them then tell no more than p, hence the factor n/p. Only the
//! excess of s² over its 99 % quantile under noise alone counts as misfit, so that a band does not jump when misfit
//! is first detected.

use nalgebra::{DMatrix, DVector, Dyn, SymmetricEigen};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Relative eigenvalue of the scaled JᵀJ below which the data do not see a direction: its standard deviation would be
/// a hundred thousand times that of the best direction.
const RANK_TOLERANCE: f64 = 1e-10;

/// Standard normal quantiles of 97.5 % and 99 %.
const Z_975: f64 = 1.959_963_985;
const Z_99: f64 = 2.326_347_874;

/// Noise and misfit of a fit, in the units of its residuals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Scatter {
    /// Standard deviation of one measurement.
    pub noise: f64,
    /// True if the noise was given; otherwise it was estimated from differences between successive residuals.
    pub known: bool,
    /// s, root mean square of the residual per degree of freedom.
    pub residual: f64,
    /// Misfit √(s² − qσ²), with q the 99 % quantile of s²/σ² under noise alone; 0 if s² is lower.
    pub misfit: f64,
    /// Measurements that a parameter can move.
    pub measurements: usize,
    /// Measurements less parameters.
    pub freedom: usize,
    /// Mean square of noise alone, over σ²: 1, or less if large residuals have less weight.
    pub expected: f64,
    /// A given noise that the residuals contradict; what is estimated stands in its place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contradicted: Option<f64>,
}

/// A given noise is contradicted by so many times as much, or as little.
pub const CONTRADICTED: f64 = 3.0;

/// Source of the noise of a fit's measurements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoiseSource<'a> {
    /// The noise of one measurement was declared.
    Declared(f64),
    /// Measurements that no parameter can tell apart differ by noise alone.
    Repeats {
        /// Sum of their squared differences from what they share.
        squares: f64,
        /// Its degrees of freedom.
        freedom: usize,
    },
    /// Differences of consecutive residuals: indices, in order. Without any, all residuals are noise.
    Neighbours(&'a [Vec<usize>]),
}

impl Scatter {
    /// Splits the residuals of a fit into noise and misfit.
    ///
    /// * `residual` — one entry per measurement
    /// * `jacobian` — its rows; zero rows, which no parameter moves, are omitted, small ones are not
    /// * `rank` — number of parameters that the measurements tell, eliminated ones included
    pub fn new(
        residual: &DVector<f64>,
        jacobian: &DMatrix<f64>,
        rank: usize,
        source: NoiseSource<'_>,
    ) -> Self {
        let informative: Vec<bool> = jacobian.row_iter().map(|row| row.amax() > 0.0).collect();
        let measurements = informative.iter().filter(|&&seen| seen).count();
        let freedom = measurements.saturating_sub(rank);
        let square = |i: usize| residual[i] * residual[i];
        let sum: f64 = (0..residual.len()).filter(|&i| informative[i]).map(square).sum();
        let mean_square = sum / freedom.max(1) as f64;
        let variance = match source {
            NoiseSource::Declared(noise) => noise * noise,
            NoiseSource::Repeats { squares, freedom } => squares / freedom as f64,
            NoiseSource::Neighbours(tracks) => {
                successive_variance(residual, tracks, &informative).unwrap_or(mean_square)
            }
        };
        let by_neighbours = matches!(source, NoiseSource::Neighbours(_));
        // The 99 % quantile of s²/σ² under noise alone.
        let chance = if by_neighbours {
            // Von Neumann's ratio: spread of its deviation from 1 for white noise.
            let n = measurements as f64;
            1.0 / (1.0 - Z_99 * ((n - 2.0).max(1.0) / (n * n - 1.0)).sqrt()).max(f64::MIN_POSITIVE)
        } else {
            chi_square(freedom.max(1) as f64, Z_99) / freedom.max(1) as f64
        };
        let excess = if freedom > 0 { (mean_square - chance * variance).max(0.0) } else { 0.0 };
        // Estimated noise cannot exceed the residual.
        let variance = if by_neighbours && excess == 0.0 { mean_square } else { variance };
        let misfit = excess.sqrt();
        Self {
            noise: variance.sqrt(),
            known: matches!(source, NoiseSource::Declared(_)),
            residual: mean_square.sqrt(),
            misfit,
            measurements,
            freedom,
            expected: 1.0,
            contradicted: None,
        }
    }
}

impl Scatter {
    /// True if the residual is below its 1 % quantile under the given noise: that noise is too large.
    pub fn noise_is_overstated(&self) -> bool {
        let freedom = self.freedom as f64;
        self.known
            && freedom > 0.0
            && self.residual.powi(2) * freedom
                < chi_square(freedom, -Z_99) * self.expected * self.noise.powi(2)
    }

    /// Variance of a white error that blurs parameters as much as the misfit does, which neighbours share: n measurements
    /// tell hardly more of it than the parameters. A misfit that the parameters could meet wholly would have n/p of its
    /// square; on exact elasticas the errors are about half of that (tests/real/bending_laws.rs: 0.41 to 0.49 of it).
    ///
    /// * `rank` — number of parameters that the measurements tell
    fn excess(&self, rank: usize) -> f64 {
        0.25 * self.misfit.powi(2) * self.measurements as f64 / rank.max(1) as f64
    }

    /// Standard deviation of a measurement: as declared, or else as if all that is left were white noise.
    pub(crate) fn white(&self) -> f64 {
        if self.known { self.noise } else { self.residual }
    }

    /// Converts to other units.
    pub fn times(self, unit: f64) -> Self {
        Self {
            noise: self.noise * unit,
            residual: self.residual * unit,
            misfit: self.misfit * unit,
            contradicted: self.contradicted.map(|given| given * unit),
            ..self
        }
    }
}

/// Variance of a residual after a fit of `parameters` parameters. If the noise is known: 1, in its units, unless the
/// sum of squares is below its 1 % quantile. Otherwise: the sum of squares per degree of freedom.
pub(crate) fn variance_left(residual: &DVector<f64>, parameters: usize, known: bool) -> f64 {
    let freedom = residual.len().saturating_sub(parameters).max(1) as f64;
    let sum = residual.norm_squared();
    if known && sum >= chi_square(freedom, -Z_99) { 1.0 } else { sum / freedom }
}

/// Variance from differences of neighbours, in which a smooth misfit cancels; `None` if no measurement has a
/// neighbour. Repeated readings carry no information on noise and are skipped.
fn successive_variance(residual: &DVector<f64>, tracks: &[Vec<usize>], informative: &[bool]) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0usize);
    for track in tracks {
        let seen: Vec<usize> = track.iter().copied().filter(|&i| informative[i]).collect();
        for pair in seen.windows(2).filter(|pair| residual[pair[0]] != residual[pair[1]]) {
            sum += (residual[pair[1]] - residual[pair[0]]).powi(2);
            count += 1;
        }
    }
    (count > 0).then(|| sum / (2.0 * count as f64))
}

/// Quantile of the χ² distribution (Wilson and Hilferty 1931).
///
/// * `z` — the standard normal quantile
pub(crate) fn chi_square(freedom: f64, z: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    freedom * (1.0 - spread + z * spread.sqrt()).max(0.0).powi(3)
}

/// 97.5 % quantile of Student's t (Cornish–Fisher expansion, within 1 % from 3 degrees of freedom on; tabled below).
fn student_975(freedom: f64) -> f64 {
    if freedom < 3.0 {
        return if freedom < 2.0 { 12.706 } else { 4.303 };
    }
    let z = Z_975;
    let z2 = z * z;
    let terms = [
        z * (z2 + 1.0) / 4.0,
        z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0,
        z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0,
    ];
    z + terms[0] / freedom + terms[1] / freedom.powi(2) + terms[2] / freedom.powi(3)
}

/// Sources of a curve's uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Source {
    /// Noise of the measurements, and what they do not tell of the curve's course.
    Noise,
    /// Errors of the clips' poses.
    ClipPoses,
    /// What no curve meets: hysteresis, or a law that the model cannot follow.
    Misfit,
    /// What the correction for the grid may leave.
    Grid,
    /// What so few control points may not follow: the distance to the curve with twice as many segments.
    Curve,
    /// Errors of curves fitted before.
    Earlier,
    /// Curves that were not measured and are assumed.
    Assumed,
}

impl std::fmt::Display for Source {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Noise => "noise",
            Self::ClipPoses => "clip poses",
            Self::Misfit => "misfit",
            Self::Grid => "grid",
            Self::Curve => "control points",
            Self::Earlier => "earlier curves",
            Self::Assumed => "assumed curves",
        })
    }
}

/// Covariance of the control values.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    /// Covariance matrix, over the directions that the data see.
    pub matrix: DMatrix<f64>,
    /// Its summands by source.
    parts: BTreeMap<Source, DMatrix<f64>>,
    /// (JᵀJ)⁻¹, over the same directions.
    inverse: DMatrix<f64>,
    /// Number of directions that the data see.
    pub rank: usize,
    /// Directions that the data do not see, as columns.
    pub unseen: DMatrix<f64>,
    /// Half-width of a 95 % band in standard deviations; `None` without degrees of freedom to estimate the noise.
    quantile: Option<f64>,
}

impl Covariance {
    /// Rank of a Jacobian.
    pub fn rank_of(jacobian: &DMatrix<f64>) -> usize {
        let gram = gram(jacobian).0;
        let largest = gram.eigenvalues.max();
        gram.eigenvalues.iter().filter(|&&value| value > RANK_TOLERANCE * largest).count()
    }

    /// The covariance of control values fitted with this Jacobian.
    pub fn new(jacobian: &DMatrix<f64>, scatter: &Scatter) -> Self {
        let parameters = jacobian.ncols();
        let (gram, norms) = gram(jacobian);
        let largest = gram.eigenvalues.max();
        let seen = |i: usize| gram.eigenvalues[i] > RANK_TOLERANCE * largest;
        let rank = (0..parameters).filter(|&i| seen(i)).count();
        let mut inverse = DMatrix::zeros(parameters, parameters);
        let mut unseen = Vec::new();
        for i in 0..parameters {
            let direction = gram.eigenvectors.column(i).component_div(&norms);
            if seen(i) {
                inverse += &direction * direction.transpose() / gram.eigenvalues[i];
            } else {
                unseen.push(direction.normalize());
            }
        }
        let unseen =
            if unseen.is_empty() { DMatrix::zeros(parameters, 0) } else { DMatrix::from_columns(&unseen) };
        // Noise estimated from few residuals is itself uncertain.
        let quantile = match scatter.freedom {
            _ if scatter.known && scatter.misfit == 0.0 => Some(Z_975),
            0 => None,
            freedom => Some(student_975(freedom as f64)),
        };
        Self::of_parts(inverse, scatter, rank, unseen, quantile)
    }

    fn of_parts(
        inverse: DMatrix<f64>,
        scatter: &Scatter,
        rank: usize,
        unseen: DMatrix<f64>,
        quantile: Option<f64>,
    ) -> Self {
        let noise = &inverse * scatter.noise.powi(2);
        let misfit = &inverse * scatter.excess(rank);
        let matrix = &noise + &misfit;
        let parts = BTreeMap::from([(Source::Noise, noise), (Source::Misfit, misfit)]);
        Self { matrix, parts, inverse, rank, unseen, quantile }
    }

    /// As [`Covariance::new`], but with a prior.
    ///
    /// * `inverse` — the posterior covariance in units of the noise
    pub(crate) fn with_prior(jacobian: &DMatrix<f64>, scatter: &Scatter, inverse: &DMatrix<f64>) -> Self {
        let Self { rank, quantile, .. } = Self::new(jacobian, scatter);
        let unseen = DMatrix::zeros(jacobian.ncols(), 0);
        Self::of_parts(inverse.clone(), scatter, rank, unseen, quantile)
    }

    /// G = (JᵀJ)⁻¹ Jᵀ J_q: effect of other parameters' errors on these.
    pub fn gain(&self, jacobian: &DMatrix<f64>, other: &DMatrix<f64>) -> DMatrix<f64> {
        &self.inverse * (jacobian.transpose() * other)
    }

    /// Adds the errors of other parameters: G Cov(q) Gᵀ.
    pub fn carry(&mut self, gain: &DMatrix<f64>, covariance: &DMatrix<f64>) {
        self.add(Source::Earlier, gain * covariance * gain.transpose());
    }

    /// Adds an error along a known direction, within ± 1 times it in 95 of 100 cases.
    pub fn widen(&mut self, source: Source, direction: &DVector<f64>) {
        self.add(source, direction * direction.transpose() / Z_975.powi(2));
    }

    /// Takes a part of the noise's covariance for another source.
    pub(crate) fn attribute(&mut self, source: Source, part: DMatrix<f64>) {
        self.matrix -= &part;
        if let Some(noise) = self.parts.get_mut(&Source::Noise) {
            *noise -= &part;
        }
        self.add(source, part);
    }

    fn add(&mut self, source: Source, summand: DMatrix<f64>) {
        self.matrix += &summand;
        let zero = || DMatrix::zeros(summand.nrows(), summand.ncols());
        *self.parts.entry(source).or_insert_with(zero) += summand;
    }

    /// Change of the parameters by errors of the measured values: (JᵀJ)⁻¹ Jᵀ e.
    pub fn change(&self, jacobian: &DMatrix<f64>, errors: &DVector<f64>) -> DVector<f64> {
        &self.inverse * (jacobian.transpose() * errors)
    }

    /// Variance of Σ wᵢkᵢ by noise alone.
    pub(crate) fn noise(&self, weights: &DVector<f64>) -> f64 {
        self.parts.get(&Source::Noise).map_or(0.0, |noise| (weights.transpose() * noise * weights)[0])
    }

    /// Half-widths of the 95 % band of Σ wᵢkᵢ by source; empty where there is no band.
    pub fn half_bands_by_source(&self, weights: &DVector<f64>) -> BTreeMap<Source, f64> {
        let (Some(_), Some(quantile)) = (self.half_band(weights), self.quantile) else {
            return BTreeMap::new();
        };
        let variance = |matrix: &DMatrix<f64>| (weights.transpose() * matrix * weights)[0];
        // Of errors along one direction another source can take no more than there are.
        let lacking = self.parts.get(&Source::Noise).map_or(0.0, |noise| variance(noise).min(0.0));
        let half = |(&source, matrix): (&Source, &DMatrix<f64>)| {
            let taken = if source == Source::ClipPoses { lacking } else { 0.0 };
            (source, quantile * (variance(matrix) + taken).max(0.0).sqrt())
        };
        self.parts.iter().map(half).collect()
    }

    /// Half-width of the 95 % band of Σ wᵢkᵢ; `None` if the data do not see it, or leave no degrees of freedom.
    pub fn half_band(&self, weights: &DVector<f64>) -> Option<f64> {
        let hidden = (self.unseen.transpose() * weights).norm();
        if hidden > 1e-6 * weights.norm() {
            return None;
        }
        Some(self.quantile? * (weights.transpose() * &self.matrix * weights)[0].max(0.0).sqrt())
    }

    /// Standard deviation of each control value; `None` if the data do not see it.
    pub fn standard_deviations(&self) -> Vec<Option<f64>> {
        (0..self.matrix.ncols())
            .map(|i| {
                let seen = self.quantile.is_some() && self.unseen.row(i).norm() <= 1e-6;
                seen.then(|| self.matrix[(i, i)].max(0.0).sqrt())
            })
            .collect()
    }

    /// Half-width of the 95 % band of each control value; `None` if the data do not see it.
    pub fn half_bands(&self) -> Vec<Option<f64>> {
        let band = |deviation: Option<f64>| Some(self.quantile? * deviation?);
        self.standard_deviations().into_iter().map(band).collect()
    }

    /// Correlation matrix of the control values; `None` for pairs with one that the data do not see.
    pub fn correlations(&self) -> Vec<Vec<Option<f64>>> {
        let correlation = |i: usize, j: usize| {
            let size = (self.matrix[(i, i)] * self.matrix[(j, j)]).sqrt();
            (size > 0.0).then(|| self.matrix[(i, j)] / size)
        };
        let all = 0..self.matrix.ncols();
        all.clone().map(|i| all.clone().map(|j| correlation(i, j)).collect()).collect()
    }
}

/// Eigenvalues and eigenvectors of JᵀJ with columns of unit length, and the original lengths.
///
/// The matrix is small. Its eigenvalues are squared singular values; below 1e-10 of the largest, no instrument is
/// precise enough.
fn gram(jacobian: &DMatrix<f64>) -> (SymmetricEigen<f64, Dyn>, DVector<f64>) {
    let norms = jacobian.column_iter().map(|column| if column.norm() > 0.0 { column.norm() } else { 1.0 });
    let norms = DVector::from_iterator(jacobian.ncols(), norms);
    let product = jacobian.transpose() * jacobian;
    let scaled = DMatrix::from_fn(norms.len(), norms.len(), |i, j| product[(i, j)] / (norms[i] * norms[j]));
    (scaled.symmetric_eigen(), norms)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{SeedableRng, rngs::StdRng};
    use rand_distr::{Distribution, StandardNormal};

    fn white(rng: &mut StdRng, n: usize, noise: f64) -> DVector<f64> {
        DVector::from_fn(n, |_, _| {
            let sample: f64 = StandardNormal.sample(rng);
            noise * sample
        })
    }

    fn line(n: usize) -> (DMatrix<f64>, Vec<Vec<usize>>) {
        (DMatrix::from_fn(n, 2, |i, j| (i as f64 / n as f64).powi(j as i32)), vec![(0..n).collect()])
    }

    #[test]
    fn white_noise_is_no_misfit_and_its_estimate_is_right() {
        let mut rng = StdRng::seed_from_u64(4);
        let (jacobian, tracks) = line(60);
        let (mut flagged, mut sum) = (0, 0.0);
        for _ in 0..400 {
            let noise = white(&mut rng, 60, 0.2);
            let fit = jacobian.clone().svd(true, true).solve(&noise, 1e-12).unwrap();
            let residual = &noise - &jacobian * fit;
            let known = Scatter::new(&residual, &jacobian, 2, NoiseSource::Declared(0.2));
            let estimated = Scatter::new(&residual, &jacobian, 2, NoiseSource::Neighbours(&tracks));
            flagged += usize::from(known.misfit > 0.0) + usize::from(estimated.misfit > 0.0);
            sum += estimated.noise / 400.0;
        }
        assert!(flagged <= 800 * 3 / 100, "{flagged}");
        assert!((sum - 0.2).abs() < 0.01, "{sum}");
    }

    #[test]
    fn sources_take_no_more_than_there_is() {
        let (jacobian, _) = line(60);
        let scatter = Scatter::new(&DVector::zeros(60), &jacobian, 2, NoiseSource::Declared(0.2));
        let covariance = Covariance::new(&jacobian, &scatter);
        let weights = DVector::from_vec(vec![1.0, 0.5]);
        let whole = covariance.half_band(&weights).unwrap();
        for share in [0.3, 1.4] {
            let mut covariance = covariance.clone();
            let part = share * &covariance.matrix;
            covariance.attribute(Source::ClipPoses, part);
            let parts = covariance.half_bands_by_source(&weights);
            let together = parts.values().map(|half| half * half).sum::<f64>().sqrt();
            assert!((together / whole - 1.0).abs() < 1e-9, "{share}: {parts:?}");
            assert!((parts[&Source::ClipPoses] / whole - share.min(1.0).sqrt()).abs() < 1e-9, "{parts:?}");
        }
    }

    #[test]
    fn a_smooth_misfit_is_seen_beside_the_noise() {
        let mut rng = StdRng::seed_from_u64(5);
        let (jacobian, tracks) = line(60);
        let residual = white(&mut rng, 60, 0.01) + DVector::from_fn(60, |i, _| 0.1 * (i as f64 * 0.3).sin());
        for known in [Some(0.01), None] {
            let scatter = Scatter::new(
                &residual,
                &jacobian,
                2,
                known.map_or(NoiseSource::Neighbours(&tracks), NoiseSource::Declared),
            );
            assert!((scatter.misfit - 0.07).abs() < 0.01, "{scatter:?}");
            assert!(scatter.noise < 0.03, "{scatter:?}");
        }
    }

    /// As in the tails of NIST's Eckerle4: standard deviations are √(‖r‖²/(n − p) (JᵀJ)⁻¹) over all n.
    #[test]
    fn a_measurement_that_a_parameter_hardly_moves_counts() {
        let jacobian = DMatrix::from_column_slice(4, 1, &[2.0, 1.0, 1e-20, 1e-35]);
        let residual = DVector::from_vec(vec![0.3, -0.6, 0.1, -0.2]);
        let scatter = Scatter::new(&residual, &jacobian, 1, NoiseSource::Neighbours(&[]));
        assert_eq!((scatter.measurements, scatter.freedom), (4, 3));
        let deviation = Covariance::new(&jacobian, &scatter).standard_deviations()[0].unwrap();
        assert!((deviation - (0.5 / 3.0 / 5.0f64).sqrt()).abs() < 1e-12, "{deviation}");
        let none = DMatrix::from_column_slice(4, 1, &[2.0, 1.0, 0.0, 0.0]);
        assert_eq!(Scatter::new(&residual, &none, 1, NoiseSource::Neighbours(&[])).measurements, 2);
    }

    #[test]
    fn a_noise_that_is_declared_too_large_is_noticed_and_no_measure() {
        let mut rng = StdRng::seed_from_u64(6);
        let (jacobian, _) = line(60);
        let residual = white(&mut rng, 60, 0.2);
        for (declared, overstated) in [(0.6, true), (0.2, false)] {
            let scatter = Scatter::new(&residual, &jacobian, 2, NoiseSource::Declared(declared));
            assert_eq!(scatter.noise_is_overstated(), overstated, "{scatter:?}");
            let variance = variance_left(&(&residual / declared), 2, true);
            let expected = if overstated { scatter.residual.powi(2) / declared.powi(2) } else { 1.0 };
            assert!((variance / expected - 1.0).abs() < 1e-9, "{variance} {expected}");
        }
    }

    #[test]
    fn what_no_measurement_sees_has_no_band() {
        let jacobian = DMatrix::from_row_slice(3, 3, &[1.0, 2.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 3.0]);
        let scatter = Scatter {
            noise: 1.0,
            known: true,
            residual: 1.0,
            misfit: 0.0,
            measurements: 3,
            freedom: 1,
            expected: 1.0,
            contradicted: None,
        };
        let covariance = Covariance::new(&jacobian, &scatter);
        assert_eq!((covariance.rank, Covariance::rank_of(&jacobian)), (2, 2));
        assert_eq!(covariance.half_band(&DVector::from_vec(vec![1.0, 0.0, 0.0])), None);
        let seen = covariance.half_band(&DVector::from_vec(vec![0.0, 0.0, 1.0])).unwrap();
        assert!((seen - Z_975 / 3.0).abs() < 1e-9);
        assert!(covariance.half_band(&DVector::from_vec(vec![1.0, 2.0, 0.0])).is_some());
    }

    #[test]
    fn quantiles_match_tables() {
        for (freedom, t) in [(1.0, 12.706), (3.0, 3.182), (5.0, 2.571), (10.0, 2.228), (30.0, 2.042)] {
            assert!((student_975(freedom) / t - 1.0).abs() < 0.01);
        }
        for (freedom, chi) in [(5.0, 15.086), (20.0, 37.566), (100.0, 135.807)] {
            assert!((chi_square(freedom, Z_99) / chi - 1.0).abs() < 0.01);
        }
    }
}
