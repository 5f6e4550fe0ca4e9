//! Droop: depth of a sheet below its holds, compared with the same sheet as laid out.

use cloth_sim::mesh::Mesh;
use nalgebra::Vector3;

/// Droop of a hung sheet.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Droop {
    /// Depth of the lowest point below the mean of the held nodes, m.
    pub depth_m: f64,
    /// The depth of the sheet as laid out, m.
    pub flat_depth_m: f64,
    /// `depth_m`/`flat_depth_m` − 1; absent if the sheet was laid out level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
    /// Mean sinking of the nodes that were lowest, m; absent if the sheet was laid out level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bottom_edge_sinks_m: Option<f64>,
    /// Sinking of the middle one of these nodes, m; absent if the sheet was laid out level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bottom_middle_sinks_m: Option<f64>,
}

/// Depths that differ by less than this share of the sheet's size count as equal.
const LEVEL: f64 = 1e-6;

/// Measures the droop of a shape.
///
/// * `mesh` — the sheet as laid out
/// * `held` — held nodes, at least one
/// * `down` — unit vector
pub fn droop(mesh: &Mesh, positions: &[Vector3<f64>], held: &[usize], down: Vector3<f64>) -> Droop {
    let lowest = |p: &[Vector3<f64>]| p.iter().map(|p| p.dot(&down)).fold(f64::MIN, f64::max);
    let middle =
        |p: &[Vector3<f64>]| held.iter().map(|&node| p[node].dot(&down)).sum::<f64>() / held.len() as f64;
    let depth = |p: &[Vector3<f64>]| lowest(p) - middle(p);
    let [depth_m, flat_depth_m] = [depth(positions), depth(&mesh.positions)];
    let size = mesh.positions.iter().map(|p| (p - mesh.positions[0]).norm()).fold(0.0, f64::max);
    let bottom = lowest(&mesh.positions);
    let edge: Vec<usize> =
        (0..mesh.len()).filter(|&node| bottom - mesh.positions[node].dot(&down) < LEVEL * size).collect();
    let sinks = |node: usize| (positions[node] - mesh.positions[node]).dot(&down);
    let hangs = flat_depth_m > LEVEL * size;
    let centre = edge.iter().map(|&node| mesh.positions[node]).sum::<Vector3<f64>>() / edge.len() as f64;
    let from_centre = |&node: &usize| (mesh.positions[node] - centre).norm();
    let nearest = edge.iter().copied().min_by(|a, b| from_centre(a).total_cmp(&from_centre(b)));
    let mean = edge.iter().map(|&node| sinks(node)).sum::<f64>() / edge.len() as f64;
    Droop {
        depth_m,
        flat_depth_m,
        share: hangs.then(|| depth_m / flat_depth_m - 1.0),
        bottom_edge_sinks_m: hangs.then_some(mean),
        bottom_middle_sinks_m: nearest.filter(|_| hangs).map(sinks),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_sim::mesh::{Diagonals, Grid};

    #[test]
    fn a_sheet_that_is_half_as_long_again_droops_by_half() {
        let grid = Grid { columns: 3, rows: 3, width: 2.0, height: 2.0, diagonals: Diagonals::Forward };
        let mesh = grid.mesh().unwrap();
        // Warp points up: the lower rows sink, the middle of the lowest row most.
        let sunk = |p: &Vector3<f64>| {
            p - Vector3::y() * (0.5 * (2.0 - p.y) - if p.x == 1.0 && p.y == 0.0 { -0.5 } else { 0.0 })
        };
        let positions: Vec<_> = mesh.positions.iter().map(sunk).collect();
        let found = droop(&mesh, &positions, &[6, 8], -Vector3::y());
        assert_eq!((found.depth_m, found.flat_depth_m), (3.5, 2.0));
        assert_eq!(found.share, Some(0.75));
        assert_eq!(found.bottom_middle_sinks_m, Some(1.5));
        assert!((found.bottom_edge_sinks_m.unwrap() - 3.5 / 3.0).abs() < 1e-15);
        // A sheet laid out level has no reference depth.
        let level = droop(&mesh, &mesh.positions, &[6, 8], -Vector3::z());
        assert_eq!((level.share, level.depth_m), (None, 0.0));
    }
}
