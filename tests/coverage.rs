//! Measures how often the 95 % bands contain the truth, for a truth that the fit can represent: simulated on the mesh
//! of the fit, with curves of as many control points.
//!
//! ```text
//! truth ──▶ simulation of the fit ──▶ + 3 mN, 0.075 mm (seed) ──▶ fit ──▶ share of rows whose band contains the truth
//! ```
//!
//! | stage | test | truth | carried forward |
//! |---|---|---|---|
//! | stretch | closed_form.rs | 5 points | – |
//! | stretch | strip, 100 × 50 mm, to 5 %, clips off by 0.03 mm and turned by as much over their length | 5 points | – |
//! | shear | picture frame | 5 points | – |
//! | shear | bias strip, 100 × 50 mm, to 12 % | constant | both stretches, from strips with 30 mN |
//! | bending | 100 mm square, overhangs of 53 to 87 mm, held lines as noisy as the rest | constant, 2 points | – |
//! | bending | the same along weft, warp and the bias | constants 1 : 0.4 : 0.6 | the other two, in two passes |
//!
//! Averaged over 201 rows and 100 seeds the share is 90–99 %; with 20 seeds on fewer nodes it is 85–100 %. The
//! uncertainty of earlier stages matters: without it the band of the bias strip contains the truth in 12–15 %.

use cloth_data::frame::{Kind, Sequence};
use cloth_data::strip::{Direction, Extension, StripTest, read_strip};
use cloth_fit::incremental::{Stage, fit};
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::report::StageReport;
use cloth_fit::stage::{self, Settings, Variant, Watch};
use cloth_sim::curve::{NegativeStrain, StiffnessCurve, equidistant};
use cloth_sim::material::{Component, Compression, Curves, Model};
use cloth_sim::strain_measure::HINGE_STRAIN_PER_CURVATURE;
use fit_cloth_tests::cantilever::{Cantilever, GRAVITY, POSITION_NOISE, SIDE};
use fit_cloth_tests::own_mesh::{simulated, with_noise, with_shaken_clips};
use fit_cloth_tests::picture_frame::PictureFrame;
use fit_cloth_tests::{coverage, weightless};

const FORCE_NOISE: f64 = 3e-3;

/// Number of seeds and nodes per side.
#[derive(Clone, Copy)]
struct Size {
    seeds: u64,
    nodes: usize,
    bending: usize,
}

const FAST: Size = Size { seeds: 20, nodes: 5, bending: 13 };
const FULL: Size = Size { seeds: 100, nodes: 13, bending: 25 };

impl Size {
    fn judge(self, name: &str, held: f64) {
        println!("{name}: {} seeds, the band holds the truth in {:.1} %", self.seeds, 100.0 * held);
        let allowed = if self.seeds < 100 { 0.85..=1.0 } else { 0.90..=0.99 };
        assert!(allowed.contains(&held), "{name}: {held}");
    }

    fn mean(self, share: impl Fn(u64) -> f64) -> f64 {
        (0..self.seeds).map(share).sum::<f64>() / self.seeds as f64
    }
}

fn curve(component: Component, strains: Vec<f64>, stiffnesses: &[f64]) -> (Component, StiffnessCurve) {
    let negative = Model::STVK.negative_strain(component, Compression::ZeroStrain);
    (component, StiffnessCurve::new(strains, stiffnesses.to_vec(), negative).unwrap())
}

fn constant(component: Component, stiffness: f64) -> (Component, StiffnessCurve) {
    curve(component, vec![0.0], &[stiffness])
}

fn membrane() -> Curves {
    let pairs = [(Component::StretchWeft, 400.0), (Component::StretchWarp, 300.0), (Component::Shear, 50.0)];
    pairs.map(|(component, stiffness)| constant(component, stiffness)).into_iter().collect()
}

/// Share of the rows of a stage's curve whose band contains the truth.
fn share(stage: &StageReport, truth: &Curves) -> f64 {
    let component = stage.components[0];
    let scale = if component.is_bending() { HINGE_STRAIN_PER_CURVATURE } else { 1.0 };
    assert!(stage.converged, "{component}: {:?}", stage.levels);
    let truth = truth.get(component).unwrap();
    coverage(&stage.curve.samples, &|strain| truth.stress(scale * strain))
}

fn shear_in_a_picture_frame(size: Size) {
    let angles: Vec<f64> = (1..=20).map(|i| 0.5f64.asin() * f64::from(i) / 20.0).collect();
    let stiffnesses = vec![60.0, 70.0, 95.0, 130.0, 150.0];
    let truth = StiffnessCurve::new(equidistant(5, 0.5), stiffnesses, NegativeStrain::Odd).unwrap();
    let settings = Settings { nodes: Some([size.nodes; 2]), ..Settings::default() };
    let truths: Curves = [(Component::Shear, truth.clone())].into_iter().collect();
    let held = size.mean(|seed| {
        let law = |strain: f64| truth.stress(strain);
        let set =
            PictureFrame { noise: Some(seed), shapes: true, ..PictureFrame::of_law(&law, &angles) }.measure();
        let known = Knowledge::default();
        let report = fit(&set, &[Stage::Shear], &known, &settings, &mut Watch::default()).unwrap();
        share(report.stage(Component::Shear).unwrap(), &truths)
    });
    size.judge("shear, picture frame", held);
}

