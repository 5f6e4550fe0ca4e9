//! What acts on the cloth from outside: its weight, and the clips and tables that hold it.

use crate::mesh::Mesh;

/// A node that is held at a prescribed place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Held {
    /// Node index.
    pub node: usize,
    /// The clip that holds it, whose force is wanted; `None` for a table or a nail.
    pub clip: Option<usize>,
}

/// Lumped masses, kg: a third of every triangle's mass to each of its vertices.
///
/// * `areal_density` — kg/m²
///
/// Source: Strohkorb 2019, §3.1.
pub fn lumped_masses(mesh: &Mesh, areal_density: f64) -> Vec<f64> {
    let mut masses = vec![0.0; mesh.len()];
    for (triangle, nodes) in mesh.triangles.iter().enumerate() {
        for &node in nodes {
            masses[node] += areal_density * 0.5 * mesh.double_area(triangle) / 3.0;
        }
    }
    masses
}
