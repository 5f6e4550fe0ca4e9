//! The whole fit of four known fabrics measured by the virtual rig: eight tests on 61×61 nodes, sampled at 10 000
//! vertices, fitted on 25×25.
//!
//! ```text
//! rig ──▶ stretch, picture frame, three overhangs ──▶ six curves ──▶ complex shear, corner pull: not used in the fit
//! ```
//!
//! The fit recovers stretch stress within 1 %, shear stress within 3 % and bending moments within 5 % (relative L2
//! over the visited range). The second pass over shear, which lets the sheet buckle, is far more accurate than the
//! first. With instrument noise and cord friction the bounds are 2, 5 and 10 %. The two motions not used in any fit
//! are predicted within 10 % of the range of their measure.

use cloth_data::frame::{Kind, MeasurementSet};
use cloth_data::rig::{KnownFabric, Rig, with_noise};
use cloth_fit::incremental::{FitReport, Stage, fit};
use cloth_fit::judge::compare::run;
use cloth_fit::judge::validation::validate;
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::report::StageReport;
use cloth_fit::stage::{Settings, Watch};
use cloth_sim::material::{Component, Curves, Model};
use cloth_sim::strain_measure::HINGE_STRAIN_PER_CURVATURE;
use fit_cloth_tests::{coverage, stress_error};

fn measure(fabric: &KnownFabric, full_noise: bool, nodes: usize) -> MeasurementSet {
    let rig = Rig { noise: full_noise, cord_hysteresis: full_noise, nodes: [nodes; 2], ..Rig::default() };
    rig.measure(fabric).unwrap()
}

fn fit_all(set: &MeasurementSet, model: Model) -> FitReport {
    let settings = Settings { model, ..Settings::default() };
    fit(set, &Stage::ALL, &Knowledge::default(), &settings, &mut Watch::default()).unwrap()
}

/// Relative L2 error of the stress or moment.
fn error(stage: &StageReport, truth: &Curves) -> f64 {
    let component = stage.components[0];
    let curve = truth.get(component).unwrap();
    let scale = if component.is_bending() { HINGE_STRAIN_PER_CURVATURE } else { 1.0 };
    stress_error(&stage.curve.samples, &|x| curve.stress(scale * x))
}

/// Share of the rows whose band holds the truth.
fn held(stage: &StageReport, truth: &Curves) -> f64 {
    let component = stage.components[0];
    let curve = truth.get(component).unwrap();
    let scale = if component.is_bending() { HINGE_STRAIN_PER_CURVATURE } else { 1.0 };
    coverage(&stage.curve.samples, &|x| curve.stress(scale * x))
}

/// Fits and validates the four fabrics.
///
/// * `nodes` — of the rig, a side
fn comes_back(full_noise: bool, nodes: usize, [stretch, shear, bending]: [f64; 3]) {
    for name in KnownFabric::names() {
        let fabric = KnownFabric::named(name).unwrap();
        let set = measure(&fabric, full_noise, nodes);
        let report = fit_all(&set, Model::STVK);
        let truth = fabric.curves().unwrap();
        for component in Model::STVK.components() {
            let stage = report.stage(component).unwrap();
            let error = error(stage, &truth);
            println!(
                "{:18} {component:13} noise {full_noise:5}: {:5.2} %, truth inside {:.2}, {} points, {:.2} s",
                name,
                100.0 * error,
                held(stage, &truth),
                stage.curve.curve.len(),
                stage.seconds
            );
            let limit = match component {
                Component::Shear => shear,
                component if component.is_stretch() => stretch,
                _ => bending,
            };
            assert!(stage.converged && stage.curve.observed, "{} {component}", name);
            assert!(error <= limit, "{} {component}: {error}", name);
        }
        // The sheet buckled; the first pass kept it flat.
        let passes = report.stages.iter().filter(|stage| stage.components == [Component::Shear]);
        let [first, second] = passes.map(|stage| error(stage, &truth)).collect::<Vec<_>>()[..] else {
            panic!("two passes over shear")
        };
        println!("{:18} shear in the plane {:.1} %, in space {:.1} %", name, 100.0 * first, 100.0 * second);
        assert!(second < 0.5 * first);
        let unseen = [Kind::ComplexShear, Kind::CornerPull];
        let validation = validate(
            &set,
            &unseen,
            report.curves(),
            &report.assumed(),
            &Settings::default(),
            &Watch::default(),
        )
        .unwrap();
        assert!(validation.sequences.len() == 2 && validation.prediction.dropped.is_empty());
        for sequence in &validation.sequences {
            let share = sequence.measure_share().unwrap();
            println!(
                "{:18} {:13} {:5.2} % of the range; several equilibria in frames {:?}",
                name,
                sequence.report.name,
                100.0 * share,
                sequence.report.multi_stable
            );
            assert!(share <= 0.1, "{} {}: {share}", name, sequence.report.name);
        }
    }
}