#[test]
fn bands_of_shear_hold_the_truth() {
    shear_in_a_picture_frame(FAST);
}

#[test]
#[ignore = "release: 100 seeds on 13x13 nodes"]
fn bands_of_shear_hold_the_truth_in_full() {
    shear_in_a_picture_frame(FULL);
}

/// A strip of 100 × 50 mm, pulled in equal steps.
fn strip(direction: Direction, largest: f64) -> Sequence {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("strip.csv");
    let rows = (1..=12).map(|i| format!("{},1\n", largest * f64::from(i) / 12.0));
    std::fs::write(&path, format!("strain,force_N\n{}", rows.collect::<String>())).unwrap();
    let extension = Extension::Strain("strain:1".into());
    read_strip(&path, &StripTest::new(direction, 0.1, 0.05, extension, "force_N".into())).unwrap().sequence
}

fn shear_after_stretch(size: Size) {
    let pulls = [(Direction::Weft, 0.05), (Direction::Warp, 0.05), (Direction::Bias, 0.12)];
    let nominal = weightless("strips", pulls.map(|(direction, largest)| strip(direction, largest)).to_vec());
    let truth: Curves =
        [(Component::StretchWeft, 300.0), (Component::StretchWarp, 200.0), (Component::Shear, 150.0)]
            .map(|(component, stiffness)| constant(component, stiffness))
            .into_iter()
            .collect();
    let nodes = Some([2 * size.nodes - 1, size.nodes]);
    let settings = Settings { nodes, variant: Variant::Linear, ..Settings::default() };
    let exact = simulated(&nominal, &truth, &settings);
    let force = |kind| if kind == Kind::StretchBias { FORCE_NOISE } else { 10.0 * FORCE_NOISE };
    // With the uncertainty of the stretch stages carried forward, and without.
    let held = |carried: bool| {
        size.mean(|seed| {
            let set = with_noise(&exact, seed, POSITION_NOISE, force);
            let fit = |stage, known: &Knowledge| {
                fit(&set, &[stage], known, &settings, &mut Watch::default()).unwrap()
            };
            let stretch = fit(Stage::Stretch, &Knowledge::default()).knowledge;
            let known = if carried { stretch } else { Knowledge::exact(stretch.curves().clone()) };
            share(fit(Stage::Shear, &known).stage(Component::Shear).unwrap(), &truth)
        })
    };
    let without = held(false);
    println!("shear, bias strip: without what stretch does not know {:.1} %", 100.0 * without);
    size.judge("shear, bias strip", held(true));
    assert!(without < 0.5, "{without}");
}

#[test]
fn bands_of_shear_carry_what_stretch_does_not_know() {
    shear_after_stretch(FAST);
}

#[test]
#[ignore = "release: 100 seeds on 25x13 nodes"]
fn bands_of_shear_carry_what_stretch_does_not_know_in_full() {
    shear_after_stretch(FULL);
}

fn stretch_between_shaken_clips(size: Size) {
    let nominal = weightless("strip", vec![strip(Direction::Weft, 0.05)]);
    let stiffnesses = [300.0, 330.0, 420.0, 560.0, 700.0];
    let stretch = curve(Component::StretchWeft, equidistant(5, 0.05), &stiffnesses);
    let truth: Curves = [stretch, constant(Component::StretchWarp, 200.0)].into_iter().collect();
    let settings = Settings { nodes: Some([2 * size.nodes - 1, size.nodes]), ..Settings::default() };
    let exact = simulated(&nominal, &truth, &settings);
    let held = |exact_clips: bool| {
        let settings = Settings { exact_clips, ..settings.clone() };
        size.mean(|seed| {
            let set = with_noise(&exact, seed, POSITION_NOISE, |_| FORCE_NOISE);
            let set = with_shaken_clips(&set, seed, 3e-5);
            let report =
                fit(&set, &[Stage::Stretch], &Knowledge::default(), &settings, &mut Watch::default())
                    .unwrap();
            let stage = report.stage(Component::StretchWeft).unwrap();
            if !exact_clips {
                assert_eq!(stage.scatter.misfit, 0.0, "seed {seed}");
            }
            share(stage, &truth)
        })
    };
    let without = held(true);
    println!("stretch, clips taken to be exact: {:.1} %", 100.0 * without);
    size.judge("stretch, shaken clips", held(false));
}

#[test]
fn bands_of_stretch_hold_what_clips_are_off() {
    stretch_between_shaken_clips(FAST);
}

