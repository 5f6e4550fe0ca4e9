//! Equilibria: ordinary, extreme and impossible ones.
//!
//! ```text
//!  ▐▔▔╲    hanging, jutting out, compressed,    goal    converged, or a status with the reason; no panic
//!      ╲   collapsed, sheared, unheld sheets    passes  see each test
//! ```

use cloth_sim::cloth::Cloth;
use cloth_sim::element::HessianKind;
use cloth_sim::equilibrium::{Equilibrium, Method, Settings, Solver, Status, Tolerance};
use cloth_sim::error::{Error, Part};
use cloth_sim::material::{Component, Curves, Model};
use cloth_sim::membrane::Membrane;
use cloth_sim::mesh::{Diagonals, Mesh};
use cloth_sim::samples::{self, SIDE, Sample};
use nalgebra::{DMatrix, DVector, Matrix3x2, Vector3};

fn solve(sample: &Sample, settings: &Settings) -> (Equilibrium, Vec<f64>) {
    let cloth = sample.cloth().expect("the sample is valid");
    let mut x = sample.start.clone();
    let found = Solver::new(&cloth).solve(&sample.curves, &mut x, settings);
    (found, x)
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |worst, (a, b)| worst.max((a - b).abs()))
}

#[test]
fn without_a_load_there_is_nothing_to_iterate() {
    for model in Model::ALL {
        let mut sample = samples::cantilever(model, 6, 500.0).unwrap();
        sample.gravity = Vector3::zeros();
        let (found, x) = solve(&sample, &Settings::default());
        assert_eq!((found.iterations, x), (0, sample.start), "{model}: {found:?}");
        // A flat sheet of ring-2 springs has no bending stiffness.
        let expected = if model == Model::SPRINGS { Status::Unstable } else { Status::Converged };
        assert_eq!(found.status, expected, "{model}");
    }
}

#[test]
fn a_clip_carries_the_weight() {
    for model in Model::ALL {
        for factor in [1.0, 1e4] {
            let mut sample = samples::hanging_sheet(model, 9).unwrap();
            sample.gravity *= factor;
            let cloth = sample.cloth().unwrap();
            let mut solver = Solver::new(&cloth);
            let mut x = sample.start.clone();
            let found = solver.solve(&sample.curves, &mut x, &Settings::default());
            assert!(found.converged(), "{model}: {found:?}");
            let force = solver.clip_forces()[0] + sample.weight();
            assert!(force.norm() < 1e-5 * sample.weight().norm(), "{model}: {force}");
        }
    }
}

/// A flat sheet, 3 % shorter between its clips than at rest.
fn compressed(model: Model) -> Sample {
    let curves = samples::fabric(model, [300.0, 30.0, 1e-6]).expect("the sample is valid");
    let mut sample = Sample::at_rest(
        samples::square(9, Diagonals::Alternating).expect("the sample is valid"),
        model,
        curves,
    );
    sample.hold(|p| if p.x == 0.0 { Some(0) } else { (p.x > 0.999 * SIDE).then_some(1) });
    sample.place(|p| Vector3::new(0.97 * p.x, p.y, p.z));
    sample
}

/// Largest distance from the plane z = 0.
fn height(x: &[f64]) -> f64 {
    x.iter().skip(2).step_by(3).fold(0.0, |highest, z| highest.max(z.abs()))
}

#[test]
fn a_flat_sheet_in_compression_is_unstable_and_buckles_when_touched() {
    for model in [Model::STVK, Model::SOFT_CONSTRAINT] {
        let mut sample = compressed(model);
        let (flat, _) = solve(&sample, &Settings { escape: false, ..Settings::default() });
        assert_eq!((flat.status, flat.iterations), (Status::Unstable, 0), "{model}: {flat:?}");
        sample.perturb(1e-5);
        let (buckled, x) = solve(&sample, &Settings::default());
        assert!(buckled.converged() && buckled.energy < 0.2 * flat.energy, "{model}: {buckled:?}");
        assert!(!buckled.escaped && height(&x) > 0.05 * SIDE, "{model}: {buckled:?}");
    }
}

