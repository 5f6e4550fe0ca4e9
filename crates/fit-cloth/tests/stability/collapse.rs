//! Cases 7 to 9: cells of zero length, hinges that are flat or folded flat, wings without height.

use crate::balance;
use crate::elements::MEMBRANE;
use crate::property::for_all;
use crate::table::{Extent, Row};
use cloth_sim::bending::Hinge;
use cloth_sim::element::Element;
use cloth_sim::equilibrium::{Settings, Solver, Status};
use cloth_sim::error::Error;
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::{Diagonals, Grid};
use cloth_sim::samples::{self, SIDE, Sample};
use nalgebra::Vector3;
use proptest::prelude::*;
use std::f64::consts::PI;

/// A sheet with a row or column of cells of zero length: energy, forces and stiffness are finite, and so is the
/// solution.
pub(crate) fn case_07(extent: Extent) -> Vec<Row> {
    let states = Model::ALL.into_iter().flat_map(|model| [true, false].map(|planar| (model, planar)));
    states
        .map(|(model, planar)| {
            let space = if planar { "in the plane" } else { "in space" };
            let row = Row::new(7, format!("{model}, no length along weft, warp or both, {space}"));
            let inputs = (1..4usize, -3.0..9.0, prop::bool::weighted(0.5), -320.0..-3.0);
            for_all(
                row,
                extent.runs(60, 2_000),
                inputs,
                |row, (which, decade, exactly, small): (usize, f64, bool, f64)| {
                    let length = if exactly { 0.0 } else { 10f64.powf(small) };
                    without_length(row, model, planar, which, (10f64.powf(decade), length))
                },
            )
        })
        .collect()
}

/// * `which` — bit 0 for weft, bit 1 for warp
/// * `length` — of the collapsed cells, as a share of their rest length
fn without_length(
    row: &mut Row,
    model: Model,
    planar: bool,
    which: usize,
    (stiffness, length): (f64, f64),
) -> bool {
    let curves: Vec<_> = MEMBRANE.map(|component| (component, stiffness)).into();
    let mesh = samples::square(5, Diagonals::Alternating).unwrap();
    let mut sample = Sample::at_rest(mesh, model, samples::linear_curves(model, &curves).unwrap());
    sample.planar = planar;
    sample.hold(|p| (p.x == 0.0).then_some(0));
    let squeeze = |c: f64, bit: usize| if which & bit == 0 { c } else { 0.3 * SIDE + length * c };
    sample.place(|p| Vector3::new(squeeze(p.x, 1), squeeze(p.y, 2), p.z));
    let cloth = sample.cloth().unwrap();
    let mut values = Vec::new();
    cloth.hessian(&sample.curves, &sample.start, cloth_sim::element::HessianKind::Full, &mut values);
    let energy = cloth.energy(&sample.curves, &sample.start);
    let (forces, _) = balance::forces(&cloth, &sample.curves, &sample.start);
    let finite = energy.is_finite()
        && values.iter().all(|value| value.is_finite())
        && forces.iter().all(|force| force.iter().all(|f| f.is_finite()));
    let mut x = sample.start.clone();
    let few = Settings { max_iterations: 10, ..Settings::default() };
    let found = Solver::new(&cloth).solve(&sample.curves, &mut x, &few);
    let stays_finite = x.iter().all(|x| x.is_finite()) && found.imbalance.is_finite();
    row.holds(finite && stays_finite, || {
        format!("{which}, k = {stiffness:e}, {length:e}: {energy} J, {found:?}")
    })
}

/// The hinge angle is accurate at zero, near ±π and between, at any size.
pub(crate) fn case_08(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for size in [1e-3, 1e-2, 1e-1, 1.0, 10.0] {
        for (range, small) in [("near 0", true), ("near ±π", true), ("any", false)] {
            let condition = format!("{range}, edge about {size} m");
            let row = Row::measured(8, condition, "error, rad", 1e-14);
            let angle =
                if small { (-300.0..-2.0).prop_map(|p| 10f64.powf(p)).boxed() } else { (0.0..PI).boxed() };
            let sides = (0.3..3.0, -1.0..2.0, 0.1..3.0, -1.0..2.0, 0.1..3.0);
            let inputs = (angle, prop::bool::ANY, sides);
            rows.push(for_all(row, extent.runs(500, 20_000), inputs, |row, (angle, up, sides)| {
                let found = folded(angle, range == "near ±π", up, size, sides);
                let expected = if range == "near ±π" { PI - angle } else { angle };
                // Folded flat, the sign of the angle is undefined.
                let error = (found.abs() - expected).abs();
                row.measure(error, || format!("{angle:e} rad, up: {up}, {sides:?}: {found:e}"))
            }));
        }
    }
    rows
}

