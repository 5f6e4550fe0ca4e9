//! How far a test went, as axes name it.

use cloth_data::frame::Kind;

/// What a test's extension is, for an axis.
pub(crate) fn extension(kind: Kind) -> &'static str {
    match kind {
        Kind::Shear | Kind::ComplexShear => "effective shear angle [rad]",
        Kind::BendWeft | Kind::BendWarp | Kind::BendBias => "overhang [m]",
        _ => "extension [–]",
    }
}
