//! Discrete-shell hinges.

use super::fold::{Fold, wrapped};
use crate::element::{Block, Element, Point, stacked};
use crate::error::{Error, Result};
use crate::material::Component;
use crate::membrane::{Direction, direction_of};
use crate::mesh::Mesh;

/// Two triangles sharing an edge.
///
/// ```text
///        x₂
///       /  \            e = x₁ − x₀      n₁ = e × (x₂ − x₀)      n₂ = (x₃ − x₀) × e
///     x₀ ── x₁          θ = atan2((n₁ × n₂)·e/|e|, n₁·n₂)
///       \  /            ε = (θ − θ₀)/h₀,  wrapped to θ − θ₀ ∈ (−π, π]
///        x₃             h₀ = (h₂ + h₃)/6, a third of the mean height;  energy density over l₀ × h₀
/// ```
///
/// Source: Miguel et al. 2012, eq. 5, after Grinspun et al. 2003. As curvature and flexural rigidity:
/// [`HINGE_STRAIN_PER_CURVATURE`](crate::strain_measure::HINGE_STRAIN_PER_CURVATURE).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hinge {
    /// The edge x₀, x₁ and the wings x₂, x₃.
    pub nodes: [usize; 4],
    /// θ₀, rad.
    pub rest_angle: f64,
    /// l₀, m.
    pub rest_length: f64,
    /// h₀, m.
    pub width: f64,
    /// Component by edge direction: an edge along warp carries weft bending, and vice versa.
    pub component: Component,
}

impl Hinge {
    /// All hinges of a mesh, one per inner edge. The edge's direction in material coordinates selects the component.
    ///
    /// # Errors
    /// A wing with zero height.
    pub fn all(mesh: &Mesh) -> Result<Vec<Self>> {
        let mut hinges = Vec::new();
        for edge in mesh.edges()? {
            let Some(right) = edge.right else { continue };
            let nodes = [edge.ends[0], edge.ends[1], edge.left, right];
            let fold = Fold::new(&nodes.map(|node| mesh.positions[node]));
            let squared = fold.length * fold.length;
            for (normal, wing) in fold.normals.iter().zip([edge.left, right]) {
                // Relative test, negated to catch NaN.
                if !(normal.norm() > 1e-10 * squared) {
                    return Err(Error::CollapsedWing { edge: edge.ends, wing });
                }
            }
            let heights = fold.normals.map(|normal| normal.norm() / fold.length);
            let along = mesh.material[nodes[1]] - mesh.material[nodes[0]];
            hinges.push(Self {
                nodes,
                rest_angle: fold.angle(),
                rest_length: fold.length,
                width: (heights[0] + heights[1]) / 6.0,
                component: match direction_of(along) {
                    Direction::Weft => Component::BendWarp,
                    Direction::Warp => Component::BendWeft,
                    Direction::Diagonal => Component::BendDiagonal,
                },
            });
        }
        Ok(hinges)
    }

    /// True if the angle jumps across ±π between two states.
    pub(crate) fn jumps(&self, x: &[Point<3>; 4], to: &[Point<3>; 4]) -> bool {
        ((self.strain(&Fold::new(to)) - self.strain(&Fold::new(x))) * self.width).abs() > std::f64::consts::PI
    }

    /// (θ − θ₀)/h₀, with the angle difference wrapped to (−π, π].
    fn strain(&self, fold: &Fold) -> f64 {
        wrapped(fold.angle() - self.rest_angle) / self.width
    }
}

impl Element<4, 3, 1> for Hinge {
    fn coordinates(&self) -> [[usize; 3]; 4] {
        stacked(self.nodes)
    }

    fn components(&self) -> [Component; 1] {
        [self.component]
    }

    fn area(&self) -> f64 {
        self.rest_length * self.width
    }

    fn extent(&mut self) -> &mut f64 {
        &mut self.rest_length
    }

    fn strains(&self, x: &[Point<3>; 4]) -> [f64; 1] {
        [self.strain(&Fold::new(x))]
    }

    fn gradients(&self, x: &[Point<3>; 4]) -> [[Point<3>; 4]; 1] {
        [Fold::new(x).gradient(1.0 / self.width)]
    }

    #[inline(always)]
    fn evaluate(&self, x: &[Point<3>; 4]) -> ([f64; 1], [[Point<3>; 4]; 1]) {
        let fold = Fold::new(x);
        ([self.strain(&fold)], [fold.gradient(1.0 / self.width)])
    }

    #[inline(always)]
    fn add_geometric(&self, x: &[Point<3>; 4], &[stress]: &[f64; 1], blocks: &mut [[Block<3>; 4]; 4]) {
        Fold::new(x).add_hessian(stress / self.width, blocks);
    }

    /// The hinge's matrix is semi-definite without the geometric part, which never is.
    fn add_clamped(&self, _x: &[Point<3>; 4], _stress: &[f64; 1], _blocks: &mut [[Block<3>; 4]; 4]) {}
}
