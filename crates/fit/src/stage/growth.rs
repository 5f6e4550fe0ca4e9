//! Growth of a curve: starts with one control point and doubles the number of segments while that pays.
//!
//! One number of points that does not pay is tolerated: a curve that bends down and up again, as of many knits, is
//! fitted no better by a line than by a constant, but by three or five points. Two in a row end the growth.
//!
//! Source: Miguel et al. 2012, §5.2; the second try is ours, unless [`GrowthRule`](super::GrowthRule) says otherwise.

use super::growth_rule::SIGNIFICANT;
use super::level::Level;
use super::settings::{Constraints, Settings};
use super::watch::{Event, Watch};
use crate::equilibria::{Equilibria, Objective, Unknown, Unknowns};
use crate::optimise::gauss_newton::{Iteration, LinearConstraints, Outcome, minimise};
use crate::optimise::uncertainty::{Covariance, variance_left};
use cloth_sim::curve::{StiffnessCurve, stability_rows};
use cloth_sim::error::Result;
use nalgebra::{DMatrix, DVector};
use std::time::Instant;

/// Residuals up to this share of the compared values are rounding; none is better than another.
const ROUNDING: f64 = 1e-12;

/// Whitening is renewed once at the minimum of every level, for comparison with other levels; for the level that is
/// kept, until the minimum moves by less than this share, or at most this often.
const SETTLED: f64 = 1e-5;
const MOST_WHITENINGS: usize = 4;

/// Grown curves.
pub struct Growth {
    /// The curves.
    pub unknowns: Unknowns,
    /// The fit with its control points.
    pub outcome: Outcome,
    /// Constraints on the curve.
    pub domain: LinearConstraints,
    /// Every level, including those that did not pay and were not kept.
    pub levels: Vec<Level>,
    /// Reason for the end of the growth.
    pub stopped: String,
}

/// If doubling a constant stiffness changes less than this share of the residual, more points would be undetermined,
/// as for ring-2 springs that depend on softer yarns.
const FELT: f64 = 0.1;

/// Fits with an increasing number of control points, starting with the simulation's curve.
///
/// * `lowest_tangent` — lower limit of dσ/dε, N/m
///
/// # Errors
/// Control points that do not form a valid curve.
pub fn grow(
    simulation: &mut Equilibria<'_>,
    settings: &Settings,
    lowest_tangents: &[f64],
    watch: &mut Watch<'_>,
) -> Result<Growth> {
    // A curve with as many points as frames fits them all and means nothing; with unknown noise, one more frame is
    // needed to judge it.
    let spare = usize::from(!simulation.noise_is_known());
    let carriers = match simulation.task().objective {
        Objective::Forces => simulation.settled().count(),
        Objective::Positions => simulation.measurements(),
    };
    let curves = simulation.unknowns().iter().count().max(1);
    let most = settings.most_points().min(carriers.saturating_sub(spare) / curves).max(1);
    let mut levels = Vec::new();
    let mut kept: Option<(Unknowns, Outcome, LinearConstraints)> = None;
    let rule = settings.growth;
    let mut unknowns = simulation.unknowns().clone();
    let mut tries = 0;
    loop {
        let points = points_of(&unknowns);
        let (outcome, domain, level) = fit_level(simulation, &unknowns, 1, settings, lowest_tangents, watch)?;
        levels.push(level);
        unknowns = unknowns.with_values(&outcome.point)?;
        let felt = (&outcome.jacobian * &outcome.point).norm() >= FELT * outcome.residual.norm();
        if points == 1 && !felt {
            let stopped = "a constant stiffness hardly changes the simulated values".to_string();
            return Ok(Growth { unknowns, outcome, domain, levels, stopped });
        }
        let all = points >= most;
        let noise = variance_left(&outcome.residual, unknowns.len(), simulation.noise_is_known());
        let rounding = (ROUNDING * (&outcome.jacobian * &outcome.point).norm()).powi(2);
        // Points that the data do not separate fit noise: their gain must exceed that of as many points by chance.
        let told_apart = Covariance::rank_of(&outcome.jacobian) == unknowns.len();
        let by_chance = |added: usize| 0.5 * added as f64 * SIGNIFICANT * noise;
        let pays = |before: f64, after: f64, added: usize| {
            rule.pays(before.max(rounding), after.max(rounding), noise)
                && (told_apart || before - after > by_chance(added))
        };
        let best = match kept {
            Some(best)
                if !pays(best.1.sum_of_squares, outcome.sum_of_squares, unknowns.len() - best.0.len()) =>
            {
                tries += 1;
                best
            }
            _ => {
                tries = 0;
                (unknowns.clone(), outcome, domain)
            }
        };
        if all || tries == rule.tries {
            let stopped = match tries {
                0 if settings.variant.is_linear() => "a linear variant has one stiffness".to_string(),
                0 if points < settings.points => {
                    format!("the frames support no more than {points} control points")
                }
                0 => format!("all {points} control points are in use"),
                _ => format!(
                    "{points} control points lower the residual by less than {:.0} %",
                    100.0 * rule.gain
                ),
            };
            let (mut unknowns, mut outcome, domain) = best;
            if simulation.is_whitened() {
                let (settled, _, level) =
                    fit_level(simulation, &unknowns, MOST_WHITENINGS, settings, lowest_tangents, watch)?;
                if !settled.residual.is_empty() {
                    unknowns = unknowns.with_values(&settled.point)?;
                    outcome = settled;
                    levels.iter_mut().filter(|l| l.points == level.points).for_each(|l| l.go_on(&level));
                }
            }
            return Ok(Growth { unknowns, outcome, domain, levels, stopped });
        }
        kept = Some(best);
        unknowns = resampled(simulation, &unknowns, next_points(points, most))?;
    }
}

