//! The whole step of the linear model, halved until F does not grow: the published outer loop.
//!
//! ```text
//! p = argmin ‖J p − r‖²  subject to  A (k + p) ≥ b          tried are k + p, k + p/2, k + p/4 … until F does not grow
//! ```
//!
//! It ends with the first step that lowers F by no more than the tolerance, or when no step lowers F and the
//! predicted gain is within the tolerance.
//!
//! Source: Miguel et al. 2012, §5.1.

use super::options::Options;
use super::outcome::{Iteration, Outcome, Status};
use super::problem::{LinearConstraints, Residuals, values};
use super::region::{Scale, Step};
use super::state::{State, accepted_state};
use crate::optimise::least_squares::Status as StepStatus;

/// Smallest share of a step that is tried.
const SHORTEST: f64 = 1.0 / 1024.0;

/// Descends from a state within the domain.
pub(super) fn descend<P: Residuals>(
    problem: &mut P,
    mut state: State,
    domain: &LinearConstraints,
    options: &Options,
    observe: &mut dyn FnMut(&Iteration),
) -> Result<Outcome, P::Error> {
    let small_gain = Status::SmallGain { tolerance: options.gain_tolerance };
    let whole = |state: &State| {
        let scale = Scale::new(&state.jacobian);
        let step = Step::new(state, domain, &scale, f64::INFINITY, None);
        let length = scale.norm(&step.step) / scale.norm_or_one(&state.point);
        (step, length)
    };
    let (mut step, mut length) = whole(&state);
    let mut share = 1.0;
    let mut iterations = Vec::new();
    let status = loop {
        if let StepStatus::Infeasible | StepStatus::NotFinite = step.status {
            break Status::StepFailed { status: step.status };
        }
        let solved = step.status == StepStatus::Optimal;
        // An inaccurate step proves no minimum.
        if length <= options.step_tolerance && !solved {
            break Status::StepFailed { status: step.status };
        }
        if length <= options.step_tolerance {
            break Status::SmallStep { tolerance: options.step_tolerance };
        }
        if iterations.len() == options.max_iterations {
            break Status::IterationLimit { limit: options.max_iterations };
        }
        let point = &state.point + share * &step.step;
        let trial = values(problem.evaluate(&point, options.jacobian_at_trials)?);
        let gain = trial.as_ref().ok().map(|(residual, _)| state.gain(residual));
        let kept = gain.filter(|&gain| gain >= 0.0);
        let before = state.residual.norm_squared();
        let iteration = Iteration {
            iteration: iterations.len() + 1,
            sum_of_squares: kept.map_or(before, |gain| (1.0 - gain) * before),
            gain,
            promised: step.promised,
            step: share * length,
            radius: f64::INFINITY,
            accepted: kept.is_some(),
            solved,
            rank: step.rank,
            active: step.active.clone(),
        };
        observe(&iteration);
        iterations.push(iteration);
        match (trial, kept) {
            (Ok((residual, jacobian)), Some(gain)) => {
                state = match accepted_state(problem, point, residual, jacobian)? {
                    Ok(next) => next,
                    Err(reason) => break Status::Stalled { reason: Some(reason) },
                };
                if gain <= options.gain_tolerance && solved || state.residual.norm_squared() == 0.0 {
                    break small_gain;
                }
                (step, length) = whole(&state);
                share = 1.0;
            }
            (rejected, _) => {
                share *= 0.5;
                if share < SHORTEST {
                    break match rejected.err() {
                        None if step.promised <= options.gain_tolerance && solved => small_gain,
                        reason => Status::Stalled { reason },
                    };
                }
            }
        }
    };
    Ok(Outcome::at(state.point, state.residual, state.jacobian, status, iterations))
}