/// Mirrored starts reach mirrored states; the state reached from flat is one of the two.
#[test]
fn a_flat_sheet_in_compression_has_two_branches() {
    let settings = Settings { tolerance: Tolerance::Relative(1e-9), ..Settings::default() };
    let mirror = |x: &mut [f64]| x.iter_mut().skip(2).step_by(3).for_each(|z| *z = -*z);
    for model in [Model::STVK, Model::SOFT_CONSTRAINT] {
        let sample = compressed(model);
        let (left, x) = solve(&sample, &settings);
        println!("{model}: {left:?}");
        let mut up = sample.clone();
        // Start towards the state found, so that all three have the same number of waves.
        up.start.iter_mut().zip(&x).for_each(|(start, x)| *start += 0.1 * (x - *start));
        let mut down = up.clone();
        mirror(&mut down.start);
        let ((upper, above), (lower, mut below)) = (solve(&up, &settings), solve(&down, &settings));
        mirror(&mut below);
        assert!(upper.converged() && lower.converged() && !upper.escaped, "{model}: {upper:?} {lower:?}");
        assert!((upper.energy / lower.energy - 1.0).abs() < 1e-12, "{model}: {upper:?} {lower:?}");
        assert!((upper.energy / left.energy - 1.0).abs() < 1e-8, "{model}: {upper:?} {left:?}");
        assert!(difference(&above, &below) < 1e-9 * SIDE, "{model}: {:e}", difference(&above, &below));
        assert!(difference(&above, &x) < 1e-6 * SIDE, "{model}: {:e}", difference(&above, &x));
    }
}

/// Flat, balanced and unstable; in planar problems, a chain of yarns in compression.
#[test]
fn what_is_unstable_is_left_and_flagged() {
    let frame =
        |model| Sample { start: flat_frame(model), ..samples::picture_frame(model, 13, 0.2).unwrap() };
    let samples = Model::ALL
        .into_iter()
        .map(|model| (model, frame(model)))
        .chain([Model::STVK, Model::SOFT_CONSTRAINT].map(|model| (model, compressed(model))))
        .chain(Model::ALL.map(|model| (model, crushed(model))));
    for (model, sample) in samples {
        let (stays, _) = solve(&sample, &Settings { escape: false, ..Settings::default() });
        assert_eq!((stays.status, stays.escaped), (Status::Unstable, false), "{model}: {stays:?}");
        let cloth = sample.cloth().unwrap();
        let mut solver = Solver::new(&cloth);
        let mut x = sample.start.clone();
        let found = solver.solve(&sample.curves, &mut x, &Settings::default());
        println!(
            "{model}: {} → {} J, height {}; {} steps, {} factorisations",
            stays.energy,
            found.energy,
            height(&x),
            found.iterations,
            found.factorisations
        );
        assert!(found.converged() && found.escaped, "{model}: {found:?}");
        assert!(found.energy < 0.99 * stays.energy && found.iterations > stays.iterations);
        // Gradient and factor belong to the returned state.
        let (gradient, forces) = (solver.gradient().to_vec(), solver.clip_forces());
        let mut right: Vec<f64> = (0..cloth.unknowns()).map(|i| (i as f64).sin()).collect();
        let mut again = right.clone();
        solver.solve_linear(&mut right);
        let stable = solver.solve(&sample.curves, &mut x, &Settings::default());
        assert!(stable.converged() && !stable.escaped && stable.factorisations == 1, "{model}: {stable:?}");
        assert_eq!((gradient, forces), (solver.gradient().to_vec(), solver.clip_forces()));
        solver.solve_linear(&mut again);
        assert_eq!(right, again, "{model}");
    }
}

/// The picture frame's start without its perturbation.
fn flat_frame(model: Model) -> Vec<f64> {
    let mut sample = samples::picture_frame(model, 13, 0.2).expect("the sample is valid");
    sample.perturb(-1e-5);
    sample.start
}

