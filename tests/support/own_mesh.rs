//! Tests simulated on the mesh of the fit: equilibria under known curves, and the resulting measurements.
//!
//! ```text
//! nominal set ──▶ the fit's replicas ──▶ equilibria ──▶ the same set with their shapes and forces (+ noise)
//!                 known curves ────────▶
//! ```

use cloth_data::frame::{Cord, Kind, MeasurementSet, Noise, Sequence};
use cloth_fit::equilibria::{Equilibria, Objective, Settled, SolveStart, Task, Unknowns};
use cloth_fit::stage::{Plan, Settings, bend, shear, stretch};
use cloth_fit::twin::replica::Replica;
use cloth_sim::material::{Component, Curves};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use rand::{SeedableRng, rngs::StdRng};
use rand_distr::{Distribution, StandardNormal};
use std::sync::Arc;

/// The stage that fits a test.
fn plan(kind: Kind) -> Plan {
    match kind {
        Kind::StretchWeft | Kind::StretchWarp => {
            stretch::plan(&[Component::StretchWeft, Component::StretchWarp])
        }
        Kind::Shear | Kind::StretchBias => shear::plan(1),
        _ => bend::plan(&[Component::BendWeft, Component::BendWarp, Component::BendDiagonal], 1),
    }
}

/// Equilibria of a sequence under known curves, simulated as in the stage that fits it: per frame, with the forces
/// along the measured components, N.
///
/// # Panics
/// If the sequence has no replica, or a frame no equilibrium.
pub fn equilibria<T>(
    set: &MeasurementSet,
    sequence: &Sequence,
    curves: &Curves,
    settings: &Settings,
    mut read: impl FnMut(Settled<'_>, &[f64]) -> T,
) -> Vec<T> {
    let alone = MeasurementSet { fabric: set.fabric.clone(), sequences: vec![sequence.clone()] };
    let mut plan = plan(sequence.kind);
    plan.kinds = vec![sequence.kind];
    plan.components.retain(|&component| curves.get(component).is_some());
    let replicas: Vec<Replica> = plan.replicas(&alone, settings).expect("a sequence that can be simulated");
    assert!(!replicas.is_empty(), "{} shows nothing", sequence.name);
    let task = Task {
        objective: Objective::Forces,
        known: curves.clone(),
        settings: settings.equilibrium,
        start: SolveStart::LastEquilibrium,
        exact_clips: true,
        robust: None,
    };
    let mut simulation = Equilibria::new(&replicas, task, Unknowns::default(), Arc::default());
    let forces = simulation.settle();
    assert!(simulation.dropped().is_empty(), "{:?}", simulation.dropped());
    simulation.settled().zip(&forces).map(|(settled, forces)| read(settled, forces)).collect()
}

/// A set with the shapes and forces of the fit's own simulation under known curves. Shapes require a measured mesh
/// with the nodes of the simulation.
pub fn simulated(nominal: &MeasurementSet, curves: &Curves, settings: &Settings) -> MeasurementSet {
    let mut set = nominal.clone();
    for (sequence, exact) in nominal.sequences.iter().zip(&mut set.sequences) {
        equilibria(nominal, sequence, curves, settings, |settled, forces| {
            let Settled { replica, frame, x, edge, .. } = settled;
            let x = replica.displayed(frame, x, edge);
            let out = replica.specimen.frame.rotation.inverse();
            let exact = &mut exact.frames[frame.index];
            exact.cords = frame
                .forces
                .iter()
                .zip(forces)
                .map(|(component, cloth)| {
                    let along = cloth + component.measured - component.force;
                    Cord { clip: component.clip, force: out * (component.direction * along), point: None }
                })
                .collect();
            for (place, rest) in exact.positions.iter_mut().flatten().zip(&sequence.mesh.positions) {
                let away = |&node: &usize| (replica.specimen.rest_in_world(node) - rest).norm();
                let nodes = 0..replica.specimen.mesh.len();
                let node = nodes.min_by(|a, b| away(a).total_cmp(&away(b))).expect("nodes");
                assert!(away(&node) < 1e-9, "a vertex is no node");
                let inside = Point3::from_slice(&x[3 * node..3 * node + 3]);
                *place = (replica.specimen.frame.inverse() * inside).coords;
            }
        });
    }
    set
}

/// Adds noise to shapes and forces, and declares it to the fit.
///
/// * `position` — standard deviation of a vertex's coordinates, m
/// * `force` — of a force along the load cell, or of each of its components, N; per test
pub fn with_noise(
    exact: &MeasurementSet,
    seed: u64,
    position: f64,
    force: impl Fn(Kind) -> f64,
) -> MeasurementSet {
    let mut random = StdRng::seed_from_u64(seed);
    let mut normal = |deviation: f64| -> f64 {
        let sample: f64 = StandardNormal.sample(&mut random);
        deviation * sample
    };
    let mut set = exact.clone();
    for sequence in &mut set.sequences {
        let force = force(sequence.kind);
        sequence.noise = Some(Noise { position_m: Some(position), force_n: Some(force), clip_m: Some(0.0) });
        for frame in &mut sequence.frames {
            for cord in &mut frame.cords {
                cord.force += match sequence.force_direction {
                    Some(direction) => direction * normal(force),
                    None => Vector3::from_fn(|_, _| normal(force)),
                };
            }
            for place in frame.positions.iter_mut().flatten() {
                *place += Vector3::from_fn(|_, _| normal(position));
            }
        }
    }
    set
}

/// Shifts and turns every clip about its centre, in every frame, and declares it to the fit.
///
/// * `deviation` — standard deviation of a clip's place along each axis, m; over its length, of its angles
pub fn with_shaken_clips(set: &MeasurementSet, seed: u64, deviation: f64) -> MeasurementSet {
    let mut random = StdRng::seed_from_u64(seed);
    let mut normals = |deviation: f64| {
        Vector3::from_fn(|_, _| -> f64 {
            let sample: f64 = StandardNormal.sample(&mut random);
            deviation * sample
        })
    };
    let mut set = set.clone();
    for sequence in &mut set.sequences {
        sequence.noise.as_mut().expect("declared noise").clip_m = Some(deviation);
        for frame in &mut sequence.frames {
            for (pose, clip) in frame.poses.iter_mut().zip(&sequence.clips) {
                let places: Vec<Vector3<f64>> =
                    clip.vertices.iter().map(|&vertex| sequence.mesh.positions[vertex]).collect();
                let centre = places.iter().sum::<Vector3<f64>>() / places.len() as f64;
                let length = places.iter().map(|place| 2.0 * (place - centre).norm()).fold(0.0, f64::max);
                let turn = UnitQuaternion::from_scaled_axis(normals(deviation / length));
                let about = Isometry3::rotation_wrt_point(turn, *pose * Point3::from(centre));
                *pose = Translation3::from(normals(deviation)) * about * *pose;
            }
        }
    }
    set
}
