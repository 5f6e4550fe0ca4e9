//! Out-of-plane energy.

mod discrete_shell;
mod fold;
mod sheet;

pub use discrete_shell::Hinge;
pub use sheet::{Sheet, SheetEdge, SheetTriangle};

use crate::element::{Change, Element, Pass, gather};
use crate::error::Result;
use crate::material::{BendingModel, Component, Model};
use crate::membrane::{Spring, ring_two};
use crate::mesh::Mesh;
use crate::strain_measure::HINGE_STRAIN_PER_CURVATURE;
use nalgebra::Vector3;

/// The bending elements.
#[derive(Debug, Clone, PartialEq)]
pub enum Bending {
    /// Ring-2 springs. A flat sheet of them has no bending stiffness.
    Springs(Vec<Spring>),
    /// Discrete-shell hinges.
    DiscreteShells(Vec<Hinge>),
    /// Triangles with moment against curvature.
    Sheet(Sheet),
}

/// Converts a bending component's own strain and stress to the curvature and moment of a sheet rolled to a cylinder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rolled {
    /// Curvature and moment themselves.
    Sheet,
    /// Hinges along the lines of a regular grid: [`HINGE_STRAIN_PER_CURVATURE`]; the moment is the stress.
    Hinges,
    /// Ring-2 springs over two segments. Strains are absolute values.
    Springs {
        /// Length of a segment, m.
        segment: f64,
        /// Share of the cloth's area that the springs stand for.
        share: f64,
    },
}

impl Rolled {
    /// Absolute strain at a curvature (1/m).
    pub fn strain(self, curvature: f64) -> f64 {
        match self {
            Self::Sheet => curvature,
            Self::Hinges => HINGE_STRAIN_PER_CURVATURE * curvature,
            Self::Springs { segment, .. } => 2.0 * (0.25 * curvature * segment).sin().powi(2),
        }
    }

    /// Curvature (1/m) at an absolute strain.
    pub fn curvature(self, strain: f64) -> f64 {
        match self {
            Self::Sheet => strain,
            Self::Hinges => strain / HINGE_STRAIN_PER_CURVATURE,
            Self::Springs { segment, .. } => 4.0 / segment * (0.5 * strain).clamp(0.0, 1.0).sqrt().asin(),
        }
    }

    /// Moment per width over stress at a curvature: m for springs, otherwise 1.
    pub fn lever(self, curvature: f64) -> f64 {
        match self {
            Self::Sheet | Self::Hinges => 1.0,
            Self::Springs { segment, share } => share * 0.5 * segment * (0.5 * curvature * segment).sin(),
        }
    }
}

impl Bending {
    /// Changes the list of elements.
    pub(crate) fn change(&mut self, change: &mut impl Change) {
        match self {
            Self::Springs(elements) => change.change::<2, 1, _>(elements),
            Self::DiscreteShells(elements) => change.change::<4, 1, _>(elements),
            Self::Sheet(sheet) => change.change::<7, 4, _>(&mut sheet.triangles),
        }
    }

    /// Runs a pass over the elements.
    pub(crate) fn visit(&self, pass: &mut impl Pass) {
        match self {
            Self::Springs(elements) => pass.visit::<2, 3, 1, _>(1, elements),
            Self::DiscreteShells(elements) => pass.visit::<4, 3, 1, _>(1, elements),
            Self::Sheet(sheet) => pass.visit::<7, 3, 4, _>(1, &sheet.triangles),
        }
    }

    /// Conversion to a rolled sheet for a component; `None` if it has no elements.
    pub fn rolled(&self, component: Component) -> Option<Rolled> {
        match self {
            Self::Sheet(_) => Some(Rolled::Sheet),
            Self::DiscreteShells(hinges) => {
                hinges.iter().any(|hinge| hinge.component == component).then_some(Rolled::Hinges)
            }
            // The two diagonal families share the cloth's area, and a roll bends only one of them.
            Self::Springs(springs) => {
                springs.iter().find(|spring| spring.component == component).map(|spring| Rolled::Springs {
                    segment: 0.5 * spring.rest_length,
                    share: if component == Component::BendDiagonal { 0.5 } else { 1.0 },
                })
            }
        }
    }

    /// Elements for the given components; `None` if none of them is a bending component.
    ///
    /// * `held` — true for nodes at prescribed positions
    /// * `rolls` — the sheet bends as a cylinder along lines of the mesh
    ///
    /// # Errors
    /// Springs on a mesh that is not a regular grid; a hinge with a collapsed wing; a triangle without area.
    pub fn new(
        model: Model,
        mesh: &Mesh,
        components: &[Component],
        held: &[bool],
        rolls: bool,
    ) -> Result<Option<Self>> {
        if !components.iter().any(|component| component.is_bending()) {
            return Ok(None);
        }
        Ok(Some(match model.bending {
            BendingModel::Springs => Self::Springs(ring_two(mesh, components)?),
            BendingModel::Hinges => {
                let hinges = Hinge::all(mesh)?;
                Self::DiscreteShells(
                    hinges.into_iter().filter(|h| components.contains(&h.component)).collect(),
                )
            }
            BendingModel::Sheet => {
                // Where nothing resists one of the curvatures, no edge turns.
                let all = [Component::BendWeft, Component::BendWarp, Component::BendTwist];
                let turns = !rolls && all.iter().all(|component| components.contains(component));
                Self::Sheet(Sheet::new(mesh, held, turns)?)
            }
        }))
    }

    /// Makes the sheet flat at rest.
    pub(crate) fn flatten(&mut self) {
        match self {
            // Their lengths at rest are those of the material.
            Self::Springs(_) => (),
            Self::DiscreteShells(hinges) => hinges.iter_mut().for_each(|hinge| hinge.rest_angle = 0.0),
            Self::Sheet(sheet) => {
                let edges = sheet.triangles.iter_mut().flat_map(|triangle| &mut triangle.edges);
                edges.for_each(|edge| edge.rest_angle = 0.0);
            }
        }
    }

    /// True if an angle changes by more than half a turn between two states, that is, jumps across ±π.
    pub(crate) fn jumps(&self, x: &[f64], to: &[f64]) -> bool {
        match self {
            Self::Springs(_) => false,
            Self::DiscreteShells(hinges) => hinges.iter().any(|hinge| {
                let own = hinge.coordinates();
                hinge.jumps(&gather(own, x), &gather(own, to))
            }),
            Self::Sheet(sheet) => sheet.triangles.iter().any(|triangle| {
                let own = triangle.coordinates;
                triangle.jumps(&gather(own, x), &gather(own, to))
            }),
        }
    }

    /// Middles of the edges whose rotations follow the nodes' coordinates in a state, m.
    pub(crate) fn rotating(&self) -> &[Vector3<f64>] {
        match self {
            Self::Springs(_) | Self::DiscreteShells(_) => &[],
            Self::Sheet(sheet) => &sheet.rotating,
        }
    }
}
