//! Stress laws that are not splines, measured in uniform stretch.
//!
//! ```text
//!   ┌───────────┐
//! ◀─│ low  high │─▶   100 mm square, two bars; force = stress × width (StVK: × stretch too), no shapes
//!   └───────────┘
//! ```
//!
//! Five control points fit 900ε + 1.6e5ε³ (to 6 %) and 8(e^{10ε} − 1) (to 25 %) within 0.7 %, 1.33(e^{60ε} − 1) (to 6
//! %) within 2 %, as relative L2 of the stress over the visited range; with 3 mN of noise within 1.5, 1.5 and 3 %. A
//! law whose stiffness falls and rises again, so that a line fits no better than a constant, still gets its control
//! points. For a truth that five points can represent, the 95 % band contains it for at least 95 % of rows and seeds: it
//! also holds what five points might not follow.

use cloth_data::frame::MeasurementSet;
use cloth_fit::stage::report::StageReport;
use cloth_fit::stage::stretch::fit;
use cloth_fit::stage::{Settings, Watch};
use cloth_sim::curve::{NegativeStrain, StiffnessCurve, equidistant};
use cloth_sim::material::{Component, Model};
use fit_cloth_tests::{UniformStretch, coverage, stress_error};
use rand::{SeedableRng, rngs::StdRng};
use rand_distr::{Distribution, StandardNormal};

type Law = (&'static str, fn(f64) -> f64, f64, f64, f64);

/// Name, stress, largest strain, error without and with noise.
const LAWS: [Law; 3] = [
    ("900ε + 1.6e5ε³", |e| 900.0 * e + 1.6e5 * e * e * e, 0.06, 0.007, 0.015),
    ("8(e^10ε − 1)", |e| 8.0 * (10.0 * e).exp_m1(), 0.25, 0.007, 0.015),
    ("1.33(e^60ε − 1)", |e| 1.33 * (60.0 * e).exp_m1(), 0.06, 0.02, 0.03),
];

const FORCE_NOISE: f64 = 3e-3;

fn fit_weft(set: &MeasurementSet, model: Model, nodes: [usize; 2]) -> StageReport {
    let settings = Settings { model, nodes: Some(nodes), ..Settings::default() };
    fit(set, Component::StretchWeft, &settings, &mut Watch::default()).unwrap().unwrap()
}

fn measure(model: Model, law: &dyn Fn(f64) -> f64, largest: f64, seed: Option<u64>) -> MeasurementSet {
    let mut random = StdRng::seed_from_u64(seed.unwrap_or(0));
    let mut normal = || StandardNormal.sample(&mut random);
    let noise = seed.map(|_| (FORCE_NOISE, &mut normal as &mut dyn FnMut() -> f64));
    UniformStretch { model, law, largest, frames: 40, grip: 0.0, noise }.measure()
}

#[test]
fn five_points_meet_laws_that_are_no_spline() {
    for (name, law, largest, without, with) in LAWS {
        for model in Model::ALL {
            for (seed, allowed) in [(None, without), (Some(11), with)] {
                let report = fit_weft(&measure(model, &law, largest, seed), model, [9, 9]);
                let error = stress_error(&report.curve.samples, &law);
                println!("{name:18} {model:15} noise {:5}: {:.3} %", seed.is_some(), 100.0 * error);
                assert!(report.converged && report.curve.curve.len() == 5);
                assert!(error <= allowed, "{name} {model}: {error}");
                // The approximation error of five points appears as misfit above the noise, and the band contains it.
                if seed.is_some() && report.scatter.misfit > 0.0 {
                    let held = coverage(&report.curve.samples, &law);
                    println!(
                        "    misfit {:.1e} N above {FORCE_NOISE} N; band holds {:.0} %",
                        report.scatter.misfit,
                        100.0 * held
                    );
                    assert!(held >= 0.85, "{name} {model}: {held}");
                }
            }
        }
    }
}

#[test]
fn bars_of_any_depth_leave_the_cloth_between_them() {
    let (_, law, largest, allowed, _) = LAWS[0];
    for grip in [0.01, 0.02] {
        let set = UniformStretch { model: Model::STVK, law: &law, largest, frames: 40, grip, noise: None }
            .measure();
        let error = stress_error(&fit_weft(&set, Model::STVK, [9, 9]).curve.samples, &law);
        println!("bars {} mm deep: {:.3} %", 1e3 * grip, 100.0 * error);
        assert!(error <= allowed);
    }
}

#[test]
fn a_law_that_a_line_does_not_improve_gets_its_points() {
    let largest = 0.6;
    // The polynomial is orthogonal to e and e², the stresses of a constant and of a linear stiffness.
    let law = |strain: f64| {
        let e = strain / largest;
        40.0 * (e + (0.4 + (e - 4.0 / 3.0) * e) * e)
    };
    let model = Model::SOFT_CONSTRAINT;
    let report = fit_weft(&measure(model, &law, largest, None), model, [9, 9]);
    assert!(report.levels[1].rms > 0.99 * report.levels[0].rms);
    let error = stress_error(&report.curve.samples, &law);
    println!("falls and rises: {} points, {:.3} %", report.curve.curve.len(), 100.0 * error);
    assert!(report.converged && error <= 0.007, "{error}");
}

fn mean_coverage(seeds: u64, nodes: [usize; 2]) -> f64 {
    let strains = equidistant(5, 0.06);
    let stiffnesses = vec![900.0, 1100.0, 1800.0, 2600.0, 2900.0];
    let truth = StiffnessCurve::new(strains, stiffnesses, NegativeStrain::Green).unwrap();
    let law = |strain: f64| truth.stress(strain);
    let mut flagged = 0;
    let sum: f64 = (0..seeds)
        .map(|seed| {
            let report = fit_weft(&measure(Model::STVK, &law, 0.06, Some(seed)), Model::STVK, nodes);
            flagged += usize::from(report.scatter.misfit > 0.0);
            coverage(&report.curve.samples, &law)
        })
        .sum();
    println!(
        "{seeds} seeds: the band holds the truth in {:.1} %; misfit seen in {flagged}",
        100.0 * sum / seeds as f64
    );
    sum / seeds as f64
}

#[test]
fn bands_hold_a_truth_that_the_curve_can_represent() {
    let held = mean_coverage(20, [7, 7]);
    assert!(held >= 0.95, "{held}");
}

#[test]
#[ignore = "release: 100 seeds on 25x25 nodes"]
fn bands_hold_a_truth_that_the_curve_can_represent_in_full() {
    let held = mean_coverage(100, [25, 25]);
    assert!(held >= 0.95, "{held}");
}
