//! Measurements: a fabric sample, its sequences, and their frames.
//!
//! Plain data in SI units. [`io`](crate::io) is its only reader and writer.

pub use crate::kind::Kind;
use cloth_sim::mesh::Mesh;
use nalgebra::{Isometry3, SVector, Vector3};
use serde::{Deserialize, Serialize};

/// A fabric sample and all its measured sequences: one folder on disk.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasurementSet {
    /// The sample.
    pub fabric: Fabric,
    /// The sequences, ordered by name.
    pub sequences: Vec<Sequence>,
}

/// The sample itself: `fabric.toml`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fabric {
    /// Name of the fabric.
    pub name: String,
    /// Weft extent of the specimen, m.
    pub width_m: f64,
    /// Warp extent of the specimen, m.
    pub height_m: f64,
    /// Mass per area, kg/m².
    pub areal_density_kg_m2: f64,
    /// Thickness, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thickness_m: Option<f64>,
    /// Origin of the sample or the data.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// Anything else.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub notes: Option<String>,
}

/// One test: ordered frames of one specimen.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sequence {
    /// Name of its folder.
    pub name: String,
    /// Which test it is.
    pub kind: Kind,
    /// Gravity, m/s²; zero leaves weight out.
    pub gravity: Vector3<f64>,
    /// Standard deviations of the instruments, where known.
    pub noise: Option<Noise>,
    /// The one direction (unit length) in which the load cell measures; `None` = all three components.
    pub force_direction: Option<Vector3<f64>>,
    /// Table edge, in bending tests only.
    pub table: Option<Table>,
    /// Rest mesh: the specimen, flat and free.
    pub mesh: Mesh,
    /// The clips, in the order of `test.toml`.
    pub clips: Vec<Clip>,
    /// The frames; frame 0 is the first of the file.
    pub frames: Vec<Frame>,
}

/// Standard deviations where none are told: cameras have a tenth of a millimetre, load cells a hundredth of a newton.
const USUAL_NOISE: [f64; 2] = [1e-4, 0.01];

impl Sequence {
    /// Standard deviation of a coordinate of a vertex, m: as told, else usual.
    pub fn position_noise(&self) -> f64 {
        self.noise.and_then(|noise| noise.position_m).unwrap_or(USUAL_NOISE[0])
    }

    /// Standard deviation of a force component, N: as told, else usual.
    pub fn force_noise(&self) -> f64 {
        self.noise.and_then(|noise| noise.force_n).unwrap_or(USUAL_NOISE[1])
    }

    /// Standard deviation of a clip's place along each axis, m: as told, else that told of a vertex, else 0.
    pub fn clip_noise(&self) -> f64 {
        self.noise.and_then(|noise| noise.clip()).unwrap_or(0.0)
    }

    /// Area of the rest mesh, m².
    pub fn area(&self) -> f64 {
        (0..self.mesh.triangles.len()).map(|triangle| 0.5 * self.mesh.double_area(triangle)).sum()
    }
}

/// No instrument sees heights that differ by less, m: they were not measured.
pub const HEIGHT_SEEN: f64 = 1e-9;

/// True if a vertex was observed there.
pub fn is_seen(place: &Vector3<f64>) -> bool {
    place.iter().all(|c| c.is_finite())
}

/// One standard deviation of the instruments.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// Of each coordinate of an observed vertex, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_m: Option<f64>,
    /// Of each component of a clip force, N.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_n: Option<f64>,
    /// Of a clip's place along each axis, m; over the clip's length, of its angles. 0: exact. Default: that of a vertex.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clip_m: Option<f64>,
}

impl Noise {
    /// Standard deviation of a clip's place along each axis, m, if known: as told, else that of a vertex.
    // Inlined into a sequence without noise, rustc 1.95 reads it through an address that it never set, and crashes.
    #[inline(never)]
    pub fn clip(&self) -> Option<f64> {
        self.clip_m.or(self.position_m)
    }
}

/// The table that a bending specimen lies on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// A point of the edge, m.
    pub edge_point_m: [f64; 3],
    /// Direction of the edge.
    pub edge_direction: [f64; 3],
    /// Horizontal direction in which the cloth overhangs.
    pub outward: [f64; 3],
}

/// A rigid clamp gripping vertices of the rest mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Clip {
    /// Its name in `clips.csv` and `forces.csv`.
    pub name: String,
    /// Its mass, kg.
    pub mass_kg: f64,
    /// Indices into the rest mesh.
    pub vertices: Vec<usize>,
}

/// Direction in which the load changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// Forces grow.
    Loading,
    /// Forces shrink.
    Unloading,
    /// Neither.
    Hold,
}

/// One measured equilibrium.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Frame {
    /// Time, s.
    pub time: Option<f64>,
    /// Which load cycle.
    pub cycle: Option<usize>,
    /// Loading or unloading.
    pub phase: Option<Phase>,
    /// One pose a clip: maps its rest points to where they are now. Empty in bending.
    pub poses: Vec<Isometry3<f64>>,
    /// The cords' forces on the clips; several cords may pull one clip.
    pub cords: Vec<Cord>,
    /// Position of every vertex, m; NaN = not observed. `None` = no shape was measured.
    pub positions: Option<Vec<Vector3<f64>>>,
}

/// One cord's force on a clip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cord {
    /// Index of the clip.
    pub clip: usize,
    /// Force that the cord exerts on the clip, N.
    pub force: Vector3<f64>,
    /// Point of action, m; `None` = the clip's centre.
    pub point: Option<Vector3<f64>>,
}

impl Frame {
    /// Sum of the cords on a clip, N; `None` if its force was not measured.
    pub fn clip_force(&self, clip: usize) -> Option<Vector3<f64>> {
        self.cords.iter().filter(|cord| cord.clip == clip).map(|cord| cord.force).reduce(|a, b| a + b)
    }
}

/// A place in a triangle mesh: a triangle and barycentric weights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshPoint {
    /// Index of the triangle.
    pub triangle: usize,
    /// Weights of its three vertices; they sum to one.
    pub weights: [f64; 3],
}

impl MeshPoint {
    /// The value there of what is known at the vertices.
    ///
    /// A vertex without weight does not enter, so that it may be unobserved.
    pub fn interpolate<const D: usize>(&self, mesh: &Mesh, values: &[SVector<f64, D>]) -> SVector<f64, D> {
        let corners = mesh.triangles[self.triangle].into_iter().zip(self.weights);
        corners
            .filter(|(_, weight)| weight.abs() > 1e-9)
            .map(|(vertex, weight)| values[vertex] * weight)
            .sum()
    }
}
