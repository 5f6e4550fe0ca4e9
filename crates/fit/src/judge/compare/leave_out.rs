//! Leave-one-out: predicts each sequence from the others, where they still show its components.

use super::distance::Distance;
use crate::incremental::{self, FitReport, Stage};
use crate::judge::prediction::predict;
use crate::stage::knowledge::Knowledge;
use crate::stage::{Settings, Watch};
use cloth_data::error::Result;
use cloth_data::frame::{Kind, MeasurementSet, Sequence};
use cloth_sim::material::Component;
use serde::{Deserialize, Serialize};

/// A sequence that was left out of the fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LeftOut {
    /// Its name.
    pub sequence: String,
    /// Components that no other sequence shows; if any, there is no prediction.
    pub lost: Vec<Component>,
    /// The error, if the other sequences could not be fitted or this one not predicted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// Distance of the prediction from the measurement.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<Distance>,
}

impl LeftOut {
    /// The overall figure; `None` without a prediction.
    pub fn relative(&self) -> Option<f64> {
        self.distance?.relative
    }
}

/// Leaves out each fitted sequence in turn.
pub(super) fn each(
    set: &MeasurementSet,
    report: &FitReport,
    settings: &Settings,
    watch: &mut Watch<'_>,
) -> Vec<LeftOut> {
    let fitted: Vec<String> = report.sequences().iter().map(|(_, sequence)| sequence.name.clone()).collect();
    let sequences = set.sequences.iter().filter(|sequence| fitted.contains(&sequence.name));
    sequences.map(|sequence| one(set, sequence, report, settings, watch)).collect()
}

fn one(
    set: &MeasurementSet,
    left_out: &Sequence,
    all: &FitReport,
    settings: &Settings,
    watch: &mut Watch<'_>,
) -> LeftOut {
    let rest = with(set, |sequence| sequence.name != left_out.name);
    let known = |component: &Component| all.knowledge.knows(*component);
    let unseen = |component: &Component| !is_shown(&rest, *component, settings);
    let lost: Vec<Component> = Component::ALL.into_iter().filter(known).filter(unseen).collect();
    let mut result = LeftOut { sequence: left_out.name.clone(), lost, failure: None, distance: None };
    if result.lost.is_empty() {
        match predicted(&rest, &with(set, |sequence| sequence.name == left_out.name), settings, watch) {
            // A sequence of the right kind may still not determine the component.
            Ok((_, missing)) if missing.iter().any(known) => {
                result.lost = missing.into_iter().filter(known).collect();
            }
            Ok((distance, _)) => result.distance = Some(distance),
            Err(error) => result.failure = Some(error.to_string()),
        }
    }
    result
}

/// Predicts one sequence from a fit of the rest; also returns the components that the fit does not know.
fn predicted(
    rest: &MeasurementSet,
    alone: &MeasurementSet,
    settings: &Settings,
    watch: &mut Watch<'_>,
) -> Result<(Distance, Vec<Component>)> {
    let report = incremental::fit(rest, &Stage::ALL, &Knowledge::default(), settings, watch)?;
    let kinds: Vec<Kind> = alone.sequences.iter().map(|sequence| sequence.kind).collect();
    let prediction = predict(alone, &kinds, report.curves(), &report.assumed(), settings, watch)?;
    Ok((Distance::of_prediction(alone, &prediction), report.missing()))
}

/// The sequences of a set that `keep` selects.
fn with(set: &MeasurementSet, keep: impl Fn(&Sequence) -> bool) -> MeasurementSet {
    MeasurementSet {
        fabric: set.fabric.clone(),
        sequences: set.sequences.iter().filter(|sequence| keep(sequence)).cloned().collect(),
    }
}

/// True if some sequence is of a kind that shows a component, or the one that shares its curve.
fn is_shown(set: &MeasurementSet, component: Component, settings: &Settings) -> bool {
    let pairs =
        [[Component::StretchWeft, Component::StretchWarp], [Component::BendWeft, Component::BendWarp]];
    let pair = pairs.iter().find(|pair| settings.variant.is_isotropic() && pair.contains(&component));
    let sharing = pair.map_or(vec![component], |pair| pair.to_vec());
    let shows = |kind: Kind| sharing.iter().any(|component| kind.shows().contains(component));
    set.sequences.iter().any(|sequence| shows(sequence.kind))
}
