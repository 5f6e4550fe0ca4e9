//! Nonlinear least squares under linear inequalities: Gauss–Newton steps in a scaled trust region.
//!
//! ```text
//! minimise F(k) = ‖r(k)‖²   subject to   A k ≥ b          r = measured − simulated, J = ∂ simulated / ∂k
//! step:  minimise ‖J p − r‖²   subject to   A (k + p) ≥ b,   ‖D p‖ ≤ Δ          d_j = largest ‖J_j‖ so far
//! ```
//!
//! The gain ratio, (F(k) − F(k+p)) over the decrease predicted by the linear model, decides whether a step is
//! accepted, and widens or narrows Δ. Near the solution steps are not cut and the method is plain Gauss–Newton. The
//! step itself: `region.rs`. Source: Moré, The Levenberg-Marquardt algorithm (1978). Optionally the whole step is
//! halved instead until F does not grow: `line_search.rs`.

mod line_search;
mod options;
mod outcome;
mod problem;
mod region;
mod state;

pub use options::{Globalisation, Options};
pub use outcome::{Iteration, Outcome, Status};
pub use problem::{Evaluation, LinearConstraints, Residuals};

use crate::optimise::least_squares::Status as StepStatus;
use nalgebra::DVector;
use problem::values;
use region::{Bend, Scale, Step};
use state::{State, accepted_state};

/// If a whole Gauss–Newton step predicts a smaller relative decrease and still does not lower the sum of squares, the
/// residuals are noisy and the search ends: with ten thousand measurements the minimum is then a hundredth of a
/// standard error away.
const NOISE: f64 = 1e-8;

/// Fits from a start; `observe` receives every step after its trial.
///
/// A start outside the domain is first moved to the nearest point inside.
///
/// # Errors
/// Only errors of [`Residuals::evaluate`]; a fit that does not converge reports it in its status.
///
/// # Panics
/// On inconsistent shapes, or if an evaluation omits a requested Jacobian.
pub fn minimise<P: Residuals>(
    problem: &mut P,
    start: &DVector<f64>,
    domain: &LinearConstraints,
    options: &Options,
    observe: &mut dyn FnMut(&Iteration),
) -> Result<Outcome, P::Error> {
    let inside = match domain.nearest(start) {
        Ok(inside) => inside,
        Err(status) => return Ok(Outcome::unevaluated(start.clone(), Status::StepFailed { status })),
    };
    let projected = inside != *start;
    let state = match values(problem.evaluate(&inside, true)?) {
        Ok((residual, Some(jacobian))) => State::new(inside, residual, jacobian, problem.robust()),
        Ok((_, None)) => panic!("the Jacobian was asked for"),
        Err(reason) => return Ok(Outcome::unevaluated(inside, Status::StartFailed { reason })),
    };
    let outcome = match options.globalisation {
        Globalisation::TrustRegion => within_region(problem, state, domain, options, observe),
        Globalisation::LineSearch => line_search::descend(problem, state, domain, options, observe),
    };
    Ok(Outcome { projected, ..outcome? })
}

/// Steps within a trust region, until a tolerance is met.
fn within_region<P: Residuals>(
    problem: &mut P,
    mut state: State,
    domain: &LinearConstraints,
    options: &Options,
    observe: &mut dyn FnMut(&Iteration),
) -> Result<Outcome, P::Error> {
    let mut scale = Scale::new(&state.jacobian);
    let mut radius = options.initial_radius * scale.norm_or_one(&state.point);
    // A decrease too small to continue for is too small to fail for.
    let noise = NOISE.max(options.gain_tolerance);
    let mut bend: Option<Bend> = None;
    let mut iterations = Vec::new();
    // Since the last accepted step: number of rejections, and the error of the last evaluation, if it failed.
    let (mut rejected, mut failure) = (0, None);

    let status = loop {
        if iterations.len() == options.max_iterations {
            break Status::IterationLimit { limit: options.max_iterations };
        }
        let step = Step::new(&state, domain, &scale, radius, bend.as_ref());
        if let StepStatus::Infeasible | StepStatus::NotFinite = step.status {
            break Status::StepFailed { status: step.status };
        }
        let share = scale.norm_or_one(&state.point);
        let length = scale.norm(&step.step);
        let short = length <= options.step_tolerance * share;
        let solved = step.status == StepStatus::Optimal;
        // An inaccurate step proves no minimum.
        if short && !step.cut && !solved {
            break Status::StepFailed { status: step.status };
        }
        if short && !step.cut {
            break Status::SmallStep { tolerance: options.step_tolerance };
        }
        if (short || rejected >= 3) && failure.is_none() && step.whole_promise <= noise && solved {
            break Status::Noise { promised: step.whole_promise };
        }
        if short {
            break Status::Stalled { reason: failure };
        }

        let point = &state.point + &step.step;
        let trial = values(problem.evaluate(&point, options.jacobian_at_trials)?);
        let gain = trial.as_ref().ok().map(|(residual, _)| state.gain(residual));
        let ratio = gain.map_or(f64::NEG_INFINITY, |gain| gain_ratio(gain, step.promised));
        let accepted = ratio > options.acceptance;
        let mut iteration = Iteration {
            iteration: iterations.len() + 1,
            sum_of_squares: state.residual.norm_squared(),
            gain,
            promised: step.promised,
            step: length / share,
            radius: radius / share,
            accepted,
            solved,
            rank: step.rank,
            active: step.active,
        };
        radius = match ratio {
            ratio if ratio < 0.25 => narrowed(gain, step.promised) * radius.min(length),
            ratio if ratio > 0.75 => radius.max(2.0 * step.seen),
            _ => radius,
        };
        match trial {
            Ok((residual, jacobian)) if accepted => {
                let next = match accepted_state(problem, point, residual, jacobian)? {
                    Ok(next) => next,
                    Err(reason) => break Status::Stalled { reason: Some(reason) },
                };
                // The curvature of robust residuals is in the step already.
                bend = problem.robust().is_none().then(|| Bend::between(&state, &next));
                state = next;
                scale.widen(&state.jacobian);
                (rejected, failure) = (0, None);
            }
            rejection => {
                rejected += 1;
                failure = rejection.err();
            }
        }
        iteration.sum_of_squares = state.residual.norm_squared();
        observe(&iteration);
        iterations.push(iteration);
        let little = gain.unwrap_or(f64::INFINITY).max(step.promised) <= options.gain_tolerance;
        if (accepted && little && solved && !step.cut) || state.residual.norm_squared() == 0.0 {
            break Status::SmallGain { tolerance: options.gain_tolerance };
        }
    };
    Ok(Outcome::at(state.point, state.residual, state.jacobian, status, iterations))
}

/// Gain over prediction. If the prediction is within rounding (a step along which the data see nothing), any point
/// that is no worse is accepted.
fn gain_ratio(gain: f64, promised: f64) -> f64 {
    let rounding = 1e-14;
    match promised <= rounding {
        true if gain >= -rounding => 1.0,
        true => f64::NEG_INFINITY,
        false => gain / promised,
    }
}

/// Factor that shortens a rejected step: to the minimum of the parabola through both ends and the slope at the start,
/// kept between a tenth and a half.
fn narrowed(gain: Option<f64>, promised: f64) -> f64 {
    // With the slope of an undamped step, twice its predicted gain π: F(t) = 1 − 2π t + (2π − gain) t².
    gain.map_or(0.25, |gain| (promised / (2.0 * promised - gain)).clamp(0.1, 0.5))
}

#[cfg(test)]
mod tests;
