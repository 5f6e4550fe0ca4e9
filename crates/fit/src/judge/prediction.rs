//! Predicts tests from known curves.

use crate::equilibria::{Counters, DroppedFrame, Equilibria, Objective, SolveStart, Task, Unknowns};
use crate::stage::interventions::Interventions;
use crate::stage::report::SequenceReport;
use crate::stage::sequence_reports;
use crate::stage::{Settings, Watch, softest_bending, unyielding};
use crate::twin::replica::{Parts, Replica};
use cloth_data::error::{Error, Result};
use cloth_data::frame::{Kind, MeasurementSet, Sequence};
use cloth_data::inspection::inspect;
use cloth_data::kind::Holding;
use cloth_data::notice::Notice;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::material::{Component, Curves};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Prediction of tests from known curves.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Residuals of each sequence.
    pub sequences: Vec<SequenceReport>,
    /// Components without a curve; a constant stiffness was assumed.
    pub assumed: Vec<Component>,
    /// Skipped frames: no equilibrium.
    pub dropped: Vec<DroppedFrame>,
    /// Contradictions within the measurements; refused sequences are skipped.
    pub notices: Vec<Notice>,
    /// Cost of the solves.
    pub counters: Counters,
    /// Numerical interventions of the solves.
    pub interventions: Interventions,
}

/// Simulates all sequences of some kinds with known curves.
///
/// * `assumed` — stiffnesses that the fit assumed for components it did not know, used again here
///
/// Sheets between clips that leave their plane are followed from rest through all frames, as in a forward simulation.
///
/// # Errors
/// Invalid settings; a sequence that no replica can be made of; no sequence left after refusals.
pub fn predict(
    set: &MeasurementSet,
    kinds: &[Kind],
    curves: &Curves,
    assumed: &BTreeMap<Component, f64>,
    settings: &Settings,
    watch: &Watch<'_>,
) -> Result<Prediction> {
    settings.validate()?;
    let spent_before = watch.meter.read();
    let wanted = |sequence: &&Sequence| kinds.contains(&sequence.kind);
    let alone = set.sequences.iter().filter(wanted).cloned().collect();
    let inspection = inspect(&MeasurementSet { fabric: set.fabric.clone(), sequences: alone });
    let sequences = inspection.set.sequences.iter();
    let sequences: Vec<(&Sequence, Parts)> =
        sequences.map(|sequence| (sequence, parts(sequence.kind, set, curves, assumed, settings))).collect();
    if sequences.is_empty() {
        inspection.check_refusals(kinds)?;
    }
    let replicas: Vec<Replica> =
        sequences.iter().map(|(sequence, parts)| Replica::new(sequence, parts)).collect::<Result<_>>()?;
    let takes_part =
        |component: &Component| sequences.iter().any(|(_, parts)| parts.components.contains(component));
    let unknown =
        settings.model.components().into_iter().filter(|&component| curves.get(component).is_none());
    let unknown: Vec<Component> = unknown.filter(takes_part).collect();
    let task = Task {
        objective: Objective::Forces,
        known: completed(curves, &unknown, assumed, &replicas, settings)?,
        settings: settings.equilibrium,
        start: SolveStart::LastEquilibrium,
        exact_clips: true,
        robust: None,
    };
    // Curves are those of the continuum, so a prediction is corrected for its grid, too.
    let finer = |(sequence, parts): &(&Sequence, Parts)| {
        Replica::new(sequence, &Parts { refinement: 2, ..parts.clone() })
    };
    let between_clips =
        sequences.iter().filter(|(sequence, _)| settings.corrects() && !sequence.clips.is_empty());
    let finer: Vec<Replica> = between_clips.map(finer).collect::<Result<_>>()?;
    let mut simulation =
        Equilibria::unsettled(&replicas, task, Unknowns::default(), Arc::clone(&watch.meter))
            .corrected_by(&finer);
    simulation.follow();
    if simulation.is_corrected() {
        simulation.settle();
        simulation.correct();
    }
    let forces = simulation.settle();
    let counters = watch.meter.read().since(&spent_before);
    Ok(Prediction {
        interventions: Interventions::new(&counters, &simulation),
        sequences: sequence_reports(&simulation, &forces),
        assumed: unknown,
        dropped: simulation.dropped().to_vec(),
        notices: inspection.notices.clone(),
        counters,
    })
}

/// The known curves, completed by assumed ones, as in the fit where its assumptions are given. Otherwise: for one of
/// weft and warp, the mean stiffness of the other, which hardly matters across a strip; for both, and for the shear
/// of a sheet on a table, a nearly inextensible membrane; for a bending curve, the softest of the others, without
/// which the sheet would crumple along its lines.
fn completed(
    curves: &Curves,
    unknown: &[Component],
    assumed: &BTreeMap<Component, f64>,
    replicas: &[Replica],
    settings: &Settings,
) -> Result<Curves> {
    let mean = |component: Component| {
        let curve = curves.get(component)?;
        Some(curve.stiffnesses().iter().sum::<f64>() / curve.len() as f64)
    };
    let stretch = mean(Component::StretchWeft).or(mean(Component::StretchWarp));
    let shear = mean(Component::Shear).unwrap_or(0.0);
    let mut completed = curves.clone();
    for &component in unknown {
        let other = match component {
            _ if component.is_bending() => softest_bending(curves),
            _ if component.is_stretch() => stretch,
            _ => None,
        };
        let stiffness = assumed.get(&component).copied().or(other);
        let stiffness = stiffness.unwrap_or_else(|| unyielding(replicas, component, shear));
        let negative = settings.model.negative_strain(component, settings.compression);
        completed.set(component, StiffnessCurve::constant(stiffness, negative).map_err(mechanics)?);
    }
    Ok(completed)
}

fn mechanics(source: cloth_sim::error::Error) -> Error {
    Error::Mechanics { context: "prediction".into(), source }
}

/// Components of a test's replica. Strips pulled along their yarns have neither shear nor bending. Without any
/// bending, known or assumed, a sheet between clips stays in its plane, since in space it would crumple. Only a sheet
/// on a table has shear without a known curve.
fn parts(
    kind: Kind,
    set: &MeasurementSet,
    curves: &Curves,
    assumed: &BTreeMap<Component, f64>,
    settings: &Settings,
) -> Parts {
    let stretches = kind.is_along_yarns();
    let bends = curves.components().chain(assumed.keys().copied()).any(Component::is_bending);
    let off_table = kind.holding() == Holding::Table;
    let takes_part = |component: Component| match component {
        _ if component.is_stretch() => true,
        _ if stretches => false,
        Component::Shear => off_table && bends || curves.get(component).is_some(),
        _ => bends,
    };
    Parts {
        model: settings.model,
        flat: kind.is_on_the_bias() || !stretches && !bends,
        components: settings
            .model
            .components()
            .into_iter()
            .filter(|&component| takes_part(component))
            .collect(),
        areal_density: set.fabric.areal_density_kg_m2,
        grid: settings.grid(),
        diagonals: settings.diagonals,
        refinement: 1,
        table: settings.table,
    }
}
