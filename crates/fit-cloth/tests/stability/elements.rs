//! Cases 6, 10 and 12: sheets that are compressed, have slender cells, or are rotated and far away.

use crate::balance::{self, larger};
use crate::property::for_all;
use crate::table::{Extent, Row};
use cloth_sim::equilibrium::{Limit, Settings, Solver, Tolerance};
use cloth_sim::error::Error;
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::{Diagonals, Grid};
use cloth_sim::samples::{self, SIDE, Sample};
use nalgebra::{Matrix3x2, Rotation3, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;

pub(crate) const MEMBRANE: [Component; 3] =
    [Component::StretchWeft, Component::StretchWarp, Component::Shear];

/// In-plane compression along weft with the border held: converges, and no triangle inverts. Shear and warp are stiff
/// enough that the yarns do not buckle.
pub(crate) fn case_06(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for model in Model::ALL {
        for share in [0.7, 0.4, 0.2, 0.1] {
            // The perturbation is up to 0.6 % of a compressed cell, on the way from rest a tenth.
            for (way, size) in [("solved there", 1e-5), ("driven there from rest", 2e-3)] {
                let row = balance::row(6, format!("{model}, compressed to λ = {share}, {way}"));
                let inputs = (-3.0..9.0, 1e-3..1.0);
                rows.push(for_all(
                    row,
                    extent.runs(3, 300),
                    inputs,
                    |row, (decade, perturbed): (f64, f64)| {
                        compressed(row, model, share, 10f64.powf(decade), (perturbed * size, size > 1e-4))
                    },
                ));
            }
        }
    }
    rows
}

fn compressed(
    row: &mut Row,
    model: Model,
    share: f64,
    stiffness: f64,
    (perturbation, driven): (f64, bool),
) -> bool {
    let patch = |share| samples::patch(model, Matrix3x2::new(share, 0.0, 0.0, 1.0, 0.0, 0.0)).unwrap();
    let stiffnesses = [stiffness, 1e3 * stiffness, 100.0 * stiffness];
    // Diagonal springs would buckle.
    let count = if model == Model::SPRINGS { 2 } else { 3 };
    let curves: Vec<_> = MEMBRANE.into_iter().zip(stiffnesses).take(count).collect();
    let mut sample = patch(if driven { 1.0 } else { share });
    sample.curves = samples::linear_curves(model, &curves).unwrap();
    sample.planar = true;
    sample.perturb(perturbation);
    let cloth = sample.cloth().unwrap();
    let mut solver = Solver::new(&cloth);
    let mut x = sample.start.clone();
    let mut found = solver.solve(&sample.curves, &mut x, &Settings::default());
    if driven {
        found = solver.load_steps(&sample.curves, &mut x, &patch(share).start, &Settings::default());
    }
    let inverted = sample.mesh.triangles.iter().find(|triangle| {
        let [a, b, c] = triangle.map(|node| Vector3::from_column_slice(&x[3 * node..3 * node + 3]));
        !((b - a).cross(&(c - a)).z > 0.0)
    });
    let also = inverted.map_or(Ok(()), |triangle| Err(format!("{triangle:?} is inverted")));
    let input = format!("k = {stiffness:.3e} N/m, perturbed by {perturbation:.1e} m");
    balance::judge(row, &cloth, &sample, &x, &found, also, &input)
}

/// Slender cells: passes the patch test to 1e-9 of the sheet's longer side, or an error names the triangle.
pub(crate) fn case_10(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for model in Model::ALL {
        for decades in 0..=6 {
            let row = Row::measured(10, format!("{model}, cells 1e{decades} : 1"), "error of places", 1e-9);
            let inputs = (-3.0..1.0, prop::bool::ANY, 0.9..1.1, -0.05..0.05, 0.9..1.1);
            rows.push(for_all(
                row,
                extent.runs(2, 200),
                inputs,
                |row, (size, tall, weft, shear, warp): (f64, bool, f64, f64, f64)| {
                    let ratio = 10f64.powi(-decades);
                    let long = 10f64.powf(size);
                    let [width, height] = if tall { [ratio * long, long] } else { [long, ratio * long] };
                    // A spring lattice is unstable in compression: it has states of lower energy than the affine one.
                    let least = if model == Model::SPRINGS { 1.0 } else { 0.0 };
                    let [weft, warp] = [weft, warp].map(|stretch| f64::max(stretch, least));
                    slender(row, model, [width, height], [weft, shear, warp])
                },
            ));
        }
    }
    let row = Row::new(10, "cells 1e11 : 1 and more: the triangle is named");
    rows.push(for_all(
        row,
        extent.runs(100, 5_000),
        (11.0..150.0, -3.0..1.0),
        |row, (decades, size): (f64, f64)| {
            let width: f64 = 10f64.powf(size);
            let height = width * 10f64.powf(-decades);
            let grid = Grid { columns: 4, rows: 3, width, height, diagonals: Diagonals::Forward };
            let error = grid.mesh().err();
            row.holds(matches!(error, Some(Error::ZeroArea { .. })), || {
                format!("{width:e} × {height:e}: {error:?}")
            })
        },
    ));
    rows
}

/// A grid with its border held by an affine map and free inner nodes. Equally stiff in both directions, so that only
/// the cells make the problem ill-conditioned.
fn slender(row: &mut Row, model: Model, [width, height]: [f64; 2], [weft, shear, warp]: [f64; 3]) -> bool {
    let mesh = Grid { columns: 5, rows: 5, width, height, diagonals: Diagonals::Alternating }.mesh().unwrap();
    let curves: Vec<_> = MEMBRANE.map(|component| (component, 300.0)).into();
    let mut sample = Sample::at_rest(mesh, model, samples::linear_curves(model, &curves).unwrap());
    sample.planar = true;
    let border = |c: f64, side: f64| c == 0.0 || c > 0.999 * side;
    sample.hold(|p| (border(p.x, width) || border(p.y, height)).then_some(0));
    // Without rotating the long side: its rounding would move the short one.
    sample.place(|p| {
        let [u, v] = if width > height { [p.x + shear * p.y, warp * p.y] } else { [p.x, p.y + shear * p.x] };
        let [stretch_u, stretch_v] = if width > height { [weft, 1.0] } else { [weft, warp] };
        Vector3::new(stretch_u * u, stretch_v * v, 0.0)
    });
    let exact = sample.start.clone();
    sample.perturb(1e-3 * width.min(height));
    let cloth = sample.cloth().unwrap();
    let settings = Settings { tolerance: Tolerance::Relative(1e-9), ..Settings::default() };
    let found = Solver::new(&cloth).solve(&sample.curves, &mut sample.start, &settings);
    row.iterations = row.iterations.max(found.iterations);
    let error = sample.start.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, larger);
    let input = || format!("{width:e} × {height:e}, {weft}, {shear}, {warp}: {found:?}");
    if !found.converged() {
        return row.holds(false, input);
    }
    row.by_rounding += u64::from(found.limit == Limit::Rounding);
    row.measure(error / width.max(height), input)
}