/// Compressed along weft to a third in the plane, with so little shear stiffness that the yarns buckle in-plane.
fn crushed(model: Model) -> Sample {
    let mut sample =
        samples::patch(model, Matrix3x2::new(0.3, 0.0, 0.0, 1.0, 0.0, 0.0)).expect("the sample is valid");
    sample.curves = samples::linear_curves(
        model,
        &[(Component::StretchWeft, 300.0), (Component::StretchWarp, 300.0), (Component::Shear, 1.0)],
    )
    .expect("the sample is valid");
    sample.planar = true;
    sample
}

/// Compressed along weft to a tenth, held on all sides, in the plane. Shear and warp are stiff enough that the yarns do
/// not buckle.
#[test]
fn a_collapsed_sheet_converges_without_inversion() {
    for model in Model::ALL {
        let mut sample = samples::patch(model, Matrix3x2::new(0.1, 0.0, 0.0, 1.0, 0.0, 0.0)).unwrap();
        let weft = Component::StretchWeft;
        let warp = Component::StretchWarp;
        let stiffnesses = [(weft, 10.0), (warp, 1e4), (Component::Shear, 1000.0)];
        // Diagonal springs would buckle as well.
        let count = if model == Model::SPRINGS { 2 } else { 3 };
        sample.curves = samples::linear_curves(model, &stiffnesses[..count]).unwrap();
        sample.planar = true;
        let exact = sample.start.clone();
        sample.perturb(1e-5);
        let (found, x) = solve(&sample, &Settings::default());
        assert!(found.converged(), "{model}: {found:?}");
        assert!(difference(&x, &exact) < 1e-6, "{model}: {:e}", difference(&x, &exact));
        for triangle in &sample.mesh.triangles {
            let [a, b, c] = triangle.map(|node| Vector3::from_column_slice(&x[3 * node..3 * node + 3]));
            assert!((b - a).cross(&(c - a)).z > 0.0, "{model}: {triangle:?} is inverted");
        }
    }
}

#[test]
fn heavy_cantilevers_converge() {
    for model in Model::ALL {
        let mut sample = samples::cantilever(model, 9, 500.0).unwrap();
        sample.gravity *= 1e4;
        let (found, x) = solve(&sample, &Settings::default());
        assert!(found.converged() && x.iter().all(|x| x.is_finite()), "{model}: {found:?}");
    }
}

#[test]
fn both_methods_find_the_same_equilibrium() {
    let tolerance = Tolerance::Relative(1e-9);
    let newton = Settings { tolerance, ..Settings::default() };
    let published = Settings { method: Method::LevenbergMarquardt, max_iterations: 500, ..newton };
    for model in [Model::STVK, Model::SOFT_CONSTRAINT] {
        for sample in [samples::cantilever(model, 9, 500.0), samples::hanging_sheet(model, 9)] {
            let sample = sample.unwrap();
            let ([first, second], [x, y]) = {
                let ((first, x), (second, y)) = (solve(&sample, &newton), solve(&sample, &published));
                ([first, second], [x, y])
            };
            assert!(first.converged() && second.converged(), "{model}: {first:?} {second:?}");
            assert!(difference(&x, &y) < 1e-7 * SIDE, "{model}: {:e}", difference(&x, &y));
            println!("{model}: {} and {} factorisations", first.factorisations, second.factorisations);
        }
    }
}

/// Dense stiffness matrix at a state.
fn stiffness(cloth: &Cloth, curves: &Curves, x: &[f64]) -> DMatrix<f64> {
    let mut values = Vec::new();
    cloth.hessian(curves, x, HessianKind::Full, &mut values);
    let unknowns = cloth.unknowns();
    DMatrix::from_fn(unknowns, unknowns, |i, j| cloth.entry(i, j).map_or(0.0, |place| values[place]))
}

