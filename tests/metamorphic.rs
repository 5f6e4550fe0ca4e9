//! Fits do not depend on the representation of a measurement: other axes, order or units, or a mirror image, give the
//! same curves and bands.
//!
//! ```text
//!  fixture ──▶ fit ──▶ curves, bands
//!     │                   ‖  within 1e-6 of the largest stress (wrinkled: 1e-4)
//!  moved, mirrored, reordered ──▶ fit ──▶ curves, weft and warp exchanged where the image does that
//! ```
//!
//! Six sequences of every fixture, with all their frames, on 13×13 nodes.

use cloth_data::frame::{Kind, MeasurementSet, Sequence};
use cloth_data::io::read_set;
use cloth_fit::incremental::{FitReport, Stage, fit};
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::report::CurveRow;
use cloth_fit::stage::stretch::fit as fit_stretch;
use cloth_fit::stage::{Settings, Watch};
use cloth_sim::material::{Component, Model};
use fit_cloth_tests::UniformStretch;
use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector2, Vector3};
use rand::seq::SliceRandom;
use rand::{SeedableRng, rngs::StdRng};
use std::path::Path;
use std::sync::LazyLock;

/// The fixtures and their fits.
static MEASURED: LazyLock<Vec<(MeasurementSet, FitReport)>> = LazyLock::new(|| {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures");
    let measured = |name| {
        let mut set = read_set(&fixtures.join(name)).unwrap();
        set.sequences.retain(|sequence| !matches!(sequence.kind, Kind::ComplexShear | Kind::CornerPull));
        let report = fitted(&set);
        (set, report)
    };
    ["cotton-denim", "cotton-satin", "rayon-spandex-knit", "wool-cotton"].map(measured).into()
});

fn fitted(set: &MeasurementSet) -> FitReport {
    fitted_by(set, true)
}

/// * `averaged` — over descriptions of the curve, and corrected for the grid; else one curve of least squares
fn fitted_by(set: &MeasurementSet, averaged: bool) -> FitReport {
    let settings = Settings { nodes: Some([13, 13]), averaged, corrected: averaged, ..Settings::default() };
    fit(set, &Stage::ALL, &Knowledge::default(), &settings, &mut Watch::default()).unwrap()
}

/// Transformed curve of a component.
struct Image {
    component: Component,
    /// Factor of the strain or curvature.
    strain: f64,
    /// Factor of the stress or moment.
    stress: f64,
}

fn itself(component: Component) -> Image {
    Image { component, strain: 1.0, stress: 1.0 }
}

fn exchanged(component: Component) -> Image {
    itself(match component {
        Component::StretchWeft => Component::StretchWarp,
        Component::StretchWarp => Component::StretchWeft,
        Component::BendWeft => Component::BendWarp,
        Component::BendWarp => Component::BendWeft,
        other => other,
    })
}

/// Fits every fixture after a change; curves and bands must be the images of the original ones.
fn same_curves(what: &str, image: impl Fn(Component) -> Image, change: impl Fn(&mut MeasurementSet)) {
    for (set, before) in &*MEASURED {
        let what = format!("{what}, {}", set.fabric.name);
        let mut changed = set.clone();
        changed.sequences.iter_mut().for_each(|sequence| sequence.mesh.grid = None);
        change(&mut changed);
        let after = fitted(&changed);
        assert!(after.failures.is_empty() && after.notices == before.notices, "{what}: {:?}", after.notices);
        // Between wrinkled shapes a path may turn either way by rounding; then the grid's correction may lack a frame.
        let wrinkled =
            |report: &FitReport| report.stages.iter().any(|stage| stage.interventions.matrices_damped > 0);
        let [curve_limit, band_limit] =
            if wrinkled(before) || wrinkled(&after) { [1e-4, 0.01] } else { [1e-6, 1e-4] };
        for component in Model::STVK.components() {
            let Image { component: other, strain, stress } = image(component);
            let [Some(before), Some(after)] = [before.stage(component), after.stage(other)] else {
                panic!("{what}: no {component}, or no {other}");
            };
            let (curve, bands) = apart(&before.curve.samples, &after.curve.samples, [strain, stress, 1.0]);
            println!("{what}, {component}: off {curve:.1e} of the largest stress, bands {bands:.1e}");
            assert!(curve < curve_limit && bands < band_limit, "{what}, {component}: {curve} {bands}");
        }
    }
}

