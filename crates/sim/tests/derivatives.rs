//! Every element against finite differences, under rigid motions, and clamped.
//!
//! ```text
//! goal    ∇ε and ∇²ε of every element are those of its strain, in any state short of collapse
//! states  a rest shape about 4 mm large, stretched, compressed, sheared or folded at random, turned and moved
//! passes  gradient 1e-6, Hessian 1e-5 relative; forces unchanged by a rigid motion to 1e-9
//! ```
//!
//! 2 000 seeded states per element; `full_count` (ignored) runs 1e5.

#![allow(clippy::print_stdout)]

use cloth_sim::bending::{Hinge, Sheet, SheetTriangle};
use cloth_sim::element::{Element, Point, complete};
use cloth_sim::finite_difference::derivative_error;
use cloth_sim::material::Component;
use cloth_sim::membrane::{SoftTriangle, Spring, StvkTriangle, Triangle};
use nalgebra::{Rotation3, SMatrix, Vector2, Vector3};
use rand::{Rng, SeedableRng, rngs::StdRng};

const CELL: f64 = 4e-3;

/// Largest relative errors over many states: gradient, Hessian, force change under a rigid motion.
#[derive(Debug, Default)]
struct Errors {
    gradient: f64,
    hessian: f64,
    rigid: f64,
    /// Most negative eigenvalue of the clamped part, relative to the largest.
    clamped: f64,
}

impl std::fmt::LowerExp for Errors {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { gradient, hessian, rigid, .. } = self;
        write!(f, "gradient {gradient:.1e}, Hessian {hessian:.1e}, rigid motion {rigid:.1e}")
    }
}

fn stack<const K: usize, const N: usize>(x: &[f64]) -> [Point<N>; K] {
    std::array::from_fn(|a| Point::from_column_slice(&x[N * a..N * a + N]))
}

fn flatten<const K: usize, const N: usize, const S: usize>(gradients: &[[Point<N>; K]; S]) -> Vec<f64> {
    gradients.iter().flatten().flat_map(|g| g.iter().copied().collect::<Vec<_>>()).collect()
}

/// Full symmetric matrix from the lower blocks.
fn dense<const K: usize, const N: usize>(blocks: &[[SMatrix<f64, N, N>; K]; K]) -> nalgebra::DMatrix<f64> {
    nalgebra::DMatrix::from_fn(N * K, N * K, |i, j| {
        let (a, b) = (i / N, j / N);
        if b <= a { blocks[a][b][(i % N, j % N)] } else { blocks[b][a][(j % N, i % N)] }
    })
}

fn check<const K: usize, const N: usize, const S: usize, E: Element<K, N, S>>(
    element: &E,
    x: &[f64],
    rng: &mut StdRng,
    errors: &mut Errors,
) {
    let strains = |x: &[f64]| element.strains(&stack::<K, N>(x)).to_vec();
    let gradients = |x: &[f64]| flatten(&element.gradients(&stack::<K, N>(x)));
    // A hundredth of the smallest distance: derivatives of an angle grow as the wing height shrinks.
    let size = smallest_distance(&stack::<K, N>(x)[..E::TRANSLATED]);
    let h = 1e-3 * size;
    let gradient = gradients(x);
    errors.gradient = errors.gradient.max(derivative_error(strains, &gradient, x, h, 0.0));
    for c in 0..S {
        let mut stress = [0.0; S];
        stress[c] = 1.0;
        let mut blocks = [[SMatrix::zeros(); K]; K];
        element.add_geometric(&stack::<K, N>(x), &stress, &mut blocks);
        complete(&mut blocks, E::TRANSLATED);
        let hessian = dense(&blocks);
        let component = |x: &[f64]| gradients(x)[c * K * N..(c + 1) * K * N].to_vec();
        let rows: Vec<f64> = hessian.transpose().iter().copied().collect();
        // A linear strain has a zero Hessian: compare with gradient/size.
        let scale = 1e-3 * gradient.iter().fold(0.0, |m: f64, g| m.max(g.abs())) / size;
        errors.hessian = errors.hessian.max(derivative_error(component, &rows, x, h, scale));
    }
    let stress: [f64; S] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
    let mut blocks = [[SMatrix::zeros(); K]; K];
    element.add_clamped(&stack::<K, N>(x), &stress, &mut blocks);
    complete(&mut blocks, E::TRANSLATED);
    let clamped = dense(&blocks).symmetric_eigenvalues();
    if clamped.max() > 0.0 {
        errors.clamped = errors.clamped.max(-clamped.min() / clamped.max());
    }
}

