//! What can be wrong with a problem before any mathematics starts. A solve that fails is no error: see
//! [`Status`](crate::equilibrium::Status).

use thiserror::Error;

/// Misuse of the mechanics, or a mesh, curve or setting that no cloth can have.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Error {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex}: {what} is not finite")]
    NotFinite {
        /// Which coordinates.
        what: &'static str,
        /// Vertex index.
        vertex: usize,
    },
    /// Two vertices at one rest position.
    #[error("vertices {first} and {second} have the same rest position; merge them")]
    DuplicateVertex {
        /// The earlier vertex.
        first: usize,
        /// The later vertex.
        second: usize,
    },
    /// A vertex that belongs to no triangle.
    #[error("vertex {vertex} belongs to no triangle; remove it")]
    UnreferencedVertex {
        /// Vertex index.
        vertex: usize,
    },
    /// A triangle that names a vertex which does not exist, or the same vertex twice.
    #[error("triangle {triangle}: vertex {vertex} of {vertices} does not exist or is named twice")]
    BadIndex {
        /// Triangle index.
        triangle: usize,
        /// The offending vertex index.
        vertex: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A triangle without area at rest.
    #[error("triangle {triangle}: its rest area is zero")]
    ZeroArea {
        /// Triangle index.
        triangle: usize,
    },
    /// An edge that belongs to more than two triangles.
    #[error("edge {}-{} belongs to three triangles ({}, {} and {}); cloth has at most two", edge[0], edge[1], triangles[0], triangles[1], triangles[2])]
    ThreeTriangles {
        /// The edge's vertices.
        edge: [usize; 2],
        /// Three of its triangles.
        triangles: [usize; 3],
    },
    /// Two neighbours that are wound in opposite senses.
    #[error("triangles {} and {} are wound in opposite senses at edge {}-{}", triangles[0], triangles[1], edge[0], edge[1])]
    MixedWinding {
        /// The shared edge.
        edge: [usize; 2],
        /// The two triangles.
        triangles: [usize; 2],
    },
    /// Material coordinates that mirror, or a triangle wound against them.
    #[error("triangle {triangle}: its material coordinates are wound the other way (mirrored)")]
    MirroredMaterial {
        /// Triangle index.
        triangle: usize,
    },
    /// Rest position and material coordinates disagree in an edge's length by more than 1 %.
    #[error("edge {}-{}: {rest} m between rest positions, {material} m between material coordinates; they must agree within 1 %{}", edge[0], edge[1], unit_between(*rest, *material))]
    EdgeLength {
        /// The edge's vertices.
        edge: [usize; 2],
        /// Length between rest positions, m.
        rest: f64,
        /// Length between material coordinates, m.
        material: f64,
    },
    /// A wing of a hinge has no height.
    #[error("hinge at edge {}-{}: the triangle to vertex {wing} has collapsed", edge[0], edge[1])]
    CollapsedWing {
        /// The hinge's edge.
        edge: [usize; 2],
        /// The vertex opposite the edge.
        wing: usize,
    },
    /// A model that needs the regular grid was given another mesh.
    #[error("{what} needs a regular grid without nodes inside its cells; this mesh is not one")]
    NeedsGrid {
        /// What needs it.
        what: &'static str,
    },
    /// Parts of the cloth that nothing holds.
    #[error("nothing holds the part of the cloth that contains {}: {free} rigid motions free", listed(parts))]
    Unpinned {
        /// Each of them, by its lowest vertex.
        parts: Vec<Part>,
        /// How many rigid motions remain to each.
        free: usize,
    },
    /// A value outside what it may be.
    #[error("{field}: found {value}, expected {expected}")]
    InvalidValue {
        /// The field.
        field: &'static str,
        /// What was found.
        value: f64,
        /// What it may be.
        expected: &'static str,
    },
    /// A time step at which an explicit integrator is not stable.
    #[error(
        "step: found {step} s, expected at most {limit:.3e} s, beyond which Runge–Kutta is not stable here"
    )]
    UnstableStep {
        /// The step asked for, s.
        step: f64,
        /// The longest stable one, s.
        limit: f64,
    },
    /// Two arrays that must have the same length have not.
    #[error("{what}: {found} given, {expected} expected")]
    ShapeMismatch {
        /// Which array.
        what: &'static str,
        /// Expected length.
        expected: usize,
        /// Found length.
        found: usize,
    },
    /// Control points that do not make a curve.
    #[error("control point {point}: {reason}")]
    Curve {
        /// Index of the control point.
        point: usize,
        /// Why not.
        reason: &'static str,
    },
}

/// A connected part of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// Its lowest vertex.
    pub vertex: usize,
    /// How many vertices it has.
    pub vertices: usize,
}

/// The unit in which one of two lengths may be, if the other is in metres.
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
