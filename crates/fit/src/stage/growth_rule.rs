//! Criterion for more control points of a curve.

/// Decrease of ‖r/σ‖² that two more points bring by chance in one of a hundred fits. A larger decrease counts however
/// small its share: next to hysteresis of a fifth of the force, one per cent of the residual is large.
pub(super) const SIGNIFICANT: f64 = 9.21;

/// Criterion for more control points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrowthRule {
    /// Minimum relative decrease of the residual; default 1 %, as published, but of another [`ResidualMeasure`].
    pub gain: f64,
    /// Measure of the residual; default the root mean square; published its square.
    pub measure: ResidualMeasure,
    /// A decrease beyond chance pays however small its share; default true; published false.
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
    /// * `noise` — variance of a residual
    pub(super) fn pays(&self, before: f64, after: f64, noise: f64) -> bool {
        let left = match self.measure {
            ResidualMeasure::RootMeanSquare => (1.0 - self.gain).powi(2),
            ResidualMeasure::SumOfSquares => 1.0 - self.gain,
        };
        after < left * before || self.significance && before - after > SIGNIFICANT * noise
    }
}
