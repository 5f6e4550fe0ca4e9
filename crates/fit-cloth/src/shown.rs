//! What page and figures both show of a sequence, beside its shapes.

mod clip_force;
mod profile;

pub(crate) use clip_force::{ClipForce, clip_forces};
pub(crate) use profile::{Profile, profiles};

use cloth_fit::shapes::Place;
use nalgebra::Vector3;

/// In double precision.
pub(crate) fn vector(place: Place) -> Vector3<f64> {
    Vector3::from(place.map(f64::from))
}