#[test]
#[ignore = "release: 100 seeds on 25x13 nodes"]
fn bands_of_stretch_hold_what_clips_are_off_in_full() {
    stretch_between_shaken_clips(FULL);
}

const DENSITY: f64 = 0.2;

/// A square pushed over an edge, with shapes observed at nodes of the default grid.
///
/// * `share` — of the rigidity at Γ = 30
fn overhanging(kind: Kind, nodes: usize, share: f64) -> Sequence {
    let rigidity = share * DENSITY * GRAVITY * 0.085f64.powi(3) / 30.0;
    let cells = nodes - 1;
    let overhangs: Vec<f64> =
        (0..5).map(|i| ((cells * (16 + 2 * i) / 30) as f64 + 0.4) * SIDE / cells as f64).collect();
    let moment = |curvature: f64| rigidity * curvature;
    let measured = [nodes; 2];
    Cantilever {
        kind,
        areal_density: DENSITY,
        moment: &moment,
        overhangs: &overhangs,
        size: [SIDE; 2],
        measured,
        noise: None,
    }
    .sequence()
}

/// Stiffness of hinges at Γ = 30.
const HINGES: f64 = DENSITY * GRAVITY * 0.085 * 0.085 * 0.085 / 30.0 / HINGE_STRAIN_PER_CURVATURE;

fn bending_alone(size: Size, points: usize) {
    let largest = HINGE_STRAIN_PER_CURVATURE * 200.0;
    let weft = curve(
        Component::BendWeft,
        equidistant(points, largest),
        [&[HINGES][..], &[1.3 * HINGES, 0.8 * HINGES]][points - 1],
    );
    let others = [Component::BendWarp, Component::BendDiagonal].map(|component| constant(component, HINGES));
    let membrane = membrane();
    let known: Curves = membrane
        .components()
        .map(|component| (component, membrane.get(component).unwrap().clone()))
        .chain(others)
        .collect();
    let mut truth = known.clone();
    truth.set(weft.0, weft.1);
    let settings = Settings { points, ..Settings::default() };
    let nominal = weightless("sheet", vec![overhanging(Kind::BendWeft, size.bending, 1.0)]);
    let exact = simulated(&nominal, &truth, &settings);
    let plan = stage::bend::plan(&[Component::BendWeft], 1);
    let held = size.mean(|seed| {
        let set = with_noise(&exact, seed, POSITION_NOISE, |_| FORCE_NOISE);
        let mut known = Knowledge::exact(known.clone());
        let stage = stage::fit(&set, &plan, &mut known, &settings, &mut Watch::default()).unwrap();
        share(&stage.unwrap(), &truth)
    });
    size.judge(&format!("bend-weft, {points} points"), held);
}

#[test]
fn bands_of_bending_hold_the_truth() {
    bending_alone(FAST, 1);
    bending_alone(FAST, 2);
}

#[test]
#[ignore = "release: 100 seeds on 25x25 nodes"]
fn bands_of_bending_hold_the_truth_in_full() {
    bending_alone(FULL, 1);
    bending_alone(FULL, 2);
}

fn all_bending(size: Size) {
    let bends = [
        (Component::BendWeft, HINGES),
        (Component::BendWarp, 0.4 * HINGES),
        (Component::BendDiagonal, 0.6 * HINGES),
    ];
    let known = membrane();
    let mut truth = known.clone();
    bends.iter().for_each(|&(component, stiffness)| {
        let (component, curve) = constant(component, stiffness);
        truth.set(component, curve);
    });
    let settings = Settings { variant: Variant::Linear, ..Settings::default() };
    let kinds = [(Kind::BendWeft, 1.0), (Kind::BendWarp, 0.4), (Kind::BendBias, 0.6)];
    let sequences = kinds.into_iter().map(|(kind, share)| overhanging(kind, size.bending, share));
    let nominal = weightless("sheet", sequences.collect());
    let exact = simulated(&nominal, &truth, &settings);
    let shares: Vec<[f64; 3]> = (0..size.seeds)
        .map(|seed| {
            let set = with_noise(&exact, seed, POSITION_NOISE, |_| FORCE_NOISE);
            let known = Knowledge::exact(known.clone());
            let report = fit(&set, &[Stage::Bend], &known, &settings, &mut Watch::default()).unwrap();
            bends.map(|(component, _)| share(report.stage(component).unwrap(), &truth))
        })
        .collect();
    for (i, (component, _)) in bends.into_iter().enumerate() {
        let held = shares.iter().map(|shares| shares[i]).sum::<f64>() / shares.len() as f64;
        size.judge(&format!("all bending, {component}"), held);
    }
}

#[test]
fn bands_of_bending_carry_what_the_others_do_not_know() {
    all_bending(FAST);
}

#[test]
#[ignore = "release: 100 seeds on 25x25 nodes"]
fn bands_of_bending_carry_what_the_others_do_not_know_in_full() {
    all_bending(FULL);
}
