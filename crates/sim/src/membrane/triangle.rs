//! Rest state of a triangle, shared by all triangle membranes.

use crate::element::{Block, Point};
use crate::material::Component;
use crate::mesh::Mesh;

/// Rest state of a triangle: weights that map its nodes to the deformation gradient.
///
/// ```text
/// w_u = Σ_a r_u,a x_a      w_v = Σ_a r_v,a x_a        (both 3-vectors; unit and orthogonal at rest)
/// ```
///
/// Source: Miguel et al. 2012, eq. 2, in the form of Volino et al. 2009.
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
    /// Rest state of one triangle of a mesh.
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

    /// Columns w_u and w_v of the deformation gradient.
    pub fn deformation<const N: usize>(&self, x: &[Point<N>; 3]) -> [Point<N>; 2] {
        let combine = |r: &[f64; 3]| x[0] * r[0] + x[1] * r[1] + x[2] * r[2];
        [combine(&self.weft), combine(&self.warp)]
    }
}

/// Components of a triangle's three strains.
pub(super) const TRIANGLE_COMPONENTS: [Component; 3] =
    [Component::StretchWeft, Component::StretchWarp, Component::Shear];

/// Adds the blocks (rᵀ S r) I of a stress tensor S.
#[inline(always)]
pub(super) fn add_scalar_blocks<const N: usize>(
    triangle: &Triangle,
    &[s_u, s_v, s_uv]: &[f64; 3],
    blocks: &mut [[Block<N>; 3]; 3],
) {
    let Triangle { weft, warp, .. } = triangle;
    for a in 1..3 {
        for b in 1..=a {
            let scalar = s_u * weft[a] * weft[b]
                + s_v * warp[a] * warp[b]
                + s_uv * (weft[a] * warp[b] + warp[a] * weft[b]);
            (0..N).for_each(|i| blocks[a][b][(i, i)] += scalar);
        }
    }
}
