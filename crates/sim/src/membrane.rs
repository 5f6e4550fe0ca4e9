//! In-plane energy: three strain measures for the same curves.

mod soft_constraint;
mod spring;
mod stvk;

pub use soft_constraint::SoftTriangle;
pub(crate) use spring::{Direction, direction_of};
pub use spring::{Spring, ring_one, ring_two};
pub use stvk::StvkTriangle;

use crate::element::Point;
use crate::error::Result;
use crate::material::{Component, Model};
use crate::mesh::Mesh;

/// The membrane's elements.
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
    /// The elements that the given components need on a mesh: a spring model without shear has no diagonals.
    ///
    /// # Errors
    /// Springs on a mesh that is no regular grid.
    pub fn new(model: Model, mesh: &Mesh, components: &[Component]) -> Result<Self> {
        let triangles = || (0..mesh.triangles.len()).map(|triangle| Triangle::new(mesh, triangle));
        Ok(match model {
            Model::Springs => Self::Springs(ring_one(mesh, components)?),
            Model::SoftConstraint => Self::SoftConstraint(triangles().map(SoftTriangle).collect()),
            Model::Stvk => Self::Stvk(triangles().map(StvkTriangle).collect()),
        })
    }
}

/// A triangle's rest state: the weights that turn its nodes into the deformation gradient.
///
/// ```text
/// w_u = Σ_a r_u,a x_a      w_v = Σ_a r_v,a x_a        (both 3-vectors; unit and orthogonal at rest)
/// ```
///
/// Source: Miguel et al. 2012, eq. 2; in this form Volino et al. 2009.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle {
    /// Node indices.
    pub nodes: [usize; 3],
    /// Rest area in material coordinates, m².
    pub area: f64,
    /// r_u of each node, 1/m.
    pub weft: [f64; 3],
    /// r_v of each node, 1/m.
    pub warp: [f64; 3],
}

impl Triangle {
    /// The rest state of one triangle of a mesh.
    pub fn new(mesh: &Mesh, triangle: usize) -> Self {
        let nodes = mesh.triangles[triangle];
        let double_area = mesh.double_area(triangle);
        let corner = |i: usize| mesh.material[nodes[i % 3]];
        let opposite = |i: usize| corner(i + 1) - corner(i + 2);
        Self {
            nodes,
            area: 0.5 * double_area,
            weft: std::array::from_fn(|i| opposite(i).y / double_area),
            warp: std::array::from_fn(|i| -opposite(i).x / double_area),
        }
    }

    /// The deformation gradient's columns w_u and w_v.
    pub fn deformation<const N: usize>(&self, x: &[Point<N>; 3]) -> [Point<N>; 2] {
        let combine = |r: &[f64; 3]| x[0] * r[0] + x[1] * r[1] + x[2] * r[2];
        [combine(&self.weft), combine(&self.warp)]
    }
}
