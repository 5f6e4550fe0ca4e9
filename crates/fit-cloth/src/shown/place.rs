//! A place of a shape, to compute with.

use cloth_fit::stage::shapes::Place;
use nalgebra::Vector3;

/// In double precision.
pub(crate) fn vector(place: Place) -> Vector3<f64> {
    Vector3::from(place.map(f64::from))
}
