//! Out-of-plane energy.

mod discrete_shell;

pub use discrete_shell::Hinge;

use crate::element::Pass;
use crate::error::Result;
use crate::material::{Component, Model};
use crate::membrane::{Spring, ring_two};
use crate::mesh::Mesh;
use crate::strain_measure::HINGE_STRAIN_PER_CURVATURE;

/// The bending elements.
#[derive(Debug, Clone, PartialEq)]
pub enum Bending {
    /// Ring-2 springs. They have no stiffness against bending where the cloth is flat.
    Springs(Vec<Spring>),
    /// Discrete-shell hinges.
    DiscreteShells(Vec<Hinge>),
}

/// What a component's elements are to a sheet that is rolled to a cylinder across them: the way from a model's own strain
/// and stress to curvature and moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rolled {
    /// Hinges along the lines of a regular grid: [`HINGE_STRAIN_PER_CURVATURE`]; the moment is the stress.
    Hinges,
    /// Ring-2 springs over two segments of this length, m, which bear this share of the cloth; read at the size of their
    /// strain.
    Springs {
        /// Length of a segment, m.
        segment: f64,
        /// Share of the cloth.
        share: f64,
    },
}

impl Rolled {
    /// The size of the strain at a curvature, 1/m.
    pub fn strain(self, curvature: f64) -> f64 {
        match self {
            Self::Hinges => HINGE_STRAIN_PER_CURVATURE * curvature,
            Self::Springs { segment, .. } => 2.0 * (0.25 * curvature * segment).sin().powi(2),
        }
    }

    /// The curvature, 1/m, at a size of the strain.
    pub fn curvature(self, strain: f64) -> f64 {
        match self {
            Self::Hinges => strain / HINGE_STRAIN_PER_CURVATURE,
            Self::Springs { segment, .. } => 4.0 / segment * (0.5 * strain).clamp(0.0, 1.0).sqrt().asin(),
        }
    }

    /// Moment per width over stress at a curvature: m for springs, 1 for hinges.
    pub fn lever(self, curvature: f64) -> f64 {
        match self {
            Self::Hinges => 1.0,
            Self::Springs { segment, share } => share * 0.5 * segment * (0.5 * curvature * segment).sin(),
        }
    }
}

impl Bending {
    /// A pass over the elements.
    pub(crate) fn visit(&self, pass: &mut impl Pass) {
        match self {
            Self::Springs(elements) => pass.visit::<2, 3, 1, _>(1, elements),
            Self::DiscreteShells(elements) => pass.visit::<4, 3, 1, _>(1, elements),
        }
    }

    /// What a component's elements are to a rolled sheet; `None` if there are none.
    pub fn rolled(&self, component: Component) -> Option<Rolled> {
        match self {
            Self::DiscreteShells(hinges) => {
                hinges.iter().any(|hinge| hinge.component == component).then_some(Rolled::Hinges)
            }
            // Both families along neither yarn share the cloth, and a roll bends one of them.
            Self::Springs(springs) => {
                springs.iter().find(|spring| spring.component == component).map(|spring| Rolled::Springs {
                    segment: 0.5 * spring.rest_length,
                    share: if component == Component::BendDiagonal { 0.5 } else { 1.0 },
                })
            }
        }
    }

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
