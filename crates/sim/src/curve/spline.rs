//! The Hermite spline k(ε): validation of its control points, and its coefficients, which are linear in the control
//! values.
//!
//! ```text
//! k = kᵢ + mᵢ t + (3s − 2mᵢ − mᵢ₊₁)/h t² + (mᵢ + mᵢ₊₁ − 2s)/h² t³      t = ε − εᵢ,  h = εᵢ₊₁ − εᵢ,  s = (kᵢ₊₁ − kᵢ)/h
//! mᵢ = (kᵢ₊₁ − kᵢ₋₁)/(εᵢ₊₁ − εᵢ₋₁) inside, one-sided at the two ends
//! ```

use crate::error::{Error, Result};

/// Largest strain and largest absolute stiffness; its inverse is the least distance between two strains. Slopes are
/// then at most 1e100 and cubic coefficients at most 1e201, so energies, stresses and tangents stay finite.
pub(super) const LARGEST: f64 = 1e50;
const LEAST_GAP: f64 = 1e-50;

/// Rejects strains that no curve can have.
pub(super) fn check_strains(strains: &[f64]) -> Result<()> {
    if strains.is_empty() {
        return Err(Error::Curve { point: 0, reason: "a curve needs at least one control point" });
    }
    if let Some(point) = strains.iter().position(|strain| !strain.is_finite()) {
        return Err(Error::Curve { point, reason: "its strain is not finite" });
    }
    if let Some(point) = strains.iter().position(|strain| *strain > LARGEST) {
        return Err(Error::Curve { point, reason: "its strain is beyond 1e50" });
    }
    if let Some(point) = strains.windows(2).position(|pair| pair[0] >= pair[1]) {
        return Err(Error::Curve { point: point + 1, reason: "its strain is not above the one before" });
    }
    if let Some(point) = strains.windows(2).position(|pair| pair[1] - pair[0] < LEAST_GAP) {
        return Err(Error::Curve {
            point: point + 1,
            reason: "its strain is less than 1e-50 above the one before",
        });
    }
    if strains[0] != 0.0 && strains.len() > 1 || strains[0] < 0.0 {
        return Err(Error::Curve { point: 0, reason: "the first strain must be zero" });
    }
    Ok(())
}

/// Slope mᵢ as a row over the control values.
pub(super) fn slope_row(strains: &[f64], point: usize) -> Vec<f64> {
    let [low, high] = [point.saturating_sub(1), (point + 1).min(strains.len() - 1)];
    let mut row = vec![0.0; strains.len()];
    row[high] += 1.0 / (strains[high] - strains[low]);
    row[low] -= 1.0 / (strains[high] - strains[low]);
    row
}

/// The four coefficients of a segment, each a row over the control values.
pub(super) fn segment_rows(strains: &[f64], segment: usize) -> [Vec<f64>; 4] {
    let width = strains[segment + 1] - strains[segment];
    let [m0, m1] = [slope_row(strains, segment), slope_row(strains, segment + 1)];
    let unit = |point: usize, i: usize| if i == point { 1.0 } else { 0.0 };
    let row = |entry: &dyn Fn(f64, f64, f64, f64) -> f64| -> Vec<f64> {
        (0..strains.len())
            .map(|i| entry(unit(segment, i), (unit(segment + 1, i) - unit(segment, i)) / width, m0[i], m1[i]))
            .collect()
    };
    [
        row(&|k0, _, _, _| k0),
        row(&|_, _, m0, _| m0),
        row(&|_, secant, m0, m1| (3.0 * secant - 2.0 * m0 - m1) / width),
        row(&|_, secant, m0, m1| (m0 + m1 - 2.0 * secant) / (width * width)),
    ]
}
