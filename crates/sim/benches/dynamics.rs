//! Cost of a time step: `cargo bench -p cloth-sim --bench dynamics`.
//!
//! A square of 0.1 m falls from horizontal, held at two corners, without damping. Rates cover the same first part of
//! the motion for all solvers; Runge–Kutta runs at 0.9 of its stable step.
#![allow(clippy::print_stdout)]

use cloth_sim::dynamics::{Damping, Integrator, LinearSolver, Motion, Newton, Settings, stable_step};
use cloth_sim::error::Result;
use cloth_sim::material::Model;
use cloth_sim::mesh::Diagonals;
use cloth_sim::samples::{self, GRAVITY, SIDE, Sample};
use nalgebra::Vector3;
use std::time::Instant;

/// Implicit Euler steps, 10 ms each.
const STEPS: usize = 20;

fn hung(nodes: usize) -> Result<Sample> {
    let curves = samples::fabric(Model::STVK, [500.0, 50.0, 1e-6])?;
    let mut sample = Sample::at_rest(samples::square(nodes, Diagonals::Alternating)?, Model::STVK, curves);
    sample.gravity = Vector3::new(0.0, 0.0, -GRAVITY);
    sample.hold(|p| (p.y > 0.999 * SIDE && (p.x == 0.0 || p.x > 0.999 * SIDE)).then_some(0));
    sample.perturb(1e-6);
    Ok(sample)
}

struct Run {
    positions: Vec<f64>,
    seconds: f64,
    newton: usize,
    linear: usize,
}

fn run(sample: &Sample, settings: &Settings, steps: usize) -> Result<Run> {
    let cloth = sample.cloth()?;
    let mut motion = Motion::new(&cloth, &sample.curves, sample.start.clone(), settings)?;
    let (mut newton, mut linear) = (0, 0);
    let start = Instant::now();
    for _ in 0..steps {
        let step = motion.step();
        newton += step.newton_iterations;
        linear += step.linear_iterations;
    }
    let seconds = start.elapsed().as_secs_f64();
    Ok(Run { positions: motion.positions().to_vec(), seconds, newton, linear })
}

fn main() -> Result<()> {
    let published = LinearSolver::ConjugateGradient { tolerance: 1e-5, max_iterations: 10_000 };
    let converged = |linear| Integrator::ImplicitEuler { newton: Newton::default(), linear };
    let single = |linear| Integrator::ImplicitEuler { newton: Newton::Single, linear };
    println!(
        "{:<8}{:<44}{:>10}{:>12}{:>12}{:>14}",
        "nodes", "integrator", "steps/s", "Newton/step", "CG/system", "from first, m"
    );
    for nodes in [25, 51, 101] {
        let sample = hung(nodes)?;
        let mut first: Option<Vec<f64>> = None;
        for (name, integrator) in [
            ("implicit, converged, direct", converged(LinearSolver::Direct)),
            ("implicit, converged, conjugate gradients", converged(published)),
            ("implicit, one linearisation, direct", single(LinearSolver::Direct)),
            ("implicit, one linearisation, conj. gradients", single(published)),
        ] {
            let found = run(&sample, &Settings { integrator, ..Settings::default() }, STEPS)?;
            let reference = first.get_or_insert_with(|| found.positions.clone());
            let apart =
                reference.iter().zip(&found.positions).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            println!(
                "{nodes:<8}{name:<44}{:>10.1}{:>12.2}{:>12.0}{apart:>14.1e}",
                STEPS as f64 / found.seconds,
                found.newton as f64 / STEPS as f64,
                found.linear as f64 / found.newton as f64,
            );
        }
        let cloth = sample.cloth()?;
        let step = 0.9 * stable_step(&cloth, &sample.curves, &sample.start, &Damping::default());
        let settings = Settings { step, integrator: Integrator::RungeKutta, ..Settings::default() };
        let steps = 500;
        let found = run(&sample, &settings, steps)?;
        let name = format!("Runge–Kutta, steps of {step:.1e} s");
        println!("{nodes:<8}{name:<44}{:>10.1}", steps as f64 / found.seconds);
        let exact = |linear| Settings {
            integrator: Integrator::ImplicitEuler { newton: Newton::Converged { tolerance: 1e-10 }, linear },
            ..Settings::default()
        };
        let gradients = LinearSolver::ConjugateGradient { tolerance: 1e-12, max_iterations: 100_000 };
        let [a, b] = [run(&sample, &exact(LinearSolver::Direct), 5)?, run(&sample, &exact(gradients), 5)?];
        let apart = a.positions.iter().zip(&b.positions).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        println!("{nodes:<8}{:<44}{:>48.1e}", "direct and conjugate gradients, both to 1e-10", apart);
    }
    Ok(())
}
