//! `material.json`: what a simulator needs of a fitted fabric, and how sure it is.
//!
//! Versioned by its `schema`. Control points, not samples, so that nothing is lost on the way to a simulator of ours.

use crate::error::{Error, Result};
use crate::frame::{Fabric, Kind, MeasurementSet};
use crate::report::{CurveReport, SequenceReport, StageReport};
use crate::stage::{Constraints, Settings};
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::material::{Component, Compression, Curves, Model};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The version of the file that is written and read.
pub const SCHEMA: &str = "fit-cloth/material/1";

/// The whole file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialFile {
    /// [`SCHEMA`].
    pub schema: String,
    /// The cloth model whose strains the curves are over.
    pub model: Model,
    /// What weft and warp do under compression.
    pub compression: Compression,
    /// The sample that was measured.
    pub fabric: Fabric,
    /// One entry a component, observed or not.
    pub curves: BTreeMap<Component, CurveEntry>,
    /// How each sequence was met.
    pub residuals: Vec<ResidualEntry>,
    /// How the file came about.
    pub provenance: Provenance,
}

/// A component's curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurveEntry {
    /// False if no frame sees the component; then nothing else stands here.
    pub observed: bool,
    /// The control points of k(ε), a Hermite spline: docs/model.md.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub control_points: Vec<ControlPoint>,
    /// The strains that the measurement visited.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visited_strain: Option<[f64; 2]>,
    /// Directions of the control values that the data see.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rank: Option<usize>,
    /// Constraints that hold the solution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub active_constraints: Option<usize>,
    /// Noise of one force component, N: given, or estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise_n: Option<f64>,
    /// What the model cannot follow beyond that noise, N; 0 if nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub misfit_n: Option<f64>,
    /// The fit came to its minimum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub converged: Option<bool>,
}

/// A control point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControlPoint {
    /// Strain.
    pub strain: f64,
    /// Stiffness, N/m.
    pub stiffness_n_per_m: f64,
    /// Standard deviation of the stiffness, N/m; absent where no frame sees it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deviation_n_per_m: Option<f64>,
}

/// How a sequence was met.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResidualEntry {
    /// Name of the sequence.
    pub sequence: String,
    /// Which test.
    pub kind: Kind,
    /// Frames used.
    pub frames: usize,
    /// Root mean square over all measured force components, N.
    pub rms_force_n: f64,
    /// Largest measured force component, N.
    pub largest_force_n: f64,
    /// Root mean square over all observed nodes, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rms_position_m: Option<f64>,
    /// Measured stiffness on loading over the curve's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loading_stiffness: Option<f64>,
    /// Measured stiffness on unloading over the curve's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unloading_stiffness: Option<f64>,
}

/// How the file came about.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Program and version.
    pub program: String,
    /// What kept the curves physical.
    pub constraints: Constraints,
    /// Columns and rows of the simulation, a sequence each.
    pub nodes: BTreeMap<String, [usize; 2]>,
}

impl MaterialFile {
    /// Collects what the stages of one model found.
    pub fn new(set: &MeasurementSet, settings: &Settings, stages: &[StageReport]) -> Self {
        let entry = |component| match stages.iter().find(|stage| stage.components.contains(&component)) {
            Some(stage) => CurveEntry::new(stage),
            None => CurveEntry::unobserved(),
        };
        let sequences = || stages.iter().flat_map(|stage| &stage.sequences);
        Self {
            schema: SCHEMA.into(),
            model: settings.model,
            compression: settings.compression,
            fabric: set.fabric.clone(),
            curves: Component::ALL.into_iter().map(|component| (component, entry(component))).collect(),
            residuals: sequences().map(ResidualEntry::new).collect(),
            provenance: Provenance {
                program: concat!("fit-cloth ", env!("CARGO_PKG_VERSION")).into(),
                constraints: settings.constraints,
                nodes: sequences().map(|sequence| (sequence.name.clone(), sequence.nodes)).collect(),
            },
        }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// A file that cannot be read, or is no such file, with line and field.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|source| Error::io(path, source))?;
        let refuse = |error: serde_json::Error| {
            Error::input(
                path,
                error.line(),
                "material",
                error.to_string(),
                "a material.json that fit-cloth wrote",
            )
        };
        // The version first: another one may well have other fields.
        let value: serde_json::Value = serde_json::from_str(&text).map_err(refuse)?;
        if value["schema"] != SCHEMA {
            return Err(Error::input(path, None, "schema", value["schema"].to_string(), SCHEMA));
        }
        serde_json::from_str(&text).map_err(refuse)
    }

    /// The file's text.
    pub fn to_json(&self) -> String {
        // Strings, numbers and maps with string keys: nothing here can fail to be JSON.
        serde_json::to_string_pretty(self).map(|text| text + "\n").unwrap_or_default()
    }

    /// The curves that were observed.
    ///
    /// # Errors
    /// Control points that make no curve.
    pub fn curves(&self) -> Result<Curves> {
        self.curves
            .iter()
            .filter(|(_, entry)| entry.observed)
            .map(|(&component, entry)| {
                let points = &entry.control_points;
                StiffnessCurve::new(
                    points.iter().map(|point| point.strain).collect(),
                    points.iter().map(|point| point.stiffness_n_per_m).collect(),
                    self.model.negative_strain(component, self.compression),
                )
                .map(|curve| (component, curve))
                .map_err(|source| Error::Mechanics { context: component.to_string(), source })
            })
            .collect()
    }
}

impl CurveEntry {
    fn unobserved() -> Self {
        Self {
            observed: false,
            control_points: Vec::new(),
            visited_strain: None,
            rank: None,
            active_constraints: None,
            noise_n: None,
            misfit_n: None,
            converged: None,
        }
    }

    fn new(stage: &StageReport) -> Self {
        let CurveReport { curve, deviations, visited, rank, active_constraints, .. } = &stage.curve;
        let point = |(i, &deviation): (usize, &Option<f64>)| ControlPoint {
            strain: curve.strains()[i],
            stiffness_n_per_m: curve.stiffnesses()[i],
            deviation_n_per_m: deviation,
        };
        Self {
            observed: true,
            control_points: deviations.iter().enumerate().map(point).collect(),
            visited_strain: Some(*visited),
            rank: Some(*rank),
            active_constraints: Some(*active_constraints),
            noise_n: Some(stage.scatter.noise),
            misfit_n: Some(stage.scatter.misfit),
            converged: Some(stage.converged),
        }
    }
}

impl ResidualEntry {
    fn new(sequence: &SequenceReport) -> Self {
        Self {
            sequence: sequence.name.clone(),
            kind: sequence.kind,
            frames: sequence.frames,
            rms_force_n: sequence.force_rms.unwrap_or(0.0),
            largest_force_n: sequence.force_largest,
            rms_position_m: sequence.position_rms,
            loading_stiffness: sequence.hysteresis.map(|h| h.loading),
            unloading_stiffness: sequence.hysteresis.map(|h| h.unloading),
        }
    }
}
