//! The assembled cloth against finite differences, and under rigid motions.
//!
//! ```text
//!  ▌▔▔▔▔▔▐   goal    gradient = dE/dx, Hessian, clip border, K d = d(gradient)/dx; parameter gradient = d(gradient)/dk
//!  ▌ 4×5 ▐   states  a stretched, sheared and crumpled grid between two clips; every model; in the plane and in space
//!  ▌▁▁▁▁▁▐   passes  1e-6 relative; forces turn with a rigid motion to 1e-9 (a kilometre away: 1e-6)
//! ```

use cloth_sim::cloth::{Cloth, ForceScale};
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::element::HessianKind;
use cloth_sim::equilibrium::{Settings, Solver, Status};
use cloth_sim::finite_difference::derivative_error;
use cloth_sim::material::{BendingModel, Component, Compression, Curves, Model};
use cloth_sim::mesh::{Diagonals, Grid, Mesh};
use cloth_sim::samples::{GRAVITY, Sample};
use nalgebra::{DMatrix, Rotation3, Vector2, Vector3};

/// All components, or those of the membrane in planar problems, with nonlinear curves.
fn curves(model: Model, planar: bool) -> Curves {
    let component = |component: Component| {
        let scale = if component.is_bending() { 1e-5 } else { 200.0 };
        let end = if component.is_bending() { 200.0 } else { 0.2 };
        let negative = model.negative_strain(component, Compression::ZeroStrain);
        let stiffnesses = [1.0, 1.7, 2.1].map(|k| k * scale).to_vec();
        (
            component,
            StiffnessCurve::new(vec![0.0, 0.4 * end, end], stiffnesses, negative).expect("a proper curve"),
        )
    };
    let own = model.components().into_iter().filter(|c| !(planar && c.is_bending()));
    own.map(component).collect()
}

fn crumpled(model: Model, planar: bool) -> Sample {
    let grid = Grid { columns: 4, rows: 5, width: 0.03, height: 0.04, diagonals: Diagonals::Alternating };
    let mut sample = Sample::at_rest(grid.mesh().expect("a proper grid"), model, curves(model, planar));
    sample.planar = planar;
    sample.gravity = if planar { Vector3::new(0.0, -GRAVITY, 0.0) } else { Vector3::new(1.0, 2.0, -GRAVITY) };
    sample.hold(|p| if p.x == 0.0 { Some(0) } else { (p.x > 0.029).then_some(1) });
    sample.place(|p| Vector3::new(1.04 * p.x + 0.1 * p.y, 1.02 * p.y, p.z));
    sample.perturb(1.5e-3);
    let nodes = sample.start.len();
    sample.start = sample.cloth().expect("a proper sheet").state(&sample.start);
    // Edges turn by up to 0.1 rad.
    let turns = sample.start[nodes..].iter_mut().enumerate();
    turns.for_each(|(i, turn)| *turn = 1e-3 * (i as f64).sin());
    sample
}

fn cases() -> impl Iterator<Item = (String, Sample)> {
    Model::ALL.into_iter().chain([Model::STVK.with(BendingModel::Sheet)]).flat_map(|model| {
        [true, false].map(|planar| (format!("{model}, planar {planar}"), crumpled(model, planar)))
    })
}

/// The full state from the unknowns alone.
fn state(cloth: &Cloth, start: &[f64], unknowns: &[f64]) -> Vec<f64> {
    let mut x = start.to_vec();
    cloth.unknown_coordinates().iter().zip(unknowns).for_each(|(&coordinate, &value)| x[coordinate] = value);
    x
}

fn gradient(cloth: &Cloth, curves: &Curves, x: &[f64]) -> (f64, Vec<f64>, ForceScale) {
    let (mut gradient, mut scale) = (vec![0.0; x.len()], ForceScale::new(cloth.points()));
    let energy = cloth.gradient(curves, x, &mut gradient, &mut scale);
    (energy, gradient, scale)
}

fn dense(cloth: &Cloth, values: &[f64]) -> DMatrix<f64> {
    let size = cloth.unknowns();
    DMatrix::from_fn(size, size, |i, j| cloth.entry(i, j).map_or(0.0, |place| values[place]))
}

