//! The mean over descriptions of a curve's course: constant, straight and bent, weighed by what the data say.

use super::level::{Level, SETTLED, domain_of, most_points, points_of, resampled};
use super::posterior::Posterior;
use super::settings::Settings;
use crate::equilibria::{Equilibria, Objective, States, Unknown, Unknowns};
use crate::optimise::gauss_newton::{Evaluation, LinearConstraints, Outcome, Residuals, Status};
use crate::optimise::uncertainty::{Covariance, Scatter};
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::error::Result;
use nalgebra::{DMatrix, DVector};

/// If doubling the stiffness changes less than this share of the residual, more points would be undetermined, as for
/// ring-2 springs that depend on softer yarns.
pub(super) const FELT: f64 = 0.1;

/// Fewest control values that the frames must tell apart for a curve to have a course: mean, trend and bend.
pub(super) const COURSE: usize = 3;

/// The mean is found where it moves by less than this share of its standard deviation. At kinks of a spline it may go to and
/// fro: after so many steps it is close enough, or there is none.
const MEAN_FOUND: f64 = 0.05;
const CLOSE: f64 = 0.5;
const MOST_MEANS: usize = 16;

/// Values are corrected for the grid where the curve moves by less than this share, and again if it has moved by more since:
/// positions, which the grid changes more, sooner than forces. In between the objective stays one function.
const FORCES_AGAIN: f64 = 0.05;
const POSITIONS_AGAIN: f64 = 0.01;

/// Shares of a step that are tried after one that was accepted.
const SHARES: [f64; 2] = [0.05, 4.0];

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
    /// The mean that the linear model promises.
    next: DVector<f64>,
    /// The equilibria here.
    states: States,
}

impl Mean {
    /// The sum of squares beyond which a step from here is too long.
    fn most(&self) -> f64 {
        self.outcome.sum_of_squares + WORSE * self.noise.powi(2)
    }

    /// The share of the way to go where the promised mean moves against the point (Barzilai and Borwein 1988).
    fn share_after(&self, last: &Self) -> f64 {
        let moved = &self.outcome.point - &last.outcome.point;
        let turned = (&self.next - &self.outcome.point) - (&last.next - &last.outcome.point);
        let share = -moved.dot(&turned) / turned.norm_squared();
        if share > 0.0 { share.clamp(SHARES[0], SHARES[1]) } else { 1.0 }
    }

    /// A share of the way to the next mean.
    fn towards(&self, share: f64) -> DVector<f64> {
        self.outcome.point.lerp(&self.next, share)
    }
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
    let (before, states) = (simulation.unknowns().clone(), simulation.states());
    let averaged = search(simulation, start, points, settings, lowest_tangents)?;
    if averaged.is_none() {
        simulation.set_unknowns(before);
        simulation.return_to(&states);
    }
    Ok(averaged)
}

/// Steps to the mean; `None` if they do not settle.
fn search(
    simulation: &mut Equilibria<'_>,
    start: &Unknowns,
    points: usize,
    settings: &Settings,
    lowest_tangents: &[f64],
) -> Result<Option<Averaged>> {
    let unknowns = resampled(simulation, start, points)?;
    let domain = domain_of(&unknowns, settings, lowest_tangents)?;
    let positions = simulation.task().objective == Objective::Positions;
    let again = if positions { POSITIONS_AGAIN } else { FORCES_AGAIN };
    let mut point = unknowns.values();
    let mut corrects = positions;
    let mut corrected_at: Option<DVector<f64>> = None;
    let mut found: Option<Mean> = None;
    let mut close = false;
    let mut share = 1.0;
    for _ in 0..MOST_MEANS {
        simulation.set_unknowns(unknowns.with_values(&point)?);
        if corrects {
            simulation.correct();
        }
        let values = match simulation.evaluate(&point, true) {
            Ok(Evaluation::Values { residual, jacobian: Some(jacobian) }) => Some((residual, jacobian)),
            _ => None,
        };
        let most = found.as_ref().filter(|_| !corrects).map_or(f64::INFINITY, Mean::most);
        let Some((residual, jacobian)) = values.filter(|(residual, _)| residual.norm_squared() <= most)
        else {
            // Too far for the linear model: half the way, from where it was found.
            let Some(last) = &found else { return Ok(None) };
            share *= 0.5;
            point = last.towards(share);
            simulation.return_to(&last.states);
            continue;
        };
        let felt = (&jacobian * &point).norm() >= FELT * residual.norm();
        if found.is_none() && (!felt || Covariance::rank_of(&jacobian) < COURSE) {
            return Ok(None);
        }
        let noise = simulation.scatter(&residual, &jacobian).white();
        let (scaled, slope) = (&residual / noise, &jacobian / noise);
        let Some(posterior) = Posterior::new(&scaled, &slope, &point) else { return Ok(None) };
        let Ok(next) = domain.nearest(&posterior.mean) else { return Ok(None) };
        let within = |share: f64| {
            let near = |i: usize| {
                let deviation = posterior.covariance[(i, i)].max(0.0).sqrt();
                (next[i] - point[i]).abs() <= share * deviation + SETTLED * point[i].abs()
            };
            (0..points).all(near)
        };
        close = within(CLOSE);
        let settled = within(MEAN_FOUND);
        if corrects {
            corrected_at = Some(point.clone());
        }
        let apart = |a: &DVector<f64>, b: &DVector<f64>| (a - b).amax() / a.amax();
        // A step that is not taken makes no correction stale.
        let end = if settled { &point } else { &next };
        let stale =
            simulation.is_corrected() && corrected_at.as_ref().is_none_or(|at| apart(end, at) > again);
        let renewed = std::mem::replace(&mut corrects, stale && (settled || apart(&next, &point) <= again));
        let outcome = Outcome::at(point, residual, jacobian, Status::MeanFound, Vec::new());
        let mean = Mean { outcome, posterior, noise, next, states: simulation.states() };
        // Under another correction the promises of two steps are not alike.
        let alike = found.as_ref().filter(|_| !renewed && !corrects);
        share = alike.map_or(1.0, |last| mean.share_after(last));
        point = domain.nearest(&mean.towards(share)).unwrap_or_else(|_| mean.next.clone());
        found = Some(mean);
        if settled && !stale {
            break;
        }
    }
    let corrected = corrected_at.is_some() || !simulation.is_corrected();
    let found = found.filter(|_| close && corrected);
    let Some(Mean { outcome, posterior, noise, .. }) = found else { return Ok(None) };
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
