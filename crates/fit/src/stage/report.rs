//! Results of a fit, as plain data without computation.

use super::interventions::Interventions;
use super::level::Level;
use super::settings::Variant;
use super::shapes::Shapes;
use crate::equilibria::{Counters, DroppedFrame, Objective};
use crate::optimise::uncertainty::{Scatter, Source};
use crate::twin::replica::SkippedFrame;
use cloth_data::frame::{Kind, Phase};
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::material::{Component, Model};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A fitted curve with its uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CurveReport {
    /// The curve, over the model's own strain.
    pub curve: StiffnessCurve,
    /// The control points as rows of the curve file. Bending: over curvature.
    pub points: Vec<CurveRow>,
    /// False if the measurements do not even determine the curve's scale; it is then no result and has no file.
    pub observed: bool,
    /// Standard deviation of each control value; `None` if no frame observes it.
    pub deviations: Vec<Option<f64>>,
    /// Half-width of the 95 % band of each control value; `None` if no frame observes it.
    pub half_bands: Vec<Option<f64>>,
    /// Strains visited by the measurement; shear and bending: absolute values.
    pub visited: [f64; 2],
    /// The range in the units of the curve file. Bending: curvatures, 1/m.
    pub seen: [f64; 2],
    /// Visited share of the range of control points, 0 … 1.
    pub share_visited: f64,
    /// 201 rows from rest, or from the smallest strain if that is negative, to the largest visited strain; no band
    /// below the visited strains. Bending: over curvature.
    pub samples: Vec<CurveRow>,
    /// Half-widths of the band by source, where it is widest, N/m; bending: N. Their squares add up to that of the band,
    /// but for its cut at zero stress.
    pub band: BTreeMap<Source, f64>,
    /// Distribution of strains over the same range. Bending: over curvature.
    pub histogram: Histogram,
    /// Number of directions of the control values that the data determine.
    pub rank: usize,
    /// Control points that no frame observes.
    pub unseen: Vec<usize>,
    /// Correlation matrix of the control values; `None` for pairs with one that the data do not see.
    pub correlations: Vec<Vec<Option<f64>>>,
    /// Number of active constraints at the solution.
    pub active_constraints: usize,
}

impl CurveReport {
    /// Largest stress of its rows, N/m; bending: moment, N.
    pub fn largest_stress(&self) -> f64 {
        self.samples.iter().fold(f64::MIN_POSITIVE, |most, row| most.max(row.stress.abs()))
    }

    /// Pairs of control values with an absolute correlation above 0.95.
    pub fn correlated(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let row = |(j, row): (usize, &Vec<Option<f64>>)| {
            row[..j].iter().enumerate().filter_map(|(i, c)| Some((i, j, (*c)?))).collect::<Vec<_>>()
        };
        self.correlations.iter().enumerate().flat_map(row).filter(|(_, _, c)| c.abs() > 0.95)
    }
}

/// One row of a curve file, or a control point in the same form.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CurveRow {
    /// Strain; bending: curvature, 1/m.
    pub strain: f64,
    /// Stress over strain, N/m; bending: flexural rigidity, moment over curvature, N·m.
    pub stiffness: f64,
    /// Stress, N/m; bending: moment per width, N.
    pub stress: f64,
    /// 95 % band of the stress or moment; `None` if no frame observes it.
    pub band: Option<[f64; 2]>,
}

/// Distribution of strains over the sheet's area, at the equilibria of all frames.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Histogram {
    /// Start of the first bin and end of the last.
    pub range: [f64; 2],
    /// Share of the area in each bin of equal width; strains outside the range are in no bin.
    pub shares: Vec<f64>,
}

/// Residuals of a sequence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SequenceReport {
    /// Name of the sequence.
    pub name: String,
    /// Kind of test.
    pub kind: Kind,
    /// Frames used.
    pub frames: usize,
    /// Frames that take no part, each with its reason.
    pub skipped: Vec<SkippedFrame>,
    /// True if nodes move in the plane only: two unknowns per node.
    pub planar: bool,
    /// Columns and rows of nodes.
    pub nodes: [usize; 2],
    /// Root mean square of measured − simulated over all measured force components, N; `None` if none was measured.
    pub force_rms: Option<f64>,
    /// Largest measured force component, N; 0 if none was measured.
    pub force_largest: f64,
    /// Largest extension of its frames: see [`ReplicaFrame`](crate::twin::replica::ReplicaFrame::extension).
    pub extension: f64,
    /// Root mean square distance between measured and simulated nodes, m, if shapes were measured.
    pub position_rms: Option<f64>,
    /// Frames whose residual stands out from its neighbours', the largest first: slip, or a wrong sign; without
    /// measured forces, a shape far off.
    pub outliers: Vec<usize>,
    /// Frames whose solve left an unstable equilibrium: they may have several equilibria. `position_rms` omits their
    /// shapes.
    pub multi_stable: Vec<usize>,
    /// Measured loading and unloading stiffness, as multiples of the curve's.
    pub hysteresis: Option<Hysteresis>,
    /// Every force component of every frame.
    pub forces: Vec<ForceRow>,
    /// Every frame's shape.
    pub shapes: Shapes,
}

