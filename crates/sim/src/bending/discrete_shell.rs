//! Discrete-shell hinges.

use crate::element::{Block, Element, Point};
use crate::error::{Error, Result};
use crate::material::Component;
use crate::membrane::{Direction, direction_of};
use crate::mesh::Mesh;
use nalgebra::{Matrix3, RowVector3, Vector3};
use std::f64::consts::PI;

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
/// Source: Miguel et al. 2012, eq. 5, after Grinspun et al. 2003. Rolled about a grid axis, a regular grid has
/// strain = 3 × curvature and flexural rigidity = 3 × stiffness.
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
    /// An edge along warp carries weft bending, and the other way round.
    pub component: Component,
}

/// The vectors of a hinge.
struct Geometry {
    edge: Vector3<f64>,
    length: f64,
    normals: [Vector3<f64>; 2],
    /// From x₀ to each wing.
    wings: [Vector3<f64>; 2],
    /// Where the wings' feet stand on the edge, 0 at x₀ and 1 at x₁.
    feet: [f64; 2],
}

impl Geometry {
    fn new(x: &[Vector3<f64>; 4]) -> Self {
        let edge = x[1] - x[0];
        let wings = [x[2] - x[0], x[3] - x[0]];
        Self {
            edge,
            length: edge.norm(),
            normals: [edge.cross(&wings[0]), wings[1].cross(&edge)],
            wings,
            feet: wings.map(|wing| wing.dot(&edge) / edge.norm_squared()),
        }
    }

    fn angle(&self) -> f64 {
        let [n1, n2] = &self.normals;
        (n1.cross(n2).dot(&self.edge) / self.length).atan2(n1.dot(n2))
    }

    /// ∂θ/∂x₂ = −|e| n₁/|n₁|², ∂θ/∂x₃ = −|e| n₂/|n₂|²; the edge's ends take what balances force and torque.
    fn gradient(&self) -> [Vector3<f64>; 4] {
        let [g2, g3] = self.normals.map(|n| n * (-self.length / n.norm_squared()));
        let [t2, t3] = self.feet;
        [-(g2 * (1.0 - t2) + g3 * (1.0 - t3)), -(g2 * t2 + g3 * t3), g2, g3]
    }

    /// ∇²θ by the product rule on [`Geometry::gradient`].
    fn hessian(&self) -> [[Matrix3<f64>; 4]; 4] {
        let g = self.gradient();
        let direction = (self.edge / self.length).transpose();
        // Derivatives of |e| with respect to x₀…x₃.
        let d_length = [-direction, direction, RowVector3::zeros(), RowVector3::zeros()];
        let mut rows = [[Matrix3::zeros(); 4]; 2];
        let mut d_feet = [[RowVector3::zeros(); 4]; 2];
        for side in 0..2 {
            let (normal, wing, wing_node) = (self.normals[side], self.wings[side], 2 + side);
            // n₁ = e × b, n₂ = b × e: the second is minus the first's form.
            let sign = if side == 0 { 1.0 } else { -1.0 };
            let by_edge = -wing.cross_matrix() * sign;
            let by_wing = self.edge.cross_matrix() * sign;
            let mut d_normal = [Matrix3::zeros(); 4];
            d_normal[0] = -(by_edge + by_wing);
            d_normal[1] = by_edge;
            d_normal[wing_node] = by_wing;
            let squared = normal.norm_squared();
            let unit = normal / squared;
            let shrink = (Matrix3::identity() - unit * normal.transpose() * 2.0) * (self.length / squared);
            for node in 0..4 {
                rows[side][node] = -(unit * d_length[node] + shrink * d_normal[node]);
            }
            // t = b·e/e·e
            let foot = self.feet[side];
            let squared = self.length * self.length;
            let by_wing = self.edge.transpose() / squared;
            let by_edge = (wing - self.edge * (2.0 * foot)).transpose() / squared;
            d_feet[side][0] = -(by_edge + by_wing);
            d_feet[side][1] = by_edge;
            d_feet[side][wing_node] = by_wing;
        }
        let [t2, t3] = self.feet;
        let end = |node: usize, weights: [f64; 2], sign: f64| {
            let by_feet = (g[2] * d_feet[0][node] + g[3] * d_feet[1][node]) * sign;
            by_feet - rows[0][node] * weights[0] - rows[1][node] * weights[1]
        };
        [
            std::array::from_fn(|node| end(node, [1.0 - t2, 1.0 - t3], 1.0)),
            std::array::from_fn(|node| end(node, [t2, t3], -1.0)),
            rows[0],
            rows[1],
        ]
    }
}

impl Hinge {
    /// The hinges of a mesh: one an inner edge, classed by the edge's direction in material coordinates.
    ///
    /// # Errors
    /// A wing without height.
    pub fn all(mesh: &Mesh) -> Result<Vec<Self>> {
        let mut hinges = Vec::new();
        for edge in mesh.edges()? {
            let Some(right) = edge.right else { continue };
            let nodes = [edge.ends[0], edge.ends[1], edge.left, right];
            let geometry = Geometry::new(&nodes.map(|node| mesh.positions[node]));
            let squared = geometry.length * geometry.length;
            for (normal, wing) in geometry.normals.iter().zip([edge.left, right]) {
                // Relative, and written so that a NaN is caught too.
                if !(normal.norm() > 1e-10 * squared) {
                    return Err(Error::CollapsedWing { edge: edge.ends, wing });
                }
            }
            let heights = geometry.normals.map(|normal| normal.norm() / geometry.length);
            let along = mesh.material[nodes[1]] - mesh.material[nodes[0]];
            hinges.push(Self {
                nodes,
                rest_angle: geometry.angle(),
                rest_length: geometry.length,
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
}

impl Element<4, 3, 1> for Hinge {
    fn nodes(&self) -> [usize; 4] {
        self.nodes
    }

    fn components(&self) -> [Component; 1] {
        [self.component]
    }

    fn area(&self) -> f64 {
        self.rest_length * self.width
    }

    fn strains(&self, x: &[Point<3>; 4]) -> [f64; 1] {
        let turn = Geometry::new(x).angle() - self.rest_angle;
        let wrapped = if turn > PI {
            turn - 2.0 * PI
        } else if turn <= -PI {
            turn + 2.0 * PI
        } else {
            turn
        };
        [wrapped / self.width]
    }

    fn gradients(&self, x: &[Point<3>; 4]) -> [[Point<3>; 4]; 1] {
        [Geometry::new(x).gradient().map(|g| g / self.width)]
    }

    fn geometric(&self, x: &[Point<3>; 4], &[stress]: &[f64; 1]) -> [[Block<3>; 4]; 4] {
        let factor = stress / self.width;
        Geometry::new(x).hessian().map(|row| row.map(|block| block * factor))
    }

    /// Without the geometric part, which is never semi-definite, the hinge's matrix is.
    fn geometric_clamped(&self, _x: &[Point<3>; 4], _stress: &[f64; 1]) -> [[Block<3>; 4]; 4] {
        [[Block::zeros(); 4]; 4]
    }
}
