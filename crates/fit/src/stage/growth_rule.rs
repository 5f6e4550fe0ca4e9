//! Criterion for more control points of a curve.

use crate::optimise::uncertainty::chi_square;

/// Standard normal quantile of 99 %.
const Z_99: f64 = 2.326_347_874;

/// Decrease of ‖r/σ‖² that some more points bring by chance in one of a hundred fits. (At half of that, as Akaike's
/// criterion has it, curves follow noise: the worst of 28 noisy fits of linear bending laws then errs by 4.4 % in place of
/// 0.4 %.)
pub(super) fn by_chance(added: usize) -> f64 {
    chi_square(added.max(1) as f64, Z_99)
}

/// Criterion for more control points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrowthRule {
    /// Minimum relative decrease of the residual; default 1 %, as published, but of another [`ResidualMeasure`].
    pub gain: f64,
    /// Measure of the residual; default the root mean square; published its square.
    pub measure: ResidualMeasure,
    /// Where the noise is known, a decrease pays if it is beyond chance, whatever its share: next to hysteresis of a fifth
    /// of the force one per cent of the residual is large, and for few measurements it is chance. Default true;
    /// published false.
    pub significance: bool,
    /// Number of successive levels without pay that ends the growth; default 2; published 1.
    pub tries: usize,
}

/// Measures of the size of residuals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResidualMeasure {
    /// In newtons or metres.
    RootMeanSquare,
    /// The objective function.
    SumOfSquares,
}

impl Default for GrowthRule {
    fn default() -> Self {
        Self { gain: 0.01, measure: ResidualMeasure::RootMeanSquare, significance: true, tries: 2 }
    }
}

impl GrowthRule {
    /// Grows until the sum of squares falls by less than 1 %. Source: Miguel et al. 2012, §5.2.
    pub const PUBLISHED: Self =
        Self { gain: 0.01, measure: ResidualMeasure::SumOfSquares, significance: false, tries: 1 };

    /// True if a decrease of the sum of squares pays.
    ///
    /// * `noise` — variance of a residual, if it is known
    /// * `left` — variance of a residual that no curve explains
    /// * `added` — number of points added
    pub(super) fn pays(
        &self,
        [before, after]: [f64; 2],
        noise: Option<f64>,
        left: f64,
        added: usize,
    ) -> bool {
        let chance = by_chance(added);
        if let Some(noise) = noise.filter(|_| self.significance) {
            return before - after > chance * noise;
        }
        let share = match self.measure {
            ResidualMeasure::RootMeanSquare => (1.0 - self.gain).powi(2),
            ResidualMeasure::SumOfSquares => 1.0 - self.gain,
        };
        after < share * before || self.significance && before - after > chance * left
    }
}
