//! Arbitrary control points → a curve → check → repair → a few steps of a small sheet.
//!
//! The first byte selects the decoding of the rest; a pair of numbers is a control point.

#![no_main]

use cloth_fit::judge::repair::repair;
use cloth_fit::material::check::context;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::curve::soundness::{Finding, check};
use cloth_sim::dynamics::{Motion, Settings, Status};
use cloth_sim::error::Error;
use cloth_sim::material::{Component, Compression, Model};
use cloth_sim::mesh::Diagonals;
use cloth_sim::samples::{self, GRAVITY, SIDE, Sample};
use libfuzzer_sys::fuzz_target;
use nalgebra::Vector3;

/// Curves of the other components: stretch and shear in N/m, bending in N·m.
const REST: [f64; 3] = [1000.0, 100.0, 1e-5];
const POINTS: usize = 10;
const STEPS: usize = 5;
const STRETCH: [Component; 2] = [Component::StretchWeft, Component::StretchWarp];
const BEND: [Component; 3] = [Component::BendWeft, Component::BendWarp, Component::BendDiagonal];

fuzz_target!(|bytes: &[u8]| {
    let Some((&flags, rest)) = bytes.split_first() else { return };
    let model = if flags & 1 == 0 { Model::STVK } else { Model::SOFT_CONSTRAINT };
    let components: &[Component] = match flags >> 1 & 3 {
        0 => &STRETCH,
        1 => &[Component::Shear],
        2 => &BEND,
        _ => &[Component::StretchWeft],
    };
    let step = [1e-3, 0.01, 0.1, 1.0][usize::from(flags >> 3 & 3)];
    let values = if flags >> 5 & 1 == 0 { decades(rest) } else { doubles(rest) };
    let points = values.chunks_exact(2).take(POINTS);
    let (strains, stiffnesses) = points.map(|pair| (pair[0], pair[1])).unzip();
    let negative = model.negative_strain(components[0], Compression::ZeroStrain);
    let curve = match StiffnessCurve::new(strains, stiffnesses, negative) {
        Ok(curve) => curve,
        Err(Error::Curve { point, reason }) => return assert!(point <= POINTS && !reason.is_empty()),
        Err(other) => panic!("{other:?}"),
    };
    fit_cloth_fuzz::evaluate(&curve);
    let context = context(model, components[0], None);
    let findings = check(&curve, &context);
    assert!(findings.iter().all(|finding| !finding.value.is_nan() && !finding.to_string().is_empty()));
    let curve = match repair(&curve, &context) {
        Ok(repaired) => {
            let sound = !findings.iter().any(Finding::is_defect);
            assert!(
                !sound || (repaired.is_unchanged() && repaired.curve == curve),
                "sound, and yet repaired"
            );
            repaired.curve
        }
        Err(reason) => {
            assert!(findings.iter().any(Finding::is_defect), "sound, and yet not its own repair: {reason}");
            return;
        }
    };
    assert!(
        !check(&curve, &context).iter().any(Finding::is_defect),
        "repaired, and yet not sound: {curve:?}"
    );
    let again = repair(&curve, &context).expect("a sound curve is its own repair");
    assert!(again.is_unchanged() && again.curve == curve);
    simulate(&curve, model, components, step);
});

/// Lets a sheet of 0.1 m swing down from two corners.
fn simulate(curve: &StiffnessCurve, model: Model, components: &[Component], step: f64) {
    let rest = samples::fabric(model, REST).expect("constants");
    let curves = rest.components().filter_map(|component| {
        let negative = model.negative_strain(component, Compression::ZeroStrain);
        let of = if components.contains(&component) { curve } else { rest.get(component)? };
        let curve = StiffnessCurve::new(of.strains().to_vec(), of.stiffnesses().to_vec(), negative);
        Some((component, curve.expect("control points of a curve")))
    });
    let mesh = samples::square(3, Diagonals::Alternating).expect("a grid");
    let mut sample = Sample::at_rest(mesh, model, curves.collect());
    sample.gravity = Vector3::new(0.0, 0.0, -GRAVITY);
    sample.hold(|p| (p.y > 0.999 * SIDE && (p.x == 0.0 || p.x > 0.999 * SIDE)).then_some(0));
    sample.perturb(1e-5);
    let cloth = sample.cloth().expect("a cloth that is held");
    let settings = Settings { step, ..Settings::default() };
    let mut motion = Motion::new(&cloth, &sample.curves, sample.start.clone(), &settings).expect("settings");
    let start = motion.energies();
    let mut scale = 0.0f64;
    for number in 0..STEPS {
        assert_ne!(motion.step().status, Status::NotFinite, "step {number} of {curve:?}");
        let now = motion.energies();
        scale = scale.max(now.kinetic).max(now.elastic).max((now.weight - start.weight).abs());
        let gain = now.total() - start.total();
        assert!(gain <= 1e-6 * scale, "step {number}: {gain:.1e} of {scale:.1e} J gained by {curve:?}");
    }
}

/// Three bytes per number: ± 0.00 to 2.55 times a power of ten from 1e-15 to 1e15; exponent 31 encodes 0.
fn decades(bytes: &[u8]) -> Vec<f64> {
    let number = |bytes: &[u8]| {
        let exponent = i32::from(bytes[0] & 31) - 15;
        let size = (f64::from(bytes[1]) + f64::from(bytes[2]) / 256.0) / 100.0;
        let sign = if bytes[0] & 0xE0 == 0xE0 { -1.0 } else { 1.0 };
        if exponent == 16 { 0.0 } else { sign * size * 10f64.powi(exponent) }
    };
    bytes.chunks_exact(3).map(number).collect()
}

/// Eight bytes per number, unchanged, including NaN, infinities and subnormal numbers.
fn doubles(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks().0.iter().map(|&bytes| f64::from_le_bytes(bytes)).collect()
}
