//! When more control points of a curve pay.

/// A fall of ‖r/σ‖² that two more points bring by chance once in a hundred. A gain above it counts however small its share
/// is: beside a hysteresis of a fifth of the force, one per cent of the residual is much.
pub(super) const SIGNIFICANT: f64 = 9.21;

/// When more control points pay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrowthRule {
    /// They must lower the residual by this share; default 1 %, as published, but of another [`Measure`].
    pub gain: f64,
    /// What must fall; default the root mean square; published its square.
    pub measure: Measure,
    /// A gain that chance does not explain pays however small its share is; default true; published false.
    pub significance: bool,
    /// So many numbers of points in a row that do not pay are the end; default 2; published 1.
    pub tries: usize,
}

/// How the size of residuals is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// In newtons or metres.
    RootMeanSquare,
    /// The function that is minimised.
    SumOfSquares,
}

impl Default for GrowthRule {
    fn default() -> Self {
        Self { gain: 0.01, measure: Measure::RootMeanSquare, significance: true, tries: 2 }
    }
}

impl GrowthRule {
    /// Until the sum of squares falls by less than 1 %. Source: Miguel et al. 2012, §5.2.
    pub const PUBLISHED: Self =
        Self { gain: 0.01, measure: Measure::SumOfSquares, significance: false, tries: 1 };

    /// True if a fall of the sum of squares pays.
    ///
    /// * `noise` — variance of a residual
    pub(super) fn pays(&self, before: f64, after: f64, noise: f64) -> bool {
        let left = match self.measure {
            Measure::RootMeanSquare => (1.0 - self.gain).powi(2),
            Measure::SumOfSquares => 1.0 - self.gain,
        };
        after < left * before || self.significance && before - after > SIGNIFICANT * noise
    }
}
