//! The course that every stage takes: replicas, a start, equilibria, a curve that grows, and how sure it is.

use super::average::Average;
use super::growth::{Growth, grow, refit};
use super::interventions::Interventions;
use super::knowledge::Knowledge;
use super::plan::{Plan, mechanics, unfit};
use super::report::{Basis, StageReport};
use super::settings::Settings;
use super::start::{Start, start};
use super::summary::{curve_report, sequence_reports};
use super::watch::Watch;
use crate::equilibria::{Equilibria, Objective, Task, Unknowns};
use crate::optimise::gauss_newton::Outcome;
use crate::optimise::uncertainty::{Covariance, Scatter, Source};
use crate::twin::replica::Replica;
use cloth_data::error::Result;
use cloth_data::frame::MeasurementSet;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::material::{Component, Curves};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

/// Runs one stage and adds what it found to what is known; `None` if no sequence shows what it fits, or if a second pass
/// over it has nothing to add.
///
/// # Errors
/// Bad settings; sequences that no replica can be made of; no frame with an equilibrium.
pub fn fit(
    set: &MeasurementSet,
    plan: &Plan,
    knowledge: &mut Knowledge,
    settings: &Settings,
    watch: &mut Watch<'_>,
) -> Result<Option<StageReport>> {
    settings.validate()?;
    let clock = Instant::now();
    let spent_before = watch.meter.read();
    let replicas = plan.replicas(set, settings)?;
    if replicas.is_empty() || plan.pass > 1 && !gains_from_bending(plan, &replicas) {
        return Ok(None);
    }
    let Start { stiffness, largest, known, assumed } = start(plan, &replicas, knowledge, settings)?;
    let before = knowledge.curves().get(plan.fitted[0]).filter(|_| plan.pass > 1).cloned();
    let negative = settings.model.negative_strain(plan.fitted[0], settings.compression);
    let constant = StiffnessCurve::constant(stiffness, negative).map_err(mechanics(plan))?;
    let first = before.clone().unwrap_or(constant);
    let unknowns = Unknowns::one(&plan.fitted, first);
    let finer_replicas = if settings.corrects() { plan.refined(set, settings, 2)? } else { Vec::new() };
    let simulation = simulate(plan, &replicas, known, unknowns, settings, watch)?;
    let mut simulation = simulation.corrected_by(&finer_replicas);
    let dropped = simulation.dropped().len();
    let growth = match &before {
        Some(_) => refit(&mut simulation, settings, &[1e-3 * largest], watch),
        None => grow(&mut simulation, settings, &[1e-3 * largest], watch),
    };
    let growth = growth.map_err(mechanics(plan))?;
    if growth.outcome.residual.is_empty() {
        let status = growth.outcome.status.to_string();
        return Err(unfit(&replicas, status, "measurements that some curve can answer"));
    }
    // The last trial may have been a step that was rejected.
    simulation.set_unknowns(growth.unknowns.clone());
    // A stage has one.
    let Some(unknown) = growth.unknowns.iter().next().cloned() else { return Ok(None) };
    let curve = &unknown.curve;
    let forces = simulation.settle();
    let complete = simulation.dropped().len() == dropped;
    let others = knowledge.without(&plan.fitted);
    let mut judgement = judge(plan, &simulation, &growth, curve, &others, complete);
    if let Some(apart) = before.and_then(|first| ignorance(plan, &assumed, &first, curve)) {
        judgement.covariance.widen(Source::Assumed, &apart);
    }
    let Judgement { scatter, covariance, gain, observed } = &judgement;
    // Where frames were lost on the way nothing is carried on.
    let uncertain: &[Component] = if complete { &plan.components } else { &[] };
    // What a first pass made of a curve that is not observed was no knowledge either.
    *knowledge = others.clone();
    if *observed {
        knowledge.learn(&plan.fitted, curve, &covariance.matrix, uncertain, gain);
    }
    let basis = Basis {
        carried: others.groups(uncertain).into_iter().flatten().collect(),
        known: others.curves().components().filter(|c| plan.components.contains(c)).collect(),
        assumed: assumed.keys().copied().collect(),
        assumed_stiffness: assumed,
    };
    let (levels, stopped) = (growth.levels.clone(), growth.stopped.clone());
    let counters = watch.meter.read().since(&spent_before);
    let interventions =
        Interventions::new(&counters, &simulation).with_fit(&levels, &simulation, &growth.outcome);
    let converged = growth.outcome.status.converged() && complete;
    Ok(Some(StageReport {
        components: plan.fitted.clone(),
        pass: plan.pass,
        model: settings.model,
        variant: settings.variant,
        objective: plan.objective,
        basis,
        curve: curve_report(&simulation, unknown, growth, covariance, *observed),
        scatter: scatter.times(simulation.unit()),
        sequences: sequence_reports(&simulation, &forces),
        dropped: simulation.dropped().to_vec(),
        levels,
        growth: stopped,
        converged,
        counters,
        interventions,
        seconds: clock.elapsed().as_secs_f64(),
    }))
}

/// True if a second pass differs from the first: shear then has the bending that was left out before, which a sheet feels
/// only where it may leave its plane.
fn gains_from_bending(plan: &Plan, replicas: &[Replica]) -> bool {
    plan.fitted[0] != Component::Shear || replicas.iter().any(Replica::may_buckle)
}

