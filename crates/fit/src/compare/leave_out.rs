//! One sequence left out at a time, where others still show its components: is it predicted?

use super::{Distance, missing};
use crate::error::Result;
use crate::frame::{Kind, MeasurementSet, Sequence};
use crate::incremental::{self, FitReport, Stage};
use crate::knowledge::Knowledge;
use crate::prediction::predict;
use crate::stage::{Settings, Watch, bend, stretch};
use cloth_sim::material::Component;
use serde::Serialize;

/// A sequence that was left out of the fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOut {
    /// Its name.
    pub sequence: String,
    /// Components that no other sequence shows. Then nothing is predicted.
    pub lost: Vec<Component>,
    /// How far the prediction of the others is from it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<Distance>,
}

impl LeftOut {
    /// The overall figure; `None` if it could not be predicted.
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
) -> Result<Vec<LeftOut>> {
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
) -> Result<LeftOut> {
    let with = |keep: &dyn Fn(&Sequence) -> bool| MeasurementSet {
        fabric: set.fabric.clone(),
        sequences: set.sequences.iter().filter(|sequence| keep(sequence)).cloned().collect(),
    };
    let [rest, alone] = [with(&|s| s.name != left_out.name), with(&|s| s.name == left_out.name)];
    let known = |component: &Component| all.knowledge.knows(*component);
    let unseen = |component: &Component| !is_shown(&rest, *component, settings);
    let mut lost: Vec<Component> = Component::ALL.into_iter().filter(known).filter(unseen).collect();
    let mut distance = None;
    if lost.is_empty() {
        let report = incremental::fit(&rest, &Stage::ALL, &Knowledge::default(), settings, watch)?;
        // A sequence may be of the right kind and still not tell.
        lost = missing(&report).into_iter().filter(known).collect();
        if lost.is_empty() {
            let prediction = predict(&alone, &[left_out.kind], report.curves(), settings)?;
            distance = Some(Distance::of_prediction(&alone, &prediction));
        }
    }
    Ok(LeftOut { sequence: left_out.name.clone(), lost, distance })
}

/// True if some sequence is of a kind that shows a component, or the one it shares its curve with.
fn is_shown(set: &MeasurementSet, component: Component, settings: &Settings) -> bool {
    let pairs =
        [[Component::StretchWeft, Component::StretchWarp], [Component::BendWeft, Component::BendWarp]];
    let pair = pairs.iter().find(|pair| settings.variant.is_isotropic() && pair.contains(&component));
    let sharing = pair.map_or(vec![component], |pair| pair.to_vec());
    let shows = |kind: Kind| sharing.iter().any(|&component| kinds(component).contains(&kind));
    set.sequences.iter().any(|sequence| shows(sequence.kind))
}

fn kinds(component: Component) -> Vec<Kind> {
    match component {
        Component::StretchWeft | Component::StretchWarp => vec![stretch::kind_of(component)],
        Component::Shear => Stage::Shear.kinds().to_vec(),
        _ => bend::kinds_of(component).to_vec(),
    }
}
