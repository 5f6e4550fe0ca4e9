//! Half widths of 95 % bands.

use cloth_fit::stage::report::CurveRow;

/// A half band this many times the value itself counts as not known.
pub(crate) const NO_KNOWLEDGE: f64 = 10.0;

/// Half a sample's 95 % band over its stress; `None` if not known.
pub(super) fn half_band(sample: &CurveRow) -> Option<f64> {
    let [low, high] = sample.band?;
    // Infinite or NaN where the stress is zero.
    Some(0.5 * (high - low) / sample.stress.abs()).filter(|half| *half < NO_KNOWLEDGE)
}

/// A half band in per cent; a share below 0.05 % is printed as `0.1 % or better` instead of 0.
pub(super) fn sure(share: f64) -> String {
    if share < 5e-4 { "0.1 % or better".into() } else { format!("{:.1} %", 100.0 * share) }
}