/// Fits again with the same number of control points, spread over the strains visited now.
///
/// # Errors
/// Control points that do not form a valid curve.
pub fn refit(
    simulation: &mut Equilibria<'_>,
    settings: &Settings,
    lowest_tangents: &[f64],
    watch: &mut Watch<'_>,
) -> Result<Growth> {
    let points = points_of(simulation.unknowns());
    let start = resampled(simulation, simulation.unknowns(), points)?;
    let (outcome, domain, level) =
        fit_level(simulation, &start, MOST_WHITENINGS, settings, lowest_tangents, watch)?;
    let unknowns = start.with_values(&outcome.point)?;
    let stopped = format!("all {points} control points of the previous pass are fitted again");
    Ok(Growth { unknowns, outcome, domain, levels: vec![level], stopped })
}

/// Fits one level: a fixed number of control points.
///
/// * `whitenings` — maximum number of renewed whitenings
fn fit_level(
    simulation: &mut Equilibria<'_>,
    unknowns: &Unknowns,
    whitenings: usize,
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
    let domains = unknowns.iter().zip(lowest_tangents);
    let domains = domains.map(|(unknown, &lowest)| domain(&unknown.curve, settings.constraints, lowest));
    let domain = LinearConstraints::together(&domains.collect::<Result<Vec<_>>>()?);
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
    // The effect of position errors of held lines depends on the shapes: use those at the minimum, independent of the
    // start.
    for _ in 0..whitenings {
        if !simulation.is_whitened() || outcome.residual.is_empty() {
            break;
        }
        simulation.set_unknowns(unknowns.with_values(&outcome.point)?);
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
fn points_of(unknowns: &Unknowns) -> usize {
    unknowns.iter().map(|unknown| unknown.curve.len()).max().unwrap_or(0)
}

/// Resamples the curves at other, equidistant control points over the visited range.
fn resampled(simulation: &Equilibria<'_>, unknowns: &Unknowns, points: usize) -> Result<Unknowns> {
    let resampled = |unknown: &Unknown| {
        let curve = unknown.curve.resampled(points, simulation.reach(unknown))?;
        Ok(Unknown { curve, ..unknown.clone() })
    };
    unknowns.iter().map(resampled).collect::<Result<_>>().map(Unknowns::new)
}

/// One, two, three, five, nine …: halves every segment, up to the maximum.
fn next_points(points: usize, most: usize) -> usize {
    if points == 1 { 2 } else { 2 * points - 1 }.min(most)
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
    let second_difference = |i: usize, j: usize| match j.wrapping_sub(i) {
        0 | 2 => 1.0,
        1 => -2.0,
        _ => 0.0,
    };
    let roughness = match points {
        1 => None,
        2 => Some(DMatrix::from_row_slice(1, 2, &[1.0, -1.0])),
        _ => Some(DMatrix::from_fn(points - 2, points, second_difference)),
    };
    Ok(LinearConstraints { bounds: DVector::from_element(rows.nrows(), lowest), rows, roughness })
}
