//! Complex shear test: bars on the left and right sides move along each other and back. The sheet buckles.

use super::fabric::KnownFabric;
use super::schedule::Step;
use super::sheet::Sheet;
use super::test::{GRAVITY, Grip, Support, Test};
use crate::frame::Kind;
use nalgebra::{Isometry3, Vector3};

/// The test. Its drive is the shift of one bar along the other, m.
pub(super) fn test(fabric: &KnownFabric, steps: Vec<Step>) -> Test {
    let sheet = Sheet::straight([fabric.width_m, fabric.height_m]);
    let clips = vec![Grip::bar("left", &sheet, 0, 0), Grip::bar("right", &sheet, 0, 1)];
    Test {
        kind: Kind::ComplexShear,
        sheet,
        support: Support::Clips(clips),
        gravity: GRAVITY,
        motion: Box::new(|moved| {
            [-0.5, 0.5].map(|share| Isometry3::from(Vector3::y() * (share * moved))).to_vec()
        }),
        steps,
    }
}