#[test]
fn the_gradient_is_the_derivative_of_the_energy() {
    for (name, sample) in cases() {
        let cloth = sample.cloth().unwrap();
        let (energy, gradient, _) = gradient(&cloth, &sample.curves, &sample.start);
        assert!((energy - cloth.energy(&sample.curves, &sample.start)).abs() <= 1e-14 * energy.abs());
        let value = |x: &[f64]| vec![cloth.energy(&sample.curves, x)];
        // Held nodes included; a planar problem has no out-of-plane forces.
        let error = derivative_error(value, &gradient, &sample.start, 1e-6, 0.0);
        assert!(error < 1e-7, "{name}: {error:e}");
    }
}

#[test]
fn the_hessian_and_the_clip_border_are_derivatives_of_the_gradient() {
    for (name, sample) in cases() {
        let cloth = sample.cloth().unwrap();
        let at: Vec<f64> = cloth.unknown_coordinates().iter().map(|&c| sample.start[c]).collect();
        let mut values = Vec::new();
        cloth.hessian(&sample.curves, &sample.start, HessianKind::Full, &mut values);
        let border = &values[cloth.entries()..values.len() - 1];
        assert_eq!(border.len(), 3 * 2 * cloth.unknowns());
        let mut rows: Vec<f64> = dense(&cloth, &values).iter().copied().collect();
        rows.extend(border);
        let value = |unknowns: &[f64]| {
            let (_, gradient, _) = gradient(&cloth, &sample.curves, &state(&cloth, &sample.start, unknowns));
            let free = cloth.unknown_coordinates().iter().map(|&c| gradient[c]);
            let forces = cloth.clip_forces(&gradient);
            free.chain(forces.iter().flat_map(|f| [f.x, f.y, f.z])).collect::<Vec<_>>()
        };
        let error = derivative_error(value, &rows, &at, 1e-6, 0.0);
        assert!(error < 1e-6, "{name}: {error:e}");
    }
}

/// Moves the nodes of every group to their rest distances.
fn parallel(mut sample: Sample, tied: &[Vec<usize>]) -> Sample {
    for group in tied {
        for &node in group {
            let offset = sample.mesh.positions[node] - sample.mesh.positions[group[0]];
            (0..3).for_each(|i| sample.start[3 * node + i] = sample.start[3 * group[0] + i] + offset[i]);
        }
    }
    sample
}

fn tied_cloth(sample: &Sample, tied: &[Vec<usize>]) -> Cloth {
    let components: Vec<Component> = sample.curves.components().collect();
    Cloth::new(&sample.problem(&components, tied)).expect("groups that are held or free")
}

/// Columns of the crumpled sheet.
fn lines() -> Vec<Vec<usize>> {
    (0..4).map(|column| (0..5).map(|row| 4 * row + column).collect()).collect()
}

#[test]
fn one_element_stands_for_all_between_parallel_lines() {
    for (name, sample) in cases() {
        let sample = parallel(sample, &lines());
        let [cloth, plain] = [tied_cloth(&sample, &lines()), sample.cloth().unwrap()];
        let count = |cloth: &Cloth| cloth.strains(Component::Shear, &sample.start).len();
        assert!(2 * count(&cloth) <= count(&plain), "{name}: {} of {}", count(&cloth), count(&plain));
        // A sheet that rolls has no rotations.
        let nodes = &sample.start[..3 * sample.mesh.len()];
        let [(energy, tied, _), (plain_energy, forces, _)] =
            [&cloth, &plain].map(|cloth| gradient(cloth, &sample.curves, &cloth.state(nodes)));
        assert!((energy / plain_energy - 1.0).abs() < 1e-12, "{name}: {energy:e}, {plain_energy:e}");
        let largest = forces.iter().fold(0.0, |largest: f64, force| largest.max(force.abs()));
        let sum =
            |forces: &[f64], line: &[usize], i| line.iter().map(|node| forces[3 * node + i]).sum::<f64>();
        for line in lines() {
            for i in 0..3 {
                let apart = sum(&tied, &line, i) - sum(&forces, &line, i);
                assert!(apart.abs() < 1e-12 * largest, "{name}: {apart:e} of {largest:e}");
            }
        }
    }
}

