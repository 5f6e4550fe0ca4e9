//! Irregular but reproducible numbers, identical on every machine.
//!
//! ```text
//! sᵢ = 2 frac((i + 1) φ) − 1      φ = (√5 − 1)/2
//! ```
//!
//! Source: equidistributed sequence of Weyl 1916, with the golden ratio.

/// Number at an index, in [−1, 1].
pub(crate) fn irregular(index: usize) -> f64 {
    2.0 * ((index + 1) as f64 * 0.618_033_988_749_895).fract() - 1.0
}
