//! Half bands, and what they are worth.

use cloth_fit::stage::report::Sample;

/// Half a band this many times what it is about is no knowledge of it.
pub(crate) const NO_KNOWLEDGE: f64 = 10.0;

/// Half a sample's 95 % band over its stress; nothing where that is not known.
pub(super) fn half_band(sample: &Sample) -> Option<f64> {
    let [low, high] = sample.band?;
    // Infinite, or no number, where there is no stress.
    Some(0.5 * (high - low) / sample.stress.abs()).filter(|half| *half < NO_KNOWLEDGE)
}

/// Half a band as a share, in per cent; what rounds to nothing is not said to be nothing.
pub(super) fn sure(share: f64) -> String {
    if share < 5e-4 { "0.1 % or better".into() } else { format!("{:.1} %", 100.0 * share) }
}
