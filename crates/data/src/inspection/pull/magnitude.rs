//! Forces implausible for cloth, which indicate another unit.

use super::reading::{Pull, digits};
use crate::notice::{Notice, Severity};
use cloth_sim::curve::soundness::MEMBRANE_STIFFNESS;

/// A metre of cloth whose stiffness is below the weight of this many metres of itself stretches by more than a
/// quarter when hung.
const SOFTEST_M: f64 = 2.0;
/// Largest stress per areal density, m²/s²: 1 N/tex along the pull, as in aramid fabrics just before they break.
const STRONGEST: f64 = 1e6;
/// Stiffness per areal density of common cloth, m²/s², used to guess the intended unit.
const COMMON: f64 = 1e4;
/// A unit is plausible if it brings the stiffness within this factor of the common value.
const LIKELY: f64 = 100.0;
/// Units and their value in newtons.
const UNITS: [(&str, f64); 8] = [
    ("MN", 1e6),
    ("kN", 1e3),
    ("kgf", 9.80665),
    ("lbf", 4.448),
    ("cN", 1e-2),
    ("gf", 9.80665e-3),
    ("mN", 1e-3),
    ("µN", 1e-6),
];

/// Checks stiffness and stress at the largest force.
///
/// * `areal_density` — kg/m²
pub(super) fn check(pull: &Pull, areal_density: f64) -> Option<Notice> {
    let largest = pull.readings.iter().max_by(|a, b| a.force.total_cmp(&b.force))?;
    let (stress, strain) = (largest.force / pull.width, largest.separation / pull.gauge - 1.0);
    if strain <= 0.0 {
        return None;
    }
    let stiffness = stress / strain;
    let lowest = MEMBRANE_STIFFNESS[0].max(SOFTEST_M * 9.81 * areal_density);
    if stiffness >= lowest && stiffness <= MEMBRANE_STIFFNESS[1] && stress <= STRONGEST * areal_density {
        return None;
    }
    let found = format!(
        "{} N on {:.1} mm at a strain of {strain:.4}, a stiffness of {} N/m",
        digits(largest.force, 3),
        1e3 * pull.width,
        digits(stiffness, 3),
    );
    let off = |(_, unit): &&(&str, f64)| (unit * stiffness / (COMMON * areal_density)).ln().abs();
    let likely =
        UNITS.iter().filter(|unit| off(unit) <= f64::ln(LIKELY)).min_by(|a, b| off(a).total_cmp(&off(b)));
    let likely = likely.map_or(String::new(), |(name, _)| format!(" ({name} would be plausible)"));
    let expected = format!(
        "{lowest:.1} to {:.0e} N/m, and a stress of at most {:.1e} N/m of a cloth of {areal_density} kg/m²: \
         another unit than N{likely}, or another width",
        MEMBRANE_STIFFNESS[1],
        STRONGEST * areal_density,
    );
    Some(pull.notice(Severity::Doubt, largest, found, expected))
}
