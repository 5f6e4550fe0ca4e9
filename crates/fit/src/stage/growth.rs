//! Growth of a curve: starts with one control point and doubles the number of segments while that pays.
//!
//! One number of points that does not pay is tolerated: a curve that bends down and up again, as of many knits, is
//! fitted no better by a line than by a constant, but by three or five points. Two in a row end the growth.
//!
//! Source: Miguel et al. 2012, §5.2; the second try is ours, unless [`GrowthRule`](super::GrowthRule) says otherwise.

use super::growth_rule::by_chance;
use super::level::Level;
use super::posterior::{Led, Posterior, Prior};
use super::settings::{Constraints, Settings};
use super::watch::{Event, Watch};
use crate::equilibria::{Equilibria, Objective, Unknown, Unknowns};
use crate::optimise::gauss_newton::{
    Evaluation, Iteration, LinearConstraints, Options, Outcome, Residuals, Status, minimise,
};
use crate::optimise::uncertainty::{Covariance, NoiseSource, Scatter, variance_left};
use cloth_sim::curve::{StiffnessCurve, stability_rows};
use cloth_sim::error::Result;
use nalgebra::{DMatrix, DVector};
use std::time::Instant;

/// Residuals up to this share of the compared values are rounding; none is better than another.
const ROUNDING: f64 = 1e-12;

/// The grid's error is corrected once at the minimum of every level, for comparison with other levels; for the level that
/// is kept, until the minimum moves by less than this share, or at most this often.
const SETTLED: f64 = 1e-4;
const MOST_CORRECTIONS: usize = 4;

/// Grown curves.
pub struct Growth {
    /// The curves.
    pub unknowns: Unknowns,
    /// The fit with its control points.
    pub outcome: Outcome,
    /// Constraints on the curve.
    pub domain: LinearConstraints,
    /// The mean over all descriptions of the curve that this is; `None` for a curve with one number of control points.
    pub average: Option<Average>,
    /// Every level, including those that did not pay and were not kept.
    pub levels: Vec<Level>,
    /// Reason for the end of the growth.
    pub stopped: String,
}

/// A mean over descriptions of a curve.
pub struct Average {
    /// Covariance of the control values in units of the noise.
    pub inverse: DMatrix<f64>,
    /// The same mean with twice as many segments.
    pub finer: Option<Finer>,
}

/// A mean over descriptions of a curve with twice as many segments.
pub struct Finer {
    /// The curve.
    pub curve: StiffnessCurve,
    /// Covariance of its control values.
    pub covariance: DMatrix<f64>,
    /// Noise and misfit that it leaves.
    pub left: Scatter,
}

/// If doubling a constant stiffness changes less than this share of the residual, more points would be undetermined,
/// as for ring-2 springs that depend on softer yarns.
const FELT: f64 = 0.1;

/// Most control points that the frames support. A curve with as many points as frames fits them all and means nothing; with
/// unknown noise, one more frame is needed to judge it.
fn most_points(simulation: &Equilibria<'_>, settings: &Settings) -> usize {
    let spare = usize::from(!simulation.noise_is_known());
    let carriers = match simulation.task().objective {
        Objective::Forces => simulation.settled().count(),
        Objective::Positions => simulation.measurements(),
    };
    let curves = simulation.unknowns().iter().count().max(1);
    settings.most_points().min(carriers.saturating_sub(spare) / curves).max(1)
}

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
    let most = most_points(simulation, settings);
    let mut levels = Vec::new();
    let mut kept: Option<(Unknowns, Outcome, LinearConstraints)> = None;
    let rule = settings.growth;
    // Forces are hardly wrong for the grid: their correction waits for the level that is kept.
    let positions = simulation.task().objective == Objective::Positions;
    let corrections = if positions { MOST_CORRECTIONS } else { 1 };
    let mut unknowns = simulation.unknowns().clone();
    let mut tries = 0;
    loop {
        let points = points_of(&unknowns);
        let on_the_way = usize::from(positions);
        let (outcome, domain, level) =
            fit_level(simulation, &unknowns, None, on_the_way, settings, lowest_tangents, watch)?;
        levels.push(level);
        unknowns = unknowns.with_values(&outcome.point)?;
        let felt = (&outcome.jacobian * &outcome.point).norm() >= FELT * outcome.residual.norm();
        if points == 1 && !felt {
            let stopped = "a constant stiffness hardly changes the simulated values".to_string();
            return Ok(Growth { unknowns, outcome, domain, average: None, levels, stopped });
        }
        let all = points >= most;
        let noise = variance_left(&outcome.residual, unknowns.len(), simulation.noise_is_known());
        let rounding = (ROUNDING * (&outcome.jacobian * &outcome.point).norm()).powi(2);
        // Points that the data do not separate fit noise: their gain must exceed that of as many points by chance.
        let told_apart = Covariance::rank_of(&outcome.jacobian) == unknowns.len();
        let known = simulation.noise_is_known().then_some(1.0);
        let pays = |before: f64, after: f64, added: usize| {
            rule.pays([before.max(rounding), after.max(rounding)], known, noise, added)
                && (told_apart || before - after > by_chance(added) * noise)
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
                _ if known.is_some() && rule.significance => {
                    format!("{points} control points lower the residual by no more than chance")
                }
                _ => format!(
                    "{points} control points lower the residual by less than {:.0} %",
                    100.0 * rule.gain
                ),
            };
            let (mut unknowns, mut outcome, domain) = best;
            if simulation.is_corrected() {
                let (settled, _, level) =
                    fit_level(simulation, &unknowns, None, corrections, settings, lowest_tangents, watch)?;
                if !settled.residual.is_empty() {
                    unknowns = unknowns.with_values(&settled.point)?;
                    outcome = settled;
                    levels.iter_mut().filter(|l| l.points == level.points).for_each(|l| l.go_on(&level));
                }
            }
            return Ok(Growth { unknowns, outcome, domain, average: None, levels, stopped });
        }
        kept = Some(best);
        unknowns = resampled(simulation, &unknowns, next_points(points, most))?;
    }
}

