//! One model in one variant, as figures.

use super::distance::Distance;
use super::leave_out::LeftOut;
use crate::stage::{Settings, Variant};
use cloth_data::error::Error;
use cloth_sim::material::{Component, Model};
use serde::{Deserialize, Serialize};

/// One model in one variant.
#[must_use]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The model.
    pub model: Model,
    /// The variant.
    pub variant: Variant,
    /// Error of the fit, if it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// Control values of all observed curves; a shared one counts once.
    pub parameters: usize,
    /// Components that no sequence determines.
    pub missing: Vec<Component>,
    /// Distance on the fitted sequences.
    pub fit: Distance,
    /// Distance on the validation sequences, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub validation: Option<Distance>,
    /// Every sequence left out in turn, if requested.
    pub left_out: Vec<LeftOut>,
    /// Overall figure of the left-out sequences; `None` if none could be spared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leave_one_out: Option<f64>,
    /// Equilibria sought in the fit.
    pub equilibria: usize,
    /// Factorisations in the fit.
    pub factorisations: usize,
    /// Wall time of the fit, s.
    pub seconds: f64,
    /// Every stage converged.
    pub converged: bool,
}

/// The overall figure that ranks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Criterion {
    /// Of the sequences left for validation.
    Validation,
    /// Of sequences left out one at a time.
    LeaveOneOut,
    /// Of the fitted sequences.
    Fit,
}

impl Row {
    /// A row for a failed fit.
    pub fn failed(settings: &Settings, error: &Error) -> Self {
        Self {
            model: settings.model,
            variant: settings.variant,
            failure: Some(error.to_string()),
            parameters: 0,
            missing: settings.model.components().to_vec(),
            fit: Distance::default(),
            validation: None,
            left_out: Vec::new(),
            leave_one_out: None,
            equilibria: 0,
            factorisations: 0,
            seconds: 0.0,
            converged: false,
        }
    }

    /// Frames without an equilibrium, which an overall figure does not include.
    pub(super) fn dropped(&self, criterion: Criterion) -> usize {
        match criterion {
            Criterion::Validation => self.validation.map_or(0, |distance| distance.dropped),
            Criterion::LeaveOneOut | Criterion::Fit => self.fit.dropped,
        }
    }

    /// An overall figure; `None` if it does not exist.
    pub fn figure(&self, criterion: Criterion) -> Option<f64> {
        match criterion {
            Criterion::Validation => self.validation?.relative,
            Criterion::LeaveOneOut => self.leave_one_out,
            Criterion::Fit => self.fit.relative,
        }
    }
}
