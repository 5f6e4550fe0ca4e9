//! Cases 20, 21, 23, 24, 26 and 27: equilibria that do not exist, are not unique, or are far from the start.

use crate::balance::{self, larger};
use crate::property::for_all;
use crate::table::{Extent, Row};
use cloth_sim::cloth::Cloth;
use cloth_sim::equilibrium::{Method, Settings, Solver, Status, Tolerance};
use cloth_sim::error::{Error, Part};
use cloth_sim::load::{Free, Guided};
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::{Diagonals, Grid};
use cloth_sim::samples::{self, GRAVITY, SIDE, Sample};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;

/// A rectangular sheet of 1 mm to 10 m; membrane and bending stiffness scale with its size so that it is the same
/// cloth.
fn sheet(model: Model, nodes: usize, size: f64, stretch: f64, ratio: f64) -> Sample {
    let diagonals = Diagonals::Alternating;
    let mesh = Grid { columns: nodes, rows: nodes, width: size, height: size, diagonals }.mesh().unwrap();
    let bend = stretch / ratio * if model == Model::SPRINGS { 1.0 } else { size * size };
    Sample::at_rest(mesh, model, samples::fabric(model, [stretch, 0.1 * stretch, bend]).unwrap())
}

/// No node held, or too few.
pub(crate) fn case_20(extent: Extent) -> Vec<Row> {
    let ways = ["nothing held", "one node on a plane", "one node on a line"];
    let rows = Model::ALL.into_iter().flat_map(|model| ways.map(|way| (model, way)));
    rows.map(|(model, way)| {
        let row = Row::new(20, format!("{model}, {way}: 6 rigid motions free"));
        let inputs = (2..7usize, -3.0..1.0, prop::array::uniform3(0.1..1.0));
        for_all(row, extent.runs(50, 2_000), inputs, |row, (nodes, size, along): (usize, f64, [f64; 3])| {
            let mut sample = sheet(model, nodes, 10f64.powf(size), 300.0, 1e6);
            let along = Vector3::from(along);
            let guided = match way {
                "one node on a plane" => Some(Free::Plane(along)),
                "one node on a line" => Some(Free::Line(along)),
                _ => None,
            };
            sample.guided = guided.map(|free| Guided { node: nodes, free }).into_iter().collect();
            let error = sample.cloth().err();
            let said = error.as_ref().is_some_and(|error| error.to_string().contains("6 rigid motions free"));
            let parts = vec![Part { vertex: 0, vertices: nodes * nodes }];
            let named = error == Some(Error::Unpinned { parts, free: 6 });
            row.holds(named && said, || format!("{nodes}, {size}, {along}: {error:?}"))
        })
    })
    .collect()
}

/// A flat sheet in compression is balanced but unstable; it buckles symmetrically to either side.
pub(crate) fn case_21(extent: Extent) -> Vec<Row> {
    let models = [Model::STVK, Model::SOFT_CONSTRAINT];
    let states = models.into_iter().flat_map(|model| [0.01, 0.03, 0.1].map(|short| (model, short)));
    let mut rows = Vec::new();
    for (model, short) in states {
        let inputs = (-3.0..9.0, 4.0..7.0);
        let row = Row::new(21, format!("{model}, flat, {:.0} % shorter: unstable, as it is", 100.0 * short));
        rows.push(for_all(row, extent.runs(5, 200), inputs.clone(), |row, (stretch, ratio): (f64, f64)| {
            let sample = compressed(model, short, 10f64.powf(stretch), 10f64.powf(ratio));
            let cloth = sample.cloth().unwrap();
            let mut x = sample.start.clone();
            let stay = Settings { escape: false, ..Settings::default() };
            let found = Solver::new(&cloth).solve(&sample.curves, &mut x, &stay);
            let holds = found.status == Status::Unstable && found.iterations == 0 && x == sample.start;
            row.holds(holds, || format!("k = 1e{stretch:.2} N/m, ratio 1e{ratio:.2}: {found:?}"))
        }));
        let row = balance::row(21, format!("{model}, flat, {:.0} % shorter: both branches", 100.0 * short));
        rows.push(for_all(row, extent.runs(3, 100), inputs, |row, (stretch, ratio): (f64, f64)| {
            let sample = compressed(model, short, 10f64.powf(stretch), 10f64.powf(ratio));
            branches(row, &sample, &format!("k = 1e{stretch:.2} N/m, ratio 1e{ratio:.2}"))
        }));
    }
    rows
}

fn compressed(model: Model, short: f64, stretch: f64, ratio: f64) -> Sample {
    let mut sample = sheet(model, 9, SIDE, stretch, ratio);
    sample.hold(|p| if p.x == 0.0 { Some(0) } else { (p.x > 0.999 * SIDE).then_some(1) });
    sample.place(|p| Vector3::new((1.0 - short) * p.x, p.y, p.z));
    sample
}

