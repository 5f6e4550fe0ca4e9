//! Source: none; the effects of unsound curves are described by Strohkorb 2019, §4.2 and figure 7.
//!
//! Goal: a curve that passes the check does not make a simulation diverge.
//!
//! ```text
//!   o──────o      a sheet of 0.1 m swings down from two corners, with the curve in weft, warp and shear;
//!    ╲____╱       StVK and soft constraints in turn, implicit Euler, 10 ms and 0.1 s
//! ```
//!
//! Parameters: the 1000 random curves of `repair.rs`, each unchanged if sound, otherwise repaired; 2 × 20 steps.
//! Passes when every step ends with finite numbers, and the energy never exceeds that of the start by more than 1e-6
//! of its scale.

use cloth_fit::judge::repair::repair;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::curve::soundness::{Context, MEMBRANE_STIFFNESS, check};
use cloth_sim::dynamics::{Motion, Settings, Status, Step};
use cloth_sim::equilibrium::Remedies;
use cloth_sim::material::{Component, Compression, Curves, Model};
use cloth_sim::mesh::Diagonals;
use cloth_sim::samples::{self, GRAVITY, SIDE, Sample};
use fit_cloth_tests::random_curve::random_curve;
use nalgebra::Vector3;

/// Mass per area, kg/m²: heavy enough to strain soft curves far beyond their last control point.
const AREAL_DENSITY: f64 = 0.5;

fn sheet(model: Model, curve: &StiffnessCurve) -> Sample {
    let of = |component| {
        let negative = model.negative_strain(component, Compression::ZeroStrain);
        let (strains, stiffnesses) = (curve.strains().to_vec(), curve.stiffnesses().to_vec());
        Some((component, StiffnessCurve::new(strains, stiffnesses, negative).ok()?))
    };
    let components = [Component::StretchWeft, Component::StretchWarp, Component::Shear];
    let curves: Curves = components.into_iter().filter_map(of).collect();
    let mesh = samples::square(5, Diagonals::Alternating).expect("a grid");
    let mut sample = Sample::at_rest(mesh, model, curves);
    sample.areal_density = AREAL_DENSITY;
    sample.gravity = Vector3::new(0.0, 0.0, -GRAVITY);
    sample.hold(|p| (p.y > 0.999 * SIDE && (p.x == 0.0 || p.x > 0.999 * SIDE)).then_some(0));
    sample.perturb(1e-5);
    sample
}

#[test]
fn no_curve_that_passes_the_check_makes_a_simulation_diverge() {
    let context = Context { magnitude: Some(MEMBRANE_STIFFNESS), visited: None };
    let (mut simulated, mut unsolved) = (0, 0);
    let mut remedies = Remedies::default();
    for seed in 0..1000 {
        let model = if seed % 2 == 0 { Model::STVK } else { Model::SOFT_CONSTRAINT };
        let given = random_curve(seed, model.negative_strain(Component::Shear, Compression::ZeroStrain));
        let curve = if check(&given, &context).is_empty() {
            given
        } else {
            // A curve with stress that is negative overall cannot be repaired.
            let Ok(repaired) = repair(&given, &context) else { continue };
            repaired.curve
        };
        assert_eq!(check(&curve, &context), [], "curve {seed}");
        simulated += 1;
        let sample = sheet(model, &curve);
        let cloth = sample.cloth().expect("a cloth that is held");
        for step in [0.01, 0.1] {
            let settings = Settings { step, ..Settings::default() };
            let mut motion =
                Motion::new(&cloth, &sample.curves, sample.start.clone(), &settings).expect("settings");
            let start = motion.energies();
            let mut scale = 0.0f64;
            for number in 0..20 {
                let Step { status, remedies: used, .. } = motion.step();
                remedies += used;
                let what = format!("curve {seed}, {model}, h = {step} s, step {number}");
                assert_ne!(status, Status::NotFinite, "{what}");
                unsolved += usize::from(status == Status::NotConverged);
                let now = motion.energies();
                scale = scale.max(now.kinetic).max(now.elastic).max((now.weight - start.weight).abs());
                let gain = now.total() - start.total();
                assert!(gain <= 1e-6 * scale, "{what}: {gain:.1e} of {scale:.1e} J gained");
            }
        }
    }
    println!(
        "{simulated} curves simulated, {unsolved} of {} steps not solved to the tolerance; {remedies:?}",
        40 * simulated
    );
    // Some of these steps must be restarted, and that is reported.
    assert!(remedies.careful > 0 && remedies.careful * 10 < 40 * simulated, "{remedies:?}");
    assert!(simulated > 980 && unsolved * 1000 < 40 * simulated, "{simulated} {unsolved}");
}