/// Distance of two curves relative to their reach or the largest stress, and the relative difference of their bands
/// where these are widest.
fn apart(before: &[CurveRow], after: &[CurveRow], [strain, stress, band]: [f64; 3]) -> (f64, f64) {
    let largest = before.iter().map(|sample| sample.stress.abs()).fold(0.0, f64::max);
    let widest = before.iter().map(half).fold(0.0, f64::max);
    let reach = before[before.len() - 1].strain;
    assert_eq!(before.len(), after.len());
    let (mut curve, mut bands) = (0.0f64, 0.0f64);
    for (a, b) in before.iter().zip(after) {
        assert_eq!(a.band.is_some(), b.band.is_some());
        curve = curve.max((b.stress / stress - a.stress).abs() / largest);
        curve = curve.max((b.strain / strain - a.strain).abs() / reach);
        bands = bands.max((half(b) / stress / band - half(a)).abs() / widest);
    }
    (curve, bands)
}

/// Half width of a band.
fn half(sample: &CurveRow) -> f64 {
    sample.band.map_or(0.0, |[low, high]| 0.5 * (high - low))
}

/// Visits every vector of a sequence, positions and directions separately.
fn each_vector(sequence: &mut Sequence, place: &dyn Fn(&mut Vector3<f64>), turn: &dyn Fn(&mut Vector3<f64>)) {
    turn(&mut sequence.gravity);
    sequence.force_direction.iter_mut().for_each(turn);
    sequence.mesh.positions.iter_mut().for_each(place);
    if let Some(table) = &mut sequence.table {
        let changed = |array: &mut [f64; 3], change: &dyn Fn(&mut Vector3<f64>)| {
            let mut vector = Vector3::from(*array);
            change(&mut vector);
            *array = vector.into();
        };
        changed(&mut table.edge_point_m, place);
        changed(&mut table.edge_direction, turn);
        changed(&mut table.outward, turn);
    }
    for frame in &mut sequence.frames {
        frame.positions.iter_mut().flatten().for_each(place);
        frame.cords.iter_mut().for_each(|cord| turn(&mut cord.force));
        frame.cords.iter_mut().filter_map(|cord| cord.point.as_mut()).for_each(place);
    }
}

/// Moves everything rigidly.
fn move_all(set: &mut MeasurementSet, motion: &Isometry3<f64>) {
    for sequence in &mut set.sequences {
        each_vector(
            sequence,
            &|place| *place = motion.rotation * *place + motion.translation.vector,
            &|direction| *direction = motion.rotation * *direction,
        );
        for pose in sequence.frames.iter_mut().flat_map(|frame| &mut frame.poses) {
            *pose = motion * *pose * motion.inverse();
        }
    }
}

/// Moves only the specimens at rest.
fn move_rest(set: &mut MeasurementSet, motion: &Isometry3<f64>) {
    for sequence in &mut set.sequences {
        for place in &mut sequence.mesh.positions {
            *place = motion.rotation * *place + motion.translation.vector;
        }
        for pose in sequence.frames.iter_mut().flat_map(|frame| &mut frame.poses) {
            *pose *= motion.inverse();
        }
    }
}

/// Rotates or mirrors the material coordinates.
fn turn_yarns(set: &mut MeasurementSet, turn: impl Fn(Vector2<f64>) -> Vector2<f64>) {
    for mesh in set.sequences.iter_mut().map(|sequence| &mut sequence.mesh) {
        mesh.material.iter_mut().for_each(|material| *material = turn(*material));
    }
}

/// Reverses the winding of the faces.
fn rewind(set: &mut MeasurementSet) {
    for triangle in set.sequences.iter_mut().flat_map(|sequence| &mut sequence.mesh.triangles) {
        triangle.swap(1, 2);
    }
}

fn exchange_kinds(set: &mut MeasurementSet) {
    std::mem::swap(&mut set.fabric.width_m, &mut set.fabric.height_m);
    for sequence in &mut set.sequences {
        sequence.kind = match sequence.kind {
            Kind::StretchWeft => Kind::StretchWarp,
            Kind::StretchWarp => Kind::StretchWeft,
            Kind::BendWeft => Kind::BendWarp,
            Kind::BendWarp => Kind::BendWeft,
            other => other,
        };
    }
}

/// Mirrors a set at the plane through the origin with this `normal`.
fn mirror(set: &mut MeasurementSet, normal: Vector3<f64>) {
    let image = Matrix3::identity() - normal * normal.transpose() * 2.0;
    for sequence in &mut set.sequences {
        each_vector(sequence, &|place| *place = image * *place, &|direction| *direction = image * *direction);
        for pose in sequence.frames.iter_mut().flat_map(|frame| &mut frame.poses) {
            let turned = image * pose.rotation.to_rotation_matrix().matrix() * image;
            pose.rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turned));
            pose.translation.vector = image * pose.translation.vector;
        }
    }
}

