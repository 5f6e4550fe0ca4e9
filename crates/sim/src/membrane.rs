//! In-plane energy: three strain measures that share the same curves.

mod soft_constraint;
mod spring;
mod stvk;
mod triangle;

pub use soft_constraint::SoftTriangle;
pub(crate) use spring::{Direction, direction_of};
pub use spring::{Spring, ring_one, ring_two};
pub use stvk::StvkTriangle;
pub use triangle::Triangle;

use crate::element::{Change, Pass};
use crate::error::Result;
use crate::material::{Component, MembraneModel, Model};
use crate::mesh::Mesh;

/// Membrane elements.
#[derive(Debug, Clone, PartialEq)]
pub enum Membrane {
    /// Ring-1 springs.
    Springs(Vec<Spring>),
    /// Soft-constraint triangles.
    SoftConstraint(Vec<SoftTriangle>),
    /// Diagonalised StVK triangles.
    Stvk(Vec<StvkTriangle>),
}

impl Membrane {
    /// Elements for the given components on a mesh; a spring model without shear gets no diagonals.
    ///
    /// # Errors
    /// Springs on a mesh that is not a regular grid.
    pub fn new(model: Model, mesh: &Mesh, components: &[Component]) -> Result<Self> {
        let triangles = || (0..mesh.triangles.len()).map(|triangle| Triangle::new(mesh, triangle));
        Ok(match model.membrane {
            MembraneModel::Springs => Self::Springs(ring_one(mesh, components)?),
            MembraneModel::SoftConstraint => Self::SoftConstraint(triangles().map(SoftTriangle).collect()),
            MembraneModel::Stvk => Self::Stvk(triangles().map(StvkTriangle).collect()),
        })
    }

    /// Changes the list of elements.
    pub(crate) fn change(&mut self, change: &mut impl Change) {
        match self {
            Self::Springs(elements) => change.change::<2, 1, _>(elements),
            Self::SoftConstraint(elements) => change.change::<3, 3, _>(elements),
            Self::Stvk(elements) => change.change::<3, 3, _>(elements),
        }
    }

    /// Runs a pass over the elements, in the plane or in space.
    pub(crate) fn visit(&self, planar: bool, pass: &mut impl Pass) {
        match (self, planar) {
            (Self::Springs(elements), true) => pass.visit::<2, 2, 1, _>(0, elements),
            (Self::Springs(elements), false) => pass.visit::<2, 3, 1, _>(0, elements),
            (Self::SoftConstraint(elements), true) => pass.visit::<3, 2, 3, _>(0, elements),
            (Self::SoftConstraint(elements), false) => pass.visit::<3, 3, 3, _>(0, elements),
            (Self::Stvk(elements), true) => pass.visit::<3, 2, 3, _>(0, elements),
            (Self::Stvk(elements), false) => pass.visit::<3, 3, 3, _>(0, elements),
        }
    }
}
