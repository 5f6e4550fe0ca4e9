//! A fit with a fixed number of control points.

use super::posterior::second_differences;
use super::settings::{Constraints, Settings};
use super::watch::{Event, Watch};
use crate::equilibria::{Equilibria, Objective, Unknown, Unknowns};
use crate::optimise::gauss_newton::{Iteration, LinearConstraints, Outcome, minimise};
use cloth_sim::curve::{StiffnessCurve, stability_rows};
use cloth_sim::error::Result;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// The correction for the grid is renewed until the minimum moves by less than this share.
pub(super) const SETTLED: f64 = 1e-4;

/// A fit with a fixed number of control points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// Control points.
    pub points: usize,
    /// Root mean square residual, N or m.
    pub rms: f64,
    /// Status at the end.
    pub status: String,
    /// Its iterations.
    pub iterations: Vec<Iteration>,
    /// Starts that violated a constraint of the curve and were moved to the nearest feasible point.
    pub projected: usize,
}

impl Level {
    /// The residual after every step tried, N or m, from the sums of squares relative to the final one.
    pub fn course(&self) -> impl Iterator<Item = f64> + '_ {
        let last = self.iterations.last().map_or(1.0, |step| step.sum_of_squares);
        let share = move |squares: f64| if last > 0.0 { (squares / last).sqrt() } else { 1.0 };
        self.iterations.iter().map(move |step| self.rms * share(step.sum_of_squares))
    }

    /// Adds a later fit with the same number of control points.
    pub(crate) fn go_on(&mut self, later: &Self) {
        let done = self.iterations.len();
        let numbered = |step: &Iteration| Iteration { iteration: done + step.iteration, ..step.clone() };
        self.iterations.extend(later.iterations.iter().map(numbered));
        self.projected += later.projected;
        self.rms = later.rms;
        self.status.clone_from(&later.status);
    }
}

/// Most control points that the frames support. A curve with as many points as frames fits them all and means nothing; with
/// unknown noise, one more frame is needed to judge it.
pub(super) fn most_points(simulation: &Equilibria<'_>, settings: &Settings) -> usize {
    let spare = usize::from(!simulation.noise_is_known());
    let carriers = match simulation.task().objective {
        Objective::Forces => simulation.settled().count(),
        Objective::Positions => simulation.measurements(),
    };
    let curves = simulation.unknowns().iter().count().max(1);
    settings.most_points().min(carriers.saturating_sub(spare) / curves).max(1)
}

/// Fits one level: a fixed number of control points.
///
/// * `corrections` — how often the correction of the grid's error is renewed at most
pub(super) fn fit_level(
    simulation: &mut Equilibria<'_>,
    unknowns: &Unknowns,
    corrections: usize,
    settings: &Settings,
    lowest_tangents: &[f64],
    watch: &mut Watch<'_>,
) -> Result<(Outcome, LinearConstraints, Level)> {
    let clock = Instant::now();
    let spent_before = watch.meter.read();
    let points = points_of(unknowns);
    let [unit, measurements] = [simulation.unit(), simulation.measurements() as f64];
    if let Some(component) = unknowns.iter().find_map(|unknown| unknown.components.first().copied()) {
        (watch.observe)(Event::Level { component, points });
    }
    simulation.set_unknowns(unknowns.clone());
    if let Some(limit) = settings.robust {
        simulation.make_robust(limit);
    }
    let domain = domain_of(unknowns, settings, lowest_tangents)?;
    let mut observe = |iteration: &Iteration| {
        let rms = unit * (iteration.sum_of_squares / measurements).sqrt();
        let factorisations = watch.meter.read().since(&spent_before).factorisations;
        let seconds = clock.elapsed().as_secs_f64();
        (watch.observe)(Event::Iteration { iteration, rms, factorisations, seconds });
    };
    let (mut iterations, mut projected): (Vec<Iteration>, usize) = (Vec::new(), 0);
    let mut fit_from = |simulation: &mut Equilibria<'_>, start: &DVector<f64>| {
        let done = iterations.len();
        let mut numbered = |step: &Iteration| {
            let step = Iteration { iteration: done + step.iteration, ..step.clone() };
            observe(&step);
            iterations.push(step);
        };
        match minimise(simulation, start, &domain, &settings.outer, &mut numbered) {
            Ok(outcome) => {
                projected += usize::from(outcome.projected);
                outcome
            }
            Err(never) => match never {},
        }
    };
    let mut outcome = fit_from(simulation, &unknowns.values());
    for _ in 0..corrections {
        if !simulation.is_corrected() || outcome.residual.is_empty() {
            break;
        }
        simulation.set_unknowns(unknowns.with_values(&outcome.point)?);
        simulation.correct();
        let again = fit_from(simulation, &outcome.point);
        let moved = (&again.point - &outcome.point).amax() / outcome.point.amax();
        if again.residual.is_empty() {
            break;
        }
        outcome = again;
        if moved <= SETTLED {
            break;
        }
    }
    let rms = unit * (outcome.sum_of_squares / measurements).sqrt();
    let status = outcome.status.to_string();
    Ok((outcome, domain, Level { points, rms, status, iterations, projected }))
}

/// Control points of each curve.
pub(super) fn points_of(unknowns: &Unknowns) -> usize {
    unknowns.iter().map(|unknown| unknown.curve.len()).max().unwrap_or(0)
}

/// Resamples the curves at other, equidistant control points over the visited range.
pub(super) fn resampled(simulation: &Equilibria<'_>, unknowns: &Unknowns, points: usize) -> Result<Unknowns> {
    let resampled = |unknown: &Unknown| {
        let curve = unknown.curve.resampled(points, simulation.reach(unknown))?;
        Ok(Unknown { curve, ..unknown.clone() })
    };
    unknowns.iter().map(resampled).collect::<Result<_>>().map(Unknowns::new)
}

/// The constraints of all curves.
pub(super) fn domain_of(
    unknowns: &Unknowns,
    settings: &Settings,
    lowest_tangents: &[f64],
) -> Result<LinearConstraints> {
    let domains = unknowns.iter().zip(lowest_tangents);
    let domains = domains.map(|(unknown, &lowest)| domain(&unknown.curve, settings.constraints, lowest));
    Ok(LinearConstraints::together(&domains.collect::<Result<Vec<_>>>()?))
}

/// The constraints of a curve, with smoothness where the data see nothing.
///
/// # Errors
/// Strains that no curve can have.
pub fn domain(curve: &StiffnessCurve, constraints: Constraints, lowest: f64) -> Result<LinearConstraints> {
    let points = curve.len();
    let (rows, lowest) = match constraints {
        Constraints::Stable => (stability_rows(curve.strains())?, lowest),
        Constraints::ControlPoints => (DMatrix::identity(points, points), 0.0),
    };
    let roughness = match points {
        1 => None,
        2 => Some(DMatrix::from_row_slice(1, 2, &[1.0, -1.0])),
        _ => Some(second_differences(points)),
    };
    Ok(LinearConstraints { bounds: DVector::from_element(rows.nrows(), lowest), rows, roughness })
}