/// Forces are invariant under any rotation and a translation by a metre or a kilometre.
pub(crate) fn case_12(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for model in Model::ALL {
        for (distance, limit) in [(0.0, 1e-9), (1.0, 1e-9), (1e3, 1e-6)] {
            let row = Row::measured(12, format!("{model}, moved by {distance} m"), "change of force", limit);
            let inputs =
                (prop::array::uniform3(-PI..PI), prop::array::uniform3(-1.0..1.0), -3.0..9.0, 0.0..0.3);
            rows.push(for_all(
                row,
                extent.runs(200, 10_000),
                inputs,
                |row, (turn, way, ratio, jitter): (_, [f64; 3], f64, f64)| {
                    let way = Vector3::from(way) * distance;
                    moved(row, model, Vector3::from(turn), way, (10f64.powf(ratio), jitter))
                },
            ));
        }
    }
    rows
}

/// * `ratio` — membrane stiffness times side squared over bending stiffness
fn moved(
    row: &mut Row,
    model: Model,
    turn: Vector3<f64>,
    way: Vector3<f64>,
    (ratio, jitter): (f64, f64),
) -> bool {
    let bend = 300.0 * SIDE * SIDE / ratio;
    let curves = samples::fabric(model, [300.0, 30.0, bend]).unwrap();
    let mut sample = Sample::at_rest(samples::square(5, Diagonals::Alternating).unwrap(), model, curves);
    sample.hold(|p| (p.x == 0.0).then_some(0));
    sample.place(|p| Vector3::new(1.1 * p.x + 0.1 * p.y, 0.95 * p.y, 0.3 * (p.x / SIDE).sin() * p.y));
    sample.perturb(jitter * 0.25 * SIDE);
    let cloth = sample.cloth().unwrap();
    let (before, scale) = balance::forces(&cloth, &sample.curves, &sample.start);
    let rotation = Rotation3::new(turn);
    sample.place(|p| rotation * p + way);
    let (after, _) = balance::forces(&cloth, &sample.curves, &sample.start);
    let largest = scale.magnitude.iter().copied().fold(0.0, larger);
    let change = before.iter().zip(&after).map(|(b, a)| (rotation * b - a).norm()).fold(0.0, larger);
    row.measure(change / largest, || format!("{turn:?}, {way:?}, ratio {ratio:e}, jitter {jitter}"))
}
