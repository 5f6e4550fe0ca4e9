//! Discrete-shell hinges.

use crate::element::{Block, Element, Point};
use crate::error::{Error, Result};
use crate::material::Component;
use crate::membrane::{Direction, direction_of};
use crate::mesh::Mesh;
use nalgebra::{Matrix3, Vector3};
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

/// Vectors of a deformed hinge.
struct Geometry {
    edge: Vector3<f64>,
    length: f64,
    normals: [Vector3<f64>; 2],
    /// Vectors from x₀ to each wing node.
    wings: [Vector3<f64>; 2],
    /// Foot points of the wings on the edge: 0 at x₀, 1 at x₁.
    feet: [f64; 2],
}

impl Geometry {
    #[inline(always)]
    fn new(x: &[Vector3<f64>; 4]) -> Self {
        let edge = x[1] - x[0];
        let wings = [x[2] - x[0], x[3] - x[0]];
        let squared = edge.norm_squared();
        Self {
            edge,
            length: squared.sqrt(),
            normals: [edge.cross(&wings[0]), wings[1].cross(&edge)],
            wings,
            feet: wings.map(|wing| wing.dot(&edge) / squared),
        }
    }

    fn angle(&self) -> f64 {
        let [n1, n2] = &self.normals;
        (n1.cross(n2).dot(&self.edge) / self.length).atan2(n1.dot(n2))
    }

    /// A multiple of ∇θ: ∂θ/∂x₂ = −|e| n₁/|n₁|², ∂θ/∂x₃ = −|e| n₂/|n₂|². The edge nodes take the parts that balance
    /// force and torque.
    #[inline(always)]
    fn gradient(&self, factor: f64) -> [Vector3<f64>; 4] {
        let [n1, n2] = &self.normals;
        let g2 = n1 * (-factor * self.length / n1.norm_squared());
        let g3 = n2 * (-factor * self.length / n2.norm_squared());
        let [t2, t3] = self.feet;
        [-(g2 * (1.0 - t2) + g3 * (1.0 - t3)), -(g2 * t2 + g3 * t3), g2, g3]
    }

    /// Adds a multiple of ∇²θ to the lower blocks.
    ///
    /// Each side has a unit normal n̂, a height h, a unit vector m̂ from the edge to the wing, and the edge ê of length
    /// l. Moving node a shifts the wing off the edge by its share c_a and turns the edge by d_a/l:
    ///
    /// ```text
    ///        x₀        x₁     wing
    /// c   −(1 − t)    −t       1          ∂θ/∂x_a = −c_a n̂/h, summed over the sides
    /// d     −1         1       0
    ///
    /// ∂²θ/∂x_a∂x_b = Σ  (c_a c_b/h² + d_a d_b/2l²) (m̂n̂ᵀ + n̂m̂ᵀ) + (c_a d_b ên̂ᵀ + d_a c_b n̂êᵀ)/(h l)
    /// ```
    #[inline(always)]
    fn add_hessian(&self, factor: f64, blocks: &mut [[Matrix3<f64>; 4]; 4]) {
        let turns = 1.0 / self.length;
        let edge = self.edge * turns;
        for side in 0..2 {
            let size = self.normals[side].norm();
            let normal = self.normals[side] * (factor / size);
            let wing = self.length / size;
            let across = (self.wings[side] - self.edge * self.feet[side]) * wing;
            // The normal carries the factor; the shares carry the lengths: c/h and d/l.
            let foot = self.feet[side];
            // Node 0 is filled in from the others.
            let shares = [(1, [-foot * wing, turns]), (2 + side, [wing, 0.0])];
            for (row, (a, [c_a, d_a])) in shares.into_iter().enumerate() {
                for (b, [c_b, d_b]) in shares.into_iter().take(row + 1) {
                    let along = across * (c_a * c_b + 0.5 * d_a * d_b);
                    let [left, right] = [along + edge * (c_a * d_b), along + edge * (d_a * c_b)];
                    blocks[a][b] += left * normal.transpose() + normal * right.transpose();
                }
            }
        }
    }
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
            let geometry = Geometry::new(&nodes.map(|node| mesh.positions[node]));
            let squared = geometry.length * geometry.length;
            for (normal, wing) in geometry.normals.iter().zip([edge.left, right]) {
                // Relative test, negated to catch NaN.
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

    /// (θ − θ₀)/h₀, with the angle difference wrapped to (−π, π].
    fn strain(&self, geometry: &Geometry) -> f64 {
        let turn = geometry.angle() - self.rest_angle;
        let wrapped = if turn > PI {
            turn - 2.0 * PI
        } else if turn <= -PI {
            turn + 2.0 * PI
        } else {
            turn
        };
        wrapped / self.width
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

    fn extent(&mut self) -> &mut f64 {
        &mut self.rest_length
    }

    fn strains(&self, x: &[Point<3>; 4]) -> [f64; 1] {
        [self.strain(&Geometry::new(x))]
    }

    fn gradients(&self, x: &[Point<3>; 4]) -> [[Point<3>; 4]; 1] {
        [Geometry::new(x).gradient(1.0 / self.width)]
    }

    #[inline(always)]
    fn evaluate(&self, x: &[Point<3>; 4]) -> ([f64; 1], [[Point<3>; 4]; 1]) {
        let geometry = Geometry::new(x);
        ([self.strain(&geometry)], [geometry.gradient(1.0 / self.width)])
    }

    #[inline(always)]
    fn add_geometric(&self, x: &[Point<3>; 4], &[stress]: &[f64; 1], blocks: &mut [[Block<3>; 4]; 4]) {
        Geometry::new(x).add_hessian(stress / self.width, blocks);
    }

    /// The hinge's matrix is semi-definite without the geometric part, which never is.
    fn add_clamped(&self, _x: &[Point<3>; 4], _stress: &[f64; 1], _blocks: &mut [[Block<3>; 4]; 4]) {}
}
