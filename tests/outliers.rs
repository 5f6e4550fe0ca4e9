//! A few invalid measurements: with `robust` they hardly move the curve.
//!
//! ```text
//!  stretch  8(e^{10ε} − 1), 40 frames:  two clip forces with a flipped sign, two three times too large
//!  bending  elastica at Γ = 30:         one vertex in a hundred seen 10 mm too high, on the outer part of the sheet
//! ```
//!
//! Relative L2 error of the stress: with `robust` at 3 below 1.5 % for forces and below 1 % for vertices; without it
//! 8 and 2 %.

use cloth_data::frame::{Kind, MeasurementSet};
use cloth_data::inspection::inspect;
use cloth_data::io::read_set;
use cloth_fit::incremental::{Stage, fit};
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::report::StageReport;
use cloth_fit::stage::{Settings, Variant, Watch};
use cloth_sim::material::{Component, Model};
use fit_cloth_tests::cantilever::{Cantilever, GRAVITY, POSITION_NOISE, SIDE, between_rows};
use fit_cloth_tests::{UniformStretch, stress_error};
use rand::{Rng, SeedableRng, rngs::StdRng};
use rand_distr::{Distribution, StandardNormal};
use std::path::Path;

const ROBUST: [Option<f64>; 2] = [None, Some(3.0)];

fn fit_one(set: &MeasurementSet, stage: Stage, component: Component, settings: &Settings) -> StageReport {
    let report = fit(set, &[stage], &Knowledge::default(), settings, &mut Watch::default()).unwrap();
    let stage = report.stage(component).unwrap().clone();
    assert!(stage.converged);
    stage
}

#[test]
fn wrong_forces_hardly_move_the_curve() {
    let law = |e: f64| 8.0 * (10.0 * e).exp_m1();
    for known in [true, false] {
        let mut random = StdRng::seed_from_u64(11);
        let mut normal = || StandardNormal.sample(&mut random);
        let noise = Some((3e-3, &mut normal as &mut dyn FnMut() -> f64));
        let stretch =
            UniformStretch { model: Model::STVK, law: &law, largest: 0.25, frames: 40, grip: 0.0, noise };
        let mut set = stretch.measure();
        let sequence = &mut set.sequences[0];
        sequence.noise = sequence.noise.filter(|_| known);
        for (frame, clip, factor) in [(9, 0, -1.0), (30, 1, -1.0), (17, 1, 3.0), (36, 0, 3.0)] {
            sequence.frames[frame].cords[clip].force *= factor;
        }
        let [ruled, robust] = ROBUST.map(|robust| {
            let settings = Settings { robust, nodes: Some([9, 9]), ..Settings::default() };
            let stage = fit_one(&set, Stage::Stretch, Component::StretchWeft, &settings);
            let bent = stage.interventions.residuals_bent;
            // The four, and some of 160 that five control points do not fit to 9 mN.
            assert!(if robust.is_some() { bent >= 4 } else { bent == 0 }, "{bent} residuals count less");
            stress_error(&stage.curve.samples, &law)
        });
        println!("forces, noise known {known}: {:.2} % without, {:.2} % with", 100.0 * ruled, 100.0 * robust);
        assert!(ruled > 0.04 && robust < 0.015, "{ruled} {robust}");
    }
}

#[test]
fn friction_of_the_cords_does_not_keep_a_robust_fit_from_its_minimum() {
    let set = read_set(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures/cotton-denim")).unwrap();
    let settings = Settings { robust: Some(3.0), nodes: Some([13, 13]), ..Settings::default() };
    for component in [Component::StretchWeft, Component::StretchWarp] {
        // Loading and unloading differ by twenty times the noise: no residual is small.
        let stage = fit_one(&set, Stage::Stretch, component, &settings);
        assert!(stage.interventions.residuals_bent > 15, "{}", stage.interventions.residuals_bent);
    }
}

#[test]
fn vertices_seen_elsewhere_hardly_move_the_curve() {
    let rigidity = 0.2 * GRAVITY * 0.085f64.powi(3) / 30.0;
    let overhangs = between_rows([12, 14, 16, 18, 20]);
    let moment = |curvature: f64| rigidity * curvature;
    for measured in [25, 60] {
        let cantilever = Cantilever {
            kind: Kind::BendWeft,
            areal_density: 0.2,
            moment: &moment,
            overhangs: &overhangs,
            size: [SIDE; 2],
            measured: [measured; 2],
            noise: Some((POSITION_NOISE, 4)),
        };
        let mut set = cantilever.measure();
        let clean = set.clone();
        let material = &clean.sequences[0].mesh.material;
        let mut random = StdRng::seed_from_u64(5);
        for frame in &mut set.sequences[0].frames[1..] {
            let positions = frame.positions.as_mut().unwrap();
            let outer = (0..positions.len()).filter(|&vertex| material[vertex].x > 0.6 * SIDE);
            let outer: Vec<usize> = outer.collect();
            for _ in 0..positions.len() / 100 {
                positions[outer[random.random_range(0..outer.len())]].z += 0.01;
            }
        }
        let error = |set: &MeasurementSet, robust| {
            let settings = Settings { robust, variant: Variant::Linear, ..Settings::default() };
            let stage = fit_one(set, Stage::Bend, Component::BendWeft, &settings);
            (stress_error(&stage.curve.samples, &moment), stage.interventions.vertices_left_out)
        };
        let (undisturbed, none) = error(&clean, None);
        let [(ruled, strays), (robust, _)] = ROBUST.map(|robust| error(&set, robust));
        println!("{none} vertices left out undisturbed, {strays} disturbed");
        // Points far from their neighbours are unobserved from the start; if neighbours are far apart, they are found
        // later.
        let told = !inspect(&set).notices.is_empty();
        assert!(none == 0 && (told || strays > 0), "{none} {strays}");
        println!(
            "vertices on {measured}²: {:.2} % undisturbed, {:.2} % without, {:.2} % with",
            100.0 * undisturbed,
            100.0 * ruled,
            100.0 * robust
        );
        assert!((told || ruled > 0.015) && robust < 0.01, "{ruled} {robust}");
    }
}

#[test]
fn a_robust_fit_without_known_noise_passes_over_frames_without_an_equilibrium() {
    let mut set = read_set(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures/cotton-denim")).unwrap();
    set.sequences.retain(|sequence| sequence.name == "stretch-weft");
    let sequence = &mut set.sequences[0];
    sequence.noise = None;
    for cord in sequence.frames[4..=6].iter_mut().flat_map(|frame| &mut frame.cords) {
        cord.force *= 0.0;
    }
    let settings = Settings { robust: Some(3.0), nodes: Some([9, 9]), ..Settings::default() };
    let report = fit(&set, &[Stage::Stretch], &Knowledge::default(), &settings, &mut Watch::default());
    assert!(report.is_ok(), "{report:?}");
}
