mod endings;

use super::{
    Evaluation, Globalisation, Iteration, LinearConstraints, Options, Outcome, Residuals, Status, minimise,
};
use crate::optimise::robust::Robust;
use nalgebra::{Complex, DMatrix, DVector};
use rand::SeedableRng;
use rand::rngs::StdRng;
use rand_distr::{Distribution, StandardNormal};
use std::convert::Infallible;

fn vector(values: &[f64]) -> DVector<f64> {
    DVector::from_column_slice(values)
}

fn matrix<const N: usize>(rows: &[[f64; N]]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), N, |i, j| rows[i][j])
}

type C = Complex<f64>;
type Model = fn(&[C], f64) -> C;

/// y = model(b, x) at given x, as measurements; derivatives by complex steps.
struct Curve {
    model: Model,
    at: Vec<f64>,
    measured: Vec<f64>,
    evaluations: usize,
}

impl Curve {
    /// Measurements without or with noise.
    fn new(model: Model, truth: &[f64], at: Vec<f64>, noise: f64) -> Self {
        let b: Vec<C> = truth.iter().map(|&value| C::from(value)).collect();
        let mut random = StdRng::seed_from_u64(5);
        let measured = at
            .iter()
            .map(|&x| {
                let draw: f64 = StandardNormal.sample(&mut random);
                model(&b, x).re + noise * draw
            })
            .collect();
        Self { model, at, measured, evaluations: 0 }
    }

    fn fit(&mut self, start: &[f64], domain: &LinearConstraints, options: &Options) -> Outcome {
        let Ok(outcome) = minimise(self, &DVector::from(start.to_vec()), domain, options, &mut |_| {});
        outcome
    }

    fn fit_freely(&mut self, start: &[f64]) -> Outcome {
        self.fit(start, &LinearConstraints::everywhere(start.len()), &Options::default())
    }
}

impl Residuals for Curve {
    type Error = Infallible;

    fn evaluate(&mut self, point: &DVector<f64>, jacobian: bool) -> Result<Evaluation, Infallible> {
        self.evaluations += 1;
        let step = 1e-30;
        let at = |shifted: usize, by: f64| -> DVector<f64> {
            let shift = |j| if j == shifted { step } else { 0.0 };
            let b: Vec<C> = point.iter().enumerate().map(|(j, &value)| C::new(value, shift(j))).collect();
            let values = self.at.iter().map(|&x| (self.model)(&b, x));
            DVector::from_iterator(self.at.len(), values.map(|y| if by == 0.0 { y.re } else { y.im / step }))
        };
        let columns: Vec<DVector<f64>> = (0..point.len()).map(|j| at(j, step)).collect();
        let residual = DVector::from(self.measured.clone()) - at(0, 0.0);
        Ok(Evaluation::Values { residual, jacobian: jacobian.then(|| DMatrix::from_columns(&columns)) })
    }
}

fn saturation(b: &[C], x: f64) -> C {
    b[0] * (C::from(1.0) - (-b[1] * x).exp())
}

fn two_decays(b: &[C], x: f64) -> C {
    b[0] + b[1] * (-b[3] * x).exp() + b[2] * (-b[4] * x).exp()
}

fn three_decays(b: &[C], x: f64) -> C {
    b.chunks(2).map(|pair| pair[0] * (-pair[1] * x).exp()).sum()
}

fn rational(b: &[C], x: f64) -> C {
    (b[0] + b[1] * x + b[2] * x * x) / (b[3] * x + b[4] * x * x + 1.0)
}

fn steps(count: usize, width: f64) -> Vec<f64> {
    (0..count).map(|i| width * i as f64).collect()
}

fn assert_close(found: &DVector<f64>, wanted: &[f64], tolerance: f64) {
    for (found, wanted) in found.iter().zip(wanted) {
        assert!((found / wanted - 1.0).abs() < tolerance, "{found} instead of {wanted}");
    }
}

