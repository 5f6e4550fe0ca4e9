//! The measured sheet: a rectangle with yarn directions and a position in space, and regular grids on it.

use crate::error::{Error, Result};
use cloth_sim::mesh::{Diagonals, Grid, Mesh};
use nalgebra::{Isometry3, Rotation2, Vector2, Vector3};

/// A rectangle of cloth at rest. Its local coordinates start at 0 along both sides.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sheet {
    /// Extents, m.
    pub(super) size: [f64; 2],
    /// Rotates sheet coordinates into material coordinates: by 45° for a sheet cut on the bias.
    pub(super) yarns: Rotation2<f64>,
    /// Maps sheet coordinates to world coordinates.
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

    /// World coordinates of a point in sheet coordinates.
    pub(super) fn at(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.place.rotation * point + self.place.translation.vector
    }

    /// Sheet coordinates of a rest point given in material coordinates.
    pub(super) fn own(&self, material: &Vector2<f64>) -> Vector2<f64> {
        self.yarns.inverse() * material
    }
}
