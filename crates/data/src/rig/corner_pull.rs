//! Corner pull test: four small clips; one pair of opposite corners is pulled apart and released, then the other.

use super::fabric::KnownFabric;
use super::schedule::Step;
use super::sheet::Sheet;
use super::test::{GRAVITY, Grip, Support, Test};
use crate::frame::Kind;
use nalgebra::{Isometry3, Vector2, Vector3};

/// Side of a small clip, m.
pub(super) const SIDE: f64 = 0.01;

/// Mass of a small clip, kg (Miguel et al. 2012, §3).
pub(super) const MASS: f64 = 0.0019;

/// The test. Its drive is the distance by which a pair is pulled apart, m: positive for the corners below left and
/// above right, negative for the other two.
pub(super) fn test(fabric: &KnownFabric, steps: Vec<Step>) -> Test {
    let size = Vector2::new(fabric.width_m, fabric.height_m);
    let names = ["below-left", "above-right", "below-right", "above-left"];
    let corners = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]].map(Vector2::from);
    let clips = names
        .into_iter()
        .zip(corners)
        .map(|(name, corner)| {
            let low = corner.component_mul(&size.add_scalar(-SIDE));
            Grip { name, mass_kg: MASS, low, high: low.add_scalar(SIDE) }
        })
        .collect();
    Test {
        kind: Kind::CornerPull,
        sheet: Sheet::straight(size.into()),
        support: Support::Clips(clips),
        gravity: GRAVITY,
        motion: Box::new(move |apart: f64| {
            let pulled = [apart.max(0.0), apart.max(0.0), (-apart).max(0.0), (-apart).max(0.0)];
            let shift = |(corner, pulled): (Vector2<f64>, f64)| {
                let outward = (corner.add_scalar(-0.5)).component_mul(&size).normalize();
                Isometry3::from(Vector3::new(outward.x, outward.y, 0.0) * (0.5 * pulled))
            };
            corners.into_iter().zip(pulled).map(shift).collect()
        }),
        steps,
    }
}
