//! Structure of `SCENE.toml`: docs/formats.md.

use cloth_sim::cloth::Rest;
use cloth_sim::material::Component;
use cloth_sim::mesh::Diagonals;
use serde::Deserialize;
use std::path::PathBuf;

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    pub(super) name: String,
    #[serde(default, rename = "notes")]
    pub(super) _notes: Option<String>,
    pub(super) gravity_m_s2: [f64; 3],
    #[serde(default)]
    pub(super) duration_s: Option<f64>,
    #[serde(default = "step")]
    pub(super) step_s: f64,
    #[serde(default = "frames")]
    pub(super) frames_per_s: f64,
    #[serde(default)]
    pub(super) components: Option<Vec<Component>>,
    #[serde(default)]
    pub(super) measure: Option<ShapeMeasure>,
    pub(super) sheet: SheetFile,
    #[serde(default)]
    pub(super) held: Vec<HoldFile>,
    #[serde(default)]
    pub(super) start: StartFile,
    #[serde(default)]
    pub(super) damping: DampingFile,
    #[serde(default)]
    pub(super) wind: Option<WindFile>,
    #[serde(default)]
    pub(super) solver: SolverFile,
}

fn step() -> f64 {
    0.01
}

fn frames() -> f64 {
    25.0
}

/// Measurement of a scene's final shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShapeMeasure {
    /// Depth of the sheet below its holds.
    Droop,
    /// Drape coefficient: share of the overhang's area that its shadow covers.
    DrapeCoefficient,
}

/// The sheet: one of grid, disc and mesh, and its position.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SheetFile {
    #[serde(default)]
    pub(super) grid: Option<GridFile>,
    #[serde(default)]
    pub(super) disc: Option<DiscFile>,
    #[serde(default)]
    pub(super) mesh: Option<MeshFile>,
    #[serde(default)]
    pub(super) rest: Rest,
    #[serde(default)]
    pub(super) origin_m: Option<[f64; 3]>,
    #[serde(default)]
    pub(super) weft: Option<[f64; 3]>,
    #[serde(default)]
    pub(super) warp: Option<[f64; 3]>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GridFile {
    pub(super) width_m: f64,
    pub(super) height_m: f64,
    pub(super) nodes: [usize; 2],
    #[serde(default = "alternating")]
    pub(super) diagonals: Diagonals,
}

fn alternating() -> Diagonals {
    Diagonals::Alternating
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DiscFile {
    pub(super) radius_m: f64,
    pub(super) rings: usize,
    #[serde(default)]
    pub(super) kept_ring: Option<usize>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshFile {
    pub(super) file: PathBuf,
    #[serde(default)]
    pub(super) weft: Option<Axis>,
    #[serde(default)]
    pub(super) warp: Option<Axis>,
}

/// An axis of space.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Axis {
    X,
    Y,
    Z,
}

/// Held nodes: exactly one of the first five keys.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct HoldFile {
    #[serde(default)]
    pub(super) corner: Option<Corner>,
    #[serde(default)]
    pub(super) edge: Option<EdgeName>,
    #[serde(default, rename = "box")]
    pub(super) within: Option<BoxFile>,
    #[serde(default)]
    pub(super) circle: Option<CircleFile>,
    #[serde(default)]
    pub(super) nodes: Option<Vec<usize>>,
    #[serde(default)]
    pub(super) free: Option<FreeName>,
    #[serde(default)]
    pub(super) direction: Option<[f64; 3]>,
}

/// Left and right along weft, bottom and top along warp.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Corner {
    BottomLeft,
    BottomRight,
    TopLeft,
    TopRight,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum EdgeName {
    Left,
    Right,
    Bottom,
    Top,
}

/// A box in material coordinates.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BoxFile {
    pub(super) low_m: [f64; 2],
    pub(super) high_m: [f64; 2],
}

/// A circle in material coordinates.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CircleFile {
    pub(super) centre_m: [f64; 2],
    pub(super) radius_m: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum FreeName {
    Plane,
    Line,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StartFile {
    #[serde(default)]
    pub(super) perturbation_m: f64,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DampingFile {
    #[serde(default)]
    pub(super) mass_per_s: f64,
    #[serde(default)]
    pub(super) stiffness_s: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WindFile {
    pub(super) velocity_m_s: [f64; 3],
    #[serde(default)]
    pub(super) gust_m_s: Option<[f64; 3]>,
    #[serde(default)]
    pub(super) gust_period_s: Option<f64>,
    #[serde(default)]
    pub(super) air_density_kg_m3: Option<f64>,
    #[serde(default)]
    pub(super) normal_drag: Option<f64>,
    #[serde(default)]
    pub(super) tangential_drag: Option<f64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SolverFile {
    #[serde(default)]
    pub(super) integrator: IntegratorName,
    #[serde(default)]
    pub(super) newton: Option<NewtonName>,
    #[serde(default)]
    pub(super) tolerance: Option<f64>,
    #[serde(default)]
    pub(super) linear: Option<LinearName>,
    #[serde(default)]
    pub(super) linear_tolerance: Option<f64>,
    #[serde(default)]
    pub(super) linear_iterations: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum IntegratorName {
    #[default]
    ImplicitEuler,
    RungeKutta,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum NewtonName {
    Converged,
    Single,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum LinearName {
    Direct,
    ConjugateGradient,
}
