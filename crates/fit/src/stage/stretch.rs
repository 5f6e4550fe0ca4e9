//! Stretch: one curve for weft or warp, from the clip forces of the strips pulled along it.
//!
//! Shear and bending are left out. The curve across keeps a constant stiffness: without Poisson coupling it does not
//! matter. Loading and unloading are fitted alike, so the curve runs through the mean of the hysteresis band.
//!
//! Source: Miguel et al. 2012, §5.2.

use super::{Constraints, Settings, Watch};
use crate::error::{Error, Result};
use crate::frame::{Kind, MeasurementSet};
use crate::gap;
use crate::gauss_newton::{Domain, Outcome};
use crate::refine::{domain, grow};
use crate::replica::Replica;
use crate::report::{SequenceReport, StageReport};
use crate::simulation::{DroppedFrame, Simulation};
use crate::specimen::Specimen;
use crate::summary::{curve_report, sequence_reports};
use crate::uncertainty::{Covariance, Scatter};
use cloth_sim::curve::{StiffnessCurve, equidistant};
use cloth_sim::material::{Component, Curves};
use std::sync::Arc;
use std::time::Instant;

/// The component that a kind of test stretches along, if it is a test of stretch.
pub fn component_of(kind: Kind) -> Option<Component> {
    match kind {
        Kind::StretchWeft => Some(Component::StretchWeft),
        Kind::StretchWarp => Some(Component::StretchWarp),
        _ => None,
    }
}

/// Fits one component on all sequences of a set that stretch along it; `None` if there are none.
///
/// # Errors
/// Bad settings; sequences that no replica can be made of; no frame with an equilibrium.
pub fn fit(
    set: &MeasurementSet,
    component: Component,
    settings: &Settings,
    watch: &mut Watch<'_>,
) -> Result<Option<StageReport>> {
    settings.validate()?;
    let clock = Instant::now();
    let replicas = replicas(set, component, settings)?;
    if replicas.is_empty() {
        return Ok(None);
    }
    let negative = settings.model.negative_strain(component, settings.compression);
    let constant = |stiffness: f64, negative| {
        StiffnessCurve::constant(stiffness, negative).map_err(mechanics(component))
    };
    // Without any simulation: the range of strain on the blended shapes, a constant stiffness, and the largest one.
    let range = blended_range(&replicas, component);
    let frames = replicas.iter().flat_map(|replica| &replica.frames);
    let extension = frames.map(|frame| frame.extension).fold(0.0, f64::max);
    if range < 0.1 * extension {
        return Err(unfit(
            &replicas,
            format!("clips apart by {extension:.2e} of their distance, and {component} of {range:.2e}"),
            "a pull along the yarns that the test's kind names: check kind, and vt in mesh.obj",
        ));
    }
    let one = constant(1.0, negative)?;
    let mean = gap::start(&replicas, component, &one, &Curves::default(), &Domain::everywhere(1))[0];
    if !(mean > 0.0) {
        return Err(unfit(
            &replicas,
            format!("clip forces that make a stiffness of {mean:.3e} N/m"),
            "the force that the cords exert on each clip, outward where the specimen is stretched: check its sign",
        ));
    }
    let known = curve_across(component, mean, settings)?;
    let fine =
        StiffnessCurve::new(equidistant(settings.points, range), vec![mean; settings.points], negative)
            .map_err(mechanics(component))?;
    let positive = domain(&fine, Constraints::ControlPoints, 0.0).map_err(mechanics(component))?;
    let largest = gap::start(&replicas, component, &fine, &known, &positive).amax().max(mean);
    let lowest_tangent = 1e-3 * largest;

    let spent_before = watch.meter.read();
    let mut simulation = Simulation::new(
        &replicas,
        component,
        constant(mean, negative)?,
        known,
        settings.equilibrium,
        Arc::clone(&watch.meter),
    );
    let dropped = simulation.dropped().len();
    if simulation.frames().next().is_none() {
        let status = simulation.dropped().first().map_or(String::new(), |dropped| dropped.status.to_string());
        return Err(unfit(
            &replicas,
            format!("no frame with an equilibrium ({status})"),
            "clips that stretch the specimen evenly, on cells that are not too long",
        ));
    }
    let growth = grow(&mut simulation, settings, lowest_tangent, watch).map_err(mechanics(component))?;
    if growth.outcome.residual.is_empty() {
        let status = growth.outcome.status.to_string();
        return Err(unfit(&replicas, status, "forces and clips that some curve can answer"));
    }
    let tracks = simulation.tracks();
    // The last trial may have been a step that was rejected.
    simulation.set_curve(growth.curve.clone());
    let forces = simulation.settle();
    let Outcome { residual, jacobian, status, .. } = &growth.outcome;
    let noise = simulation.noise_is_known().then_some(1.0);
    let rank = Covariance::rank_of(jacobian);
    let scatter = Scatter::new(residual, jacobian, rank, &tracks, noise);
    let covariance = Covariance::new(jacobian, &scatter);
    let converged = status.converged() && simulation.dropped().len() == dropped;
    let (levels, stopped) = (growth.levels.clone(), growth.stopped.clone());
    Ok(Some(StageReport {
        component,
        model: settings.model,
        curve: curve_report(&simulation, growth, &covariance),
        scatter: scatter.times(simulation.unit()),
        sequences: sequence_reports(&simulation, &forces),
        dropped: simulation.dropped().to_vec(),
        levels,
        growth: stopped,
        converged,
        counters: watch.meter.read().since(&spent_before),
        seconds: clock.elapsed().as_secs_f64(),
    }))
}