#[test]
fn known_parameters_are_found_from_far() {
    // Formulas, sizes and starts of NIST's Misra1a, Kirby2, Lanczos3 and MGH17; their own data are tested elsewhere.
    type Case<'a> = (Model, &'a [f64], Vec<f64>, &'a [f64]);
    let cases: [Case; 4] = [
        (saturation, &[239.0, 5.5e-4], steps(14, 55.0), &[500.0, 1e-4]),
        (
            rational,
            &[1.67, -0.139, 2.6e-3, -1.7e-3, 2.2e-5],
            steps(150, 2.5),
            &[2.0, -0.1, 3e-3, -1e-3, 1e-5],
        ),
        (
            three_decays,
            &[0.0951, 1.0, 0.8607, 3.0, 1.5576, 5.0],
            steps(24, 0.05),
            &[1.2, 0.3, 5.6, 5.5, 6.5, 7.6],
        ),
        (
            two_decays,
            &[0.375, 1.94, -1.46, 0.0129, 0.0221],
            steps(33, 10.0),
            &[50.0, 150.0, -100.0, 1.0, 2.0],
        ),
    ];
    for (model, truth, at, start) in cases {
        let outcome = Curve::new(model, truth, at, 0.0).fit_freely(start);
        assert!(outcome.status.converged(), "{}", outcome.status);
        assert_close(&outcome.point, truth, 1e-6);
    }
}

#[test]
fn with_noise_the_gradient_vanishes_at_the_end() {
    let mut curve = Curve::new(two_decays, &[0.375, 1.94, -1.46, 0.0129, 0.0221], steps(33, 10.0), 1e-3);
    let outcome = curve.fit_freely(&[50.0, 150.0, -100.0, 1.0, 2.0]);
    assert!(outcome.status.converged(), "{}", outcome.status);
    for column in outcome.jacobian.column_iter() {
        let cosine = column.dot(&outcome.residual) / column.norm() / outcome.residual.norm();
        assert!(cosine.abs() < 1e-6, "{cosine:e}");
    }
    let squares: Vec<f64> = outcome.iterations.iter().map(|iteration| iteration.sum_of_squares).collect();
    assert!(squares.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-13)));
}

#[test]
fn bounds_active_at_the_solution_agree_with_enumeration() {
    let truth = [2.0, 0.5, 1.0, 0.05];
    let model: Model = |b, x| b[0] * (-b[1] * x).exp() + b[2] * (-b[3] * x).exp();
    let start = [1.0, 1.0, 0.5, 0.02];
    // Upper limits, some of them below the optimum.
    for caps in [[1.8, 1.0, 2.0, 1.0], [5.0, 0.4, 2.0, 0.03], [1.5, 0.3, 0.9, 1.0], [9.0, 9.0, 9.0, 9.0]] {
        let mut best: Option<Outcome> = None;
        for set in 0..16usize {
            let free: Vec<usize> = (0..4).filter(|j| set >> j & 1 == 0).collect();
            let mut reduced =
                Reduced { curve: Curve::new(model, &truth, steps(40, 0.5), 0.01), caps, free: free.clone() };
            let from = DVector::from_iterator(free.len(), free.iter().map(|&j| start[j]));
            let domain = LinearConstraints::everywhere(free.len());
            let Ok(mut outcome) = minimise(&mut reduced, &from, &domain, &Options::default(), &mut |_| {});
            outcome.point = reduced.whole(&outcome.point);
            let inside = (0..4).all(|j| outcome.point[j] <= caps[j] + 1e-9);
            let better = best.as_ref().is_none_or(|best| outcome.sum_of_squares < best.sum_of_squares);
            if inside && outcome.status.converged() && better {
                best = Some(outcome);
            }
        }
        let reference = best.unwrap();
        let domain = LinearConstraints {
            rows: -DMatrix::identity(4, 4),
            bounds: -DVector::from(caps.to_vec()),
            roughness: None,
        };
        let outcome =
            Curve::new(model, &truth, steps(40, 0.5), 0.01).fit(&start, &domain, &Options::default());
        assert!(outcome.status.converged(), "{}", outcome.status);
        assert!((&outcome.point - &reference.point).amax() < 1e-6, "{} {}", outcome.point, reference.point);
        assert!((0..4).all(|j| outcome.point[j] <= caps[j] * (1.0 + 1e-15)));
        let resting = (0..4).filter(|&j| outcome.point[j] >= caps[j] * (1.0 - 1e-12)).count();
        assert_eq!(outcome.iterations.last().unwrap().active.len(), resting);
    }
}

/// A curve with some parameters fixed at their caps.
struct Reduced {
    curve: Curve,
    caps: [f64; 4],
    free: Vec<usize>,
}

impl Reduced {
    fn whole(&self, point: &DVector<f64>) -> DVector<f64> {
        let mut whole = DVector::from(self.caps.to_vec());
        self.free.iter().zip(point.iter()).for_each(|(&j, &value)| whole[j] = value);
        whole
    }
}

impl Residuals for Reduced {
    type Error = Infallible;

