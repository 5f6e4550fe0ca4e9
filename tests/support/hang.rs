//! The wool sheet of 10 m × 10 m hung from two corners by Strohkorb 2019.

use crate::{data, rows};
use cloth_data::io::{YarnAxes, read_mesh};
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::load::Held;
use cloth_sim::material::{Component, Compression, Curves, Model};
use cloth_sim::samples::Sample;
use nalgebra::Vector3;

/// The sheet at rest, y up; weft and warp carry tension only, and bending has no stiffness.
///
/// * `planar` — restricts motion to planes z = const
///
/// # Panics
/// If the reference data cannot be read.
pub fn gnatv_hang(planar: bool) -> Sample {
    let axes = YarnAxes { weft: Vector3::x(), warp: Vector3::y() };
    let mesh = read_mesh(&data("gnatv_hang/rest_mesh.obj"), Some(axes)).expect("the sheet at rest");
    let held = [2, 3].map(|node| Held { node, clip: Some(0) }).into();
    let gravity = Vector3::new(0.0, -9.8, 0.0);
    let at_rest = Sample::at_rest(mesh, Model::STVK, wool());
    Sample { areal_density: 0.15, gravity, held, planar, ..at_rest }
}

/// The published stress points of the wool over Green strain, with a spline of the stiffness between them.
fn wool() -> Curves {
    let table = rows("gnatv_wool/stress_strain_as_published.csv");
    let names =
        [("weft", Component::StretchWeft), ("warp", Component::StretchWarp), ("shear", Component::Shear)];
    let curve = |(name, component): (&str, Component)| {
        let number = |field: &str| field.parse::<f64>().expect("a number");
        let points =
            table.iter().filter(|row| row[0] == name).map(|row| [&row[2], &row[3]].map(|f| number(f)));
        let above: Vec<[f64; 2]> = points.filter(|[strain, _]| *strain > 1e-9).collect();
        let secants: Vec<f64> = above.iter().map(|[strain, stress]| stress / strain).collect();
        let strains = std::iter::once(0.0).chain(above.iter().map(|point| point[0])).collect();
        let stiffnesses = std::iter::once(secants[0]).chain(secants.iter().copied()).collect();
        let negative = Model::STVK.negative_strain(component, Compression::None);
        (component, StiffnessCurve::new(strains, stiffnesses, negative).expect("a curve"))
    };
    names.into_iter().map(curve).collect()
}
