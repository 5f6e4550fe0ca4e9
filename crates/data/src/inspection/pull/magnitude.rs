//! Forces of a size that no cloth has: another unit.

use super::reading::{Pull, digits};
use crate::notice::{Notice, Severity};
use cloth_sim::curve::soundness::MEMBRANE_STIFFNESS;

/// A metre of cloth that is softer than the weight of so many metres of itself hangs down by more than a quarter.
const SOFTEST_M: f64 = 2.0;
/// Largest stress by areal density, m²/s²: 1 N/tex along the pull, as fabrics of aramid just before they break.
const STRONGEST: f64 = 1e6;
/// Stiffness by areal density of common cloth, m²/s², to find the unit that is meant.
const COMMON: f64 = 1e4;
/// A unit is likely that makes it common within this factor.
const LIKELY: f64 = 100.0;
/// Units in newtons.
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

/// Judges the stiffness and the strength at the largest force.
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
    let likely = likely.map_or(String::new(), |(name, _)| format!(" (as {name} it would do)"));
    let expected = format!(
        "{lowest:.1} to {:.0e} N/m, and a stress of at most {:.1e} N/m of a cloth of {areal_density} kg/m²: \
         another unit than N{likely}, or another width",
        MEMBRANE_STIFFNESS[1],
        STRONGEST * areal_density,
    );
    Some(pull.notice(Severity::Doubt, largest, found, expected))
}
