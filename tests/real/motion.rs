//! Motion compared with closed forms.
//!
//! ```text
//!  goal    time integration and masses agree with closed forms
//!  data    analytic/: period of a pendulum, modes of a hanging chain (Bessel's zeros) and of a cantilever
//!  passes  pendulum: Runge–Kutta at a thousandth of the small period 1e-6, implicit Euler of first order;
//!          modes: frequency within 1 % at 60 cells
//!
//!   ▬▬▬      ┬        ▒▒▬▬▬▬▬
//!    ╲       │)
//!     ●      │(
//! ```

use cloth_sim::cloth::Cloth;
use cloth_sim::dynamics::{Damping, stable_step};
use cloth_sim::dynamics::{Integrator, Motion, Settings, Status};
use cloth_sim::equilibrium::{self, Solver};
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::Mesh;
use cloth_sim::samples::{self, Sample};
use fit_cloth_tests::rows;
use fit_cloth_tests::strip::{beam, rolled, strip};
use nalgebra::{Vector2, Vector3};
use std::f64::consts::TAU;

const GRAVITY: f64 = 9.8;

/// Number of half periods over which a frequency is measured.
const SWINGS: u32 = 10;

fn numbers(name: &str) -> Vec<Vec<f64>> {
    let number = |field: &String| field.parse().expect("numbers, as its README describes");
    rows(name).iter().map(|row| row.iter().map(number).collect()).collect()
}

/// Next zero crossing of a quantity, from the cubic through values and slopes at both ends, s.
fn crossing(motion: &mut Motion<'_>, step: f64, value: impl Fn(&[f64]) -> f64) -> f64 {
    let sample = |motion: &Motion<'_>| [value(motion.positions()), value(motion.velocities())];
    let mut before = sample(motion);
    loop {
        let time = motion.time();
        assert_eq!(motion.step().status, Status::Done);
        let now = sample(motion);
        if before[0] * now[0] < 0.0 {
            let cubic = |t: f64| {
                let (u, s) = (1.0 - t, t);
                u * u * (1.0 + 2.0 * s) * before[0]
                    + s * s * (1.0 + 2.0 * u) * now[0]
                    + step * (s * u * u * before[1] - s * s * u * now[1])
            };
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if cubic(middle) * before[0] > 0.0 { low = middle } else { high = middle }
            }
            return time + step * low;
        }
        before = now;
    }
}

/// Period of a pendulum relative to that of small swings: a triangle with its base on the axis and a stiffness of
/// `stiffness` times its weight.
fn pendulum(amplitude: f64, stiffness: f64, integrator: Integrator, steps: f64) -> f64 {
    let material = [[0.0, -0.5], [1.0, 0.0], [0.0, 0.5]].map(|[x, y]| Vector2::new(x, y));
    let positions = material.iter().map(|m| m.push(0.0)).collect();
    let mesh = Mesh::new(positions, material.to_vec(), vec![[0, 1, 2]]).unwrap();
    // Mass ρA/3 at the tip, stiffness A k/L², with A = ½.
    let weight = samples::AREAL_DENSITY * 0.5 / 3.0 * GRAVITY;
    let curves = samples::linear_curves(
        Model::SOFT_CONSTRAINT,
        &[(Component::StretchWeft, 2.0 * stiffness * weight), (Component::Shear, weight)],
    );
    let mut sample = Sample::at_rest(mesh, Model::SOFT_CONSTRAINT, curves.unwrap());
    sample.gravity = Vector3::new(0.0, 0.0, -GRAVITY);
    sample.hold(|p| (p.x == 0.0).then_some(0));
    let length = 1.0 + amplitude.cos() / stiffness;
    sample.place(|p| Vector3::new(length * p.x * amplitude.sin(), p.y, -length * p.x * amplitude.cos()));
    let cloth = sample.cloth().unwrap();
    let small = TAU / GRAVITY.sqrt();
    let step = small / steps;
    let settings = Settings { step, integrator, ..Settings::default() };
    let mut motion = Motion::new(&cloth, &sample.curves, sample.start.clone(), &settings).unwrap();
    4.0 * crossing(&mut motion, step, |x| x[3]) / small
}

#[test]
fn a_pendulum_has_its_period() {
    let implicit = Settings::default().integrator;
    let mut worst = 0.0f64;
    for row in numbers("analytic/pendulum_period.csv") {
        let [degrees, expected] = row[..] else { panic!("{row:?}") };
        let period =
            |stiffness, integrator, steps| pendulum(degrees.to_radians(), stiffness, integrator, steps);
        // The stretch of the arm changes the period by powers of 1/stiffness; two of them are eliminated.
        let stiffnesses = [1e3, 2e3, 4e3];
        let [soft, middle, stiff] =
            stiffnesses.map(|stiffness| period(stiffness, Integrator::RungeKutta, 1000.0));
        let off = (8.0 * stiff - 6.0 * middle + soft) / 3.0 / expected - 1.0;
        worst = worst.max(off.abs());
        let [coarse, fine] = [1000.0, 2000.0].map(|steps| period(4e3, implicit, steps) - stiff);
        // Energy loss shortens the period to first order; small swings hardly depend on it and are accurate to second
        // order.
        let fall = (coarse / fine).abs();
        println!(
            "pendulum, {degrees}°: {off:.1e} by Runge–Kutta, implicit Euler × {fall:.2} with half the step"
        );
        assert!(off.abs() < 1e-6, "{degrees}°: {off:e}");
        assert!(fall > 1.8 && (degrees < 45.0 || fall < 2.2), "{degrees}°: {fall}");
    }
    println!("pendulum: within {worst:.1e}");
}

