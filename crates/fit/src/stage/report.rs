//! What a fit found, as plain data: nothing here computes.

use super::interventions::Interventions;
use super::level::Level;
use super::settings::Variant;
use super::shapes::Shapes;
use crate::equilibria::{Counters, DroppedFrame, Objective};
use crate::optimise::uncertainty::Scatter;
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
    /// Its control points as rows of the curve file. Bending: over curvature.
    pub points: Vec<Sample>,
    /// False if the measurements do not tell even its scale: then it is no result, and has no file.
    pub observed: bool,
    /// Standard deviation of each control value; `None` where no frame sees it.
    pub deviations: Vec<Option<f64>>,
    /// Half the 95 % band of each control value; `None` where no frame sees it.
    pub half_bands: Vec<Option<f64>>,
    /// The strains that the measurement visited; shear and bending: their sizes.
    pub visited: [f64; 2],
    /// The same as the curve file has it. Bending: curvatures, 1/m.
    pub seen: [f64; 2],
    /// Share of the range of control points that was visited, 0 … 1.
    pub share_visited: f64,
    /// 201 rows from rest, or from the smallest strain where that is negative, to the largest that was visited; without a
    /// band below those that were. Bending: over curvature.
    pub samples: Vec<Sample>,
    /// How often strains were met, over the same range. Bending: over curvature.
    pub histogram: Histogram,
    /// How many directions of the control values the data see.
    pub rank: usize,
    /// Control points that no frame sees.
    pub unseen: Vec<usize>,
    /// Correlation of each control value with each; `None` with one that the data do not see.
    pub correlations: Vec<Vec<Option<f64>>>,
    /// How many of the curve's constraints hold the solution.
    pub active_constraints: usize,
}

impl CurveReport {
    /// Pairs of control values whose correlation exceeds 0.95 in size.
    pub fn correlated(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let row = |(j, row): (usize, &Vec<Option<f64>>)| {
            row[..j].iter().enumerate().filter_map(|(i, c)| Some((i, j, (*c)?))).collect::<Vec<_>>()
        };
        self.correlations.iter().enumerate().flat_map(row).filter(|(_, _, c)| c.abs() > 0.95)
    }
}

/// One row of a curve file, or a control point in the same terms.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Strain; bending: curvature, 1/m.
    pub strain: f64,
    /// Stress over strain, N/m; bending: flexural rigidity, moment over curvature, N·m.
    pub stiffness: f64,
    /// Stress, N/m; bending: moment per width, N.
    pub stress: f64,
    /// 95 % band of the stress or moment; `None` where no frame sees it.
    pub band: Option<[f64; 2]>,
}

/// Which strains the equilibria of all frames have, by the sheet's area.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Histogram {
    /// Where the first bin begins and the last one ends.
    pub range: [f64; 2],
    /// Share of the area in each bin, all as wide; what lies outside the range is in none.
    pub shares: Vec<f64>,
}

/// How a sequence was met.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SequenceReport {
    /// Name of the sequence.
    pub name: String,
    /// Which test it is.
    pub kind: Kind,
    /// Frames used.
    pub frames: usize,
    /// Frames left out because nothing was stretched, or no force measured.
    pub at_rest: usize,
    /// Two unknowns a node.
    pub planar: bool,
    /// Columns and rows of nodes.
    pub nodes: [usize; 2],
    /// Root mean square of measured − simulated over all measured force components, N; `None` = none was measured.
    pub force_rms: Option<f64>,
    /// Largest measured force component, N; 0 if none was measured.
    pub force_largest: f64,
    /// How far its frames went at most: see [`ReplicaFrame`](crate::twin::replica::ReplicaFrame::extension).
    pub extension: f64,
    /// Root mean square distance between measured and simulated nodes, m, where shapes were measured.
    pub position_rms: Option<f64>,
    /// Frames whose residual stands out from its neighbours', the farthest first: a slip, or a wrong sign; where no force
    /// was measured, a shape far off.
    pub outliers: Vec<usize>,
    /// Frames that left an unstable equilibrium: they may have several. Their shapes are not in `position_rms`.
    pub multi_stable: Vec<usize>,
    /// Measured stiffness on loading and on unloading, as multiples of the curve's.
    pub hysteresis: Option<Hysteresis>,
    /// Every force component of every frame.
    pub forces: Vec<ForceRow>,
    /// Every frame's shape.
    pub shapes: Shapes,
}