/// Compares with a dense solve: with K after mixed Newton, with K + μI after Levenberg–Marquardt. μ starts at 1e-3 of
/// the mean diagonal and falls to a tenth in each step, since all steps succeed here. The mean is that of the last
/// step's matrix.
#[test]
fn the_published_method_keeps_the_damping_of_its_last_step() {
    let sample = samples::hanging_sheet(Model::STVK, 5).unwrap();
    let cloth = sample.cloth().unwrap();
    let curves = &sample.curves;
    let newton = Settings { tolerance: Tolerance::Relative(1e-9), ..Settings::default() };
    let published = Settings { method: Method::LevenbergMarquardt, ..newton };
    let mut x = sample.start.clone();
    let mut solver = Solver::new(&cloth);
    let right: DVector<f64> = DVector::from_fn(cloth.unknowns(), |i, _| (i as f64).sin());
    // From the start, and from the equilibrium, where no step is taken and the initial μ remains.
    for (settings, steps) in [(published, 1..200), (published, 0..1), (newton, 0..1)] {
        let found = solver.solve(curves, &mut x, &settings);
        assert!(found.converged() && steps.contains(&found.iterations), "{found:?}");
        let matrix = stiffness(&cloth, curves, &x);
        let mut solution = right.clone();
        solver.solve_linear(solution.as_mut_slice());
        let damped = (&right - &matrix * &solution).component_div(&solution);
        let mean = matrix.diagonal().abs().mean();
        let steps = found.iterations.max(1) as i32;
        let expected =
            if settings.method == Method::MixedNewton { 0.0 } else { 1e-3 * 0.1f64.powi(steps - 1) };
        println!("{steps} steps: μ = {:e} of the mean diagonal, expected {expected:e}", damped.mean() / mean);
        let exact = (matrix + DMatrix::identity(right.len(), right.len()) * (expected * mean)).lu();
        let exact = exact.solve(&right).unwrap();
        assert!((&solution - &exact).amax() < 1e-3 * exact.amax(), "{steps}");
        if settings.method == Method::LevenbergMarquardt && steps == 1 {
            let true_answer = stiffness(&cloth, curves, &x).lu().solve(&right).unwrap();
            assert!((&solution - &true_answer).amax() > 0.1 * true_answer.amax());
        }
    }
}

#[test]
fn the_published_method_does_not_ask_for_stability() {
    let published = Settings { method: Method::LevenbergMarquardt, ..Settings::default() };
    for model in [Model::STVK, Model::SOFT_CONSTRAINT] {
        let (flat, _) = solve(&compressed(model), &published);
        assert_eq!((flat.status, flat.iterations, flat.escaped), (Status::Converged, 0, false), "{model}");
    }
}

#[test]
fn what_nothing_holds_is_named() {
    let mut sample = samples::cantilever(Model::STVK, 4, 500.0).unwrap();
    sample.held.clear();
    let error = sample.cloth().unwrap_err();
    assert_eq!(error, Error::Unpinned { parts: vec![Part { vertex: 0, vertices: 16 }], free: 6 });
    assert!(error.to_string().contains("6 rigid motions free"), "{error}");

    let one = samples::square(4, Diagonals::Forward).unwrap();
    let apart = Vector3::x() * (2.0 * SIDE);
    let positions = one.positions.iter().copied().chain(one.positions.iter().map(|p| p + apart)).collect();
    let material = one.material.iter().chain(&one.material).copied().collect();
    let triangles = one.triangles.iter().copied().chain(one.triangles.iter().map(|t| t.map(|v| v + 16)));
    let mesh = Mesh::new(positions, material, triangles.collect()).unwrap();
    let mut sample =
        Sample::at_rest(mesh, Model::STVK, samples::fabric(Model::STVK, [500.0, 50.0, 1e-5]).unwrap());
    let parts = [0, 16].map(|vertex| Part { vertex, vertices: 16 }).to_vec();
    let error = sample.cloth().unwrap_err();
    assert_eq!(error, Error::Unpinned { parts: parts.clone(), free: 6 });
    assert!(
        error.to_string().contains("vertex 0 (16 vertices), nor that of vertex 16 (16 vertices)"),
        "{error}"
    );
    sample.hold(|p| (p.x < 0.5 * SIDE).then_some(0));
    assert_eq!(sample.cloth().unwrap_err(), Error::Unpinned { parts: parts[1..].to_vec(), free: 6 });
}

