//! Descent of sheets to rest.
//!
//! ```text
//!   ├──────────┐  flat       a sheet of 0.1 m clamped along one edge, level at first
//!   │╲                       passes  energy falls from step to step, the end is a stable equilibrium,
//!   │ ╲__  at rest           and one that starts there stays
//! ```

#![allow(clippy::unwrap_used)]

use cloth_sim::descent::{Settings, descend};
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::{Diagonals, Grid};
use cloth_sim::samples::{SIDE, Sample, linear_curves};
use nalgebra::Vector3;

fn level_sheet() -> Sample {
    let grid = Grid { columns: 9, rows: 9, width: SIDE, height: SIDE, diagonals: Diagonals::Alternating };
    let stiffnesses =
        Component::ALL.map(|component| (component, if component.is_bending() { 1e-7 } else { 500.0 }));
    let curves = linear_curves(Model::STVK, &stiffnesses).unwrap();
    let sample = Sample::at_rest(grid.mesh().unwrap(), Model::STVK, curves);
    let mut sample = Sample { gravity: Vector3::new(0.0, 0.0, -9.81), ..sample };
    sample.hold(|p| (p.x == 0.0).then_some(0));
    sample
}

#[test]
fn a_limp_sheet_sinks_to_where_it_hangs_and_stays_there() {
    let sample = level_sheet();
    let cloth = sample.cloth().unwrap();
    let mut x = sample.start.clone();
    let mut ways = Vec::new();
    let before = cloth.energy(&sample.curves, &x);
    let found =
        descend(&cloth, &sample.curves, &mut x, &Settings::default(), &mut |_, way| ways.push(way)).unwrap();
    assert!(found.equilibrium.converged() && found.steps == ways.len() && found.steps > 10, "{found:?}");
    let energy = cloth.energy(&sample.curves, &x);
    assert!(energy < before && (energy - found.equilibrium.energy).abs() < 1e-12 * energy.abs());
    // It hangs nearly straight down.
    let lowest = x.chunks_exact(3).map(|node| node[2]).fold(f64::MAX, f64::min);
    assert!((-1.001 * SIDE..-0.9 * SIDE).contains(&lowest), "{lowest}");
    let rest = x.clone();
    let again = descend(&cloth, &sample.curves, &mut x, &Settings::default(), &mut |_, _| ()).unwrap();
    let moved = x.iter().zip(&rest).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(again.equilibrium.converged() && moved < 1e-6, "{again:?}: {moved:e}");
}

#[test]
fn too_few_steps_end_where_the_solve_ends_and_bad_settings_are_refused() {
    let sample = level_sheet();
    let cloth = sample.cloth().unwrap();
    let few = Settings { max_steps: 3, ..Settings::default() };
    let mut x = sample.start.clone();
    let found = descend(&cloth, &sample.curves, &mut x, &few, &mut |_, _| ()).unwrap();
    assert!(found.steps == 3 && x.iter().all(|c| c.is_finite()), "{found:?}");
    let wrong = Settings { step: f64::NAN, ..Settings::default() };
    assert!(descend(&cloth, &sample.curves, &mut x, &wrong, &mut |_, _| ()).is_err());
}