/// The solver leaves the flat state by itself; starts on either side of it end in mirrored states.
fn branches(row: &mut Row, sample: &Sample, input: &str) -> bool {
    let settings = Settings { tolerance: Tolerance::Relative(1e-9), ..Settings::default() };
    let cloth = sample.cloth().unwrap();
    let mut solver = Solver::new(&cloth);
    let mut x = sample.start.clone();
    let left = solver.solve(&sample.curves, &mut x, &settings);
    let mirrored = |x: &[f64]| -> Vec<f64> {
        x.iter().enumerate().map(|(i, c)| if i % 3 == 2 { -c } else { *c }).collect()
    };
    let mut up = sample.start.clone();
    up.iter_mut().zip(&x).for_each(|(start, x)| *start += 0.1 * (x - *start));
    let mut down = mirrored(&up);
    let [upper, lower] = [&mut up, &mut down].map(|x| solver.solve(&sample.curves, x, &settings));
    let apart = up.iter().zip(mirrored(&down)).map(|(a, b)| (a - b).abs()).fold(0.0, larger);
    let alike = lower.converged()
        && left.converged()
        && left.escaped
        && (upper.energy / lower.energy - 1.0).abs() < 1e-9
        && apart < 1e-6 * SIDE;
    let also = if alike { Ok(()) } else { Err(format!("{left:?}, {upper:?}, {lower:?}, {apart:e} m apart")) };
    balance::judge(row, &cloth, sample, &up, &upper, also, input)
}

/// Ring-2 springs have no stiffness at flat: without a load this is reported, with a load the sheet finds its shape.
pub(crate) fn case_23(extent: Extent) -> Vec<Row> {
    let loads = [0.0, 1e-3, 1.0, 1e2, 1e4];
    loads
        .map(|load| {
            let inputs = (2..6u8, 0.0..6.0, 0.0..1e-4);
            if load == 0.0 {
                let row = Row::new(23, "flat, no load: balanced, said to be unstable");
                return for_all(
                    row,
                    extent.runs(20, 500),
                    inputs,
                    |row, (stretch, ratio, _): (u8, f64, _)| {
                        let sample = clamped(10f64.powi(stretch.into()), 10f64.powf(ratio));
                        let cloth = sample.cloth().unwrap();
                        let mut x = sample.start.clone();
                        let found = Solver::new(&cloth).solve(&sample.curves, &mut x, &Settings::default());
                        let holds = found.status == Status::Unstable && x.iter().all(|x| x.is_finite());
                        row.holds(holds, || format!("1e{stretch} N/m, ratio 1e{ratio:.2}: {found:?}"))
                    },
                );
            }
            let row = balance::row(23, format!("flat, {load} g across the sheet, at most 1000 iterations"));
            for_all(row, extent.runs(3, 100), inputs, |row, (stretch, ratio, perturbed): (u8, f64, f64)| {
                let mut sample = clamped(10f64.powi(stretch.into()), 10f64.powf(ratio));
                sample.gravity = Vector3::new(0.0, 0.0, -load * GRAVITY);
                sample.perturb(perturbed);
                let input = format!("1e{stretch} N/m, ratio 1e{ratio:.2}, perturbed by {perturbed:.1e} m");
                balance::solve(
                    row,
                    &sample,
                    &Settings { max_iterations: 1_000, ..Settings::default() },
                    &input,
                )
                .0
            })
        })
        .into()
}

/// A flat sheet of springs, clamped along its first two columns.
fn clamped(stretch: f64, ratio: f64) -> Sample {
    let mut sample = sheet(Model::SPRINGS, 9, SIDE, stretch, ratio);
    sample.hold(|p| (p.x < 1.5 * SIDE / 8.0).then_some(0));
    sample
}

/// A clip jumps by half the sheet's length in one frame, along, across and obliquely: load steps follow it.
pub(crate) fn case_24(extent: Extent) -> Vec<Row> {
    let ways =
        [("along", [0.5, 0.0, 0.0]), ("aslant", [0.4, 0.3, 0.0]), ("out of the plane", [0.3, 0.1, 0.4])];
    let mut rows = Vec::new();
    for model in Model::ALL {
        for (name, way) in ways {
            for (space, planar) in [("in the plane", true), ("in space", false)] {
                if planar && way[2] != 0.0 {
                    continue;
                }
                let row = balance::row(24, format!("{model}, {space}, {name}"));
                // In space, softer sheets are stretched by their weight alone.
                let softest = if planar { -1.0 } else { 1.0 };
                let inputs = (softest..6.0, 4.0..9.0);
                rows.push(for_all(row, extent.runs(2, 100), inputs, |row, (stretch, ratio): (f64, f64)| {
                    jumps(row, model, (planar, Vector3::from(way)), 10f64.powf(stretch), 10f64.powf(ratio))
                }));
            }
        }
    }
    rows
}

