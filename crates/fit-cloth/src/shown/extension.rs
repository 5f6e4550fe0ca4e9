//! How far a test went, as axes name it.

use cloth_data::kind::{Extension, Kind};

/// What a test's extension is, for an axis.
pub(crate) fn extension(kind: Kind) -> &'static str {
    match kind.extension() {
        Extension::ShearAngle => "effective shear angle [rad]",
        Extension::Overhang => "overhang [m]",
        Extension::Elongation => "extension [–]",
    }
}
