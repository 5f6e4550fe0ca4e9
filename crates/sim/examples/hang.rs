//! A square of cloth hanging from two corners: `cargo run -p cloth-sim --example hang`.
#![allow(clippy::print_stdout)]

use cloth_sim::cloth::{Cloth, Problem};
use cloth_sim::equilibrium::{Settings, Solver};
use cloth_sim::error::Result;
use cloth_sim::load::Held;
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::{Diagonals, Grid};
use cloth_sim::nalgebra::Vector3;
use cloth_sim::samples::{GRAVITY, fabric};

fn main() -> Result<()> {
    let grid = Grid { columns: 21, rows: 21, width: 0.3, height: 0.3, diagonals: Diagonals::Alternating };
    let mesh = grid.mesh()?;
    let curves = fabric(Model::STVK, [300.0, 30.0, 1e-5])?;
    let held = [0, 20].map(|column| Held { node: grid.node(column, 20), clip: None });
    let (areal_density, gravity) = (0.2, Vector3::new(0.0, -GRAVITY, 0.0));
    let sheet = Problem::new(&mesh, Model::STVK, &Component::ALL);
    let cloth = Cloth::new(&Problem { areal_density, gravity, held: &held, ..sheet })?;
    let mut x = mesh.coordinates();
    let found = Solver::new(&cloth).solve(&curves, &mut x, &Settings::default());
    let sag = 0.3 - x[3 * grid.node(10, 20) + 1];
    println!("{}: between its corners the sheet sags by {:.2} mm", found.status, 1e3 * sag);
    Ok(())
}

#[test]
fn runs() {
    main().expect("a sheet with two corners held");
}
