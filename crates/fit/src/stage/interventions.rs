//! Numerical interventions, counted and reported: regularised, projected, extrapolated, clamped, down-weighted, left
//! out, restarted.
//!
//! The report lists frames without an equilibrium, frames at rest, directions that the data do not see and assumed
//! curves separately.

use super::level::Level;
use crate::equilibria::{Counters, Equilibria};
use crate::optimise::gauss_newton::Outcome;
use cloth_sim::equilibrium::Remedies;
use cloth_sim::material::Component;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Counts of numerical interventions in a stage or a prediction. Zeros are not written.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Interventions {
    /// Equilibria whose imbalance was compared with rounding, since the tolerance lies below it.
    #[serde(skip_serializing_if = "is_zero")]
    pub equilibria_decided_by_rounding: usize,
    /// Stiffness matrices that were not positive definite and were clamped element by element.
    #[serde(skip_serializing_if = "is_zero")]
    pub matrices_clamped: usize,
    /// Stiffness matrices damped by μI: not positive definite, or shortly after one that was not.
    #[serde(skip_serializing_if = "is_zero")]
    pub matrices_damped: usize,
    /// Solves that Newton's method could not finish and Levenberg–Marquardt continued.
    #[serde(skip_serializing_if = "is_zero")]
    pub solves_by_levenberg_marquardt: usize,
    /// Failed solves that were restarted with a softer or stiffer membrane.
    #[serde(skip_serializing_if = "is_zero")]
    pub solves_continued: usize,
    /// Unstable equilibria that were left for a lower one nearby.
    #[serde(skip_serializing_if = "is_zero")]
    pub unstable_balances_left: usize,
    /// Solves restarted from the shape blended between the clips.
    #[serde(skip_serializing_if = "is_zero")]
    pub solves_begun_anew: usize,
    /// Solves that then took load steps from the flat sheet.
    #[serde(skip_serializing_if = "is_zero")]
    pub solves_in_load_steps: usize,
    /// Load steps, or steps of a descent to rest, that were too long and were halved.
    #[serde(skip_serializing_if = "is_zero")]
    pub steps_halved: usize,
    /// Time steps restarted with descent in every iteration.
    #[serde(skip_serializing_if = "is_zero")]
    pub time_steps_begun_anew: usize,
    /// Frames that continuation from the previous frame did not reach; they started from their measured shape.
    #[serde(skip_serializing_if = "is_zero")]
    pub frames_not_followed: usize,
    /// Rejected steps of the fit: too little decrease, or a point that could not be evaluated.
    #[serde(skip_serializing_if = "is_zero")]
    pub steps_rejected: usize,
    /// Steps of the fit whose linearised problem was not solved to full accuracy.
    #[serde(skip_serializing_if = "is_zero")]
    pub steps_inaccurate: usize,
    /// Starts of a level that violated a constraint of the curve and were projected to the nearest feasible point.
    #[serde(skip_serializing_if = "is_zero")]
    pub starts_projected: usize,
    /// Residuals with less weight: outliers, if a robust fit was requested.
    #[serde(skip_serializing_if = "is_zero")]
    pub residuals_bent: usize,
    /// Vertices too far off a line of the table to be used for its position.
    #[serde(skip_serializing_if = "is_zero")]
    pub vertices_left_out: usize,
    /// Frames that no finer grid corrects: it has no equilibrium near theirs. The band does not hold their grid's error.
    #[serde(skip_serializing_if = "is_zero")]
    pub frames_uncorrected: usize,
    /// Share of the sheet, over all frames, strained beyond the last control point of a component's curve, where
    /// stress continues straight.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub share_extrapolated: BTreeMap<Component, f64>,
}

impl From<Remedies> for Interventions {
    /// The interventions of the solver alone.
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
    /// The interventions of solves, and of the shapes that a simulation reached.
    pub fn new(counters: &Counters, simulation: &Equilibria<'_>) -> Self {
        Self {
            equilibria_decided_by_rounding: counters.by_rounding,
            solves_begun_anew: counters.begun_anew,
            solves_in_load_steps: counters.in_load_steps,
            frames_not_followed: counters.not_followed,
            vertices_left_out: simulation.vertices_left_out(),
            frames_uncorrected: simulation.uncorrected(),
            share_extrapolated: simulation.extrapolated(),
            ..Self::from(counters.remedies)
        }
    }

    /// Adds the interventions of a fit.
    ///
    /// * `outcome` — final outcome, with residuals as weighted
    pub fn with_fit(self, levels: &[Level], simulation: &Equilibria<'_>, outcome: &Outcome) -> Self {
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

    /// True if there were no interventions.
    pub fn none(&self) -> bool {
        *self == Self::default()
    }

    /// Each intervention in a few words.
    pub fn in_words(&self) -> Vec<String> {
        let counts = [
            (self.equilibria_decided_by_rounding, "equilibria decided by rounding"),
            (self.matrices_clamped, "matrices clamped"),
            (self.matrices_damped, "matrices damped"),
            (self.solves_by_levenberg_marquardt, "solves finished by Levenberg-Marquardt"),
            (self.solves_continued, "solves restarted with a softer or stiffer membrane"),
            (self.unstable_balances_left, "unstable equilibria left"),
            (self.solves_begun_anew, "solves restarted"),
            (self.solves_in_load_steps, "solves in load steps"),
            (self.steps_halved, "steps halved"),
            (self.time_steps_begun_anew, "time steps restarted with descent"),
            (self.frames_not_followed, "frames not reached from the previous one"),
            (self.steps_rejected, "fit steps rejected"),
            (self.steps_inaccurate, "fit steps solved inexactly"),
            (self.starts_projected, "infeasible starts projected"),
            (self.residuals_bent, "residuals downweighted"),
            (self.vertices_left_out, "vertices too far off the profile of their overhang"),
            (
                self.frames_uncorrected,
                "frames not corrected for the grid, whose error there is not in the band",
            ),
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