/// The error that assumed bending may make, N/m at each control point: the difference to the first pass, in which the sheet
/// does not bend at all. No fabric is stiffer than that, and few are much softer than the assumption. A quarter is added,
/// since the truth of a sheet that stayed flat is the end of that range and must be well inside the band.
fn ignorance(
    plan: &Plan,
    assumed: &BTreeMap<Component, f64>,
    first: &StiffnessCurve,
    curve: &StiffnessCurve,
) -> Option<DVector<f64>> {
    let unknown = !plan.flat && plan.fitted[0] == Component::Shear && assumed.keys().any(|c| c.is_bending());
    let apart = curve
        .strains()
        .iter()
        .zip(curve.stiffnesses())
        .map(|(&strain, k)| 1.25 * (first.stiffness(strain) - k));
    unknown.then(|| DVector::from_iterator(curve.len(), apart))
}

/// All frames in equilibrium under the first curves.
fn simulate<'r>(
    plan: &Plan,
    replicas: &'r [Replica],
    known: Curves,
    unknowns: Unknowns,
    settings: &Settings,
    watch: &Watch<'_>,
) -> Result<Equilibria<'r>> {
    let task = Task {
        objective: plan.objective,
        known,
        settings: settings.equilibrium,
        start: settings.solve_start,
        exact_clips: settings.exact_clips,
        robust: None,
    };
    let simulation = Equilibria::new(replicas, task, unknowns, Arc::clone(&watch.meter));
    if simulation.settled().next().is_none() {
        let status = simulation.dropped().first().map_or(String::new(), |dropped| dropped.status.to_string());
        return Err(unfit(
            replicas,
            format!("no frame with an equilibrium ({status})"),
            match plan.objective {
                Objective::Forces => {
                    "clips at the ends of the specimen that deform it evenly (cloth behind or beside a clip is loose: end the mesh there), on \
                     cells that are not too long"
                }
                Objective::Positions => "a sheet that hangs off the table under its weight",
            },
        ));
    }
    Ok(simulation)
}

/// Uncertainty of a fitted curve.
struct Judgement {
    scatter: Scatter,
    covariance: Covariance,
    /// Propagated errors of the known curves.
    gain: DMatrix<f64>,
    observed: bool,
}

/// * `others` — what is known of the other curves
/// * `complete` — no frame was lost on the way, so that the fit's Jacobian and the simulation have the same rows
fn judge(
    plan: &Plan,
    simulation: &Equilibria<'_>,
    growth: &Growth,
    curve: &StiffnessCurve,
    others: &Knowledge,
    complete: bool,
) -> Judgement {
    let Outcome { residual, jacobian, .. } = &growth.outcome;
    let scatter = simulation.scatter(residual, jacobian);
    let observed = is_observed(plan, growth, curve, &scatter, others);
    // What more control points would meet is no misfit: it is in the band as theirs.
    let mut covariance = match &growth.average {
        Some(Average { inverse, finer }) => {
            let finer = finer.as_ref().map(|finer| finer.left).filter(|left| left.misfit < scatter.misfit);
            let left = finer.unwrap_or(scatter);
            Covariance::with_prior(jacobian, &left, inverse)
        }
        None => Covariance::new(jacobian, &scatter),
    };
    if complete {
        let errors = simulation.by_clip_poses();
        let changes = errors.iter().map(|error| covariance.change(jacobian, error));
        let of_clips = changes.map(|change| &change * change.transpose());
        if let Some(of_clips) = of_clips.reduce(|sum, next| sum + next) {
            covariance.attribute(Source::ClipPoses, of_clips);
        }
    }
    if simulation.is_corrected() && complete {
        let left = simulation.left_of_grid();
        if left.len() == jacobian.nrows() {
            let change = covariance.change(jacobian, &left);
            covariance.widen(Source::Grid, &change);
        }
    }
    let groups = others.groups(&plan.components);
    let mut gain = DMatrix::zeros(curve.len(), 0);
    if complete && !groups.is_empty() {
        gain = covariance.gain(jacobian, &simulation.sensitivity_to(&groups));
        covariance.carry(&gain, &others.covariance(&plan.components));
    }
    Judgement { scatter, covariance, gain, observed }
}

/// True if the measurements tell the curve's scale: a curve twice as stiff would stand out from the noise, and from half of
/// what the curve cannot meet anyway. A curve far below what is known of the other bending is taken to be as large as that:
/// that it is so soft is knowledge too. What earlier stages do not know is not counted.
fn is_observed(
    plan: &Plan,
    growth: &Growth,
    curve: &StiffnessCurve,
    scatter: &Scatter,
    knowledge: &Knowledge,
) -> bool {
    let others = [Component::BendWeft, Component::BendWarp];
    let bends = plan.fitted[0].is_bending();
    let usual = others.iter().filter_map(|&component| knowledge.curves().get(component));
    let usual = usual.flat_map(|curve| curve.stiffnesses().iter().copied());
    let reference = usual.filter(|_| bends).fold(f64::MAX, f64::min);
    let floor = if reference < f64::MAX { reference } else { 0.0 };
    let size = DVector::from_iterator(curve.len(), curve.stiffnesses().iter().map(|k| k.max(floor)));
    let signal = (&growth.outcome.jacobian * size).norm();
    let misfit = 0.5 * scatter.misfit * (scatter.measurements as f64).sqrt();
    signal > (2.0 * scatter.noise).hypot(misfit)
}
