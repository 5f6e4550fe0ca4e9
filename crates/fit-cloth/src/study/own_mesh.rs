//! Tests as a fit itself simulates them: under known curves, on the fit's own mesh, before noise is added.

use super::physical::Reference;
use super::scene::Scene;
use cloth_fit::error::Result;
use cloth_fit::frame::{Cord, MeasurementSet};
use cloth_fit::simulation::{Meter, Settled};
use cloth_fit::stage::Settings;
use nalgebra::{Point3, Vector3};
use std::sync::Arc;

/// What one frame would be measured as.
struct Seen {
    frame: usize,
    cords: Vec<Cord>,
    /// In world coordinates, m, each with its place at rest.
    places: Vec<[Vector3<f64>; 2]>,
}

/// The scene's set, measured on the fit's own mesh. Shapes need a measured mesh with the simulation's nodes.
///
/// # Errors
/// As [`Scene::balance`].
pub(super) fn simulated(scene: &Scene, reference: &Reference, settings: &Settings) -> Result<MeasurementSet> {
    let meter = Arc::<Meter>::default();
    let (_, frames) = scene.read(reference, settings, &meter, seen)?;
    let mut set = scene.set.clone();
    for sequence in &mut set.sequences {
        for seen in &frames {
            let frame = &mut sequence.frames[seen.frame];
            frame.cords.clone_from(&seen.cords);
            for (place, rest) in frame.positions.iter_mut().flatten().zip(&sequence.mesh.positions) {
                let away = |[_, other]: &[Vector3<f64>; 2]| (other - rest).norm();
                let nearest = seen.places.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
                if let Some([now, _]) = nearest {
                    *place = *now;
                }
            }
        }
    }
    Ok(set)
}

fn seen(settled: Settled<'_>, forces: &[f64]) -> Seen {
    let Settled { replica, frame, x, .. } = settled;
    let back = replica.specimen.frame.inverse();
    // One cord a clip: its force is what the cloth pulls with, less the clip's weight.
    let mut cords: Vec<Cord> = Vec::new();
    for (component, cloth) in frame.forces.iter().zip(forces) {
        let along = cloth + component.measured - component.force;
        let force = back.rotation * (component.direction * along);
        match cords.iter_mut().find(|cord| cord.clip == component.clip) {
            Some(cord) => cord.force += force,
            None => cords.push(Cord { clip: component.clip, force, point: None }),
        }
    }
    let place = |node: usize| {
        let now = back * Point3::from_slice(&x[3 * node..3 * node + 3]);
        [now.coords, replica.specimen.rest_in_world(node)]
    };
    Seen {
        frame: frame.index,
        cords,
        places: (0..replica.specimen.mesh.len()).map(place).collect(),
    }
}
