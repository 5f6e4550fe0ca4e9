//! Clips that move far from one frame to the next.
//!
//! ```text
//!   ▐▔▔▔▔▌ → → →      a strip's clip jumps by 50 %      goal    one call, as many steps as needed
//!   ▐▔▔╲  ↻           a clamp turns by 120°             passes  the energy of 20 fixed steps, to 1e-8
//! ```

use cloth_sim::curve::StiffnessCurve;
use cloth_sim::equilibrium::{Equilibrium, Settings, Solver, Status, Tolerance};
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::Diagonals;
use cloth_sim::samples::{self, GRAVITY, SIDE, Sample};
use nalgebra::{Rotation3, Vector3};

/// Position of a rest point of the last clip after a share of the motion.
type Way<'a> = &'a dyn Fn(f64, Vector3<f64>) -> Vector3<f64>;

/// A state in which the last clip has moved by a share of the motion.
fn moved(sample: &Sample, x: &[f64], way: Way<'_>, share: f64) -> Vec<f64> {
    let mut x = x.to_vec();
    let last = sample.held.iter().filter_map(|held| held.clip).max();
    for node in sample.held.iter().filter(|held| held.clip == last).map(|held| held.node) {
        let rest = sample.mesh.positions[node];
        x[3 * node..3 * node + 3].copy_from_slice(way(share, rest).as_slice());
    }
    x
}

/// Moves the last clip in one call and in twenty solves; returns the outcome of the call.
fn compare(sample: &Sample, way: Way<'_>) -> Equilibrium {
    let settings = Settings { tolerance: Tolerance::Relative(1e-9), ..Settings::default() };
    let cloth = sample.cloth().expect("the sample is valid");
    let mut solver = Solver::new(&cloth);
    let mut y = sample.start.clone();
    let mut reference = solver.solve(&sample.curves, &mut y, &settings);
    let mut x = y.clone();
    let mut factorisations = 0;
    for step in 1..=20 {
        y = moved(sample, &y, way, f64::from(step) / 20.0);
        reference = solver.solve(&sample.curves, &mut y, &settings);
        assert!(reference.converged(), "{reference:?}");
        factorisations += reference.factorisations;
    }
    let target = moved(sample, &x, way, 1.0);
    let found = solver.load_steps(&sample.curves, &mut x, &target, &settings);
    assert!(found.converged() && !found.escaped, "{found:?}");
    assert!((found.energy / reference.energy - 1.0).abs() < 1e-8, "{found:?} {reference:?}");
    assert!(found.factorisations < factorisations, "{found:?} {factorisations}");
    for node in sample.held.iter().map(|held| 3 * held.node) {
        assert_eq!(x[node..node + 3], target[node..node + 3]);
    }
    // Gradient and factor belong to the returned state.
    let gradient = solver.gradient().to_vec();
    let again = solver.solve(&sample.curves, &mut x, &settings);
    assert_eq!((again.iterations, &gradient[..]), (0, solver.gradient()), "{again:?}");
    found
}

#[test]
fn a_clip_jumps_by_half_the_length() {
    let way: Way<'_> = &|share, p| Vector3::new((1.0 + 0.5 * share) * p.x, p.y + 0.1 * share * SIDE, 0.0);
    for model in Model::ALL {
        let (mut sample, _) = samples::strip(model, Diagonals::Forward, 300.0, 1.0).unwrap();
        for component in [Component::StretchWeft, Component::StretchWarp, Component::Shear] {
            let negative = model.negative_strain(component, Default::default());
            let stiffnesses = vec![100.0, 300.0, 900.0];
            let curve = StiffnessCurve::new(vec![0.0, 0.05, 0.2], stiffnesses, negative).unwrap();
            sample.curves.set(component, curve);
        }
        let planar = compare(&sample, way);
        sample.planar = false;
        sample.curves = samples::fabric(model, [300.0, 30.0, 1e-6]).unwrap();
        sample.gravity = Vector3::new(0.0, 0.0, -GRAVITY);
        let sagging = compare(&sample, way);
        let counts = [planar, sagging].map(|found| found.factorisations);
        println!("{model}: {counts:?} factorisations in the plane and in space");
        assert!(counts[0] <= 8 && counts[1] <= 20, "{model}: {counts:?}");
    }
}

/// A horizontal clamp turns down and back up, a hanging sheet about the vertical. In planar problems the whole turn in
/// one step flips triangles, so it takes several.
#[test]
fn a_clamp_turns_by_120_degrees() {
    let middle = Vector3::new(0.5 * SIDE, SIDE, 0.0);
    let turn = |axis: Vector3<f64>, share: f64| Rotation3::new(axis * (share * 120f64.to_radians()));
    for model in Model::ALL {
        let clamp = samples::cantilever(model, 13, 500.0).unwrap();
        let clamped =
            [1.0, -1.0].map(|sign| compare(&clamp, &|share, p| turn(Vector3::y(), sign * share) * p));
        let about = |axis| move |share, p| middle + turn(axis, share) * (p - middle);
        let mut sheet = samples::hanging_sheet(model, 13).unwrap();
        let hanging = compare(&sheet, &about(Vector3::y()));
        sheet.planar = true;
        let components = [Component::StretchWeft, Component::StretchWarp, Component::Shear];
        sheet.curves = samples::linear_curves(model, &components.map(|c| (c, 300.0))).unwrap();
        let planar = compare(&sheet, &about(Vector3::z()));
        let counts = [clamped[0], clamped[1], hanging, planar].map(|found| found.factorisations);
        println!("{model}: {counts:?} factorisations");
    }
}

#[test]
fn nowhere_to_go_is_a_solve() {
    let sample = samples::cantilever(Model::STVK, 9, 500.0).unwrap();
    let cloth = sample.cloth().unwrap();
    let mut solver = Solver::new(&cloth);
    let mut x = sample.start.clone();
    let target = x.clone();
    let found = solver.load_steps(&sample.curves, &mut x, &target, &Settings::default());
    assert!(found.converged(), "{found:?}");
    let before = x.clone();
    let again = solver.load_steps(&sample.curves, &mut x, &target, &Settings::default());
    assert_eq!((again.status, again.iterations, x), (Status::Converged, 0, before));
}

#[test]
fn what_cannot_be_reached_leaves_the_last_balance() {
    let (sample, _) = samples::strip(Model::STVK, Diagonals::Forward, 300.0, 1.05).unwrap();
    let cloth = sample.cloth().unwrap();
    let mut solver = Solver::new(&cloth);
    let mut x = sample.start.clone();
    let before = solver.solve(&sample.curves, &mut x, &Settings::default());
    let start = x.clone();
    let [not_a_number, infinite] =
        [f64::NAN, f64::INFINITY].map(|bad| moved(&sample, &x, &|_, _| Vector3::from_element(bad), 1.0));
    let far = moved(&sample, &x, &|_, p| 2.0 * p, 1.0);
    let never = Settings { max_iterations: 0, ..Settings::default() };
    for (target, settings, status) in [
        (not_a_number, Settings::default(), Status::NotFinite),
        (infinite, Settings::default(), Status::NotFinite),
        (far, never, Status::IterationLimit),
    ] {
        let found = solver.load_steps(&sample.curves, &mut x, &target, &settings);
        assert_eq!((found.status, &x), (status, &start), "{found:?}");
        assert!((found.energy / before.energy - 1.0).abs() < 1e-12 && found.imbalance <= found.tolerance);
    }
}
