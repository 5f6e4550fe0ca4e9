//! Tests simulated by the fit's own model: known curves on the fit's own mesh, before noise is added.

use crate::physical::Reference;
use crate::scene::{Balanced, BalancedFrame, TestScene};
use cloth_data::error::Result;
use cloth_data::frame::{Cord, MeasurementSet};
use cloth_fit::stage::Settings;
use nalgebra::{Point3, Vector3};

/// Measures the scene's set on the fit's own mesh. Shapes need a measured mesh with the simulation's nodes.
///
/// # Errors
/// Those of [`TestScene::balance`].
pub(crate) fn simulated(
    scene: &TestScene,
    reference: &Reference,
    settings: &Settings,
) -> Result<MeasurementSet> {
    let balanced = scene.balance(reference, settings)?;
    let mut set = scene.set.clone();
    for sequence in &mut set.sequences {
        for frame in &balanced.frames {
            let seen = &mut sequence.frames[balanced.index(frame)];
            seen.cords = cords(&balanced, frame);
            let places = places(&balanced, frame);
            for (place, rest) in seen.positions.iter_mut().flatten().zip(&sequence.mesh.positions) {
                let away = |[_, other]: &[Vector3<f64>; 2]| (other - rest).norm();
                let nearest = places.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
                nearest.into_iter().for_each(|[now, _]| *place = *now);
            }
        }
    }
    Ok(set)
}

/// One cord per clip; its force is the pull of the cloth minus the clip's weight.
fn cords(balanced: &Balanced, frame: &BalancedFrame) -> Vec<Cord> {
    let back = balanced.replica.specimen.frame.rotation.inverse();
    let mut cords: Vec<Cord> = Vec::new();
    let components = &balanced.replica.frames[frame.place].forces;
    for (component, cloth) in components.iter().zip(&frame.forces) {
        let force = back * (component.direction * (cloth + component.measured - component.force));
        match cords.iter_mut().find(|cord| cord.clip == component.clip) {
            Some(cord) => cord.force += force,
            None => cords.push(Cord { clip: component.clip, force, point: None }),
        }
    }
    cords
}

/// Present and rest position of every node, in world coordinates, m.
fn places(balanced: &Balanced, frame: &BalancedFrame) -> Vec<[Vector3<f64>; 2]> {
    let specimen = &balanced.replica.specimen;
    let back = specimen.frame.inverse();
    let place = |node: usize| {
        let now = back * Point3::from_slice(&frame.x[3 * node..3 * node + 3]);
        [now.coords, specimen.rest_in_world(node)]
    };
    (0..specimen.mesh.len()).map(place).collect()
}