/// Angular frequency of a mode excited across the plane of a cloth, 1/s.
fn frequency(cloth: &Cloth, sample: &Sample, mode: impl Fn(Vector2<f64>) -> f64) -> f64 {
    let shape: Vec<f64> = sample.mesh.positions.iter().map(|p| mode(p.xy())).collect();
    let velocities = shape.iter().flat_map(|d| [0.0, 0.0, 1e-4 * d]).collect();
    let step = 0.9 * stable_step(cloth, &sample.curves, &sample.start, &Damping::default());
    let settings = Settings { step, integrator: Integrator::RungeKutta, ..Settings::default() };
    let mut motion =
        Motion::with_velocities(cloth, &sample.curves, sample.start.clone(), velocities, &settings).unwrap();
    let along = |x: &[f64]| -> f64 {
        let terms = x.chunks_exact(3).zip(&shape).zip(cloth.masses());
        terms.map(|((x, d), mass)| mass * d * x[2]).sum()
    };
    // The first step leaves zero, where the motion starts. Other excited modes average out over several swings.
    assert_eq!(motion.step().status, Status::Done);
    let first = crossing(&mut motion, step, along);
    let last = (0..SWINGS).fold(first, |_, _| crossing(&mut motion, step, along));
    0.5 * TAU * f64::from(SWINGS) / (last - first)
}

/// J₀ by its series, accurate to 1e-10 up to 12.
fn bessel(x: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..60 {
        term *= -0.25 * x * x / f64::from(k * k);
        sum += term;
    }
    sum
}

#[test]
fn a_hanging_chain_has_its_modes() {
    // Waves are slow and short near the free end: cells shorten towards it.
    let columns: Vec<f64> = (0..=60).map(|i| 1.0 - (1.0 - f64::from(i) / 60.0).powf(1.5)).collect();
    let weight = samples::AREAL_DENSITY * GRAVITY;
    let curves = samples::fabric(Model::STVK, [1e3 * weight, 1e2 * weight, 0.0]).unwrap();
    let curves = [Component::StretchWeft, Component::StretchWarp, Component::Shear]
        .into_iter()
        .filter_map(|component| Some((component, curves.get(component)?.clone())))
        .collect();
    let mut sample = Sample::at_rest(strip(&columns, 0.05, 2), Model::STVK, curves);
    sample.gravity = Vector3::new(GRAVITY, 0.0, 0.0);
    sample.hold(|p| (p.x == 0.0).then_some(0));
    let cloth = sample.cloth().unwrap();
    let found =
        Solver::new(&cloth).solve(&sample.curves, &mut sample.start, &equilibrium::Settings::default());
    assert!(found.converged(), "{found:?}");
    for row in numbers("analytic/hanging_chain_modes.csv") {
        let [mode, expected] = row[..] else { panic!("{row:?}") };
        let found = frequency(&cloth, &sample, |p| bessel(2.0 * expected * (1.0 - p.x).max(0.0).sqrt()));
        let off = found / GRAVITY.sqrt() / expected - 1.0;
        println!("hanging chain, mode {mode}: {:+.3} %", 100.0 * off);
        assert!(off.abs() < 0.01, "mode {mode}: {off}");
    }
}

#[test]
fn a_cantilever_has_its_modes() {
    // D = 1e-5 N·m by hinges of a third of it.
    let curves = samples::fabric(Model::STVK, [1.0, 0.5, 1e-5 / 3.0]).unwrap();
    let mut sample = Sample::at_rest(strip(&beam(0.1, 60), 0.01, 3), Model::STVK, curves);
    sample.hold(|p| (p.x <= 0.0).then_some(0));
    let cloth = rolled(&sample, 3);
    for row in numbers("analytic/cantilever_vibration_modes.csv") {
        let [mode, beta, expected] = row[..] else { panic!("{row:?}") };
        let ratio = (beta.cosh() + beta.cos()) / (beta.sinh() + beta.sin());
        let shape = |p: Vector2<f64>| {
            let s = beta * p.x.max(0.0) / 0.1;
            s.cosh() - s.cos() - ratio * (s.sinh() - s.sin())
        };
        let unit = (1e-5f64 / (samples::AREAL_DENSITY * 1e-4)).sqrt();
        let off = frequency(&cloth, &sample, shape) / unit / expected - 1.0;
        println!("cantilever, mode {mode}: {:+.3} %", 100.0 * off);
        assert!(off.abs() < 0.01, "mode {mode}: {off}");
    }
}