fn jumps(row: &mut Row, model: Model, (planar, way): (bool, Vector3<f64>), stretch: f64, ratio: f64) -> bool {
    let mut sample = sheet(model, 7, SIDE, stretch, ratio);
    sample.hold(|p| if p.x == 0.0 { Some(0) } else { (p.x > 0.999 * SIDE).then_some(1) });
    if planar {
        let components = [Component::StretchWeft, Component::StretchWarp, Component::Shear];
        let curves: Vec<_> = components.into_iter().zip([stretch, stretch, 0.1 * stretch]).collect();
        sample.curves = samples::linear_curves(model, &curves).unwrap();
        sample.planar = true;
    } else {
        sample.gravity = Vector3::new(0.0, 0.0, -GRAVITY);
        // A small irregularity, or springs would stay flat.
        sample.place(|p| Vector3::new(1.001 * p.x, p.y, p.z));
    }
    sample.perturb(1e-5);
    let cloth = sample.cloth().unwrap();
    let mut solver = Solver::new(&cloth);
    let mut x = sample.start.clone();
    let before = solver.solve(&sample.curves, &mut x, &Settings::default());
    let mut target = x.clone();
    for node in sample.held.iter().filter(|held| held.clip == Some(1)).map(|held| held.node) {
        (0..3).for_each(|i| target[3 * node + i] += SIDE * way[i]);
    }
    let found = solver.load_steps(&sample.curves, &mut x, &target, &Settings::default());
    let there =
        sample.held.iter().all(|held| (0..3).all(|i| x[3 * held.node + i] == target[3 * held.node + i]));
    let also = if there { Ok(()) } else { Err(format!("not there; before: {before:?}")) };
    let input = format!("k = {stretch:.2e} N/m, ratio {ratio:.2e}, {way:?}");
    balance::judge(row, &cloth, &sample, &x, &found, also, &input)
}

/// No load: no iteration is needed, at any position and size.
pub(crate) fn case_26(extent: Extent) -> Vec<Row> {
    let rows = Model::ALL.into_iter().flat_map(|model| [0.0, 1.0, 1e3].map(|far| (model, far)));
    rows.map(|(model, far)| {
        let row = Row::new(26, format!("{model}, at rest, turned, {far} m away"));
        let turn = prop::array::uniform3(-3.0..3.0);
        let inputs = (-3.0..1.0, -3.0..9.0, 0.0..9.0, turn);
        for_all(
            row,
            extent.runs(20, 1_000),
            inputs,
            |row, (size, stretch, ratio, turn): (f64, f64, f64, _)| {
                let mut sample = sheet(model, 6, 10f64.powf(size), 10f64.powf(stretch), 10f64.powf(ratio));
                // Held along a single line it could swing.
                let clamp = 1.5 * 10f64.powf(size) / 5.0;
                sample.hold(|p| (p.x < clamp).then_some(0));
                let turn = Vector3::from(turn);
                let rotation = Rotation3::new(turn);
                sample.place(|p| rotation * p + turn * far);
                let cloth: Cloth = sample.cloth().unwrap();
                let mut x = sample.start.clone();
                let stay = Settings { escape: false, ..Settings::default() };
                let found = Solver::new(&cloth).solve(&sample.curves, &mut x, &stay);
                // Ring-2 springs have no stiffness at flat; far away, rounding strains decide in all models.
                let balanced = found.converged() || found.status == Status::Unstable;
                let stable = found.converged() || model == Model::SPRINGS || far > 0.0;
                row.holds(balanced && stable && found.iterations == 0 && x == sample.start, || {
                    format!("1e{size:.2} m, 1e{stretch:.2} N/m, ratio 1e{ratio:.2}, {turn:?}: {found:?}")
                })
            },
        )
    })
    .collect()
}

/// Out of iterations: a status, with the best state so far.
pub(crate) fn case_27(extent: Extent) -> Vec<Row> {
    let methods = [Method::MixedNewton, Method::LevenbergMarquardt];
    let rows = Model::ALL.into_iter().flat_map(|model| methods.map(|method| (model, method)));
    rows.map(|(model, method)| {
        let row = Row::new(27, format!("{model}, {method:?}"));
        let inputs = (0..8usize, 1.0..5.0, 1e-2..1e2);
        for_all(row, extent.runs(10, 1_000), inputs, |row, (cap, stretch, gravity): (usize, f64, f64)| {
            let mut sample = samples::cantilever(model, 7, 10f64.powf(stretch)).unwrap();
            sample.gravity *= gravity;
            let cloth = sample.cloth().unwrap();
            let mut solver = Solver::new(&cloth);
            let mut x = sample.start.clone();
            let settings = Settings { method, max_iterations: cap, ..Settings::default() };
            let found = solver.solve(&sample.curves, &mut x, &settings);
            let capped = found.iterations == cap && found.status == Status::IterationLimit;
            let [before, after] = [&sample.start, &x].map(|x| cloth.energy(&sample.curves, x));
            let honest = (after - found.energy).abs() <= 1e-9 * after.abs();
            let finite = x.iter().all(|x| x.is_finite()) && found.imbalance.is_finite();
            let no_worse = after <= before;
            row.holds(found.converged() || capped && finite && honest && no_worse, || {
                format!("{cap}, 1e{stretch:.2} N/m, {gravity:.3} g, {before} J: {found:?}")
            })
        })
    })
    .collect()
}
