//! Every status of a fit, by either method, and its message.

use super::*;

/// A problem given by a function of the point and of the request for a Jacobian.
struct Given<F>(F);

impl<F: FnMut(f64, bool) -> Result<Evaluation, &'static str>> Residuals for Given<F> {
    type Error = &'static str;

    fn evaluate(&mut self, point: &DVector<f64>, jacobian: bool) -> Result<Evaluation, &'static str> {
        self.0(point[0], jacobian)
    }
}

/// Fits one parameter.
fn fit(
    evaluate: impl FnMut(f64, bool) -> Result<Evaluation, &'static str>,
    start: f64,
    options: &Options,
) -> Result<Outcome, &'static str> {
    minimise(&mut Given(evaluate), &vector(&[start]), &LinearConstraints::everywhere(1), options, &mut |_| {})
}

/// A residual, beside a constant one that keeps the sum of squares at or above 1.
fn values(residual: f64, slope: f64) -> Result<Evaluation, &'static str> {
    let jacobian = Some(matrix(&[[slope], [0.0]]));
    Ok(Evaluation::Values { residual: vector(&[residual, 1.0]), jacobian })
}

/// The defaults of both methods.
fn both() -> [Options; 2] {
    [Options::default(), line_search(1e-13)]
}

#[test]
fn a_start_at_the_minimum_does_not_move() {
    for options in both() {
        for residual in [vector(&[0.0, 1.0]), vector(&[0.0, 0.0])] {
            let evaluate = |_, _| {
                let jacobian = Some(matrix(&[[1.0], [0.0]]));
                Ok(Evaluation::Values { residual: residual.clone(), jacobian })
            };
            let outcome = fit(evaluate, 2.0, &options).unwrap();
            assert_eq!(outcome.status.to_string(), "the parameters moved by less than 1e-11");
            assert!(outcome.status.converged() && outcome.iterations.is_empty() && outcome.point[0] == 2.0);
        }
    }
}

#[test]
fn a_minimum_is_found_to_the_noise_of_the_residual_and_no_closer() {
    // Noise of 1e-5: a step to the zero of the residual predicts a gain of 1e-10 of the sum and does not achieve it.
    let evaluate = |k: f64, _| values(2.0 - k + 1e-5 * (1e9 * k).sin(), 1.0);
    let outcome = fit(evaluate, 5.0, &Options::default()).unwrap();
    let said = outcome.status.to_string();
    assert!(matches!(outcome.status, Status::Noise { promised } if promised < 1e-9), "{said}");
    assert!(said.starts_with("the possible gain, a share of "), "{said}");
    assert!(outcome.status.converged() && (outcome.point[0] - 2.0).abs() < 1e-4, "{}", outcome.point);
}

#[test]
fn a_derivative_of_the_wrong_sign_leads_nowhere() {
    for options in both() {
        let outcome = fit(|k, _| values(2.0 - k, -1.0), 5.0, &options).unwrap();
        assert_eq!(outcome.status.to_string(), "no step, however short, lowered the residual");
        assert!(!outcome.status.converged() && outcome.point[0] == 5.0);
    }
    // A line search with a gain tolerance of 1 % stops when no more is predicted.
    let outcome = fit(|k, _| values(2.0 - k, -1.0), 1.9, &line_search(0.01)).unwrap();
    assert_eq!(outcome.status, Status::SmallGain { tolerance: 0.01 });
    assert_eq!(outcome.point[0], 1.9);
}

#[test]
fn numbers_that_are_not_finite_are_no_values() {
    for (residual, slope) in [(f64::NAN, 1.0), (1.0, f64::INFINITY), (1e200, 1.0)] {
        let outcome = fit(|_, _| values(residual, slope), 1.0, &Options::default()).unwrap();
        let said = "the start could not be evaluated: the residual or its derivative is not finite";
        assert_eq!(outcome.status.to_string(), said);
        assert!(outcome.sum_of_squares.is_nan() && outcome.residual.is_empty());
    }
    // Finite values with a non-finite square.
    for options in both() {
        let outcome = fit(|k, _| values(2.0 - k, 1e300), 1.0, &options).unwrap();
        let said = "the linearised step failed: the least-squares problem contains NaN or infinite numbers";
        assert_eq!(outcome.status.to_string(), said);
        assert_eq!((outcome.point[0], outcome.sum_of_squares), (1.0, 2.0));
    }
}

#[test]
fn a_point_without_derivatives_is_not_gone_to() {
    let evaluate = |k: f64, jacobian: bool| match jacobian {
        true if k != 5.0 => Ok(Evaluation::Failed { reason: "no sensitivities".to_owned() }),
        true => values(2.0 - k, 1.0),
        false => Ok(Evaluation::Values { residual: vector(&[2.0 - k, 1.0]), jacobian: None }),
    };
    for options in both() {
        let options = Options { jacobian_at_trials: false, ..options };
        let outcome = fit(evaluate, 5.0, &options).unwrap();
        let said = "no step, however short, could be evaluated: no sensitivities";
        assert_eq!(outcome.status.to_string(), said);
        assert_eq!(outcome.point[0], 5.0);
    }
}

#[test]
fn what_ends_the_problem_ends_the_fit() {
    for options in both() {
        let gone = |from: f64| move |k: f64, _| if k == from { values(2.0 - k, 1.0) } else { Err("gone") };
        assert_eq!(fit(gone(1.0), 5.0, &options).unwrap_err(), "gone");
        assert_eq!(fit(gone(5.0), 5.0, &options).unwrap_err(), "gone");
    }
}

/// A problem that gives no Jacobian except at 5.
fn forgetful(k: f64, _: bool) -> Result<Evaluation, &'static str> {
    match values(2.0 - k, 1.0) {
        Ok(Evaluation::Values { residual, .. }) if k != 5.0 => {
            Ok(Evaluation::Values { residual, jacobian: None })
        }
        other => other,
    }
}

#[test]
#[should_panic(expected = "the Jacobian was asked for")]
fn a_start_without_its_jacobian_is_misuse() {
    let _ = fit(forgetful, 1.0, &Options::default());
}

#[test]
#[should_panic(expected = "the Jacobian was asked for")]
fn a_step_without_its_jacobian_is_misuse() {
    let _ = fit(forgetful, 5.0, &Options::default());
}
