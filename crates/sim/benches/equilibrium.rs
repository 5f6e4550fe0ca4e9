//! Cost of an equilibrium, part by part: `cargo bench -p cloth-sim`.
//!
//! Times are the fastest of several runs, in ms on one core; on a shared machine a median mostly measures other
//! processes. Compare machines by the number of factorisations.
#![allow(clippy::print_stdout)]

use cloth_sim::cloth::{Cloth, ForceScale};
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::element::HessianKind;
use cloth_sim::equilibrium::{Settings, Solver};
use cloth_sim::error::Result;
use cloth_sim::material::{Component, Curves, Model};
use cloth_sim::mesh::Diagonals;
use cloth_sim::samples::{self, SIDE, Sample};
use nalgebra::Vector3;
use std::time::Instant;

fn main() -> Result<()> {
    println!(
        "{:<18}{:>6}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>8}",
        "parts, ms", "nodes", "unknowns", "gradient", "Hessian", "factor", "solve 1", "solve 8", "H/F"
    );
    for nodes in [25, 51, 101] {
        parts("stretch, planar", nodes, &stretch_test(nodes, 0.03)?)?;
        parts("all, 3-D", nodes, &samples::picture_frame(Model::STVK, nodes, 0.2)?)?;
    }
    println!(
        "\n{:<18}{:>10}{:>12}{:>16}{:>8}{:>10}",
        "frames, 25 nodes", "start", "iterations", "factorisations", "most", "ms"
    );
    let pulls = (0..30).map(|i| 0.01 + 0.05 * f64::from(i) / 29.0);
    let stretch: Result<Vec<_>> = pulls.map(|pull| stretch_test(25, pull)).collect();
    equilibria("stretch", &stretch?, Component::StretchWeft)?;
    let cantilever: Result<Vec<_>> = [0.03, 0.1, 0.2]
        .into_iter()
        .map(|areal_density| Ok(Sample { areal_density, ..samples::cantilever(Model::STVK, 25, 500.0)? }))
        .collect();
    equilibria("cantilever", &cantilever?, Component::BendWeft)?;
    let shear: Result<Vec<_>> =
        [0.05, 0.1, 0.2].into_iter().map(|angle| samples::picture_frame(Model::STVK, 25, angle)).collect();
    equilibria("picture frame", &shear?, Component::Shear)
}

/// A sheet between two bars, one of which is pulled, rotated by a tenth of the strain, and shortened by half of it.
fn stretch_test(nodes: usize, pull: f64) -> Result<Sample> {
    let mesh = samples::square(nodes, Diagonals::Alternating)?;
    let curve = |component| {
        let negative = Model::STVK.negative_strain(component, Default::default());
        Ok((component, StiffnessCurve::new(vec![0.0, 0.03, 0.08], vec![200.0, 400.0, 600.0], negative)?))
    };
    let curves = [Component::StretchWeft, Component::StretchWarp].into_iter().map(curve);
    let mut sample = Sample::at_rest(mesh, Model::STVK, curves.collect::<Result<Curves>>()?);
    sample.planar = true;
    sample.hold(|p| if p.x == 0.0 { Some(0) } else { (p.x > 0.999 * SIDE).then_some(1) });
    sample.place(|p| {
        let (s, y) = (p.x / SIDE, p.y - 0.5 * SIDE);
        let (sin, cos) = (0.1 * pull * s).sin_cos();
        let y = y * (1.0 - 0.5 * pull * s);
        Vector3::new(p.x + s * (pull * SIDE) - sin * y, 0.5 * SIDE + cos * y, 0.0)
    });
    Ok(sample)
}

fn mean(times: &[f64]) -> f64 {
    times.iter().sum::<f64>() / times.len() as f64
}

/// Time of a task, ms: the fastest of several runs.
fn time(mut task: impl FnMut()) -> f64 {
    let once = |task: &mut dyn FnMut()| {
        let start = Instant::now();
        task();
        1e3 * start.elapsed().as_secs_f64()
    };
    let first = once(&mut task);
    let repeats = ((400.0 / first) as usize).clamp(10, 1001);
    (0..repeats).map(|_| once(&mut task)).fold(first, f64::min)
}

