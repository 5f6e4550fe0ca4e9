//! Growth of a curve: starts with one control point and doubles the number of segments while that pays.
//!
//! One number of points that does not pay is tolerated: a curve that bends down and up again, as of many knits, is
//! fitted no better by a line than by a constant, but by three or five points. Two in a row end the growth.
//!
//! Source: Miguel et al. 2012, §5.2; the second try is ours, unless [`GrowthRule`](super::GrowthRule) says otherwise.

use super::average::{Average, Averaged, COURSE, FELT, average};
use super::growth_rule::by_chance;
use super::level::{Level, fit_level, most_points, points_of, resampled};
use super::settings::Settings;
use super::watch::Watch;
use crate::equilibria::{Equilibria, Objective, Unknowns};
use crate::optimise::gauss_newton::{LinearConstraints, Outcome};
use crate::optimise::uncertainty::{Covariance, variance_left};
use cloth_sim::error::Result;

/// Residuals up to this share of the compared values are rounding; none is better than another.
const ROUNDING: f64 = 1e-12;

/// Gain of a step that ends a level on the way to the mean.
const ROUGH: f64 = 1e-4;

/// A curve with one number of control points is corrected for the grid at most so often.
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

impl Growth {
    /// A mean, after the levels on the way to it.
    fn of(averaged: Averaged, mut levels: Vec<Level>, stopped: String) -> Self {
        let Averaged { unknowns, outcome, domain, level, average } = averaged;
        match levels.iter_mut().find(|earlier| earlier.points == level.points) {
            Some(earlier) => earlier.go_on(&level),
            None => levels.push(level),
        }
        Self { unknowns, outcome, domain, average: Some(average), levels, stopped }
    }
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
    // Forces are hardly wrong for the grid: their correction waits for the level that is kept. Positions, and shapes that
    // tell the poses of clips, are corrected on the way, which ends with the mean or with a last fit: up to there a rough
    // minimum tells whether a level pays.
    let shapes = simulation.task().objective == Objective::Positions || simulation.finds_clip_poses();
    let on_the_way = simulation.is_corrected() && shapes;
    let mut rough = settings.clone();
    if on_the_way {
        rough.outer.gain_tolerance = rough.outer.gain_tolerance.max(ROUGH);
    }
    let mut unknowns = simulation.unknowns().clone();
    let mut tries = 0;
    loop {
        let points = points_of(&unknowns);
        let (outcome, domain, level) =
            fit_level(simulation, &unknowns, usize::from(on_the_way), &rough, lowest_tangents, watch)?;
        levels.push(level);
        unknowns = unknowns.with_values(&outcome.point)?;
        let felt = (&outcome.jacobian * &outcome.point).norm() >= FELT * outcome.residual.norm();
        if points == 1 && !felt {
            let stopped = "a constant stiffness hardly changes the simulated values".to_string();
            return Ok(Growth { unknowns, outcome, domain, average: None, levels, stopped });
        }
        // The mean needs no more than a start that has a course. Robust weights need the best one.
        if points == COURSE
            && settings.robust.is_none()
            && let Some(averaged) = average(simulation, &unknowns, settings, lowest_tangents)?
        {
            let stopped =
                format!("the mean over constant, straight and bent courses with {most} control points");
            return Ok(Growth::of(averaged, levels, stopped));
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
            if let Some(averaged) = average(simulation, &unknowns, settings, lowest_tangents)? {
                return Ok(Growth::of(averaged, levels, stopped));
            }
            if simulation.is_corrected() {
                let (settled, _, level) =
                    fit_level(simulation, &unknowns, MOST_CORRECTIONS, settings, lowest_tangents, watch)?;
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
    let before = simulation.unknowns().clone();
    let points = points_of(&before);
    let stopped = format!("all {points} control points of the previous pass are fitted again");
    if let Some(limit) = settings.robust {
        simulation.make_robust(limit);
    }
    if let Some(averaged) = average(simulation, &before, settings, lowest_tangents)? {
        return Ok(Growth::of(averaged, Vec::new(), stopped));
    }
    let start = resampled(simulation, &before, points)?;
    let (outcome, domain, level) =
        fit_level(simulation, &start, MOST_CORRECTIONS, settings, lowest_tangents, watch)?;
    let unknowns = start.with_values(&outcome.point)?;
    Ok(Growth { unknowns, outcome, domain, average: None, levels: vec![level], stopped })
}

/// One, two, three, five, nine …: halves every segment, up to the maximum.
fn next_points(points: usize, most: usize) -> usize {
    if points == 1 { 2 } else { 2 * points - 1 }.min(most)
}