impl SequenceReport {
    /// Skipped frames: at rest, without a force, or without an equilibrium.
    ///
    /// * `dropped` — frames without an equilibrium, of this and other sequences
    pub fn left_out(&self, dropped: &[DroppedFrame]) -> usize {
        self.skipped.len() + dropped.iter().filter(|frame| frame.sequence == self.name).count()
    }
}

/// Hysteresis: loading and unloading stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hysteresis {
    /// Ratio of loading stiffness to the curve's.
    pub loading: f64,
    /// Ratio of unloading stiffness to the curve's.
    pub unloading: f64,
}

/// One measured force component with its simulated value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ForceRow {
    /// Index of the frame in its sequence.
    pub frame: usize,
    /// Loading or unloading.
    pub phase: Phase,
    /// Index of the clip.
    pub clip: usize,
    /// Number of the component on its clip; its direction may turn with the clip.
    pub number: usize,
    /// Unit direction of the component, in the specimen's own frame.
    pub direction: Vector3<f64>,
    /// The force in world axes.
    pub world: Vector3<f64>,
    /// Extension of the test: see [`ReplicaFrame`](crate::twin::replica::ReplicaFrame::extension).
    pub extension: f64,
    /// Measured, N.
    pub measured: f64,
    /// Simulated, N.
    pub simulated: f64,
}

/// Curves that a stage took as known.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Basis {
    /// Components fitted before; the bands include their errors.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub carried: Vec<Component>,
    /// All components with known curves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub known: Vec<Component>,
    /// Unmeasured components; a constant stiffness was assumed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub assumed: Vec<Component>,
    /// That stiffness, N/m (bending: N·m per the model's own strain). Absent in files of earlier versions.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub assumed_stiffness: BTreeMap<Component, f64>,
}

impl Basis {
    /// The stiffnesses that a fit assumed for unmeasured components, given the basis of each of its curves. If stages
    /// differ, that of shear counts, which depends on it most.
    pub fn all_assumed<'a>(of: impl Fn(Component) -> Option<&'a Self>) -> BTreeMap<Component, f64> {
        let mut all = BTreeMap::new();
        let others = Component::ALL.into_iter().filter(|component| *component != Component::Shear);
        for basis in std::iter::once(Component::Shear).chain(others).filter_map(of) {
            for (&component, &stiffness) in &basis.assumed_stiffness {
                all.entry(component).or_insert(stiffness);
            }
        }
        all
    }
}

/// Report of one stage: one curve.
#[must_use]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StageReport {
    /// Fitted components: one, or weft and warp with a shared curve.
    pub components: Vec<Component>,
    /// First or second pass over the components.
    pub pass: usize,
    /// Model of the fit.
    pub model: Model,
    /// Variant of the model.
    pub variant: Variant,
    /// The compared quantity.
    pub objective: Objective,
    /// Curves taken as known.
    pub basis: Basis,
    /// The curve.
    pub curve: CurveReport,
    /// Noise and misfit, N or m.
    pub scatter: Scatter,
    /// Residuals of each sequence.
    pub sequences: Vec<SequenceReport>,
    /// Skipped frames: their equilibrium was not found.
    pub dropped: Vec<DroppedFrame>,
    /// Levels of the curve's growth.
    pub levels: Vec<Level>,
    /// Reason for the end of the growth.
    pub growth: String,
    /// True if the kept level converged.
    pub converged: bool,
    /// Cost of the solves.
    pub counters: Counters,
    /// Numerical interventions.
    pub interventions: Interventions,
    /// Wall time, s.
    pub seconds: f64,
}

impl StageReport {
    /// Names of the fitted components.
    pub fn name(&self) -> String {
        let names: Vec<String> = self.components.iter().map(|component| component.to_string()).collect();
        names.join(" = ")
    }

    /// Skipped frames of one of its sequences: at rest, without a force, or without an equilibrium.
    pub fn left_out(&self, sequence: &SequenceReport) -> usize {
        sequence.left_out(&self.dropped)
    }
}