fn smallest_distance<const N: usize>(nodes: &[Point<N>]) -> f64 {
    let pairs = (0..nodes.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
    pairs.map(|(a, b)| (nodes[a] - nodes[b]).norm()).fold(f64::MAX, f64::min)
}

/// Force change when the state is rotated arbitrarily and moved by up to a metre.
fn check_rigid<const K: usize, const S: usize, E: Element<K, 3, S>>(
    element: &E,
    x: &[f64],
    rng: &mut StdRng,
    errors: &mut Errors,
) {
    let nodes: [Point<3>; K] = stack(x);
    let axis = Vector3::from_fn(|_, _| rng.random_range(-3.0..3.0));
    let rotation = Rotation3::new(axis);
    let shift = Vector3::from_fn(|_, _| rng.random_range(-0.5..0.5));
    let mut moved = nodes;
    moved[..E::TRANSLATED].iter_mut().for_each(|p| *p = rotation * *p + shift);
    let force = |nodes: &[Point<3>; K]| {
        let (strains, gradients) = (element.strains(nodes), element.gradients(nodes));
        std::array::from_fn::<_, K, _>(|a| (0..S).map(|c| gradients[c][a] * strains[c]).sum::<Vector3<f64>>())
    };
    let (before, after) = (force(&nodes), force(&moved));
    // Relative to the element's largest force, but at least to that of a unit strain: at rest there is no force. (A
    // hinge's strain is in 1/m and reaches 10³.)
    let unit = element.gradients(&nodes).iter().flatten().fold(0.0, |m: f64, g| m.max(g.norm()));
    let largest = before.iter().fold(unit, |m: f64, f| m.max(f.norm()));
    for (a, (before, after)) in before.iter().zip(&after).enumerate() {
        let turned = if a < E::TRANSLATED { rotation * before } else { *before };
        errors.rigid = errors.rigid.max((turned - after).norm() / largest);
    }
}

/// A random state of `K` nodes with given rest positions: an affine map, a jitter and a rigid motion.
fn state<const K: usize>(rest: &[[f64; 3]; K], rng: &mut StdRng) -> Vec<f64> {
    let stretch = rng.random_range(0.3..1.8);
    let shear = rng.random_range(-0.8..0.8);
    let jitter = if rng.random_bool(0.2) { 0.0 } else { rng.random_range(0.0..0.3) * CELL };
    let rotation = Rotation3::new(Vector3::from_fn(|_, _| rng.random_range(-3.0..3.0)));
    let shift = Vector3::from_fn(|_, _| rng.random_range(-0.05..0.05));
    rest.iter()
        .flat_map(|p| {
            let p = Vector3::new(stretch * p[0] + shear * p[1], p[1], p[2]);
            let p = p + Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0) * jitter);
            let p = rotation * p + shift;
            [p.x, p.y, p.z]
        })
        .collect()
}

fn planar(x: &[f64]) -> Vec<f64> {
    x.chunks(3).flat_map(|p| [p[0], p[1]]).collect()
}