/// Fewest control values that the frames must tell apart for a curve to be described: mean, trend and bend.
const COURSE: usize = 3;

/// The mean over all descriptions is found where it moves by less than this share of its standard deviation. Where it still
/// moves after so many steps the weights stay, and a fit led by them finds it: at kinks of a spline steps go to and fro.
const MEAN_FOUND: f64 = 0.05;
const MOST_MEANS: usize = 8;

/// On the way to the mean positions are corrected at every step, forces where the curve moves by more than this share.
const CORRECTED_AGAIN: f64 = 0.05;

/// Increase of ‖r/σ‖² that makes a step to the mean too long.
const WORSE: f64 = 9.0;

/// True if the curve is averaged over descriptions: one that may bend.
fn is_averaged(simulation: &Equilibria<'_>, settings: &Settings) -> bool {
    let one = simulation.unknowns().iter().count() == 1;
    settings.averaged && one && most_points(simulation, settings) >= COURSE
}

/// Moves a grown curve to the mean over all descriptions of its course, with all control points.
///
/// # Errors
/// Control points that do not form a valid curve.
pub(crate) fn average(
    simulation: &mut Equilibria<'_>,
    growth: Growth,
    settings: &Settings,
    lowest_tangents: &[f64],
    watch: &mut Watch<'_>,
) -> Result<Growth> {
    let points = most_points(simulation, settings);
    let felt = (&growth.outcome.jacobian * &growth.outcome.point).norm();
    if !is_averaged(simulation, settings)
        || growth.outcome.residual.len() <= points
        || felt < FELT * growth.outcome.residual.norm()
    {
        return Ok(growth);
    }
    let mut unknowns = resampled(simulation, &growth.unknowns, points)?;
    let domain = domain_of(&unknowns, settings, lowest_tangents)?;
    simulation.set_unknowns(unknowns.clone());
    let mut point = unknowns.values();
    let mut found: Option<(Outcome, DMatrix<f64>, Option<Prior>, f64)> = None;
    let mut settled = false;
    for _ in 0..MOST_MEANS {
        let values = match simulation.evaluate(&point, true) {
            Ok(Evaluation::Values { residual, jacobian: Some(jacobian) }) => Some((residual, jacobian)),
            _ => None,
        };
        let worse = |residual: &DVector<f64>| {
            let last = found.as_ref().map(|(last, .., noise)| last.sum_of_squares + WORSE * noise * noise);
            last.is_some_and(|most| residual.norm_squared() > most)
        };
        let Some((residual, jacobian)) = values.filter(|(residual, _)| !worse(residual)) else {
            // Too far for the linear model: half the way.
            match &found {
                Some((last, ..)) => point = 0.5 * (&point + &last.point),
                None => break,
            }
            continue;
        };
        // What the frames tell apart is no course.
        if found.is_none() && Covariance::rank_of(&jacobian) < COURSE {
            break;
        }
        let noise = scatter(simulation, &residual, &jacobian).white();
        let (scaled, slope) = (&residual / noise, &jacobian / noise);
        let Some(posterior) = Posterior::new(&scaled, &slope, &point) else { break };
        let prior = Prior::behind(&posterior, &scaled, &slope, &point, noise);
        let Ok(next) = domain.nearest(&posterior.mean) else { break };
        let near = |i: usize| {
            let deviation = posterior.covariance[(i, i)].max(0.0).sqrt();
            (next[i] - point[i]).abs() <= MEAN_FOUND * deviation + SETTLED * point[i].abs()
        };
        settled = (0..points).all(near);
        let sum_of_squares = residual.norm_squared();
        let status = Status::MeanFound;
        let outcome = Outcome {
            sum_of_squares,
            point: point.clone(),
            residual,
            jacobian,
            status,
            ..growth.outcome.clone()
        };
        found = Some((outcome, posterior.covariance, prior, noise));
        if settled {
            break;
        }
        let moved = (&next - &point).amax() / point.amax();
        point = next;
        simulation.set_unknowns(unknowns.with_values(&point)?);
        if moved > CORRECTED_AGAIN || simulation.task().objective == Objective::Positions {
            simulation.correct();
        }
    }
    let Some((mut outcome, covariance, prior, noise)) = found else { return Ok(growth) };
    unknowns = unknowns.with_values(&outcome.point)?;
    let rms = simulation.unit() * (outcome.sum_of_squares / outcome.residual.len() as f64).sqrt();
    let status = outcome.status.to_string();
    let mut level = Level { points, rms, status, iterations: Vec::new(), projected: 0 };
    if !settled && prior.is_some() {
        let (led, _, last) =
            fit_level(simulation, &unknowns, prior.as_ref(), 1, settings, lowest_tangents, watch)?;
        if !led.residual.is_empty() {
            unknowns = unknowns.with_values(&led.point)?;
            (outcome, level) = (led, last);
        }
    }
    let mut levels = growth.levels;
    match levels.iter_mut().find(|earlier| earlier.points == points) {
        Some(earlier) => earlier.go_on(&level),
        None => levels.push(level),
    }
    let finer = finer(simulation, &unknowns)?;
    let average = Some(Average { inverse: covariance / (noise * noise), finer });
    Ok(Growth { unknowns, outcome, domain, average, levels, stopped: growth.stopped })
}