    fn evaluate(&mut self, point: &DVector<f64>, jacobian: bool) -> Result<Evaluation, Infallible> {
        let whole = self.whole(point);
        self.curve.evaluate(&whole, jacobian).map(|evaluation| match evaluation {
            Evaluation::Values { residual, jacobian } => Evaluation::Values {
                residual,
                jacobian: jacobian.map(|jacobian| jacobian.select_columns(&self.free)),
            },
            failed => failed,
        })
    }
}

#[test]
fn a_start_outside_is_moved_inside() {
    let domain = LinearConstraints { rows: matrix(&[[1.0, 0.0]]), bounds: vector(&[200.0]), roughness: None };
    let mut curve = Curve::new(saturation, &[239.0, 5.5e-4], steps(14, 55.0), 0.0);
    let outcome = curve.fit(&[-100.0, 1e-3], &domain, &Options::default());
    assert!(outcome.projected && outcome.iterations.iter().all(|step| step.solved));
    assert_close(&outcome.point, &[239.0, 5.5e-4], 1e-9);
    let nowhere = LinearConstraints {
        rows: matrix(&[[1.0, 0.0], [-1.0, 0.0]]),
        bounds: vector(&[1.0, 1.0]),
        roughness: None,
    };
    let outcome = curve.fit(&[0.0, 1e-3], &nowhere, &Options::default());
    let said = "the linearised step failed: the inequalities contradict one another";
    assert_eq!(outcome.status.to_string(), said);
}

/// A model without an answer in part of its domain.
struct Fragile {
    curve: Curve,
    most: f64,
}

impl Residuals for Fragile {
    type Error = Infallible;

    fn evaluate(&mut self, point: &DVector<f64>, jacobian: bool) -> Result<Evaluation, Infallible> {
        match point[1] > self.most {
            true => Ok(Evaluation::Failed { reason: "no equilibrium".to_owned() }),
            false => self.curve.evaluate(point, jacobian),
        }
    }
}

#[test]
fn points_that_cannot_be_evaluated_are_stepped_around() {
    let curve = || Curve::new(saturation, &[239.0, 5.5e-4], steps(14, 55.0), 0.0);
    let fit = |most: f64, observe: &mut dyn FnMut(&Iteration)| {
        let start = vector(&[500.0, 1e-4]);
        let options = Options { initial_radius: 100.0, ..Options::default() };
        let mut problem = Fragile { curve: curve(), most };
        let Ok(outcome) =
            minimise(&mut problem, &start, &LinearConstraints::everywhere(2), &options, observe);
        outcome
    };
    let mut failures = 0;
    let outcome = fit(5.6e-4, &mut |iteration| failures += usize::from(iteration.gain.is_none()));
    assert!(failures > 0);
    assert_close(&outcome.point, &[239.0, 5.5e-4], 1e-9);
    // The solution itself cannot be evaluated: the status says so, and the best point is kept.
    let outcome = fit(4e-4, &mut |_| {});
    assert_eq!(outcome.status.to_string(), "no step, however short, could be evaluated: no equilibrium");
    assert!(outcome.point[1] > 3.9e-4 && !outcome.status.converged());
    let outcome = fit(0.0, &mut |_| {});
    assert_eq!(outcome.status, Status::StartFailed { reason: "no equilibrium".to_owned() });
}

#[test]
fn unseen_parameters_are_smoothed_and_do_not_disturb() {
    // Only the first two of five parameters matter.
    let model: Model = |b, x| (b[0] * x).exp() + b[1] * b[1] * x + b[2] * 0.0 + b[3] * 0.0 + b[4] * 0.0;
    let roughness =
        DMatrix::from_fn(3, 5, |i, j| [1.0, -2.0, 1.0].get(j.wrapping_sub(i)).copied().unwrap_or(0.0));
    let domain = LinearConstraints { roughness: Some(roughness), ..LinearConstraints::everywhere(5) };
    let mut curve = Curve::new(model, &[1.0, 3.0, 0.0, 0.0, 0.0], steps(20, 0.1), 0.0);
    let outcome = curve.fit(&[0.5, 1.0, 70.0, -9.0, 0.0], &domain, &Options::default());
    assert!(outcome.status.converged(), "{}", outcome.status);
    assert_close(&outcome.point, &[1.0, 3.0, 5.0, 7.0, 9.0], 1e-9);
    assert_eq!(outcome.iterations.last().unwrap().rank, 2);
    // Without roughness they stay.
    let outcome =
        curve.fit(&[0.5, 1.0, 70.0, -9.0, 4.0], &LinearConstraints::everywhere(5), &Options::default());
    assert_close(&outcome.point, &[1.0, 3.0, 70.0, -9.0, 4.0], 1e-9);
}

