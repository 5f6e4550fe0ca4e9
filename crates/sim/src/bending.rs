//! Out-of-plane energy.

mod discrete_shell;

pub use discrete_shell::{HINGE_STRAIN_PER_CURVATURE, Hinge};

use crate::error::Result;
use crate::material::{Component, Model};
use crate::membrane::{Spring, ring_two};
use crate::mesh::Mesh;

/// The bending elements.
#[derive(Debug, Clone, PartialEq)]
pub enum Bending {
    /// Ring-2 springs. They have no stiffness against bending where the cloth is flat.
    Springs(Vec<Spring>),
    /// Discrete-shell hinges.
    DiscreteShells(Vec<Hinge>),
}

impl Bending {
    /// The elements that the given components need; `None` if none of them is a bending component.
    ///
    /// # Errors
    /// Springs on a mesh that is no regular grid; a hinge with a collapsed wing.
    pub fn new(model: Model, mesh: &Mesh, components: &[Component]) -> Result<Option<Self>> {
        if !components.iter().any(|component| component.is_bending()) {
            return Ok(None);
        }
        Ok(Some(match model {
            Model::Springs => Self::Springs(ring_two(mesh, components)?),
            Model::SoftConstraint | Model::Stvk => {
                let hinges = Hinge::all(mesh)?;
                Self::DiscreteShells(
                    hinges.into_iter().filter(|h| components.contains(&h.component)).collect(),
                )
            }
        }))
    }
}