fn triangle(rng: &mut StdRng) -> ([[f64; 3]; 3], Triangle) {
    let corner = |x: f64, y: f64, rng: &mut StdRng| {
        [x * CELL + rng.random_range(-0.2..0.2) * CELL, y * CELL + rng.random_range(-0.2..0.2) * CELL, 0.0]
    };
    let rest = [corner(0.0, 0.0, rng), corner(1.0, 0.0, rng), corner(0.3, 1.0, rng)];
    let mesh = cloth_sim::mesh::Mesh::new(
        rest.iter().map(|p| Vector3::from(*p)).collect(),
        rest.iter().map(|p| Vector2::new(p[0], p[1])).collect(),
        vec![[0, 1, 2]],
    )
    .expect("a proper triangle");
    (rest, Triangle::new(&mesh, 0))
}

/// Two wings about an edge along x, folded by an angle.
fn hinge(rng: &mut StdRng) -> ([[f64; 3]; 4], Hinge) {
    let fold: f64 = rng.random_range(-2.8..2.8);
    let [a, b] = [rng.random_range(0.5..1.5) * CELL, rng.random_range(0.5..1.5) * CELL];
    let rest = [
        [0.0, 0.0, 0.0],
        [CELL, 0.0, 0.0],
        [rng.random_range(0.0..1.0) * CELL, a, 0.0],
        [rng.random_range(0.0..1.0) * CELL, -b * fold.cos(), b * fold.sin()],
    ];
    let hinge = Hinge {
        nodes: [0, 1, 2, 3],
        rest_angle: rng.random_range(-0.3..0.3),
        rest_length: CELL,
        width: (a + b) / 6.0,
        component: Component::BendWeft,
    };
    (rest, hinge)
}

/// A triangle among four, with its points at rest: the one in the middle, or one with borders, or one beside a held one.
fn sheet(rng: &mut StdRng) -> ([[f64; 3]; 6], SheetTriangle) {
    let place = |x: f64, y: f64, rng: &mut StdRng| {
        let mut near = |place: f64| (place + rng.random_range(-0.2..0.2)) * CELL;
        Vector3::new(near(x), near(y), 0.2 * near(0.0))
    };
    let places = [(0.0, 0.0), (1.0, 0.0), (0.3, 1.0), (1.3, 1.0), (-0.7, 1.0), (0.6, -1.0)];
    let nodes: Vec<Vector3<f64>> = places.map(|(x, y)| place(x, y, rng)).into();
    let mesh = cloth_sim::mesh::Mesh::new(
        nodes.clone(),
        nodes.iter().map(|p| Vector2::new(p.x, p.y)).collect(),
        vec![[0, 1, 2], [2, 1, 3], [0, 2, 4], [1, 0, 5]],
    )
    .expect("four triangles");
    let held: Vec<bool> = match rng.random_bool(0.3) {
        true => (0..6).map(|node| [0, 2, 4].contains(&node)).collect(),
        false => vec![false; 6],
    };
    let triangles = Sheet::new(&mesh, &held, true).expect("a proper sheet").triangles;
    let triangle = triangles[rng.random_range(0..triangles.len())];
    let rest = std::array::from_fn(|a| nodes[triangle.coordinates[a][0] / 3].into());
    (rest, triangle)
}

/// True if no triangle beside the first has collapsed or is folded onto it.
fn is_open(triangle: &SheetTriangle, nodes: &[Point<3>]) -> bool {
    let normal = |a: usize, b: usize, c: usize| (nodes[b] - nodes[a]).cross(&(nodes[c] - nodes[a]));
    let own = normal(0, 1, 2);
    (0..3).all(|e| {
        let [from, to] = [(e + 1) % 3, (e + 2) % 3];
        let height = |normal: Vector3<f64>| normal.norm() / (nodes[to] - nodes[from]).norm();
        let beyond = normal(from, 3 + e, to);
        height(own) > 0.1 * CELL
            && (triangle.edges[e].share == 0.0 || height(beyond) > 0.1 * CELL && own.angle(&beyond) < 2.5)
    })
}