#[test]
fn the_published_rule_stops_early_and_says_so() {
    let mut curve = Curve::new(saturation, &[239.0, 5.5e-4], steps(14, 55.0), 0.5);
    let options = Options { gain_tolerance: 0.01, ..Options::default() };
    let early = curve.fit(&[250.0, 5e-4], &LinearConstraints::everywhere(2), &options);
    assert_eq!(early.status.to_string(), "the residual fell by less than 1e-2 between two iterations");
    let full = curve.fit_freely(&[250.0, 5e-4]);
    assert!(early.iterations.len() < full.iterations.len());
    assert!(early.sum_of_squares < full.sum_of_squares * 1.01);
    let options = Options { max_iterations: 1, ..Options::default() };
    let outcome = curve.fit(&[500.0, 1e-4], &LinearConstraints::everywhere(2), &options);
    assert_eq!(outcome.status.to_string(), "not converged after 1 iterations");
}

fn line_search(gain_tolerance: f64) -> Options {
    Options { globalisation: Globalisation::LineSearch, gain_tolerance, ..Options::default() }
}

#[test]
fn a_line_search_halves_steps_until_they_are_no_worse() {
    // From 5 the whole step ends at −25, its halves at −10, −2.5 and 1.25: the last is nearer to 2.
    let overshoots: Model = |b, _| (b[0] - 2.0) / ((b[0] - 2.0) * (b[0] - 2.0) + 1.0).sqrt();
    let mut curve = Curve::new(overshoots, &[2.0], vec![0.0], 0.0);
    let outcome = curve.fit(&[5.0], &LinearConstraints::everywhere(1), &line_search(1e-13));
    assert!(outcome.status.converged() && (outcome.point[0] - 2.0).abs() < 1e-9, "{}", outcome.point);
    let kept: Vec<bool> = outcome.iterations.iter().map(|iteration| iteration.accepted).collect();
    assert_eq!(kept[..4], [false, false, false, true]);
    let lengths: Vec<f64> = outcome.iterations.iter().map(|iteration| iteration.step).collect();
    assert_eq!(lengths[1..4], [0.5, 0.25, 0.125].map(|share| share * lengths[0]));
    let squares = outcome.iterations.windows(2).all(|pair| pair[1].sum_of_squares <= pair[0].sum_of_squares);
    assert!(squares && outcome.iterations.iter().all(|i| i.accepted == i.gain.is_some_and(|g| g >= 0.0)));
}

#[test]
fn a_line_search_ends_with_the_first_small_gain() {
    let mut curve = Curve::new(saturation, &[239.0, 5.5e-4], steps(14, 55.0), 0.5);
    let outcome = curve.fit(&[250.0, 5e-4], &LinearConstraints::everywhere(2), &line_search(0.01));
    assert_eq!(outcome.status.to_string(), "the residual fell by less than 1e-2 between two iterations");
    let gains: Vec<f64> = outcome.iterations.iter().filter_map(|i| i.gain.filter(|_| i.accepted)).collect();
    let (last, before) = gains.split_last().unwrap();
    assert!(*last <= 0.01 && !before.is_empty() && before.iter().all(|&gain| gain > 0.01), "{gains:?}");
    let full = curve.fit_freely(&[250.0, 5e-4]);
    assert!(outcome.sum_of_squares < full.sum_of_squares * 1.01);
    let limited = Options { max_iterations: 1, ..line_search(1e-13) };
    let outcome = curve.fit(&[500.0, 1e-4], &LinearConstraints::everywhere(2), &limited);
    assert_eq!(outcome.status, Status::IterationLimit { limit: 1 });
}

#[test]
fn a_line_search_keeps_to_the_domain_and_off_points_without_an_answer() {
    let curve = || Curve::new(saturation, &[239.0, 5.5e-4], steps(14, 55.0), 0.0);
    let start = vector(&[500.0, 1e-4]);
    let bounded =
        LinearConstraints { rows: matrix(&[[0.0, -1.0]]), bounds: vector(&[-4e-4]), roughness: None };
    let outcome = curve().fit(start.as_slice(), &bounded, &line_search(1e-13));
    assert!(outcome.status.converged() && outcome.point[1] <= 4e-4 * (1.0 + 1e-12));
    assert_eq!(outcome.iterations.last().unwrap().active.len(), 1);
    let mut fragile = Fragile { curve: curve(), most: 5.6e-4 };
    let everywhere = LinearConstraints::everywhere(2);
    let Ok(outcome) = minimise(&mut fragile, &start, &everywhere, &line_search(1e-13), &mut |_| {});
    assert_close(&outcome.point, &[239.0, 5.5e-4], 1e-6);
    let mut fragile = Fragile { curve: curve(), most: 1e-4 };
    let Ok(outcome) = minimise(&mut fragile, &start, &everywhere, &line_search(1e-13), &mut |_| {});
    assert_eq!(outcome.status, Status::Stalled { reason: Some("no equilibrium".to_owned()) });
}