fn parts(name: &str, nodes: usize, sample: &Sample) -> Result<()> {
    let cloth = sample.cloth()?;
    let mut x = sample.start.clone();
    let mut solver = Solver::new(&cloth);
    let found = solver.solve(&sample.curves, &mut x, &Settings::default());
    assert!(found.converged(), "{name}: {}", found.status);
    let mut gradient = vec![0.0; x.len()];
    let mut scale = ForceScale::new(cloth.points());
    let mut values = Vec::new();
    let gradient_time = time(|| {
        cloth.gradient(&sample.curves, &x, &mut gradient, &mut scale);
    });
    let hessian_time = time(|| cloth.hessian(&sample.curves, &x, HessianKind::Full, &mut values));
    // From an equilibrium, a solve takes one gradient, one Hessian and one factorisation.
    let solve_time = time(|| {
        let again = solver.solve(&sample.curves, &mut x, &Settings::default());
        assert_eq!(again.factorisations, 1);
    });
    let factor_time = solve_time - gradient_time - hessian_time;
    let [one, eight] = [1, 8].map(|sides| {
        let mut columns = vec![1.0; sides * cloth.unknowns()];
        time(|| solver.solve_linear(&mut columns))
    });
    println!(
        "{name:<18}{nodes:>6}{:>10}{gradient_time:>10.3}{hessian_time:>10.3}{factor_time:>10.3}{one:>10.3}{eight:>10.3}{:>8.2}",
        cloth.unknowns(),
        hessian_time / factor_time
    );
    Ok(())
}

/// Equilibria of several frames from four starts.
///
/// * `off` — component with the wrong stiffness
fn equilibria(name: &str, frames: &[Sample], off: Component) -> Result<()> {
    let softer = |sample: &Sample, factor: f64| -> Result<Curves> {
        let mut curves = sample.curves.clone();
        if let Some(curve) = sample.curves.get(off) {
            curves
                .set(off, curve.with_stiffnesses(curve.stiffnesses().iter().map(|k| factor * k).collect())?);
        }
        Ok(curves)
    };
    for start in [Start::Cold, Start::Measured, Start::Warm, Start::Predicted] {
        let (mut counts, mut times) = (Vec::new(), Vec::new());
        for sample in frames {
            let cloth = sample.cloth()?;
            let mut solver = Solver::new(&cloth);
            let mut x = sample.start.clone();
            if start != Start::Cold {
                let factor = if start == Start::Measured { 1.0 / 1.5 } else { 0.9 };
                let before = softer(sample, factor)?;
                let found = solver.solve(&before, &mut x, &Settings::default());
                assert!(found.converged(), "{name}: {}", found.status);
                if start == Start::Predicted {
                    predict(&cloth, &mut solver, &before, &sample.curves, off, &mut x);
                }
            }
            let mut found = Vec::new();
            let elapsed = time(|| {
                let mut x = x.clone();
                let equilibrium = solver.solve(&sample.curves, &mut x, &Settings::default());
                assert!(equilibrium.converged(), "{name}: {}", equilibrium.status);
                found = vec![equilibrium.iterations, equilibrium.factorisations];
            });
            counts.push(found);
            times.push(elapsed);
        }
        let [iterations, factorisations] = [0, 1]
            .map(|which| counts.iter().map(|found| found[which]).sum::<usize>() as f64 / frames.len() as f64);
        let most = counts.iter().map(|found| found[1]).max().unwrap_or(0);
        println!(
            "{name:<18}{:>10}{iterations:>12.1}{factorisations:>16.1}{most:>8}{:>10.2}",
            format!("{start:?}"),
            mean(&times)
        );
    }
    Ok(())
}

/// Start of a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Start {
    /// The interpolated or flat shape.
    Cold,
    /// The equilibrium for a stiffness 1.5 times too small.
    Measured,
    /// The equilibrium for a stiffness 10 % too small.
    Warm,
    /// The previous start, moved by the predicted displacement.
    Predicted,
}

/// x − K⁻¹ ∂g/∂k Δk.
fn predict(
    cloth: &Cloth,
    solver: &mut Solver<'_>,
    before: &Curves,
    after: &Curves,
    component: Component,
    x: &mut [f64],
) {
    let (Some(old), Some(new)) = (before.get(component), after.get(component)) else { return };
    let mut columns = Vec::new();
    cloth.parameter_gradient(before, component, x, &mut columns);
    let changes = new.stiffnesses().iter().zip(old.stiffnesses()).map(|(new, old)| new - old);
    let mut step = vec![0.0; cloth.unknowns()];
    for (change, column) in changes.zip(columns.chunks_exact(x.len())) {
        for (step, &coordinate) in step.iter_mut().zip(cloth.unknown_coordinates()) {
            *step -= change * column[coordinate];
        }
    }
    solver.solve_linear(&mut step);
    for (step, &coordinate) in step.iter().zip(cloth.unknown_coordinates()) {
        x[coordinate] += step;
    }
}
