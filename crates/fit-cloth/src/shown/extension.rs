//! Axis labels for the extension of a test.

use cloth_data::frame::Kind;

/// Name and unit of a test's extension.
pub(crate) fn extension(kind: Kind) -> &'static str {
    match kind {
        Kind::Shear | Kind::ComplexShear => "effective shear angle [rad]",
        Kind::BendWeft | Kind::BendWarp | Kind::BendBias => "overhang [m]",
        _ => "extension [–]",
    }
}