#[test]
fn all_curves_come_of_the_fixtures() {
    for (set, report) in &*MEASURED {
        assert_eq!(report.notices, []);
        for component in Model::STVK.components() {
            assert!(report.stage(component).unwrap().curve.observed, "{}: {component}", set.fabric.name);
        }
    }
}

#[test]
fn a_set_that_is_moved_as_a_whole_gives_the_same_curves() {
    let motion = Isometry3::new(Vector3::new(1.0, -2.0, 0.7), Vector3::new(0.4, -1.1, 2.0));
    same_curves("moved", itself, |set| move_all(set, &motion));
}

#[test]
fn a_rest_mesh_may_lie_in_any_plane() {
    for turn in [
        Vector3::new(60f64.to_radians(), 0.0, 0.0),
        Vector3::new(0.0, 2f64.to_radians(), 0.0),
        Vector3::new(1.9, -1.2, 1.7),
    ] {
        let motion = Isometry3::new(Vector3::new(0.3, 0.1, -0.2), turn);
        same_curves(&format!("rest turned by {turn:?}"), itself, |set| move_rest(set, &motion));
    }
}

#[test]
fn a_mirror_image_gives_the_same_curves_though_it_shears_the_other_way() {
    // In the plane, where shear changes sign, and out of the plane, where only the visible side changes.
    same_curves("mirrored in y", itself, |set| {
        mirror(set, Vector3::y());
        turn_yarns(set, |m| Vector2::new(m.x, -m.y));
        rewind(set);
    });
    same_curves("sheared the other way", itself, |set| {
        turn_yarns(set, |m| Vector2::new(-m.x, m.y));
        rewind(set);
    });
}

#[test]
fn yarns_that_are_turned_or_exchanged_give_the_same_curves() {
    same_curves("by 180°", itself, |set| turn_yarns(set, |m| -m));
    same_curves("by 90°", exchanged, |set| {
        turn_yarns(set, |m| Vector2::new(-m.y, m.x));
        exchange_kinds(set);
    });
    same_curves("exchanged", exchanged, |set| {
        turn_yarns(set, |m| Vector2::new(m.y, m.x));
        rewind(set);
        exchange_kinds(set);
    });
}

#[test]
fn the_order_of_vertices_and_frames_does_not_matter() {
    same_curves("vertices", itself, |set| {
        let mut random = StdRng::seed_from_u64(5);
        for sequence in &mut set.sequences {
            let mut from: Vec<usize> = (0..sequence.mesh.len()).collect();
            from.shuffle(&mut random);
            let mut to = vec![0; from.len()];
            from.iter().enumerate().for_each(|(new, &old)| to[old] = new);
            let taken = |of: &[Vector3<f64>]| from.iter().map(|&old| of[old]).collect::<Vec<_>>();
            sequence.mesh.positions = taken(&sequence.mesh.positions);
            sequence.mesh.material = from.iter().map(|&old| sequence.mesh.material[old]).collect();
            sequence.mesh.triangles.iter_mut().flatten().for_each(|vertex| *vertex = to[*vertex]);
            sequence
                .clips
                .iter_mut()
                .flat_map(|clip| &mut clip.vertices)
                .for_each(|vertex| *vertex = to[*vertex]);
            for positions in sequence.frames.iter_mut().filter_map(|frame| frame.positions.as_mut()) {
                *positions = taken(positions);
            }
        }
    });
    same_curves("frames", itself, |set| {
        let mut random = StdRng::seed_from_u64(6);
        set.sequences.iter_mut().for_each(|sequence| sequence.frames.shuffle(&mut random));
    });
}