#[test]
fn jacobians_on_demand_change_nothing_but_the_count() {
    let curve = || Curve::new(saturation, &[239.0, 5.5e-4], steps(14, 55.0), 0.5);
    let (mut at_once, mut later) = (curve(), curve());
    let on_demand = Options { jacobian_at_trials: false, ..Options::default() };
    let everywhere = LinearConstraints::everywhere(2);
    let first = at_once.fit(&[500.0, 1e-4], &everywhere, &Options::default());
    let second = later.fit(&[500.0, 1e-4], &everywhere, &on_demand);
    assert_eq!(first.point, second.point);
    assert_eq!(at_once.evaluations, first.iterations.len() + 1);
    assert!(later.evaluations > at_once.evaluations);
}

/// A misfit of 100, larger by 1e-7 of it away from the first evaluated point, beside 1 − k.
struct Rough {
    first: Option<f64>,
}

impl Residuals for Rough {
    type Error = Infallible;

    fn evaluate(&mut self, point: &DVector<f64>, _: bool) -> Result<Evaluation, Infallible> {
        let first = *self.first.get_or_insert(point[0]);
        let misfit = if point[0] == first { 100.0 } else { 100.0 * (1.0 + 1e-7) };
        Ok(Evaluation::Values {
            residual: vector(&[1.0 - point[0], misfit]),
            jacobian: Some(matrix(&[[1.0], [0.0]])),
        })
    }
}

/// From 0.97 the linear model predicts a gain of 9e-8, but every step is worse by the roughness.
#[test]
fn a_gain_below_the_tolerance_that_roughness_hides_is_no_failure() {
    let fit = |gain_tolerance| {
        let options = Options { gain_tolerance, ..Options::default() };
        let domain = LinearConstraints::everywhere(1);
        let Ok(outcome) =
            minimise(&mut Rough { first: None }, &vector(&[0.97]), &domain, &options, &mut |_| {});
        outcome.status
    };
    assert!(matches!(fit(1e-6), Status::Noise { promised } if (8e-8..1e-7).contains(&promised)));
    assert!(matches!(fit(1e-13), Status::Stalled { reason: None }));
}

/// A curve's robust residuals.
struct Bent(Curve, Robust);

impl Residuals for Bent {
    type Error = Infallible;

    fn evaluate(&mut self, point: &DVector<f64>, jacobian: bool) -> Result<Evaluation, Infallible> {
        let Evaluation::Values { mut residual, jacobian } = self.0.evaluate(point, jacobian)? else {
            unreachable!("a curve has values everywhere");
        };
        let mut jacobian = jacobian.expect("asked for");
        for (i, value) in residual.iter_mut().enumerate() {
            let (bent, slope) = self.1.bend(*value);
            *value = bent;
            jacobian.row_mut(i).scale_mut(slope);
        }
        Ok(Evaluation::Values { residual, jacobian: Some(jacobian) })
    }

    fn robust(&self) -> Option<Robust> {
        Some(self.1)
    }
}

#[test]
fn where_all_residuals_are_bent_few_steps_suffice() {
    // Loading and unloading of a cloth with friction: no row is near the curve. Gauss–Newton alone takes 94 steps.
    let line: Model = |b, x| b[0] * x + b[1] * x * x;
    let mut curve = Curve::new(line, &[1.0, 0.5], (0..40).map(|i| 0.1 * f64::from(i)).collect(), 0.01);
    curve.measured.iter_mut().enumerate().for_each(|(i, y)| *y *= if i % 2 == 0 { 1.1 } else { 0.93 });
    let (limit, start) = (0.03, vector(&[3.0, 3.0]));
    let mut bent = Bent(curve, Robust { limit });
    let domain = LinearConstraints::everywhere(2);
    let Ok(outcome) = minimise(&mut bent, &start, &domain, &Options::default(), &mut |_| {});
    assert!(outcome.status.converged(), "{}", outcome.status);
    assert!(outcome.iterations.len() <= 30, "{} steps", outcome.iterations.len());
    let slope = outcome.jacobian.tr_mul(&outcome.residual).norm();
    assert!(slope <= 1e-6 * outcome.jacobian.norm() * outcome.residual.norm(), "{slope}");
}