/// The angle of a hinge whose second wing is turned by a small angle from flat or folded flat.
fn folded(
    angle: f64,
    over: bool,
    up: bool,
    size: f64,
    (edge, foot, height, other, second): (f64, f64, f64, f64, f64),
) -> f64 {
    let hinge = Hinge {
        nodes: [0, 1, 2, 3],
        rest_angle: 0.0,
        rest_length: size * edge,
        width: 1.0,
        component: Component::BendWeft,
    };
    let (sin, cos) = angle.sin_cos();
    let [sin, cos] = [if up { sin } else { -sin }, if over { -cos } else { cos }];
    let x = [[0.0, 0.0, 0.0], [edge, 0.0, 0.0], [foot, height, 0.0], [other, -second * cos, second * sin]];
    hinge.strains(&x.map(|p| Vector3::from(p) * size))[0]
}

/// A wing without height is an error that names the edge; in a deformed state it is a status.
pub(crate) fn case_09(extent: Extent) -> Vec<Row> {
    let splits = [Diagonals::Forward, Diagonals::Backward, Diagonals::Alternating, Diagonals::Crossed];
    let mut rows = Vec::new();
    for diagonals in splits {
        let inputs = (2..6usize, 2..6usize, -3.0..1.0, 0..1000usize, 0.0..1.0, -13.0..-10.5);
        let row = Row::new(9, format!("{diagonals:?}: the rest shape's edge is named"));
        rows.push(for_all(
            row,
            extent.runs(100, 5_000),
            inputs,
            |row, (columns, rows, size, at, foot, height): (_, _, f64, _, _, f64)| {
                let size = 10f64.powf(size);
                collapsed(
                    row,
                    Grid { columns, rows, width: size, height: size, diagonals },
                    at,
                    [foot, 10f64.powf(height)],
                )
            },
        ));
    }
    for model in [Model::STVK, Model::SOFT_CONSTRAINT] {
        let row = Row::new(9, format!("{model}: a collapsed state is a status"));
        rows.push(for_all(
            row,
            extent.runs(20, 1_000),
            (0..1000usize, -3.0..9.0),
            |row, (at, decade): (usize, f64)| {
                let stretch = 10f64.powf(decade);
                let mut sample = samples::cantilever(model, 5, stretch).unwrap();
                // One corner of a triangle on another: every hinge between them has a wing without height.
                let triangle = sample.mesh.triangles[at % sample.mesh.triangles.len()];
                let place = |node: usize| 3 * node..3 * node + 3;
                sample.start.copy_within(place(triangle[0]), 3 * triangle[2]);
                let before = sample.start.clone();
                let cloth = sample.cloth().unwrap();
                let found =
                    Solver::new(&cloth).solve(&sample.curves, &mut sample.start, &Settings::default());
                let named = found.status == Status::NotFinite;
                row.holds(named && sample.start == before, || format!("{at}, {stretch:e}: {found:?}"))
            },
        ));
    }
    rows
}

/// Moves a corner of a triangle nearly onto the opposite edge, an inner one.
fn collapsed(row: &mut Row, grid: Grid, at: usize, [foot, height]: [f64; 2]) -> bool {
    let mut mesh = grid.mesh().unwrap();
    let edges = mesh.edges().unwrap();
    let inner: Vec<_> = edges.iter().filter(|edge| edge.right.is_some()).collect();
    let edge = inner[at % inner.len()];
    let [from, to] = edge.ends.map(|node| mesh.positions[node]);
    let across = Vector3::new(from.y - to.y, to.x - from.x, 0.0);
    mesh.positions[edge.left] = from + (to - from) * foot + across * height;
    let error = Hinge::all(&mesh).err();
    let named = match &error {
        Some(Error::CollapsedWing { edge: [a, b], wing }) => {
            // Another inner edge of the triangle may be named instead.
            let [p, q, r] = [*a, *b, *wing].map(|node| mesh.positions[node]);
            let flat = (q - p).cross(&(r - p)).norm() <= 1e-10 * (q - p).norm_squared();
            let words = error.as_ref().map(Error::to_string).unwrap_or_default();
            flat && words.contains(&format!("edge {a}-{b}")) && words.contains(&format!("vertex {wing}"))
        }
        _ => false,
    };
    row.holds(named, || format!("{grid:?}, {:?}, foot {foot}, height {height:e}: {error:?}", edge.ends))
}
