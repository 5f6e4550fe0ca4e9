//! Entries of `material.json` for one curve and one sequence.

use super::control_point::{ControlPoint, Unit};
use crate::equilibria::DroppedFrame;
use crate::equilibria::Objective;
use crate::judge::verdict::{self, Verdict};
use crate::optimise::uncertainty::Source;
use crate::stage::interventions::Interventions;
use crate::stage::report::{Basis, CurveReport, SequenceReport, StageReport};
use cloth_data::frame::Kind;
use cloth_data::notice::Notice;
use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use cloth_sim::error::Error;
use cloth_sim::material::{Component, Model};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A component's curve.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurveEntry {
    /// False if the measurements do not even determine the curve's scale; it then has no control points.
    pub observed: bool,
    /// True if the fit took the curve as known: the entry is copied from the file that contained it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub given: bool,
    /// Components that share the curve, if there are several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shared_by: Vec<Component>,
    /// Verdict on the curve, with reasons.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
    /// The control points of k(ε), a Hermite spline: docs/model.md.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub control_points: Vec<ControlPoint>,
    /// Range of strains visited by the measurement.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visited_strain: Option<[f64; 2]>,
    /// Visited share of the range of control points, 0 … 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share_visited: Option<f64>,
    /// Number of directions of the control values that the data determine.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rank: Option<usize>,
    /// Control points that no frame observes, counted from 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unseen_points: Vec<usize>,
    /// Control values correlated above 0.95.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub correlations: Vec<Correlation>,
    /// Number of active constraints at the solution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub active_constraints: Option<usize>,
    /// Noise of one force component, N: given or estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise_n: Option<f64>,
    /// Model misfit beyond that noise, N; 0 if none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub misfit_n: Option<f64>,
    /// Noise of one coordinate, m, if shapes were fitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise_m: Option<f64>,
    /// Model misfit beyond that noise, m; 0 if none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub misfit_m: Option<f64>,
    /// Half-widths of the band by source where it is widest, N/m; bending: N.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub band: BTreeMap<Source, f64>,
    /// Curves that the fit took as known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub basis: Option<Basis>,
    /// First or second pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pass: Option<usize>,
    /// Frames used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frames: Option<usize>,
    /// True if the fit converged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub converged: Option<bool>,
    /// Numerical interventions; omitted if there were none.
    #[serde(default, skip_serializing_if = "Interventions::none")]
    pub interventions: Interventions,
}

/// A pair of control values that the data hardly separate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Correlation {
    /// The control points, counted from 0.
    pub points: [usize; 2],
    /// Their correlation, −1 … 1.
    pub correlation: f64,
}

impl CurveEntry {
    /// The entry for a stage's result; without a stage, only `observed: false`.
    pub(super) fn new(stage: Option<&StageReport>, notices: &[Notice]) -> Self {
        let Some(stage) = stage else { return Self::default() };
        let report = &stage.curve;
        let scatter = |objective| Some(stage.scatter).filter(|_| stage.objective == objective);
        let [forces, positions] = [Objective::Forces, Objective::Positions].map(scatter);
        let correlation = |(i, j, correlation)| Correlation { points: [i, j], correlation };
        Self {
            observed: report.observed,
            given: false,
            verdict: Some(verdict::of_stage(stage, notices)),
            shared_by: if stage.components.len() > 1 { stage.components.clone() } else { Vec::new() },
            control_points: if report.observed { control_points(stage) } else { Vec::new() },
            visited_strain: Some(report.visited),
            share_visited: Some(report.share_visited),
            rank: Some(report.rank),
            unseen_points: report.unseen.clone(),
            correlations: report.correlated().map(correlation).collect(),
            active_constraints: Some(report.active_constraints),
            noise_n: forces.map(|scatter| scatter.noise),
            misfit_n: forces.map(|scatter| scatter.misfit),
            noise_m: positions.map(|scatter| scatter.noise),
            misfit_m: positions.map(|scatter| scatter.misfit),
            band: report.band.clone(),
            basis: Some(stage.basis.clone()),
            pass: Some(stage.pass),
            frames: Some(stage.sequences.iter().map(|sequence| sequence.frames).sum()),
            converged: Some(stage.converged),
            interventions: stage.interventions.clone(),
        }
    }

    /// The curve through the control points; or the index of an invalid control point, and the reason.
    pub(super) fn curve(
        &self,
        model: Model,
        component: Component,
        negative: NegativeStrain,
    ) -> Result<StiffnessCurve, (usize, String)> {
        let points = &self.control_points;
        if let Some(point) = points.iter().position(|point| point.unit != Unit::of(model, component)) {
            let reason = match Unit::of(model, component) {
                Unit::NewtonPerMetre => "stiffness_n_m instead of stiffness_n_per_m",
                Unit::NewtonMetre => "stiffness_n_per_m instead of stiffness_n_m",
            };
            return Err((point, reason.into()));
        }
        StiffnessCurve::new(
            points.iter().map(|point| point.strain).collect(),
            points.iter().map(|point| point.stiffness).collect(),
            negative,
        )
        .map_err(|error| match error {
            Error::Curve { point, reason } => (point, reason.into()),
            other => (0, other.to_string()),
        })
    }
}

fn control_points(stage: &StageReport) -> Vec<ControlPoint> {
    let CurveReport { curve, deviations, .. } = &stage.curve;
    let unit = Unit::of(stage.model, stage.components[0]);
    let values = curve.strains().iter().zip(curve.stiffnesses()).zip(deviations);
    values
        .map(|((&strain, &stiffness), &deviation)| ControlPoint { strain, stiffness, deviation, unit })
        .collect()
}

/// Residuals of a sequence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResidualEntry {
    /// Name of the sequence.
    pub sequence: String,
    /// Kind of test.
    pub kind: Kind,
    /// Frames used.
    pub frames: usize,
    /// Root mean square over all measured force components, N, if forces were measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rms_force_n: Option<f64>,
    /// Largest measured force component, N, if forces were measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_force_n: Option<f64>,
    /// Root mean square over all observed nodes, m, if shapes were measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rms_position_m: Option<f64>,
    /// Ratio of the measured loading stiffness to the curve's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loading_stiffness: Option<f64>,
    /// Ratio of the measured unloading stiffness to the curve's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unloading_stiffness: Option<f64>,
    /// Frames whose solve left an unstable equilibrium: they may have several equilibria.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub multi_stable_frames: Vec<usize>,
    /// Frames whose residual stands out from its neighbours', the largest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outlier_frames: Vec<usize>,
    /// Skipped frames: their equilibrium was not found.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub dropped_frames: Vec<usize>,
}

impl ResidualEntry {
    /// The entry for the report of a sequence.
    ///
    /// * `dropped` — frames without an equilibrium, of any sequence
    pub fn new(sequence: &SequenceReport, dropped: &[DroppedFrame]) -> Self {
        let lost = dropped.iter().filter(|dropped| dropped.sequence == sequence.name);
        Self {
            sequence: sequence.name.clone(),
            kind: sequence.kind,
            frames: sequence.frames,
            rms_force_n: sequence.force_rms,
            largest_force_n: sequence.force_rms.map(|_| sequence.force_largest),
            rms_position_m: sequence.position_rms,
            loading_stiffness: sequence.hysteresis.map(|h| h.loading),
            unloading_stiffness: sequence.hysteresis.map(|h| h.unloading),
            multi_stable_frames: sequence.multi_stable.clone(),
            outlier_frames: sequence.outliers.clone(),
            dropped_frames: lost.map(|dropped| dropped.frame).collect(),
        }
    }
}
