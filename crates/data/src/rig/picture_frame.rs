//! Shear test: a frame of four bars, hinged at the corners, is sheared and returned.
//!
//! ```text
//!      ┌───────┐            ┌───────┐       w_u = (cos γ/2, sin γ/2)
//!      │       │    ──▶    ╱       ╱        w_v = (sin γ/2, cos γ/2)
//!      └───────┘          └───────┘         shear strain w_u·w_v = sin γ, no stretch
//! ```

use super::fabric::KnownFabric;
use super::schedule::Step;
use super::sheet::Sheet;
use super::test::{GRAVITY, Grip, Support, Test};
use crate::frame::Kind;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// The test. Its drive is the shear angle γ, rad.
pub(super) fn test(fabric: &KnownFabric, steps: Vec<Step>) -> Test {
    let size = [fabric.width_m, fabric.height_m];
    let sheet = Sheet::straight(size);
    let bars = [("left", 0, 0), ("right", 0, 1), ("below", 1, 0), ("above", 1, 1)];
    let clips = bars.map(|(name, axis, end)| Grip::bar(name, &sheet, axis, end)).to_vec();
    Test {
        kind: Kind::Shear,
        sheet,
        support: Support::Clips(clips),
        gravity: GRAVITY,
        motion: Box::new(move |angle| motions(size, angle).to_vec()),
        steps,
    }
}

/// Motions of the bars left, right, below, above, about the centre of the frame.
fn motions([width, height]: [f64; 2], angle: f64) -> [Isometry3<f64>; 4] {
    let turn = |angle| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
    let [along_weft, along_warp] = [turn(0.5 * angle), turn(-0.5 * angle)];
    let centre = Vector3::new(0.5 * width, 0.5 * height, 0.0);
    // The other pair of bars moves the centre of a bar.
    let bar = |rotation: UnitQuaternion<f64>, arm: Vector3<f64>, other: UnitQuaternion<f64>| {
        let shift = centre + other * arm - rotation * (centre + arm);
        Isometry3::from_parts(Translation3::from(shift), rotation)
    };
    let [across, up] = [Vector3::x() * (0.5 * width), Vector3::y() * (0.5 * height)];
    [
        bar(along_warp, -across, along_weft),
        bar(along_warp, across, along_weft),
        bar(along_weft, -up, along_warp),
        bar(along_weft, up, along_warp),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::schedule::there_and_back;
    use super::super::truth::Truth;
    use super::*;
    use cloth_sim::material::Component;
    use cloth_sim::mesh::Diagonals;

    /// In the plane and without weight the shear is homogeneous: every bar carries stress × length along itself.
    #[test]
    fn every_bar_takes_the_stress_along_itself() {
        let mut fabric = KnownFabric::named("cotton-denim").unwrap();
        (fabric.width_m, fabric.height_m) = (0.1, 0.08);
        let curves = fabric.curves().unwrap();
        let mut test = test(&fabric, there_and_back(&[0.2], 2, 1));
        test.gravity = Vector3::zeros();
        let grid = test.sheet.grid([7, 6], Diagonals::Backward);
        let mesh = test.sheet.mesh(grid).unwrap();
        let states = Truth::new(&test, &mesh, &grid, &fabric, &curves).frames().unwrap();
        for (state, step) in states.iter().zip(&test.steps).skip(1).take(3) {
            let stress = curves.get(Component::Shear).unwrap().stress(step.drive.sin());
            let axes = test.axes(&state.motions);
            for (clip, expected) in [-0.08, 0.08, -0.1, 0.1].into_iter().enumerate() {
                let force = axes[clip] * (stress * expected);
                assert!((state.holds[clip] - force).norm() < 1e-6, "{:?} {force:?}", state.holds[clip]);
            }
        }
    }
}