#[test]
fn an_iteration_cap_is_a_status_and_the_best_state_stays() {
    let sample = samples::cantilever(Model::STVK, 9, 500.0).unwrap();
    let before = sample.cloth().unwrap().energy(&sample.curves, &sample.start);
    for method in [Method::MixedNewton, Method::LevenbergMarquardt] {
        for max_iterations in [0, 1, 3] {
            let (found, x) = solve(&sample, &Settings { method, max_iterations, ..Settings::default() });
            assert_eq!(
                (found.status, found.iterations),
                (Status::IterationLimit, max_iterations),
                "{found:?}"
            );
            assert!(x.iter().all(|x| x.is_finite()) && found.imbalance.is_finite());
            let energy = sample.cloth().unwrap().energy(&sample.curves, &x);
            assert!((energy - found.energy).abs() <= 1e-12 * energy.abs());
            assert!(max_iterations > 0 || energy == before);
        }
    }
}

#[test]
fn what_is_not_finite_is_a_status() {
    let sample = samples::cantilever(Model::STVK, 6, 500.0).unwrap();
    let last = sample.start.len() - 1;
    for bad in [f64::NAN, f64::INFINITY] {
        let mut sample = sample.clone();
        sample.start[last] = bad;
        assert_eq!(solve(&sample, &Settings::default()).0.status, Status::NotFinite);
    }
    // The last corner on its neighbour: a wing without height has finite energy but non-finite forces.
    let mut sample = sample.clone();
    sample.start.copy_within(last - 5..last - 2, last - 2);
    assert!(sample.cloth().unwrap().energy(&sample.curves, &sample.start).is_finite());
    let (found, x) = solve(&sample, &Settings::default());
    assert_eq!((found.status, x), (Status::NotFinite, sample.start), "{found:?}");
}

#[test]
fn without_stiffness_nothing_panics() {
    for model in Model::ALL {
        let mut sample = samples::cantilever(model, 6, 500.0).unwrap();
        sample.curves = samples::fabric(model, [0.0; 3]).unwrap();
        let (falling, x) = solve(&sample, &Settings::default());
        assert!(!falling.converged() && x.iter().all(|x| x.is_finite()), "{model}: {falling:?}");
        sample.gravity = Vector3::zeros();
        let (resting, _) = solve(&sample, &Settings::default());
        assert_eq!((resting.status, resting.iterations), (Status::Unstable, 0), "{model}: {resting:?}");
    }
}

#[test]
fn a_stretch_problem_has_two_unknowns_a_node_and_nothing_of_bending() {
    for model in Model::ALL {
        let (mut sample, _) = samples::strip(model, Diagonals::Alternating, 300.0, 1.05).unwrap();
        let stretch = sample.cloth().unwrap();
        assert_eq!(stretch.unknowns(), 2 * (stretch.nodes() - sample.held.len()));
        assert!(stretch.bending().is_none());
        if let Membrane::Springs(springs) = stretch.membrane() {
            assert!(springs.iter().all(|spring| spring.component != Component::Shear));
            // 6 rows of 8 and 9 columns of 5.
            assert_eq!(springs.len(), 6 * 8 + 9 * 5);
        }
        // Nodes couple through springs along cell sides or through triangles, never across two triangles.
        let per_node = stretch.entries() as f64 / (stretch.unknowns() as f64);
        assert!(per_node < if model == Model::SPRINGS { 6.0 } else { 8.0 }, "{model}: {per_node}");
        sample.planar = false;
        sample.curves = samples::fabric(model, [300.0, 30.0, 1e-6]).unwrap();
        let all = sample.cloth().unwrap();
        assert_eq!(all.unknowns(), 3 * (all.nodes() - sample.held.len()));
        assert!(all.entries() > 2 * stretch.entries());
        sample.planar = true;
        assert!(matches!(sample.cloth(), Err(Error::InvalidValue { field: "planar", .. })));
    }
}