/// How a known curve meets tests.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// How each sequence was met.
    pub sequences: Vec<SequenceReport>,
    /// Frames without an equilibrium, which take no part.
    pub dropped: Vec<DroppedFrame>,
}

/// Simulates all sequences that stretch along a component with a known curve: how well they are predicted.
///
/// # Errors
/// As [`fit`].
pub fn predict(
    set: &MeasurementSet,
    component: Component,
    curve: &StiffnessCurve,
    settings: &Settings,
) -> Result<Prediction> {
    settings.validate()?;
    let replicas = replicas(set, component, settings)?;
    let known =
        curve_across(component, curve.stiffnesses().iter().sum::<f64>() / curve.len() as f64, settings)?;
    let mut simulation =
        Simulation::new(&replicas, component, curve.clone(), known, settings.equilibrium, Arc::default());
    let forces = simulation.settle();
    Ok(Prediction {
        sequences: sequence_reports(&simulation, &forces),
        dropped: simulation.dropped().to_vec(),
    })
}

/// The constant curve across the pull.
fn curve_across(component: Component, stiffness: f64, settings: &Settings) -> Result<Curves> {
    let across = match component {
        Component::StretchWeft => Component::StretchWarp,
        _ => Component::StretchWeft,
    };
    let negative = settings.model.negative_strain(across, settings.compression);
    let curve = StiffnessCurve::constant(stiffness, negative).map_err(mechanics(component))?;
    Ok(Curves::from_iter([(across, curve)]))
}

fn unfit(replicas: &[Replica], found: String, expected: &str) -> Error {
    let names: Vec<&str> = replicas.iter().map(|replica| &replica.name[..]).collect();
    Error::Geometry { sequence: names.join(", "), found, expected: expected.into() }
}

fn mechanics(component: Component) -> impl Fn(cloth_sim::error::Error) -> Error {
    move |source| Error::Mechanics { context: component.to_string(), source }
}

fn replicas(set: &MeasurementSet, component: Component, settings: &Settings) -> Result<Vec<Replica>> {
    let parts = [Component::StretchWeft, Component::StretchWarp];
    set.sequences
        .iter()
        .filter(|sequence| component_of(sequence.kind) == Some(component))
        .map(|sequence| {
            let specimen = Specimen::new(sequence, settings.nodes, settings.diagonals)?;
            Replica::new(sequence, specimen, settings.model, &parts, set.fabric.areal_density_kg_m2)
        })
        .collect()
}

/// The largest strain on the blended shapes of all frames.
fn blended_range(replicas: &[Replica], component: Component) -> f64 {
    replicas
        .iter()
        .flat_map(|replica| replica.frames.iter().map(move |frame| (replica, frame)))
        .flat_map(|(replica, frame)| replica.cloth.strains(component, &frame.start))
        .fold(f64::MIN_POSITIVE, |largest, [strain, _]| largest.max(strain))
}
