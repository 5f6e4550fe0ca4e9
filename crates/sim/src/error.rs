//! Input errors, detected before any solve. A failed solve is not an error: see [`Status`](crate::equilibrium::Status).

use thiserror::Error;

/// Misuse of the mechanics, or an impossible mesh, curve or setting.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Error {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex}: {what} is not finite")]
    NotFinite {
        /// The kind of coordinate.
        what: &'static str,
        /// Vertex index.
        vertex: usize,
    },
    /// Two vertices have the same rest position.
    #[error("vertices {first} and {second} have the same rest position; merge them")]
    DuplicateVertex {
        /// The earlier vertex.
        first: usize,
        /// The later vertex.
        second: usize,
    },
    /// A vertex belongs to no triangle.
    #[error("vertex {vertex} belongs to no triangle; remove it")]
    UnreferencedVertex {
        /// Vertex index.
        vertex: usize,
    },
    /// A triangle refers to a vertex that does not exist, or twice to the same vertex.
    #[error("triangle {triangle}: vertex {vertex} of {vertices} does not exist or is named twice")]
    BadIndex {
        /// Triangle index.
        triangle: usize,
        /// The offending vertex index.
        vertex: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A triangle has zero rest area.
    #[error("triangle {triangle}: its rest area is zero")]
    ZeroArea {
        /// Triangle index.
        triangle: usize,
    },
    /// An edge belongs to more than two triangles.
    #[error("edge {}-{} belongs to three triangles ({}, {} and {}); cloth has at most two", edge[0], edge[1], triangles[0], triangles[1], triangles[2])]
    ThreeTriangles {
        /// The edge's vertices.
        edge: [usize; 2],
        /// Three of its triangles.
        triangles: [usize; 3],
    },
    /// Two neighbouring triangles have opposite winding.
    #[error("triangles {} and {} are wound in opposite senses at edge {}-{}", triangles[0], triangles[1], edge[0], edge[1])]
    MixedWinding {
        /// The shared edge.
        edge: [usize; 2],
        /// The two triangles.
        triangles: [usize; 2],
    },
    /// Material coordinates are mirrored, or a triangle is wound against them.
    #[error("triangle {triangle}: its material coordinates are mirrored (opposite winding)")]
    MirroredMaterial {
        /// Triangle index.
        triangle: usize,
    },
    /// Rest positions and material coordinates disagree in an edge's length by more than 1 %.
    #[error("edge {}-{}: {rest} m between rest positions, {material} m between material coordinates; they must agree within 1 %{}", edge[0], edge[1], unit_between(*rest, *material))]
    EdgeLength {
        /// The edge's vertices.
        edge: [usize; 2],
        /// Length between rest positions, m.
        rest: f64,
        /// Length between material coordinates, m.
        material: f64,
    },
    /// A hinge's wing has zero height.
    #[error("hinge at edge {}-{}: the triangle to vertex {wing} has collapsed", edge[0], edge[1])]
    CollapsedWing {
        /// The hinge's edge.
        edge: [usize; 2],
        /// The vertex opposite the edge.
        wing: usize,
    },
    /// The model needs a regular grid, but the mesh is not one.
    #[error("{what} needs a regular grid without nodes inside its cells; this mesh is not one")]
    NeedsGrid {
        /// The part of the model that needs the grid.
        what: &'static str,
    },
    /// Nothing holds some parts of the cloth.
    #[error("nothing holds the part of the cloth that contains {}: {free} rigid motions free", listed(parts))]
    Unpinned {
        /// The parts, by lowest vertex.
        parts: Vec<Part>,
        /// Number of free rigid motions of each.
        free: usize,
    },
    /// A value is out of range.
    #[error("{field}: found {value}, expected {expected}")]
    InvalidValue {
        /// The field.
        field: &'static str,
        /// The value found.
        value: f64,
        /// The allowed range.
        expected: &'static str,
    },
    /// A time step exceeds the stability limit of an explicit integrator.
    #[error(
        "step: found {step} s, expected at most {limit:.3e} s, beyond which Runge–Kutta is not stable here"
    )]
    UnstableStep {
        /// The requested step, s.
        step: f64,
        /// The longest stable step, s.
        limit: f64,
    },
    /// Two arrays that must have the same length differ.
    #[error("{what}: {found} given, {expected} expected")]
    ShapeMismatch {
        /// Name of the array.
        what: &'static str,
        /// Expected length.
        expected: usize,
        /// Found length.
        found: usize,
    },
    /// Control points do not form a valid curve.
    #[error("control point {point}: {reason}")]
    Curve {
        /// Index of the control point.
        point: usize,
        /// The reason.
        reason: &'static str,
    },
}

/// A connected part of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// Its lowest vertex.
    pub vertex: usize,
    /// Number of vertices.
    pub vertices: usize,
}

/// Suggests a unit for one of two lengths if the other is in metres.
fn unit_between(first: f64, second: f64) -> &'static str {
    match first.max(second) / first.min(second) {
        900.0..1100.0 => " (millimetres?)",
        90.0..110.0 => " (centimetres?)",
        _ => "",
    }
}

fn listed(parts: &[Part]) -> String {
    let part = |Part { vertex, vertices }: &Part| format!("vertex {vertex} ({vertices} vertices)");
    parts.iter().map(part).collect::<Vec<_>>().join(", nor that of ")
}

/// Result with the crate's [`Error`](enum@Error).
pub type Result<T> = std::result::Result<T, Error>;
