//! Numerical interventions of a solve are counted.
//!
//! ```text
//!  strip pulled      nothing              picture frame, cold    matrices clamped and damped
//!  sheet pressed     unstable balances    clip out of reach      load steps halved
//!  no stiffness      Levenberg–Marquardt  pressed, in motion     a linearised step clamped
//! ```

#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use cloth_sim::curve::StiffnessCurve;
use cloth_sim::dynamics::{self, Integrator, LinearSolver, Motion, Newton};
use cloth_sim::equilibrium::{Equilibrium, Remedies, Settings, Solver, Status};
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::Diagonals;
use cloth_sim::samples::{self, SIDE, Sample};
use nalgebra::{Matrix3x2, Vector3};

fn solve(sample: &Sample, settings: &Settings) -> Equilibrium {
    let cloth = sample.cloth().unwrap();
    Solver::new(&cloth).solve(&sample.curves, &mut sample.start.clone(), settings)
}

/// Compressed along weft, flat and balanced.
fn pressed(model: Model) -> Sample {
    let map = Matrix3x2::new(0.98, 0.0, 0.0, 1.0, 0.0, 0.0);
    let mut sample = samples::patch(model, map).unwrap();
    sample.curves = samples::fabric(model, [300.0, 30.0, 1e-7]).unwrap();
    sample
}

#[test]
fn a_strip_needs_none() {
    for model in Model::ALL {
        let (mut sample, _) = samples::strip(model, Diagonals::Forward, 300.0, 1.05).unwrap();
        sample.perturb(1e-5);
        let found = solve(&sample, &Settings::default());
        assert!(found.converged() && found.iterations > 0 && found.remedies.none(), "{found:?}");
    }
}

#[test]
fn an_unstable_balance_that_is_left_counts() {
    for model in [Model::STVK, Model::SOFT_CONSTRAINT] {
        let left = solve(&pressed(model), &Settings::default());
        assert!(left.converged() && left.escaped && left.remedies.escapes > 0, "{left:?}");
        let stays = solve(&pressed(model), &Settings { escape: false, ..Settings::default() });
        assert_eq!((stays.status, stays.remedies), (Status::Unstable, Remedies::default()));
    }
}

#[test]
fn matrices_that_are_not_positive_definite_count() {
    for model in [Model::STVK, Model::SOFT_CONSTRAINT] {
        let found = solve(&samples::picture_frame(model, 13, 0.2).unwrap(), &Settings::default());
        assert!(found.converged() && found.remedies.clamped > 0 && found.remedies.damped > 0, "{found:?}");
    }
}

#[test]
fn a_solve_that_newton_cannot_finish_counts() {
    let mut sample = samples::cantilever(Model::STVK, 6, 500.0).unwrap();
    sample.curves = samples::fabric(Model::STVK, [0.0; 3]).unwrap();
    let falling = solve(&sample, &Settings::default());
    assert!(!falling.converged() && falling.remedies.levenberg_marquardt > 0, "{falling:?}");
    // Another membrane does not help a cloth without stiffness either.
    assert_eq!(falling.remedies.continued, 1);
}

/// 1, ½, ¼ … 1/256 of the motion: nine steps that are too long.
#[test]
fn load_steps_that_are_halved_count() {
    let (sample, _) = samples::strip(Model::STVK, Diagonals::Forward, 300.0, 1.0).unwrap();
    let cloth = sample.cloth().unwrap();
    let mut target = sample.start.clone();
    target.iter_mut().for_each(|x| *x *= 2.0);
    let never = Settings { max_iterations: 0, ..Settings::default() };
    let mut solver = Solver::new(&cloth);
    let mut x = sample.start.clone();
    let stuck = solver.load_steps(&sample.curves, &mut x, &target, &never);
    assert_eq!((stuck.status, stuck.remedies.halved), (Status::IterationLimit, 9));
    let reached = solver.load_steps(&sample.curves, &mut x, &target, &Settings::default());
    assert!(reached.converged() && reached.remedies.halved == 0, "{reached:?}");
}

#[test]
fn a_linearised_step_that_is_clamped_counts() {
    let sample = pressed(Model::STVK);
    let cloth = sample.cloth().unwrap();
    let clamped = |step| {
        let integrator = Integrator::ImplicitEuler { newton: Newton::Single, linear: LinearSolver::Direct };
        let settings = dynamics::Settings { step, integrator, ..dynamics::Settings::default() };
        let mut motion = Motion::new(&cloth, &sample.curves, sample.start.clone(), &settings).unwrap();
        motion.step().remedies.clamped
    };
    // The mass term of a short step outweighs the compression.
    assert_eq!((clamped(1.0), clamped(1e-6)), (1, 0));
}

/// A strip whose curves end at 5 %, held everywhere at uniform stretch.
#[test]
fn what_is_strained_beyond_a_curve_is_told() {
    for model in Model::ALL {
        let (mut sample, _) = samples::strip(model, Diagonals::Forward, 300.0, 1.0).unwrap();
        let weft = Component::StretchWeft;
        let cloth = sample.cloth().unwrap();
        let stretched = |stretch: f64| -> Vec<f64> {
            let place = |node: &[f64]| Vector3::new(stretch * node[0], node[1], node[2]);
            sample.start.chunks_exact(3).flat_map(|node| <[f64; 3]>::from(place(node))).collect()
        };
        let mut half = stretched(1.1);
        half.chunks_exact_mut(3).for_each(|node| node[0] = node[0].min(0.55 * SIDE + 1e-9));
        let [slightly, far] = [1.02, 1.1].map(stretched);
        // A constant stiffness has no end.
        assert_eq!(cloth.extrapolated(&sample.curves, weft, &far), 0.0);
        let negative = model.negative_strain(weft, Default::default());
        let curve = StiffnessCurve::new(vec![0.0, 0.05], vec![300.0, 400.0], negative).unwrap();
        sample.curves.set(weft, curve);
        let shares = [&slightly, &far, &half].map(|x| cloth.extrapolated(&sample.curves, weft, x));
        assert!(shares[0] == 0.0 && (shares[1] - 1.0).abs() < 1e-12, "{model}: {shares:?}");
        assert!((shares[2] - 0.5).abs() < 1e-12, "{model}: {shares:?}");
        assert_eq!(cloth.extrapolated(&sample.curves, Component::StretchWarp, &far), 0.0);
    }
}
