//! Case 11: derivatives of every element against finite differences, in random states.

use crate::balance::larger;
use crate::property::for_all;
use crate::table::{Extent, Row};
use cloth_sim::bending::Hinge;
use cloth_sim::element::{Block, Element, Point, complete};
use cloth_sim::finite_difference::derivative_error;
use cloth_sim::material::Component;
use cloth_sim::membrane::{SoftTriangle, Spring, StvkTriangle, Triangle};
use nalgebra::{DMatrix, Rotation3, Vector2, Vector3};
use proptest::prelude::*;
use proptest::strategy::BoxedStrategy;

/// Random rest shape, state and position of an element.
#[derive(Debug, Clone)]
struct State {
    /// Length of an edge, 1 mm to 10 m.
    size: f64,
    /// Offsets of the rest shape's corners, in edges.
    rest: [f64; 6],
    /// Affine map: stretch, shear.
    map: [f64; 2],
    /// Offset of every node, in edges.
    jitter: [f64; 12],
    turn: [f64; 3],
    shift: [f64; 3],
}

fn states() -> BoxedStrategy<State> {
    let numbers = (
        -3.0..1.0,
        prop::array::uniform6(-0.2..0.2),
        (0.3..1.8, -0.8..0.8),
        prop::array::uniform12(-0.3..0.3),
        prop::array::uniform3(-3.0..3.0),
        prop::array::uniform3(-10.0..10.0),
    );
    numbers
        .prop_map(|(decade, rest, (stretch, shear), jitter, turn, shift)| State {
            size: 10f64.powf(decade),
            rest,
            map: [stretch, shear],
            jitter,
            turn,
            shift,
        })
        .boxed()
}

impl State {
    /// Deformed positions of nodes from their rest positions, in edges.
    fn places<const K: usize, const N: usize>(&self, rest: [[f64; 3]; K]) -> [Point<N>; K] {
        let rotation = Rotation3::new(Vector3::from(self.turn));
        std::array::from_fn(|a| {
            let [x, y, z] = rest[a];
            let jitter = Vector3::from_column_slice(&self.jitter[3 * a..3 * a + 3]);
            let place = Vector3::new(self.map[0] * x + self.map[1] * y, y, z) + jitter;
            let place = if N == 2 { place } else { rotation * place };
            let place = (place + Vector3::from(self.shift)) * self.size;
            Point::from_column_slice(&place.as_slice()[..N])
        })
    }

    fn corners(&self) -> [[f64; 3]; 3] {
        let [a, b, c, d, e, f] = self.rest;
        [[a, b, 0.0], [1.0 + c, d, 0.0], [0.3 + e, 1.0 + f, 0.0]]
    }

    fn triangle(&self) -> Triangle {
        let corners = self.corners().map(|[x, y, _]| Vector2::new(x, y) * self.size);
        let mesh = cloth_sim::mesh::Mesh::new(
            corners.iter().map(|p| p.push(0.0)).collect(),
            corners.to_vec(),
            vec![[0, 1, 2]],
        );
        Triangle::new(&mesh.unwrap(), 0)
    }

    fn spring(&self) -> Spring {
        let nodes = [0, 1];
        Spring { nodes, rest_length: self.size, area: self.size * self.size, component: Component::Shear }
    }

    /// A hinge at an edge along x, its wings folded by any angle up to 160°.
    fn hinge(&self) -> ([[f64; 3]; 4], Hinge) {
        let (sin, cos) = (14.0 * self.rest[0]).sin_cos();
        let [a, b] = [1.0 + 2.0 * self.rest[1], 1.0 + 2.0 * self.rest[2]];
        let rest = [
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.5 + 2.0 * self.rest[3], a, 0.0],
            [0.5 + 2.0 * self.rest[4], -b * cos, b * sin],
        ];
        let hinge = Hinge {
            nodes: [0, 1, 2, 3],
            rest_angle: self.rest[5],
            rest_length: self.size,
            width: self.size * (a + b) / 6.0,
            component: Component::BendWeft,
        };
        (rest, hinge)
    }
}