#[test]
fn lines_that_are_not_parallel_are_a_status_and_the_state_stays() {
    let sample = crumpled(Model::STVK, false);
    let cloth = tied_cloth(&sample, &lines());
    let mut not_a_number = parallel(crumpled(Model::STVK, false), &lines()).start;
    not_a_number[7] = f64::NAN;
    for (start, status) in [(sample.start.clone(), Status::NotParallel), (not_a_number, Status::NotFinite)] {
        let mut solver = Solver::new(&cloth);
        let bits = |x: &[f64]| x.iter().map(|c| c.to_bits()).collect::<Vec<_>>();
        let mut x = start.clone();
        let solved = solver.solve(&sample.curves, &mut x, &Settings::default());
        let driven = solver.load_steps(&sample.curves, &mut x, &start, &Settings::default());
        assert_eq!([solved.status, driven.status], [status; 2]);
        assert_eq!(bits(&x), bits(&start));
    }
}

#[test]
fn nodes_that_move_alike_share_their_unknowns() {
    for (name, sample) in cases() {
        let held = |node: &usize| !sample.held.iter().any(|held| held.node == *node);
        let free: Vec<usize> = (0..sample.mesh.len()).filter(held).collect();
        // A group of neighbours, which share elements, and one of distant nodes, both at their rest distances.
        let tied = vec![free[..4].to_vec(), vec![free[5], free[free.len() - 1]]];
        let sample = parallel(sample, &tied);
        let cloth = tied_cloth(&sample, &tied);
        let plain = sample.cloth().unwrap();
        assert_eq!(plain.unknowns() - cloth.unknowns(), 4 * if sample.planar { 2 } else { 3 });
        let mut values = Vec::new();
        cloth.hessian(&sample.curves, &sample.start, HessianKind::Full, &mut values);
        let value = |change: &[f64]| {
            let mut moved = vec![0.0; sample.start.len()];
            cloth.spread(change, &mut moved);
            moved.iter_mut().zip(&sample.start).for_each(|(moved, x)| *moved += x);
            let (_, gradient, _) = gradient(&cloth, &sample.curves, &moved);
            let mut forces = vec![0.0; cloth.unknowns()];
            cloth.collect(&gradient, &mut forces);
            forces
        };
        let rows: Vec<f64> = dense(&cloth, &values).iter().copied().collect();
        let error = derivative_error(value, &rows, &vec![0.0; cloth.unknowns()], 1e-6, 0.0);
        assert!(error < 1e-6, "{name}: {error:e}");
    }
}

#[test]
fn the_clamped_hessian_has_no_negative_eigenvalue() {
    for (name, sample) in cases() {
        let cloth = sample.cloth().unwrap();
        let mut x = sample.start.clone();
        // Strong compression, where the true Hessian is indefinite.
        x.iter_mut().step_by(3).for_each(|x| *x *= 0.3);
        let lowest = |curvature| {
            let mut values = Vec::new();
            cloth.hessian(&sample.curves, &x, curvature, &mut values);
            let eigenvalues = dense(&cloth, &values).symmetric_eigenvalues();
            eigenvalues.min() / eigenvalues.max()
        };
        assert!(lowest(HessianKind::Full) < -1e-3, "{name}");
        assert!(lowest(HessianKind::Clamped) > -1e-12, "{name}");
    }
}

#[test]
fn the_parameter_gradient_is_the_derivative_in_every_control_value() {
    for (name, sample) in cases() {
        let cloth = sample.cloth().unwrap();
        let mut columns = Vec::new();
        for component in sample.curves.components() {
            cloth.parameter_gradient(&sample.curves, component, &sample.start, &mut columns);
            let curve = sample.curves.get(component).unwrap();
            let value = |k: &[f64]| {
                // Alone, so that its forces are not lost among the others.
                let curves = [(component, curve.with_stiffnesses(k.to_vec()).unwrap())].into_iter().collect();
                gradient(&cloth, &curves, &sample.start).1
            };
            let rows = DMatrix::from_column_slice(sample.start.len(), curve.len(), &columns).transpose();
            let k = curve.stiffnesses();
            let error = derivative_error(value, rows.as_slice(), k, 0.1 * k[0], 0.0);
            assert!(error < 1e-9, "{name}, {component}: {error:e}");
        }
    }
}

