//! The mean over descriptions of a curve's course: constant, straight and bent, weighed by what the data say.

use super::level::{Level, SETTLED, domain_of, most_points, points_of, resampled};
use super::posterior::Posterior;
use super::settings::Settings;
use crate::equilibria::{Equilibria, Objective, Unknown, Unknowns};
use crate::optimise::gauss_newton::{Evaluation, LinearConstraints, Outcome, Residuals, Status};
use crate::optimise::uncertainty::{Covariance, Scatter};
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::error::Result;
use nalgebra::{DMatrix, DVector};

/// If doubling the stiffness changes less than this share of the residual, more points would be undetermined, as for
/// ring-2 springs that depend on softer yarns.
pub(super) const FELT: f64 = 0.1;

/// Fewest control values that the frames must tell apart for a curve to have a course: mean, trend and bend.
const COURSE: usize = 3;

/// The mean is found where it moves by less than this share of its standard deviation. At kinks of a spline it may go to and
/// fro: after so many steps it is close enough, or there is none.
const MEAN_FOUND: f64 = 0.05;
const CLOSE: f64 = 0.5;
const MOST_MEANS: usize = 16;

/// On the way to the mean positions are corrected for the grid at every step; forces, which the grid hardly changes, once
/// the curve moves by less than this share, and again if it has moved by more since.
const CORRECTED_AGAIN: f64 = 0.05;

/// Increase of ‖r/σ‖² that makes a step to the mean too long.
const WORSE: f64 = 9.0;

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

/// A fit of a mean.
pub(super) struct Averaged {
    /// The curve.
    pub(super) unknowns: Unknowns,
    /// The fit with its control points.
    pub(super) outcome: Outcome,
    /// Constraints on the curve.
    pub(super) domain: LinearConstraints,
    /// The fit, as the last level.
    pub(super) level: Level,
    /// The mean.
    pub(super) average: Average,
}

/// A step on the way to the mean.
struct Mean {
    outcome: Outcome,
    posterior: Posterior,
    noise: f64,
}

/// The mean over all descriptions of a curve's course, with all control points; `None` where it has none: the variant has
/// one stiffness, several curves are fitted together, the frames hardly feel it, or it is not found.
///
/// # Errors
/// Control points that do not form a valid curve.
pub(super) fn average(
    simulation: &mut Equilibria<'_>,
    start: &Unknowns,
    settings: &Settings,
    lowest_tangents: &[f64],
) -> Result<Option<Averaged>> {
    let points = most_points(simulation, settings);
    let one = start.iter().count() == 1;
    if !settings.averaged || !one || points < COURSE || simulation.measurements() <= points {
        return Ok(None);
    }
    let unknowns = resampled(simulation, start, points)?;
    let domain = domain_of(&unknowns, settings, lowest_tangents)?;
    simulation.set_unknowns(unknowns.clone());
    let at_every_step = simulation.task().objective == Objective::Positions;
    if at_every_step {
        simulation.correct();
    }
    let mut point = unknowns.values();
    let mut corrected_at: Option<DVector<f64>> = None;
    let mut found: Option<Mean> = None;
    let mut close = false;
    let mut most: Option<f64> = None;
    for _ in 0..MOST_MEANS {
        let values = match simulation.evaluate(&point, true) {
            Ok(Evaluation::Values { residual, jacobian: Some(jacobian) }) => Some((residual, jacobian)),
            _ => None,
        };
        let near = values.filter(|(residual, _)| most.is_none_or(|most| residual.norm_squared() <= most));
        let Some((residual, jacobian)) = near else {
            // Too far for the linear model: half the way.
            match &found {
                Some(last) => point = 0.5 * (&point + &last.outcome.point),
                None => return Ok(None),
            }
            continue;
        };
        let felt = (&jacobian * &point).norm() >= FELT * residual.norm();
        if found.is_none() && (!felt || Covariance::rank_of(&jacobian) < COURSE) {
            return Ok(None);
        }
        let noise = simulation.scatter(&residual, &jacobian).white();
        let (scaled, slope) = (&residual / noise, &jacobian / noise);
        let Some(posterior) = Posterior::new(&scaled, &slope, &point) else { break };
        let Ok(next) = domain.nearest(&posterior.mean) else { break };
        let within = |share: f64| {
            let near = |i: usize| {
                let deviation = posterior.covariance[(i, i)].max(0.0).sqrt();
                (next[i] - point[i]).abs() <= share * deviation + SETTLED * point[i].abs()
            };
            (0..points).all(near)
        };
        close = within(CLOSE);
        let settled = within(MEAN_FOUND);
        let outcome = Outcome::at(point.clone(), residual, jacobian, Status::MeanFound, Vec::new());
        most = Some(outcome.sum_of_squares + WORSE * noise.powi(2));
        found = Some(Mean { outcome, posterior, noise });
        let moved = |at: &DVector<f64>| (&next - at).amax() / next.amax();
        let once = simulation.is_corrected() && !at_every_step;
        let stale = once && corrected_at.as_ref().is_none_or(|at| moved(at) > CORRECTED_AGAIN);
        if settled && !stale {
            break;
        }
        let step = moved(&point);
        point = next;
        simulation.set_unknowns(unknowns.with_values(&point)?);
        if at_every_step || stale && step <= CORRECTED_AGAIN {
            simulation.correct();
            corrected_at = Some(point.clone());
            // Another objective.
            most = None;
        }
    }
    let Some(Mean { outcome, posterior, noise }) = found.filter(|_| close) else { return Ok(None) };
    let unknowns = unknowns.with_values(&outcome.point)?;
    let rms = simulation.unit() * (outcome.sum_of_squares / outcome.residual.len() as f64).sqrt();
    let status = outcome.status.to_string();
    let level = Level { points, rms, status, iterations: Vec::new(), projected: 0 };
    let finer = finer(simulation, &unknowns)?;
    let average = Average { inverse: posterior.covariance / noise.powi(2), finer };
    Ok(Some(Averaged { unknowns, outcome, domain, level, average }))
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
    let noise = simulation.scatter(&residual, &jacobian).white();
    let posterior = Posterior::new(&(&residual / noise), &(&jacobian / noise), &point);
    let Some(posterior) = posterior else { return Ok(None) };
    let left = residual - &jacobian * (&posterior.mean - &point);
    // A point outside what a curve may be is no better description.
    let Ok(found) = finer.with_values(&posterior.mean) else { return Ok(None) };
    let Some(Unknown { curve, .. }) = found.iter().next().cloned() else { return Ok(None) };
    let left = simulation.scatter(&left, &jacobian);
    Ok(Some(Finer { curve, covariance: posterior.covariance, left }))
}
