//! How known curves meet tests, whatever they were fitted to.

use crate::error::{Error, Result};
use crate::frame::{Kind, MeasurementSet};
use crate::replica::{Parts, Replica};
use crate::report::SequenceReport;
use crate::simulation::{Counters, DroppedFrame, Meter, Objective, Simulation, Task};
use crate::stage::Settings;
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
) -> Result<Prediction> {
    settings.validate()?;
    let curves = &with_both_stretches(curves, settings)?;
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
        robust: None,
    };
    let none = StiffnessCurve::constant(0.0, NegativeStrain::Odd).map_err(mechanics)?;
    let meter = Arc::<Meter>::default();
    let mut simulation = Simulation::unsettled(&replicas, task, none, Arc::clone(&meter));
    simulation.follow();
    let forces = simulation.settle();
    Ok(Prediction {
        sequences: sequence_reports(&simulation, &forces),
        dropped: simulation.dropped().to_vec(),
        counters: meter.read(),
    })
}

/// If only one of weft and warp is known, the other gets its mean stiffness: across a strip it hardly matters, but
/// without any the sheet would have no shape.
fn with_both_stretches(curves: &Curves, settings: &Settings) -> Result<Curves> {
    let mut both = curves.clone();
    let pair = [Component::StretchWeft, Component::StretchWarp];
    for [known, missing] in [pair, [pair[1], pair[0]]] {
        if let (Some(curve), None) = (curves.get(known), curves.get(missing)) {
            let mean = curve.stiffnesses().iter().sum::<f64>() / curve.len() as f64;
            let negative = settings.model.negative_strain(missing, settings.compression);
            both.set(missing, StiffnessCurve::constant(mean, negative).map_err(mechanics)?);
        }
    }
    Ok(both)
}

fn mechanics(source: cloth_sim::error::Error) -> Error {
    Error::Mechanics { context: "prediction".into(), source }
}

/// What a test's replica consists of: in strips pulled along their yarns shear and bending play no part.
pub(crate) fn parts(kind: Kind, set: &MeasurementSet, curves: &Curves, settings: &Settings) -> Parts {
    let stretches = matches!(kind, Kind::StretchWeft | Kind::StretchWarp);
    let components: Vec<Component> =
        curves.components().filter(|component| !stretches || component.is_stretch()).collect();
    Parts {
        model: settings.model,
        flat: kind == Kind::StretchBias,
        components,
        areal_density: set.fabric.areal_density_kg_m2,
        nodes: settings.nodes,
        diagonals: settings.diagonals,
    }
}