#[test]
fn the_stiffness_times_a_displacement_is_the_derivative_along_it() {
    for (name, sample) in cases() {
        let cloth = sample.cloth().unwrap();
        // One clip turns; in a planar problem nothing moves along z.
        let axis = if sample.planar { Vector3::z() } else { Vector3::new(0.3, -0.2, 1.0) };
        let mut displacement = vec![0.0; sample.start.len()];
        for held in sample.held.iter().filter(|held| held.clip == Some(1)) {
            let own = 3 * held.node..3 * held.node + 3;
            let moved = axis.cross(&Vector3::from_column_slice(&sample.start[own.clone()]));
            displacement[own].copy_from_slice(moved.as_slice());
        }
        let value = |along: &[f64]| {
            let x: Vec<f64> = sample.start.iter().zip(&displacement).map(|(x, d)| x + along[0] * d).collect();
            gradient(&cloth, &sample.curves, &x).1
        };
        let rows = cloth.stiffness_times(&sample.curves, &sample.start, &displacement);
        let error = derivative_error(value, &rows, &[0.0], 1e-5, 0.0);
        assert!(error < 1e-6, "{name}: {error:e}");
    }
}

#[test]
fn a_rigid_motion_turns_the_forces_and_leaves_the_energy() {
    let rotation = Rotation3::new(Vector3::new(2.0, -1.1, 0.4));
    for model in Model::ALL {
        let mut sample = crumpled(model, false);
        sample.gravity = Vector3::zeros();
        let cloth = sample.cloth().unwrap();
        let (energy, before, scale) = gradient(&cloth, &sample.curves, &sample.start);
        let largest = scale.magnitude.iter().fold(0.0, |a: f64, &b| a.max(b));
        for (shift, allowed) in
            [(Vector3::new(0.5, -0.3, 0.2), 1e-9), (Vector3::new(1000.0, -600.0, 300.0), 1e-6)]
        {
            let mut moved = sample.clone();
            moved.place(|p| rotation * p + shift);
            let (moved_energy, after, _) = gradient(&cloth, &sample.curves, &moved.start);
            assert!((moved_energy - energy).abs() <= allowed * energy, "{model}");
            let mut total = Vector3::zeros();
            for (before, after) in before.chunks(3).zip(after.chunks(3)) {
                let (before, after) = (Vector3::from_column_slice(before), Vector3::from_column_slice(after));
                let change = (rotation * before - after).norm() / largest;
                assert!(change <= allowed, "{model}: {change:e}");
                total += after;
            }
            assert!(total.norm() <= 1e-11 * largest, "{model}: {total}");
        }
    }
}

/// A node with three triangles is the wing of two edges of one triangle.
#[test]
fn the_hessian_counts_a_node_that_is_two_wings_twice() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.4, 0.9], [0.5, 0.3]];
    let mesh = Mesh::new(
        corners.map(|[x, y]| Vector3::new(x, y, 0.1 * x * y)).to_vec(),
        corners.map(|[x, y]| Vector2::new(x, y)).to_vec(),
        vec![[0, 1, 3], [1, 2, 3], [2, 0, 3]],
    )
    .unwrap();
    let model = Model::STVK.with(BendingModel::Sheet);
    let mut sample = Sample::at_rest(mesh, model, curves(model, false));
    sample.hold(|p| (p.x == 0.0).then_some(0));
    sample.start = sample.cloth().unwrap().state(&sample.start);
    let cloth = sample.cloth().unwrap();
    let start: Vec<f64> = sample.start.iter().enumerate().map(|(i, x)| x + 0.05 * (i as f64).sin()).collect();
    let mut values = Vec::new();
    cloth.hessian(&sample.curves, &start, HessianKind::Full, &mut values);
    let at: Vec<f64> = cloth.unknown_coordinates().iter().map(|&c| start[c]).collect();
    let value = |unknowns: &[f64]| {
        let (_, gradient, _) = gradient(&cloth, &sample.curves, &state(&cloth, &start, unknowns));
        cloth.unknown_coordinates().iter().map(|&c| gradient[c]).collect::<Vec<_>>()
    };
    let rows: Vec<f64> = dense(&cloth, &values).iter().copied().collect();
    let error = derivative_error(value, &rows, &at, 1e-5, 0.0);
    assert!(error < 1e-6, "{error:e}");
}
