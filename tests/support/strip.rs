//! A strip of cloth with node columns at given positions, for beams, chains and hanging strips.

use cloth_sim::cloth::Cloth;
use cloth_sim::material::Component;
use cloth_sim::mesh::Mesh;
use cloth_sim::samples::Sample;
use nalgebra::{Vector2, Vector3};

/// A flat strip in the plane z = 0: its length along x and weft, its width along y and warp.
///
/// ```text
///  rows ─ 1 ┬──┬──┬──┐
///           │╱ │ ╲│╱ │        node (column, row) has index column · rows + row
///         0 └──┴──┴──┘
///           columns
/// ```
///
/// * `columns` — positions of the node columns along x, ascending, m
/// * `width` — m
/// * `rows` — number of node rows, at least 2
///
/// # Panics
/// If the arguments do not form a mesh.
pub fn strip(columns: &[f64], width: f64, rows: usize) -> Mesh {
    let places = columns
        .iter()
        .flat_map(|&x| (0..rows).map(move |row| Vector2::new(x, width * row as f64 / (rows - 1) as f64)));
    let material: Vec<Vector2<f64>> = places.collect();
    let positions: Vec<Vector3<f64>> = material.iter().map(|m| m.push(0.0)).collect();
    let mut triangles = Vec::new();
    for column in 0..columns.len() - 1 {
        for row in 0..rows - 1 {
            let low = column * rows + row;
            let [up, right, high] = [low + 1, low + rows, low + rows + 1];
            if (column + row) % 2 == 0 {
                triangles.extend([[low, right, high], [low, high, up]]);
            } else {
                triangles.extend([[low, right, up], [right, high, up]]);
            }
        }
    }
    Mesh::new(positions, material, triangles).expect("a proper strip")
}

/// Columns of a beam clamped at 0: equal cells up to `length`, and behind the clamp a cell so thin that the hinges at
/// the clamp represent half a cell.
///
/// ```text
///  D/k of a hinge is the mean of its two cells' widths: (0 + Δ)/2
/// ```
pub fn beam(length: f64, cells: usize) -> Vec<f64> {
    let cell = length / cells as f64;
    std::iter::once(-1e-3 * cell).chain((0..=cells).map(|i| cell * i as f64)).collect()
}

/// The cloth of a strip with rigid node columns: it rolls up without twisting.
///
/// A free strip of hinges folds its diagonals in turn and is about a fifth softer than the cylinder.
///
/// # Panics
/// If the sample is not a valid problem.
pub fn rolled(sample: &Sample, rows: usize) -> Cloth {
    let held = |node: &usize| sample.held.iter().any(|held| held.node == *node);
    let columns = (0..sample.mesh.len() / rows).map(|column| (column * rows..(column + 1) * rows).collect());
    let free: Vec<Vec<usize>> = columns.filter(|nodes: &Vec<usize>| !nodes.iter().any(held)).collect();
    let components: Vec<Component> = sample.curves.components().collect();
    Cloth::new(&sample.problem(&components, &free)).expect("columns that are held or free")
}
