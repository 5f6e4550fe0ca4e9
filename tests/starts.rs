//! A fit does not depend on its start: twenty starts over three decades reach the same optimum, for every stage.
//!
//! ```text
//!  start × 10^−1.5 … 10^1.5, log-uniform ──▶ fit ──▶ control values alike within 0.1 %
//! ```
//!
//! Stretch: 8(e^{10ε} − 1) to 25 % in uniform stretch, 3 mN. Shear: 60ε + 400ε³ in a picture frame, 3 mN. Bending:
//! the heavy elastica at Γ = 30, along weft and on the bias, 0.075 mm.

use cloth_data::frame::{Kind, MeasurementSet};
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::report::StageReport;
use cloth_fit::stage::{Plan, Settings, Watch, bend, fit, shear, stretch};
use cloth_sim::material::{Component, Model};
use fit_cloth_tests::UniformStretch;
use fit_cloth_tests::cantilever::{Cantilever, GRAVITY, POSITION_NOISE, SIDE, between_rows};
use fit_cloth_tests::picture_frame::PictureFrame;
use rand::{Rng, SeedableRng, rngs::StdRng};
use rand_distr::{Distribution, StandardNormal};

const STARTS: usize = 20;

fn fit_from(set: &MeasurementSet, plan: &Plan, start_factor: f64) -> StageReport {
    let settings = Settings { start_factor, nodes: Some([13, 13]), ..Settings::default() };
    fit(set, plan, &mut Knowledge::default(), &settings, &mut Watch::default()).unwrap().unwrap()
}

fn one_optimum(set: &MeasurementSet, plan: &Plan) {
    let reference = fit_from(set, plan, 1.0);
    assert!(reference.converged);
    let mut random = StdRng::seed_from_u64(7);
    let mut apart = Vec::new();
    let mut worst = 0.0f64;
    for _ in 0..STARTS {
        let factor = 10f64.powf(random.random_range(-1.5..1.5));
        let report = fit_from(set, plan, factor);
        let [a, b] = [&reference, &report].map(|report| report.curve.curve.stiffnesses());
        let largest = a.iter().copied().fold(0.0, f64::max);
        let off = match a.len() == b.len() {
            true => {
                a.iter().zip(b).map(|(a, b)| (a - b).abs() / a.abs().max(1e-3 * largest)).fold(0.0, f64::max)
            }
            false => f64::INFINITY,
        };
        worst = worst.max(off);
        if off > 1e-3 || !report.converged {
            let rms = report.levels.iter().map(|level| (level.points, level.rms)).collect::<Vec<_>>();
            apart.push(format!("× {factor:.3}: {off:.1e}, {b:?}, {rms:?}, dropped {}", report.dropped.len()));
        }
    }
    println!("{}: {STARTS} starts end within {worst:.1e}", plan.name());
    let levels: Vec<_> = reference.levels.iter().map(|level| (level.points, level.rms)).collect();
    assert!(apart.is_empty(), "{:?} {levels:?}\n{}", reference.curve.curve.stiffnesses(), apart.join("\n"));
}

#[test]
fn stretch_ends_in_one_optimum() {
    let mut random = StdRng::seed_from_u64(11);
    let mut normal = || StandardNormal.sample(&mut random);
    let law = |e: f64| 8.0 * (10.0 * e).exp_m1();
    let noise = Some((3e-3, &mut normal as &mut dyn FnMut() -> f64));
    let set = UniformStretch { model: Model::STVK, law: &law, largest: 0.25, frames: 20, grip: 0.0, noise };
    one_optimum(&set.measure(), &stretch::plan(&[Component::StretchWeft]));
}

#[test]
fn shear_ends_in_one_optimum() {
    let angles: Vec<f64> = (1..=15).map(|i| 0.5f64.asin() * f64::from(i) / 15.0).collect();
    let law = |e: f64| 60.0 * e + 400.0 * e * e * e;
    let set = PictureFrame { noise: Some(2), shapes: true, ..PictureFrame::of_law(&law, &angles) }.measure();
    one_optimum(&set, &shear::plan(1));
}

#[test]
fn bending_ends_in_one_optimum() {
    let rigidity = 0.2 * GRAVITY * 0.085f64.powi(3) / 30.0;
    let overhangs = between_rows([12, 14, 16, 18, 20]);
    for (kind, component) in
        [(Kind::BendWeft, Component::BendWeft), (Kind::BendBias, Component::BendDiagonal)]
    {
        let cantilever = Cantilever {
            kind,
            areal_density: 0.2,
            moment: &|curvature| rigidity * curvature,
            overhangs: &overhangs,
            size: [SIDE; 2],
            measured: [50, 50],
            noise: Some((POSITION_NOISE, 4)),
        };
        one_optimum(&cantilever.measure(), &bend::plan(&[component], 1));
    }
}
