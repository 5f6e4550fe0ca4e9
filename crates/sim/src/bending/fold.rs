//! The angle across an edge.

use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

/// Two triangles beside an edge.
///
/// ```text
///        x₂
///       /  \            e = x₁ − x₀      n₁ = e × (x₂ − x₀)      n₂ = (x₃ − x₀) × e
///     x₀ ── x₁          θ = atan2((n₁ × n₂)·e/|e|, n₁·n₂)
///       \  /
///        x₃
/// ```
///
/// Source: Bridson, Marino and Fedkiw 2003 (gradient); Tamstorf and Grinspun 2013 (Hessian).
pub(super) struct Fold {
    edge: Vector3<f64>,
    pub(super) length: f64,
    pub(super) normals: [Vector3<f64>; 2],
    /// Vectors from x₀ to each wing node.
    wings: [Vector3<f64>; 2],
    /// Foot points of the wings on the edge: 0 at x₀, 1 at x₁.
    feet: [f64; 2],
}

impl Fold {
    #[inline(always)]
    pub(super) fn new(x: &[Vector3<f64>; 4]) -> Self {
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

    /// θ, rad.
    pub(super) fn angle(&self) -> f64 {
        let [n1, n2] = &self.normals;
        (n1.cross(n2).dot(&self.edge) / self.length).atan2(n1.dot(n2))
    }

    /// A multiple of ∇θ: ∂θ/∂x₂ = −|e| n₁/|n₁|², ∂θ/∂x₃ = −|e| n₂/|n₂|². The edge nodes take the parts that balance
    /// force and torque.
    #[inline(always)]
    pub(super) fn gradient(&self, factor: f64) -> [Vector3<f64>; 4] {
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
    pub(super) fn add_hessian(&self, factor: f64, blocks: &mut [[Matrix3<f64>; 4]; 4]) {
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

/// An angle, or a difference of two, wrapped to (−π, π].
pub(super) fn wrapped(angle: f64) -> f64 {
    if angle > PI {
        angle - 2.0 * PI
    } else if angle <= -PI {
        angle + 2.0 * PI
    } else {
        angle
    }
}