/// The mean with twice as many segments, by one linearised step; `None` without equilibria.
fn finer(simulation: &mut Equilibria<'_>, unknowns: &Unknowns) -> Result<Option<Finer>> {
    let finer = resampled(simulation, unknowns, 2 * points_of(unknowns) - 1)?;
    let point = finer.values();
    simulation.set_unknowns(finer.clone());
    let Ok(Evaluation::Values { residual, jacobian: Some(jacobian) }) = simulation.evaluate(&point, true)
    else {
        return Ok(None);
    };
    let noise = scatter(simulation, &residual, &jacobian).white();
    let posterior = Posterior::new(&(&residual / noise), &(&jacobian / noise), &point);
    let Some(posterior) = posterior else { return Ok(None) };
    let left = residual - &jacobian * (&posterior.mean - &point);
    // A point outside what a curve may be is no better description.
    let Ok(found) = finer.with_values(&posterior.mean) else { return Ok(None) };
    let Some(Unknown { curve, .. }) = found.iter().next().cloned() else { return Ok(None) };
    let left = scatter(simulation, &left, &jacobian);
    Ok(Some(Finer { curve, covariance: posterior.covariance, left }))
}

/// Noise and misfit of an evaluation.
pub(crate) fn scatter(
    simulation: &Equilibria<'_>,
    residual: &DVector<f64>,
    jacobian: &DMatrix<f64>,
) -> Scatter {
    let tracks = simulation.tracks();
    let source = match (simulation.noise_is_known(), simulation.repeats()) {
        (true, _) => NoiseSource::Declared(1.0),
        (false, Some((squares, freedom))) => NoiseSource::Repeats { squares, freedom },
        (false, None) => NoiseSource::Neighbours(&tracks),
    };
    let rank = Covariance::rank_of(jacobian) + simulation.eliminated();
    Scatter {
        expected: simulation.task().robust.map_or(1.0, |robust| robust.mean_of_noise()),
        ..Scatter::new(residual, jacobian, rank, source)
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
    let averaged = is_averaged(simulation, settings);
    // The mean moves it.
    let evaluated = Settings { outer: Options { max_iterations: 0, ..settings.outer }, ..settings.clone() };
    let settings = if averaged { &evaluated } else { settings };
    let (outcome, domain, level) =
        fit_level(simulation, &start, None, MOST_CORRECTIONS, settings, lowest_tangents, watch)?;
    let unknowns = start.with_values(&outcome.point)?;
    let levels = if averaged { Vec::new() } else { vec![level] };
    let stopped = format!("all {points} control points of the previous pass are fitted again");
    Ok(Growth { unknowns, outcome, domain, average: None, levels, stopped })
}

/// Fits one level: a fixed number of control points.
///
/// * `prior` — leads the fit; what it returns is the data's own
/// * `corrections` — how often the correction of the grid's error is renewed at most
fn fit_level(
    simulation: &mut Equilibria<'_>,
    unknowns: &Unknowns,
    prior: Option<&Prior>,
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
        let mut led = Led { problem: simulation, prior };
        match minimise(&mut led, start, &domain, &settings.outer, &mut numbered) {
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
    if prior.is_some() && !outcome.residual.is_empty() {
        let own = measurements as usize;
        outcome.residual = outcome.residual.rows(0, own).into_owned();
        outcome.jacobian = outcome.jacobian.rows(0, own).into_owned();
        outcome.sum_of_squares = outcome.residual.norm_squared();
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

/// The constraints of all curves.
fn domain_of(unknowns: &Unknowns, settings: &Settings, lowest_tangents: &[f64]) -> Result<LinearConstraints> {
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
