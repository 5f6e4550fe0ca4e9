//! Positions of a shape as vectors.

use cloth_fit::stage::shapes::Place;
use nalgebra::Vector3;

/// Converts a position to double precision.
pub(crate) fn vector(place: Place) -> Vector3<f64> {
    Vector3::from(place.map(f64::from))
}
