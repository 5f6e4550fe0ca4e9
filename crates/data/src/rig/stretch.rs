//! Stretch test: two bars on opposite sides are pulled apart and returned. In the plane, without weight.

use super::fabric::KnownFabric;
use super::schedule::Step;
use super::sheet::Sheet;
use super::test::{Grip, Support, Test};
use crate::frame::Kind;
use nalgebra::{Isometry3, Vector3};

/// Largest drive: the increase of the bar distance, m.
pub(super) fn largest(fabric: &KnownFabric, kind: Kind) -> f64 {
    match kind {
        Kind::StretchWeft => fabric.largest_extension.stretch_weft * fabric.width_m,
        _ => fabric.largest_extension.stretch_warp * fabric.height_m,
    }
}

/// The test along weft or along warp.
pub(super) fn test(fabric: &KnownFabric, kind: Kind, steps: Vec<Step>) -> Test {
    let axis = usize::from(kind != Kind::StretchWeft);
    let sheet = Sheet::straight([fabric.width_m, fabric.height_m]);
    let clips = vec![Grip::bar("low", &sheet, axis, 0), Grip::bar("high", &sheet, axis, 1)];
    let direction = Vector3::ith(axis, 1.0);
    Test {
        kind,
        sheet,
        support: Support::Clips(clips),
        gravity: Vector3::zeros(),
        motion: Box::new(move |apart| {
            [-0.5, 0.5].map(|share| Isometry3::from(direction * (share * apart))).to_vec()
        }),
        steps,
    }
}