/// Gradients to 1e-6 and Hessians to 1e-5 of their largest entry, for every kind of element.
pub(crate) fn case_11(extent: Extent) -> Vec<Row> {
    [
        kind("stvk triangle in space", extent, |state| {
            errors::<3, 3, 3>(&StvkTriangle(state.triangle()), state.places(state.corners()))
        }),
        kind("stvk triangle in the plane", extent, |state| {
            errors::<3, 2, 3>(&StvkTriangle(state.triangle()), state.places(state.corners()))
        }),
        kind("soft-constraint triangle in space", extent, |state| {
            let (triangle, x) = (state.triangle(), state.places::<3, 3>(state.corners()));
            has_length(&triangle, &x).then(|| errors::<3, 3, 3>(&SoftTriangle(triangle), x)).flatten()
        }),
        kind("soft-constraint triangle in the plane", extent, |state| {
            let (triangle, x) = (state.triangle(), state.places::<3, 2>(state.corners()));
            has_length(&triangle, &x).then(|| errors::<3, 2, 3>(&SoftTriangle(triangle), x)).flatten()
        }),
        kind("spring in space", extent, |state| {
            errors::<2, 3, 1>(&state.spring(), state.places([[0.0; 3], [1.0, 0.0, 0.0]]))
        }),
        kind("spring in the plane", extent, |state| {
            errors::<2, 2, 1>(&state.spring(), state.places([[0.0; 3], [1.0, 0.0, 0.0]]))
        }),
        kind("hinge", extent, |state| {
            let (rest, hinge) = state.hinge();
            let x = state.places::<4, 3>(rest);
            is_open(&hinge, &x, state.size).then(|| errors::<4, 3, 1>(&hinge, x)).flatten()
        }),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Soft constraints have a kink where a yarn has zero length: finite differences across it do not converge.
fn has_length<const N: usize>(triangle: &Triangle, x: &[Point<N>; 3]) -> bool {
    triangle.deformation(x).iter().all(|w| w.norm() > 0.1)
}

/// True away from a collapsed wing and from the jump of the angle at ±π.
fn is_open(hinge: &Hinge, x: &[Point<3>; 4], size: f64) -> bool {
    let edge = x[1] - x[0];
    let height = |wing: usize| edge.cross(&(x[wing] - x[0])).norm() / edge.norm();
    let turn = hinge.strains(x)[0] * hinge.width + hinge.rest_angle;
    height(2).min(height(3)) > 0.1 * size && edge.norm() > 0.1 * size && turn.abs() < 2.8
}

/// The two rows of one kind of element. States without a derivative are redrawn.
fn kind(name: &str, extent: Extent, errors: impl Fn(&State) -> Option<[f64; 2]>) -> [Row; 2] {
    [("gradient", 1e-6, 0), ("Hessian", 1e-5, 1)].map(|(what, limit, which)| {
        let row = Row::measured(11, format!("{name}: {what}"), "relative error", limit);
        let smooth = states().prop_filter_map("no derivative there", |state| {
            let errors = errors(&state)?;
            Some((state, errors))
        });
        for_all(row, extent.runs(500, 100_000), smooth, |row, (state, errors)| {
            row.measure(errors[which], || format!("{state:?}"))
        })
    })
}

/// The largest errors of gradients and Hessians over all strains; `None` if two nodes coincide.
fn errors<const K: usize, const N: usize, const S: usize>(
    element: &impl Element<K, N, S>,
    x: [Point<N>; K],
) -> Option<[f64; 2]> {
    let pairs = (0..K).flat_map(|a| (0..a).map(move |b| (a, b)));
    let size = pairs.map(|(a, b)| (x[a] - x[b]).norm()).fold(f64::MAX, f64::min);
    let span = (1..K).map(|a| (x[a] - x[0]).norm()).fold(0.0, f64::max);
    if size < 0.05 * span {
        return None;
    }
    let middle = x.iter().sum::<Point<N>>() / K as f64;
    let stacked: Vec<f64> = x.iter().flat_map(|p| (p - middle).iter().copied().collect::<Vec<_>>()).collect();
    let nodes = |x: &[f64]| -> [Point<N>; K] {
        std::array::from_fn(|a| Point::from_column_slice(&x[N * a..N * a + N]) + middle)
    };
    let gradients = |x: &[f64]| -> Vec<f64> {
        let gradients = element.gradients(&nodes(x));
        gradients.iter().flatten().flat_map(|g| g.iter().copied().collect::<Vec<_>>()).collect()
    };
    let h = 1e-3 * size;
    let gradient = gradients(&stacked);
    let strains = |x: &[f64]| element.strains(&nodes(x)).to_vec();
    let mut worst = [derivative_error(strains, &gradient, &stacked, h, 0.0), 0.0];
    for c in 0..S {
        let mut stress = [0.0; S];
        stress[c] = 1.0;
        let mut blocks = [[Block::<N>::zeros(); K]; K];
        element.add_geometric(&x, &stress, &mut blocks);
        complete(&mut blocks, K);
        let of = |i: usize, j: usize| {
            let (a, b) = (i / N, j / N);
            if b <= a { blocks[a][b][(i % N, j % N)] } else { blocks[b][a][(j % N, i % N)] }
        };
        let rows: Vec<f64> = DMatrix::from_fn(K * N, K * N, |i, j| of(j, i)).iter().copied().collect();
        let component = |x: &[f64]| gradients(x)[c * K * N..(c + 1) * K * N].to_vec();
        // A linear strain has zero Hessian: compare with gradient/size.
        let scale = 1e-3 * gradient.iter().fold(0.0, |m: f64, g| m.max(g.abs())) / size;
        worst[1] = larger(worst[1], derivative_error(component, &rows, &stacked, h, scale));
    }
    Some(worst)
}
