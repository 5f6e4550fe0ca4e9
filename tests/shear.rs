//! Shear laws that are not splines, measured in a picture frame.
//!
//! ```text
//!      ╱────────╱ ─▶     100 mm square, four bars; stress × side along each bar, seen flat; stretch not measured
//!    ╱        ╱
//! ◀─╱────────╱
//! ```
//!
//! Five control points fit 60ε + 400ε³ up to sin γ = 0.5 within 0.7 % without noise and within 1.5 % with 3 mN, as
//! relative L2 of the stress over the visited range, for both triangle models. An unobserved sheet may have buckled:
//! the band then also contains this truth, in at least 90 % of the range, and the verdict names bending.

use cloth_data::io::read_set;
use cloth_data::rig::KnownFabric;
use cloth_fit::incremental::{FitReport, Stage, fit};
use cloth_fit::judge::verdict::{Grade, of_stage};
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::{Settings, Watch};
use cloth_sim::material::{Component, Model};
use fit_cloth_tests::picture_frame::PictureFrame;
use fit_cloth_tests::{coverage, stress_error};
use std::path::Path;

fn law(strain: f64) -> f64 {
    60.0 * strain + 400.0 * strain * strain * strain
}

fn fit_shear(model: Model, noise: Option<u64>, shapes: bool) -> FitReport {
    let angles: Vec<f64> = (1..=20).map(|i| 0.5f64.asin() * f64::from(i) / 20.0).collect();
    let set = PictureFrame { noise, shapes, ..PictureFrame::of_law(&law, &angles) }.measure();
    let settings = Settings { model, ..Settings::default() };
    fit(&set, &[Stage::Shear], &Knowledge::default(), &settings, &mut Watch::default()).unwrap()
}

#[test]
fn five_points_meet_a_law_of_shear_that_is_no_spline() {
    for model in [Model::STVK, Model::SOFT_CONSTRAINT] {
        for (noise, allowed) in [(None, 0.007), (Some(2), 0.015)] {
            let report = fit_shear(model, noise, true);
            let stage = report.stage(Component::Shear).unwrap();
            let error = stress_error(&stage.curve.samples, &law);
            println!(
                "{model}, noise {noise:?}: {:.3} %, {} points, {} factorisations",
                100.0 * error,
                stage.curve.curve.len(),
                stage.counters.factorisations
            );
            assert!(stage.converged && stage.curve.observed && error <= allowed);
            assert!(stage.sequences[0].planar && stage.basis.assumed.len() == 2);
        }
    }
}

#[test]
fn a_sheet_that_nobody_saw_may_have_buckled_or_not() {
    let report = fit_shear(Model::STVK, Some(2), false);
    let stage = report.stage(Component::Shear).unwrap();
    let held = coverage(&stage.curve.samples, &law);
    let verdict = of_stage(stage, &report.notices);
    println!("not seen: the band holds the truth in {:.0} % of the range; {verdict:?}", 100.0 * held);
    assert!(!stage.sequences[0].planar && held >= 0.9);
    assert!(verdict.grade > Grade::Green && verdict.reasons.iter().any(|reason| reason.contains("bending")));
}

/// Without bending tests, with the shapes of the sheared sheet and without.
#[test]
fn shear_alone_holds_the_truth_of_a_sheet_that_buckles_or_says_what_it_lacks() {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures");
    for name in ["cotton-denim", "cotton-satin", "rayon-spandex-knit", "wool-cotton"] {
        let truth =
            KnownFabric::named(name).unwrap().curves().unwrap().get(Component::Shear).unwrap().clone();
        let mut set = read_set(&fixtures.join(name)).unwrap();
        for shapes in [true, false] {
            if !shapes {
                let frames = set.sequences.iter_mut().flat_map(|sequence| &mut sequence.frames);
                frames.for_each(|frame| frame.positions = None);
            }
            let stages = [Stage::Stretch, Stage::Shear];
            let report =
                fit(&set, &stages, &Knowledge::default(), &Settings::default(), &mut Watch::default())
                    .unwrap();
            let stage = report.stage(Component::Shear).unwrap();
            let held = coverage(&stage.curve.samples, &|strain| truth.stress(strain));
            let error = stress_error(&stage.curve.samples, &|strain| truth.stress(strain));
            let verdict = of_stage(stage, &report.notices);
            println!(
                "{name}, shapes {shapes}: off by {:.1} %, the band holds the truth in {:.0} %, {}",
                100.0 * error,
                100.0 * held,
                verdict.grade
            );
            assert!(held >= 0.9, "{name}, shapes {shapes}: {held}");
            assert!(
                verdict.grade > Grade::Green && verdict.reasons.iter().any(|why| why.contains("bending"))
            );
        }
    }
}
