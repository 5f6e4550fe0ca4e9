//! How known curves meet tests, whatever they were fitted to.

use crate::error::{Error, Result};
use crate::frame::{Kind, MeasurementSet};
use crate::interventions::Interventions;
use crate::replica::{Parts, Replica};
use crate::report::SequenceReport;
use crate::simulation::{Counters, DroppedFrame, Objective, Simulation, SolveStart, Task};
use crate::stage::{Settings, Watch, softest_bending};
use crate::summary::sequence_reports;
use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use cloth_sim::material::{Component, Curves};
use std::sync::Arc;

/// How known curves meet tests.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// How each sequence was met.
    pub sequences: Vec<SequenceReport>,
    /// Frames without an equilibrium, which take no part.
    pub dropped: Vec<DroppedFrame>,
    /// What the solves have cost.
    pub counters: Counters,
    /// What helped them along.
    pub interventions: Interventions,
}

/// Simulates all sequences of some kinds with known curves: how well they are predicted.
///
/// Sheets between clips that leave their plane are followed from rest through all frames, as a simulator would meet them.
///
/// # Errors
/// Bad settings; sequences that no replica can be made of.
pub fn predict(
    set: &MeasurementSet,
    kinds: &[Kind],
    curves: &Curves,
    settings: &Settings,
    watch: &Watch<'_>,
) -> Result<Prediction> {
    settings.validate()?;
    let spent_before = watch.meter.read();
    let curves = &completed(curves, settings)?;
    let replicas: Vec<Replica> = set
        .sequences
        .iter()
        .filter(|sequence| kinds.contains(&sequence.kind))
        .map(|sequence| Replica::new(sequence, &parts(sequence.kind, set, curves, settings)))
        .collect::<Result<_>>()?;
    let task = Task {
        fitted: Vec::new(),
        objective: Objective::Forces,
        known: curves.clone(),
        settings: settings.equilibrium,
        start: SolveStart::LastEquilibrium,
        robust: None,
    };
    let none = StiffnessCurve::constant(0.0, NegativeStrain::Odd).map_err(mechanics)?;
    let mut simulation = Simulation::unsettled(&replicas, task, none, Arc::clone(&watch.meter));
    simulation.follow();
    let forces = simulation.settle();
    let counters = watch.meter.read().since(&spent_before);
    Ok(Prediction {
        interventions: Interventions::new(&counters, &simulation),
        sequences: sequence_reports(&simulation, &forces),
        dropped: simulation.dropped().to_vec(),
        counters,
    })
}

/// What is missing beside what is known: for one of weft and warp the other's mean stiffness, which across a strip hardly
/// matters, but without any the sheet would have no shape; for a bending curve the softest of the others, without which the
/// sheet would crumple along its lines.
fn completed(curves: &Curves, settings: &Settings) -> Result<Curves> {
    let mean = |curve: &StiffnessCurve| curve.stiffnesses().iter().sum::<f64>() / curve.len() as f64;
    let [weft, warp] = [Component::StretchWeft, Component::StretchWarp];
    let stretch = curves.get(weft).or(curves.get(warp)).map(mean);
    let bending = softest_bending(curves);
    let mut completed = curves.clone();
    for component in Component::ALL.into_iter().filter(|&component| curves.get(component).is_none()) {
        let other = if component.is_bending() { bending } else { stretch.filter(|_| component.is_stretch()) };
        if let Some(stiffness) = other {
            let negative = settings.model.negative_strain(component, settings.compression);
            completed.set(component, StiffnessCurve::constant(stiffness, negative).map_err(mechanics)?);
        }
    }
    Ok(completed)
}

fn mechanics(source: cloth_sim::error::Error) -> Error {
    Error::Mechanics { context: "prediction".into(), source }
}

/// What a test's replica consists of: in strips pulled along their yarns shear and bending play no part. Without any
/// bending curve a sheet between clips stays in its plane: in space it would crumple.
fn parts(kind: Kind, set: &MeasurementSet, curves: &Curves, settings: &Settings) -> Parts {
    let stretches = matches!(kind, Kind::StretchWeft | Kind::StretchWarp);
    let components: Vec<Component> =
        curves.components().filter(|component| !stretches || component.is_stretch()).collect();
    Parts {
        model: settings.model,
        flat: kind == Kind::StretchBias || !stretches && !curves.components().any(Component::is_bending),
        components,
        areal_density: set.fabric.areal_density_kg_m2,
        nodes: settings.nodes,
        diagonals: settings.diagonals,
        table: settings.table,
    }
}