#[test]
fn another_sample_is_met_as_far_as_it_differs() {
    let fabric = KnownFabric::named("cotton-denim").unwrap();
    let rig = Rig { nodes: [31, 31], measured: [25, 25], frames: 6, ..Rig::default() };
    let settings = Settings { nodes: Some([15, 15]), ..Settings::default() };
    let [first, second] =
        [1, 2].map(|sample| Rig { sample, ..rig.clone() }.measure(&fabric).expect("a measured sample"));
    let report = fit(&first, &Stage::ALL, &Knowledge::default(), &settings, &mut Watch::default()).unwrap();
    let shares = [&first, &second].map(|set| {
        let kinds = [Kind::StretchWeft, Kind::StretchWarp, Kind::Shear];
        let met =
            validate(set, &kinds, report.curves(), &report.assumed(), &settings, &Watch::default()).unwrap();
        met.sequences
            .iter()
            .filter_map(|sequence| {
                let share = sequence.report.force_rms? / sequence.report.force_largest;
                println!(
                    "{:14} {:13} {:.2} % of the largest force",
                    set.fabric.name,
                    sequence.report.name,
                    100.0 * share
                );
                Some(share)
            })
            .fold(0.0, f64::max)
    });
    // Its curves are those of the first sample times factors within about 10 %.
    assert!(shares[0] < 0.01 && shares[1] > shares[0] && shares[1] < 0.3);
}

/// A set of every test on a coarse grid.
fn coarse(name: &str) -> MeasurementSet {
    let rig = Rig { nodes: [25, 25], measured: [13, 13], frames: 12, ..Rig::default() };
    rig.measure(&KnownFabric::named(name).unwrap()).unwrap()
}

/// Miguel et al. 2012, §5.2.
#[test]
fn stages_run_in_the_published_order_each_on_the_ones_before() {
    use Component::{BendDiagonal, BendWarp, BendWeft, Shear, StretchWarp, StretchWeft};
    let settings = Settings { nodes: Some([9, 9]), ..Settings::default() };
    let set = coarse("cotton-denim");
    let report = fit(&set, &Stage::ALL, &Knowledge::default(), &settings, &mut Watch::default()).unwrap();
    let order: Vec<_> = report.stages.iter().map(|stage| (stage.components.clone(), stage.pass)).collect();
    let stretch = [StretchWeft, StretchWarp].map(|component| (vec![component], 1));
    let others = [1, 2].map(|pass| [Shear, BendWeft, BendWarp, BendDiagonal].map(|c| (vec![c], pass)));
    assert_eq!(order, [&stretch[..], &others[0], &others[1]].concat());
    let carried = |stage: usize| &report.stages[stage].basis.carried[..];
    assert_eq!(carried(2), [StretchWeft, StretchWarp]);
    assert_eq!(carried(6), [StretchWeft, StretchWarp, BendWeft, BendWarp, BendDiagonal]);
}

/// Miguel et al. 2012, §6, by complex shear and corner pulls. The rig's truth is StVK. Of satin alone springs find all
/// bending curves; others are assumed.
#[test]
fn springs_predict_worst_and_the_other_models_are_alike() {
    for name in KnownFabric::names() {
        let set = coarse(name);
        let [stvk, soft, springs] = [Model::STVK, Model::SOFT_CONSTRAINT, Model::SPRINGS].map(|model| {
            let settings = Settings { model, nodes: Some([13, 13]), ..Settings::default() };
            let entry = run(&set, &settings, false, &mut Watch::default()).unwrap();
            let complete = model != Model::SPRINGS || name == "cotton-satin";
            assert_eq!(entry.row.missing.is_empty(), complete, "{name} {model}");
            let met = entry.row.validation.unwrap();
            assert_eq!(met.dropped, 0, "{name} {model}");
            met.relative.unwrap()
        });
        println!("{name:18} StVK {stvk:.4}, soft constraints {soft:.4}, springs {springs:.4}");
        assert!((soft / stvk - 1.0).abs() < 0.05 && springs > 1.5 * stvk.max(soft), "{name}");
    }
}

#[test]
#[ignore = "release: four fabrics without noise"]
fn four_fabrics_come_back() {
    comes_back(false, 61, [0.003, 0.008, 0.03]);
    comes_back(false, 97, [0.003, 0.01, 0.02]);
}

#[test]
fn four_fabrics_come_back_through_full_noise() {
    comes_back(true, 61, [0.02, 0.05, 0.1]);
}

/// Coverage of all bands over many seeds, of everything that the rig can add: noise of vertices, forces and clip poses.
/// `SEEDS=30 cargo test --release -p fit-cloth-tests --test main bands_of_the_rig -- --ignored --nocapture`
#[test]
#[ignore = "release: 30 seeds of four fabrics, on 61x61 and 97x97 nodes: hours"]
fn bands_of_the_rig_hold_the_truth() {
    let mut sound = true;
    let seeds: u64 = std::env::var("SEEDS").map_or(30, |seeds| seeds.parse().expect("SEEDS: a number"));
    for nodes in [61, 97] {
        for name in KnownFabric::names() {
            let fabric = KnownFabric::named(name).unwrap();
            let truth = fabric.curves().unwrap();
            let mut sums = vec![0.0; Model::STVK.components().len()];
            let exact = Rig { nodes: [nodes; 2], noise: false, ..Rig::default() }.measure(&fabric).unwrap();
            for seed in 1..=seeds {
                let report = fit_all(&with_noise(&exact, 1.0, 1.0, true, seed), Model::STVK);
                for (sum, component) in sums.iter_mut().zip(Model::STVK.components()) {
                    *sum += held(report.stage(component).unwrap(), &truth) / seeds as f64;
                }
            }
            let pooled = sums.iter().sum::<f64>() / sums.len() as f64;
            let each: Vec<String> = Model::STVK
                .components()
                .iter()
                .zip(&sums)
                .map(|(c, held)| format!("{c} {held:.2}"))
                .collect();
            println!("{name:18} {nodes} nodes, {seeds} seeds: {pooled:.3} inside; {}", each.join(", "));
            sound &= pooled >= 0.9 && sums.iter().all(|&held| held >= 0.6);
        }
    }
    assert!(sound);
}