impl SequenceReport {
    /// Frames that take no part: at rest, without a force, or without an equilibrium.
    ///
    /// * `dropped` — the frames without an equilibrium, of this and other sequences
    pub fn left_out(&self, dropped: &[DroppedFrame]) -> usize {
        self.at_rest + dropped.iter().filter(|frame| frame.sequence == self.name).count()
    }
}

/// Loading against unloading.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hysteresis {
    /// Stiffness on loading over the curve's.
    pub loading: f64,
    /// Stiffness on unloading over the curve's.
    pub unloading: f64,
}

/// One measured force component and its simulation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ForceRow {
    /// Index of the frame in its sequence.
    pub frame: usize,
    /// Loading or unloading.
    pub phase: Phase,
    /// Index of the clip.
    pub clip: usize,
    /// Which of the clip's components; its direction may turn with the clip.
    pub number: usize,
    /// Unit direction of the component, in the specimen's own frame.
    pub direction: Vector3<f64>,
    /// The same in the world's axes.
    pub world: Vector3<f64>,
    /// How far the test went: see [`ReplicaFrame`](crate::twin::replica::ReplicaFrame::extension).
    pub extension: f64,
    /// Measured, N.
    pub measured: f64,
    /// Simulated, N.
    pub simulated: f64,
}

/// What a stage took as known.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Basis {
    /// Components fitted before, whose errors the bands carry on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub carried: Vec<Component>,
    /// All components whose curves were known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub known: Vec<Component>,
    /// Components that nobody measured: a constant stiffness was assumed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub assumed: Vec<Component>,
    /// That stiffness, N/m (bending: N·m per the model's own strain). Files of former versions lack it.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub assumed_stiffness: BTreeMap<Component, f64>,
}

impl Basis {
    /// The stiffnesses that a fit has assumed of what nobody measured, given the basis of each of its curves; where its
    /// stages differ that of shear, which depends on it most.
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

/// A stage of the fit: one curve.
#[must_use]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StageReport {
    /// Which components were fitted: one, or weft and warp with a curve in common.
    pub components: Vec<Component>,
    /// First or second pass over them.
    pub pass: usize,
    /// With which model.
    pub model: Model,
    /// In which variant.
    pub variant: Variant,
    /// What was compared.
    pub objective: Objective,
    /// What was taken as known.
    pub basis: Basis,
    /// The curve.
    pub curve: CurveReport,
    /// Noise and misfit, N or m.
    pub scatter: Scatter,
    /// How each sequence was met.
    pub sequences: Vec<SequenceReport>,
    /// Frames whose equilibrium was not found; they take no part.
    pub dropped: Vec<DroppedFrame>,
    /// The levels of the curve's growth.
    pub levels: Vec<Level>,
    /// Why the growth ended.
    pub growth: String,
    /// The level that was kept came to its minimum.
    pub converged: bool,
    /// What was spent.
    pub counters: Counters,
    /// What helped it along.
    pub interventions: Interventions,
    /// Wall time, s.
    pub seconds: f64,
}

impl StageReport {
    /// The fitted components by name.
    pub fn name(&self) -> String {
        let names: Vec<String> = self.components.iter().map(|component| component.to_string()).collect();
        names.join(" = ")
    }

    /// Frames of one of its sequences that take no part: at rest, without a force, or without an equilibrium.
    pub fn left_out(&self, sequence: &SequenceReport) -> usize {
        sequence.left_out(&self.dropped)
    }
}