/// Noise averages out and misfit does not; additional measurements may justify another control point. (By least squares
/// alone: more measurements also tell descriptions of a curve apart, so that bands over all of them shrink otherwise.)
#[test]
fn frames_that_stand_twice_make_bands_narrower_by_root_two_but_for_misfit() {
    for (set, _) in &*MEASURED {
        let before = fitted_by(set, false);
        let mut set = set.clone();
        for sequence in &mut set.sequences {
            sequence.frames =
                sequence.frames.iter().flat_map(|frame| [frame.clone(), frame.clone()]).collect();
        }
        let after = fitted_by(&set, false);
        assert_eq!(after.notices, before.notices);
        for component in Model::STVK.components() {
            let [before, after] = [&before, &after].map(|report| report.stage(component).unwrap());
            let grown = after.curve.points.len() > before.curve.points.len();
            let (curve, narrower) =
                apart(&before.curve.samples, &after.curve.samples, [1.0, 1.0, 0.5f64.sqrt()]);
            let widest =
                [before, after].map(|stage| stage.curve.samples.iter().map(half).fold(0.0, f64::max));
            let wider = widest[1] / widest[0];
            let what = format!("{}, {component}", set.fabric.name);
            println!(
                "{what}: off {curve:.1e} of the largest stress, bands × {wider:.3}, another point: {grown}"
            );
            let rms = (widest[0] + widest[1]) / before.curve.samples.last().unwrap().stress;
            match before.scatter.misfit > 0.0 || after.scatter.misfit > 0.0 {
                _ if grown => assert!(curve < 2.0 * rms, "{what}"),
                // Another reach of the same number of points.
                true => assert!((0.7..1.5).contains(&wider) && curve < rms, "{what}"),
                false => assert!(narrower < 0.1 && curve < 0.05 * rms, "{what}: {narrower} {curve}"),
            }
        }
    }
}

#[test]
fn units_of_length_and_force_do_not_matter() {
    // The units of length and force are arbitrary: all derived values scale with them.
    let (length, force) = (1.25, 1.5);
    let stress = force / length;
    let image = |component: Component| match component.is_bending() {
        true => Image { strain: 1.0 / length, stress: force, ..itself(component) },
        false => Image { stress, ..itself(component) },
    };
    same_curves("units", image, |set| {
        set.fabric.width_m *= length;
        set.fabric.height_m *= length;
        set.fabric.areal_density_kg_m2 *= force / length.powi(2);
        for sequence in &mut set.sequences {
            each_vector(sequence, &|place| *place *= length, &|_| {});
            sequence.mesh.material.iter_mut().for_each(|material| *material *= length);
            sequence.clips.iter_mut().for_each(|clip| clip.mass_kg *= force);
            if let Some(noise) = &mut sequence.noise {
                noise.position_m = noise.position_m.map(|noise| noise * length);
                noise.force_n = noise.force_n.map(|noise| noise * force);
            }
            for frame in &mut sequence.frames {
                frame.cords.iter_mut().for_each(|cord| cord.force *= force);
                frame.poses.iter_mut().for_each(|pose| pose.translation.vector *= length);
            }
        }
    });
}

/// A strip of 50 N/m pulled to a tenth, with exact forces and no shapes: only the start of its solves distinguishes
/// it from a crumpled one.
fn strip() -> MeasurementSet {
    UniformStretch { model: Model::STVK, law: &|e| 50.0 * e, largest: 0.1, grip: 0.0, frames: 5, noise: None }
        .measure()
}

fn gives_fifty(what: &str, set: &MeasurementSet) {
    let settings = Settings { nodes: Some([9, 9]), ..Settings::default() };
    let stage = fit_stretch(set, Component::StretchWeft, &settings, &mut Watch::default()).unwrap().unwrap();
    assert!(stage.dropped.is_empty() && stage.sequences[0].multi_stable.is_empty(), "{what}");
    for sample in &stage.curve.samples {
        assert!((sample.stress - 50.0 * sample.strain).abs() < 1e-6 * 5.0, "{what}: {sample:?}");
    }
}

#[test]
fn a_strip_that_was_carried_around_without_being_seen_gives_its_curve() {
    gives_fifty("as it lies", &strip());
    for turn in [
        Vector3::z() * 3.0,
        Vector3::z() * std::f64::consts::PI,
        Vector3::new(0.3, 2.9, 0.4),
        Vector3::x() * 3.1,
    ] {
        let mut set = strip();
        move_rest(&mut set, &Isometry3::new(Vector3::new(0.2, 0.4, 0.0), turn));
        gives_fifty(&format!("rest turned by {turn:?}"), &set);
    }
    // Rotated from frame to frame, in its plane and out of it.
    for axis in [Vector3::z_axis(), Vector3::x_axis()] {
        let mut set = strip();
        for (index, frame) in set.sequences[0].frames.iter_mut().enumerate() {
            let turn = UnitQuaternion::from_axis_angle(&axis, 0.6 * index as f64);
            frame.poses.iter_mut().for_each(|pose| *pose = turn * *pose);
            frame.cords.iter_mut().for_each(|cord| cord.force = turn * cord.force);
        }
        gives_fifty(&format!("turned about {axis:?} as it was pulled"), &set);
    }
}
