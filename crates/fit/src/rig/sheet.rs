//! The sheet that is measured: a rectangle with its yarns, somewhere in space, and regular grids over it.

use crate::error::{Error, Result};
use crate::frame::MeshPoint;
use cloth_sim::mesh::{Diagonals, Grid, Mesh};
use nalgebra::{Isometry3, Rotation2, Vector2, Vector3};

/// A rectangle of cloth at rest. Its own coordinates run from 0 along its sides.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sheet {
    /// Extents, m.
    pub(super) size: [f64; 2],
    /// Turns the sheet's coordinates into material ones: by 45° on a sheet cut on the bias.
    pub(super) yarns: Rotation2<f64>,
    /// Turns the sheet's coordinates into world ones.
    pub(super) place: Isometry3<f64>,
}

impl Sheet {
    /// A sheet cut along the yarns, in the plane z = 0 with weft along x.
    pub(super) fn straight(size: [f64; 2]) -> Self {
        Self { size, yarns: Rotation2::identity(), place: Isometry3::identity() }
    }

    /// A regular grid over the sheet.
    pub(super) fn grid(&self, [columns, rows]: [usize; 2], diagonals: Diagonals) -> Grid {
        let [width, height] = self.size;
        Grid { columns, rows, width, height, diagonals }
    }

    /// The mesh of a grid over the sheet, in world coordinates.
    pub(super) fn mesh(&self, grid: Grid) -> Result<Mesh> {
        let mechanics = |source| Error::Mechanics { context: "rig, mesh".into(), source };
        let mut mesh = grid.mesh().map_err(mechanics)?;
        mesh.positions.iter_mut().for_each(|p| *p = self.at(p));
        mesh.material.iter_mut().for_each(|m| *m = self.yarns * *m);
        let checked = Mesh::new(mesh.positions, mesh.material, mesh.triangles).map_err(mechanics)?;
        Ok(Mesh { grid: Some(grid), ..checked })
    }

    /// World coordinates of a point given in the sheet's own.
    pub(super) fn at(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.place.rotation * point + self.place.translation.vector
    }

    /// The sheet's own coordinates of a point at rest, for a mesh's material coordinates.
    pub(super) fn own(&self, material: &Vector2<f64>) -> Vector2<f64> {
        self.yarns.inverse() * material
    }

    /// Where a vertex lies in the mesh of a grid.
    ///
    /// * `material` — the vertex's material coordinates, m
    pub(super) fn locate(&self, grid: &Grid, material: &Vector2<f64>) -> MeshPoint {
        let [dx, dy] = grid.cell();
        let own = self.own(material);
        let cell = |p: f64, count: usize| (p.max(0.0) as usize).min(count - 2);
        let (x, y) = (own.x / dx, own.y / dy);
        let (column, row) = (cell(x, grid.columns), cell(y, grid.rows));
        let (s, t) = (x - column as f64, y - row as f64);
        let first = 2 * (row * (grid.columns - 1) + column);
        let second = first + 1;
        // The corners of a cell are low, right, up and high: Grid::mesh.
        match (grid.is_forward(column, row), s >= t, s + t <= 1.0) {
            (true, true, _) => MeshPoint { triangle: first, weights: [1.0 - s, s - t, t] },
            (true, false, _) => MeshPoint { triangle: second, weights: [1.0 - t, s, t - s] },
            (false, _, true) => MeshPoint { triangle: first, weights: [1.0 - s - t, s, t] },
            (false, _, false) => MeshPoint { triangle: second, weights: [1.0 - t, s + t - 1.0, 1.0 - s] },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_vertex_is_found_where_it_lies() {
        let sheet = Sheet { yarns: Rotation2::new(0.3), ..Sheet::straight([0.1, 0.07]) };
        let seen = sheet.mesh(sheet.grid([13, 9], Diagonals::Forward)).unwrap();
        for diagonals in [Diagonals::Forward, Diagonals::Backward, Diagonals::Alternating] {
            let grid = sheet.grid([6, 5], diagonals);
            let mesh = sheet.mesh(grid).unwrap();
            for (position, material) in seen.positions.iter().zip(&seen.material) {
                let point = sheet.locate(&grid, material);
                assert!(point.weights.iter().all(|&weight| weight > -1e-12));
                assert!((point.interpolate(&mesh, &mesh.positions) - position).norm() < 1e-9);
            }
        }
    }
}
