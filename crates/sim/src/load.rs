//! External loads and supports: weight, clips and tables.

use crate::error::{Error, Result};
use crate::mesh::Mesh;
use nalgebra::{Matrix3, Vector3};

/// A node held at a prescribed position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Held {
    /// Node index.
    pub node: usize,
    /// The clip that holds the node and whose force is computed; `None` for a table or a nail.
    pub clip: Option<usize>,
}

/// A node that may move in some directions only, for example along a rail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guided {
    /// Node index.
    pub node: usize,
    /// Its free directions.
    pub free: Free,
}

/// Free directions of a guided node; vectors of any nonzero length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Free {
    /// Two: the plane across this normal.
    Plane(Vector3<f64>),
    /// One: along this line.
    Line(Vector3<f64>),
    /// None.
    Nowhere,
}

impl Free {
    /// The projection S onto the free directions: I − nnᵀ, ttᵀ or 0.
    ///
    /// Source: Baraff and Witkin 1998, §5.1.
    ///
    /// # Errors
    /// A vector that is zero or not finite.
    pub fn projection(self) -> Result<Matrix3<f64>> {
        let unit = |direction: Vector3<f64>| {
            let length = direction.norm();
            // Negated to catch NaN.
            if !(length > 0.0 && length.is_finite()) {
                let expected = "a direction of finite length above zero";
                return Err(Error::InvalidValue { field: "guided", value: length, expected });
            }
            Ok(direction / length)
        };
        Ok(match self {
            Self::Plane(normal) => {
                let normal = unit(normal)?;
                Matrix3::identity() - normal * normal.transpose()
            }
            Self::Line(along) => {
                let along = unit(along)?;
                along * along.transpose()
            }
            Self::Nowhere => Matrix3::zeros(),
        })
    }
}

/// Lumped masses, kg: a third of every triangle's mass on each of its vertices.
///
/// * `areal_density` — kg/m²
///
/// Source: Strohkorb 2019, §3.1.
pub fn lumped_masses(mesh: &Mesh, areal_density: f64) -> Vec<f64> {
    let mut masses = vec![0.0; mesh.len()];
    for (triangle, nodes) in mesh.triangles.iter().enumerate() {
        for &node in nodes {
            masses[node] += areal_density * 0.5 * mesh.double_area(triangle) / 3.0;
        }
    }
    masses
}
