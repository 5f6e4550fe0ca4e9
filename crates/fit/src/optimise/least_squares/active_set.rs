//! The polish: moves a point near the solution to the solution, holding rows as equations.
//!
//! An interior-point solution has a few correct digits, which nearly always reveal the active rows. With these held,
//! the problem is a plain least-squares problem in the remaining space, solved to rounding. A wrong guess is
//! corrected as in any primal active-set method: a row met on the way is added; at the end of the way the multipliers
//! of all rows met are computed as a non-negative least-squares problem, and if they do not balance the gradient, the
//! search continues along the remainder. (Dropping rows with negative multipliers one by one can cycle where more
//! rows meet than the space has dimensions, as the rows of a curve do at zero stiffness.)
//!
//! Sources: Nocedal & Wright, Numerical Optimization (2006), algorithm 16.3; Lawson & Hanson, Solving Least Squares
//! Problems (1974), chapter 23.

use super::dense::{Spectrum, Split, independent};
use super::kkt::Held;
use super::scaled::Scaled;
use nalgebra::DVector;

/// Polishes a start; `working` holds the rows that seem active.
pub(super) fn polish(problem: &Scaled, start: &DVector<f64>, working: &[usize]) -> Held {
    let rows = &problem.rows;
    let count = rows.nrows();
    let mut working = working.to_vec();
    let mut point = start.clone();
    let mut multipliers = DVector::zeros(count);
    let (mut repeated, mut lowest) = (false, f64::INFINITY);
    for _ in 0..50 + 4 * (problem.columns() + count) {
        working = independent(rows, working.into_iter());
        let split = Split::by(rows, &working);
        let gap =
            DVector::from_iterator(working.len(), working.iter().map(|&row| -problem.slack(row, &point)));
        let (Some(snap), true) = (split.shortest(&gap), point.iter().all(|value| value.is_finite())) else {
            break;
        };
        point += &snap;

        let reduced = &problem.matrix * &split.null;
        let along =
            Spectrum::of(&reduced).solve(&(&problem.target - &problem.matrix * &point), problem.threshold);
        let step = &split.null * along;
        if let Some((row, fraction)) = first_met(problem, &point, &step, &working) {
            point.axpy(fraction, &step, 1.0);
            working.push(row);
            continue;
        }
        point += &step;

        if let Some(row) = violated(problem, &point, &working) {
            working.push(row);
            continue;
        }
        // A long last step leaves rounding behind: repeat once.
        if step.amax() + snap.amax() > 1e-8 * point.amax() && !repeated {
            repeated = true;
            continue;
        }
        repeated = false;
        let gradient = problem.gradient(&point);
        let rounding = 1e-12 * problem.gradient_scale(&point);
        let tight = (0..count).filter(|&row| problem.slack(row, &point) <= 1e-12 * problem.size(row, &point));
        multipliers = pushes(problem, &tight.collect::<Vec<_>>(), &gradient, rounding);
        let downhill = rows.tr_mul(&multipliers) - &gradient;
        // Every pass must lower the cost; otherwise only rounding is left.
        let cost = (&problem.matrix * &point - &problem.target).norm_squared();
        if downhill.amax() <= rounding || cost >= lowest {
            break;
        }
        lowest = cost;
        working = (0..count).filter(|&row| multipliers[row] > 0.0).collect();
        let bend = (&problem.matrix * &downhill).norm_squared();
        let step = &downhill * (downhill.norm_squared() / bend);
        let met = first_met(problem, &point, &step, &working);
        point.axpy(met.map_or(1.0, |(_, fraction)| fraction), &step, 1.0);
        working.extend(met.map(|(row, _)| row));
    }
    Held { point, multipliers }
}

/// The λ ≥ 0 over some rows with the least ‖Gᵀλ − gradient‖ (Lawson & Hanson); zero for all other rows.
fn pushes(problem: &Scaled, among: &[usize], gradient: &DVector<f64>, rounding: f64) -> DVector<f64> {
    let mut multipliers = DVector::zeros(problem.rows.nrows());
    let mut pushing: Vec<usize> = Vec::new();
    for _ in 0..3 * among.len() {
        let left = gradient - problem.rows.tr_mul(&multipliers);
        let gain = |row: usize| problem.along(row, &left);
        let next = among.iter().copied().filter(|row| !pushing.contains(row) && gain(*row) > 0.1 * rounding);
        let Some(row) = next.max_by(|&a, &b| gain(a).total_cmp(&gain(b))) else { break };
        pushing.push(row);
        if independent(&problem.rows, pushing.iter().copied()).len() < pushing.len() {
            break;
        }
        while let Some(wanted) = Split::by(&problem.rows, &pushing).multipliers(gradient) {
            // Stops where the first multiplier turns negative, and drops that row.
            let part = |i: usize| multipliers[pushing[i]] / (multipliers[pushing[i]] - wanted[i]);
            let first =
                (0..pushing.len()).filter(|&i| wanted[i] <= 0.0).min_by(|&i, &j| part(i).total_cmp(&part(j)));
            let share = first.map_or(1.0, part);
            for (i, &row) in pushing.iter().enumerate() {
                multipliers[row] += share * (wanted[i] - multipliers[row]);
            }
            let Some(first) = first else { break };
            multipliers[pushing.remove(first)] = 0.0;
        }
    }
    multipliers
}

/// The row that a step meets first, and the fraction of the step up to there.
fn first_met(
    problem: &Scaled,
    point: &DVector<f64>,
    step: &DVector<f64>,
    working: &[usize],
) -> Option<(usize, f64)> {
    let length = step.norm();
    (0..problem.rows.nrows())
        .filter(|row| !working.contains(row))
        .filter_map(|row| {
            let approach = -problem.along(row, step);
            let fraction = problem.slack(row, point).max(0.0) / approach;
            (approach > 1e-12 * length && fraction < 1.0).then_some((row, fraction))
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The row most violated beyond rounding and independent of the held ones.
fn violated(problem: &Scaled, point: &DVector<f64>, working: &[usize]) -> Option<usize> {
    let mut rows: Vec<(usize, f64)> = (0..problem.rows.nrows())
        .filter(|row| !working.contains(row))
        .map(|row| (row, problem.violation(row, point)))
        .filter(|&(_, violation)| violation > 1e-13)
        .collect();
    rows.sort_by(|a, b| b.1.total_cmp(&a.1));
    rows.into_iter().map(|(row, _)| row).find(|&row| {
        independent(&problem.rows, working.iter().copied().chain([row])).len() == working.len() + 1
    })
}