fn run(states: usize) {
    let mut rng = StdRng::seed_from_u64(7);
    let [mut stvk, mut soft, mut spring, mut shell, mut plate]: [Errors; 5] = Default::default();
    let (mut folds, mut sheets) = (0, 0);
    for _ in 0..states {
        let (rest, shape) = triangle(&mut rng);
        let x = state(&rest, &mut rng);
        let flat = planar(&x);
        let node = |x: &[f64], i: usize| Vector2::new(x[2 * i], x[2 * i + 1]);
        let collapsed = (0..3).any(|i| (node(&flat, i) - node(&flat, (i + 1) % 3)).norm() < 0.02 * CELL);
        // Soft constraints have no derivative at |w| = 0, where the implementation smooths the length.
        let [w_u, w_v] = shape.deformation(&stack::<3, 2>(&flat));
        let short = w_u.norm() < 0.1 || w_v.norm() < 0.1;
        check::<3, 3, 3, _>(&StvkTriangle(shape), &x, &mut rng, &mut stvk);
        check::<3, 3, 3, _>(&SoftTriangle(shape), &x, &mut rng, &mut soft);
        if !collapsed && !short {
            check::<3, 2, 3, _>(&StvkTriangle(shape), &flat, &mut rng, &mut stvk);
            check::<3, 2, 3, _>(&SoftTriangle(shape), &flat, &mut rng, &mut soft);
        }
        check_rigid(&StvkTriangle(shape), &x, &mut rng, &mut stvk);
        check_rigid(&SoftTriangle(shape), &x, &mut rng, &mut soft);

        let line =
            Spring { nodes: [0, 1], rest_length: CELL, area: CELL * CELL, component: Component::Shear };
        let ends = state(&[[0.0; 3], [CELL, 0.0, 0.0]], &mut rng);
        check::<2, 3, 1, _>(&line, &ends, &mut rng, &mut spring);
        check_rigid(&line, &ends, &mut rng, &mut spring);

        let (rest, fold) = hinge(&mut rng);
        let x = state(&rest, &mut rng);
        let nodes: [Point<3>; 4] = stack(&x);
        let height = |wing: usize| {
            let edge = nodes[1] - nodes[0];
            edge.cross(&(nodes[wing] - nodes[0])).norm() / edge.norm()
        };
        let turn = fold.strains(&nodes)[0] * fold.width + fold.rest_angle;
        // Avoid collapsed wings and the jump at ±π.
        if height(2).min(height(3)) > 0.1 * CELL && turn.abs() < 2.8 {
            folds += 1;
            check::<4, 3, 1, _>(&fold, &x, &mut rng, &mut shell);
            check_rigid(&fold, &x, &mut rng, &mut shell);
        }

        let (rest, triangle) = sheet(&mut rng);
        let mut x = state(&rest, &mut rng);
        if is_open(&triangle, &stack::<6, 3>(&x)) {
            sheets += 1;
            x.extend((0..3).map(|_| rng.random_range(-0.3..0.3) * CELL));
            check::<7, 3, 4, _>(&triangle, &x, &mut rng, &mut plate);
            check_rigid(&triangle, &x, &mut rng, &mut plate);
        }
    }
    assert!(folds > states / 3 && sheets > states / 3, "{folds} folded states, {sheets} sheets");
    for (name, errors) in
        [("stvk", stvk), ("soft", soft), ("spring", spring), ("hinge", shell), ("sheet", plate)]
    {
        println!("{name}, {states} states: {errors:e}");
        assert!(errors.gradient <= 1e-6, "{name}: {errors:?}");
        assert!(errors.hessian <= 1e-5, "{name}: {errors:?}");
        assert!(errors.rigid <= 1e-9, "{name}: {errors:?}");
        assert!(errors.clamped <= 1e-12, "{name}: {errors:?}");
    }
}

#[test]
fn elements_are_the_derivatives_of_their_strains() {
    run(2_000);
}

#[test]
#[ignore = "release: the full 1e5 states"]
fn full_count() {
    run(100_000);
}
