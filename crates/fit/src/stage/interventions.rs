//! What was regularised, projected, extrapolated, clamped, bent, left out or tried again on the way to a result: counted and
//! told, so that nothing is mended in silence.
//!
//! Frames without an equilibrium, frames at rest, directions that the data do not see and assumed curves stand in the report
//! on their own.

use super::level::Level;
use crate::equilibria::{Counters, Simulation};
use crate::optimise::gauss_newton::Outcome;
use cloth_sim::equilibrium::Remedies;
use cloth_sim::material::Component;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How often a stage, or a prediction, helped itself. What is zero is not written.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Interventions {
    /// Equilibria whose imbalance was measured against rounding, since the tolerance lies below it.
    #[serde(skip_serializing_if = "is_zero")]
    pub equilibria_decided_by_rounding: usize,
    /// Stiffness matrices that were not positive definite, and were clamped element by element.
    #[serde(skip_serializing_if = "is_zero")]
    pub matrices_clamped: usize,
    /// Stiffness matrices that were not positive definite, or had not been shortly before, and were damped by μI.
    #[serde(skip_serializing_if = "is_zero")]
    pub matrices_damped: usize,
    /// Solves that Newton's method could not finish and Levenberg–Marquardt went on with.
    #[serde(skip_serializing_if = "is_zero")]
    pub solves_by_levenberg_marquardt: usize,
    /// Solves that came to nothing, and were begun anew with a softer or stiffer membrane.
    #[serde(skip_serializing_if = "is_zero")]
    pub solves_continued: usize,
    /// Balances that were not stable, and were left for a lower one beside them.
    #[serde(skip_serializing_if = "is_zero")]
    pub unstable_balances_left: usize,
    /// Solves begun anew from the shape blended between the clips.
    #[serde(skip_serializing_if = "is_zero")]
    pub solves_begun_anew: usize,
    /// Solves that then took load steps from the flat sheet.
    #[serde(skip_serializing_if = "is_zero")]
    pub solves_in_load_steps: usize,
    /// Load steps, or steps of a descent to rest, that were too long and were halved.
    #[serde(skip_serializing_if = "is_zero")]
    pub steps_halved: usize,
    /// Time steps that were begun anew, downhill all the way.
    #[serde(skip_serializing_if = "is_zero")]
    pub time_steps_begun_anew: usize,
    /// Frames that could not be followed from the one before, and started from their measured shape.
    #[serde(skip_serializing_if = "is_zero")]
    pub frames_not_followed: usize,
    /// Steps of the fit that lowered the residual too little, or led nowhere, and were taken back.
    #[serde(skip_serializing_if = "is_zero")]
    pub steps_rejected: usize,
    /// Steps of the fit whose linearised problem was solved, but not to the last digit.
    #[serde(skip_serializing_if = "is_zero")]
    pub steps_inaccurate: usize,
    /// Starts of a level that broke a constraint of the curve, and were projected to the nearest that does not.
    #[serde(skip_serializing_if = "is_zero")]
    pub starts_projected: usize,
    /// Residuals that count less, as outliers do where that was asked for.
    #[serde(skip_serializing_if = "is_zero")]
    pub residuals_bent: usize,
    /// Vertices seen so far off a line of the table that they were left out of its place.
    #[serde(skip_serializing_if = "is_zero")]
    pub vertices_left_out: usize,
    /// Share of the sheet, over all frames, in which a component is strained beyond its curve's last control point, where
    /// stress goes on straight.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub share_extrapolated: BTreeMap<Component, f64>,
}

impl From<Remedies> for Interventions {
    /// Those of the solver alone.
    fn from(remedies: Remedies) -> Self {
        Self {
            matrices_clamped: remedies.clamped,
            matrices_damped: remedies.damped,
            solves_by_levenberg_marquardt: remedies.levenberg_marquardt,
            unstable_balances_left: remedies.escapes,
            solves_continued: remedies.continued,
            steps_halved: remedies.halved,
            time_steps_begun_anew: remedies.careful,
            ..Self::default()
        }
    }
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

impl Interventions {
    /// Those of solves, and of the shapes that a simulation has come to.
    pub fn new(counters: &Counters, simulation: &Simulation<'_>) -> Self {
        Self {
            equilibria_decided_by_rounding: counters.by_rounding,
            solves_begun_anew: counters.begun_anew,
            solves_in_load_steps: counters.in_load_steps,
            frames_not_followed: counters.not_followed,
            vertices_left_out: simulation.vertices_left_out(),
            share_extrapolated: simulation.extrapolated(),
            ..Self::from(counters.remedies)
        }
    }

    /// With those of a fit.
    ///
    /// * `outcome` — its end, in residuals as they count
    pub fn with_fit(self, levels: &[Level], simulation: &Simulation<'_>, outcome: &Outcome) -> Self {
        let steps = || levels.iter().flat_map(|level| &level.iterations);
        let bent = simulation.task().robust.map_or(f64::INFINITY, |robust| robust.bend(robust.limit).0);
        Self {
            steps_rejected: steps().filter(|step| !step.accepted).count(),
            steps_inaccurate: steps().filter(|step| !step.solved).count(),
            starts_projected: levels.iter().map(|level| level.projected).sum(),
            residuals_bent: outcome.residual.iter().filter(|residual| residual.abs() > bent).count(),
            ..self
        }
    }

    /// True if nothing was needed.
    pub fn none(&self) -> bool {
        *self == Self::default()
    }

    /// Each in a few words.
    pub fn in_words(&self) -> Vec<String> {
        let counts = [
            (self.equilibria_decided_by_rounding, "equilibria decided by rounding"),
            (self.matrices_clamped, "matrices clamped"),
            (self.matrices_damped, "matrices damped"),
            (self.solves_by_levenberg_marquardt, "solves ended by Levenberg-Marquardt"),
            (self.solves_continued, "solves by way of a softer or stiffer membrane"),
            (self.unstable_balances_left, "unstable balances left"),
            (self.solves_begun_anew, "solves begun anew"),
            (self.solves_in_load_steps, "solves in load steps"),
            (self.steps_halved, "steps halved"),
            (self.time_steps_begun_anew, "time steps begun anew, downhill"),
            (self.frames_not_followed, "frames not followed from the one before"),
            (self.steps_rejected, "steps of the fit taken back"),
            (self.steps_inaccurate, "steps of the fit not solved to the last digit"),
            (self.starts_projected, "starts moved to where the curve's constraints hold"),
            (self.residuals_bent, "residuals that count less"),
            (self.vertices_left_out, "vertices left out of the table's lines"),
        ];
        let counted =
            counts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}"));
        let shares = self.share_extrapolated.iter();
        let shares = shares.map(|(component, share)| {
            format!("{:.2} % of the sheet beyond the last control point of {component}", 100.0 * share)
        });
        counted.chain(shares).collect()
    }
}
