//! Names with a unit suffix: `tx_m`, `areal_density_kg_m2`. Values in another unit are reported, never converted.

/// Unit suffixes, longest first, with their names.
const UNITS: [(&str, &str); 30] = [
    ("_n_per_m", "newtons per metre"),
    ("_per_m", "per metre"),
    ("_n_m", "newton metres"),
    ("_kg_m3", "kilograms per cubic metre"),
    ("_g_m2", "grams per square metre"),
    ("_kg_m2", "kilograms per square metre"),
    ("_m_s2", "metres per second squared"),
    ("_m_s", "metres per second"),
    ("_mm", "millimetres"),
    ("_cm", "centimetres"),
    ("_um", "micrometres"),
    ("_km", "kilometres"),
    ("_in", "inches"),
    ("_m", "metres"),
    ("_mn", "millinewtons"),
    ("_cn", "centinewtons"),
    ("_kn", "kilonewtons"),
    ("_gf", "grams-force"),
    ("_lbf", "pounds-force"),
    ("_n", "newtons"),
    ("_ms", "milliseconds"),
    ("_min", "minutes"),
    ("_h", "hours"),
    ("_s", "seconds"),
    ("_g", "grams"),
    ("_mg", "milligrams"),
    ("_kg", "kilograms"),
    ("_deg", "degrees"),
    ("_rad", "radians"),
    ("_percent", "percent"),
];

/// Splits `tx_mm` into the quantity `tx` and the unit "millimetres", and `moment [gf·cm/cm]` into `moment` and the
/// bracketed text.
fn split(name: &str) -> (&str, Option<&str>) {
    if let Some((quantity, unit)) = in_brackets(name) {
        return (quantity, Some(unit));
    }
    UNITS
        .iter()
        .find_map(|&(suffix, unit)| Some((name.strip_suffix(suffix)?, Some(unit))))
        .unwrap_or((name, None))
}

/// Splits a name into quantity and bracketed unit.
fn in_brackets(name: &str) -> Option<(&str, &str)> {
    let within = |open: char, close: char| name.strip_suffix(close)?.rsplit_once(open);
    let (quantity, unit) = within('[', ']').or_else(|| within('(', ')'))?;
    Some((quantity.trim(), unit.trim()))
}

/// True if the names differ only in their units.
pub(super) fn same_quantity(found: &str, expected: &str) -> bool {
    split(&found.to_lowercase()).0 == split(expected).0
}

/// Remedy for a name with another unit, or without one.
pub(super) fn conversion(found: &str, expected: &str) -> String {
    // Bending moments are per width: N·m/m.
    let per_width = if expected.starts_with("moment") { ", newton metres per metre of width" } else { "" };
    let found = found.to_lowercase();
    match (split(&found).1, split(expected).1) {
        (Some(from), Some(to)) if from != to => format!("convert {from} to {to}{per_width}"),
        (None, Some(to)) => format!("the values in {to}, the unit in the name"),
        _ => "exactly this name".into(),
    }
}
