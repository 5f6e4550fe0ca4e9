//! Axis labels for the extension of a test.

use cloth_data::kind::{Extension, Kind};

/// Name and unit of a test's extension.
pub(crate) fn extension(kind: Kind) -> &'static str {
    match kind.extension() {
        Extension::ShearAngle => "effective shear angle [rad]",
        Extension::Overhang => "overhang [m]",
        Extension::Elongation => "extension [–]",
    }
}
