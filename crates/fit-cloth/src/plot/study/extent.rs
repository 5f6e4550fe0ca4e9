//! Extents of logarithmic axes.

use std::ops::Range;

/// Decades that contain all values; `None` if no value is above zero.
pub(super) fn decades(values: impl Iterator<Item = f64>) -> Option<Range<f64>> {
    let (mut low, mut high) = (f64::INFINITY, 0.0f64);
    for value in values.filter(|value| *value > 0.0) {
        (low, high) = (low.min(value), high.max(value));
    }
    (high > 0.0).then(|| 10f64.powf((0.9 * low).log10().floor())..10f64.powf((1.1 * high).log10().ceil()))
}
