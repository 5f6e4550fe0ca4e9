//! The polish: from a point near the solution to the solution, by holding rows as equations.
//!
//! An interior-point solution is a few digits; which rows hold it there is nearly always known from it. With these
//! held the problem is a plain least-squares problem in what is left of the space, solved to rounding. A wrong guess
//! is corrected as in any primal active-set method: the first row met on the way is added, a row that pulls is let go.
//! Source: Nocedal & Wright, Numerical Optimization (2006), algorithm 16.3; differs in taking steps of least norm
//! where the reduced problem is rank-deficient, and in snapping to the held rows before each step.

use super::dense::{Spectrum, Split, independent};
use super::scaled::Scaled;
use nalgebra::DVector;

/// A point and the multipliers of all (unit) rows, zero for rows that are not held.
#[derive(Debug, Clone)]
pub(super) struct Held {
    pub(super) point: DVector<f64>,
    pub(super) multipliers: DVector<f64>,
}

/// Polishes a start, with the rows that seem to hold it in `working`.
pub(super) fn polish(problem: &Scaled, start: &DVector<f64>, working: &[usize]) -> Held {
    let rows = &problem.rows;
    let count = rows.nrows();
    let mut working = independent(rows, working.iter().copied());
    let mut point = start.clone();
    let mut multipliers = DVector::zeros(count);
    let limit = 50 + 4 * (problem.columns() + count);
    for iteration in 0..limit {
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

        let gradient = problem.gradient(&point);
        let Some(held) = split.multipliers(&gradient) else { break };
        multipliers.fill(0.0);
        working.iter().zip(held.iter()).for_each(|(&row, &value)| multipliers[row] = value);
        if let Some(row) = violated(problem, &point, &working) {
            working.push(row);
            continue;
        }
        let pulling = (0..working.len()).filter(|&i| held[i] < -1e-12 * problem.gradient_scale(&point));
        // Late in a long run the lowest index is taken, which cannot cycle (Bland).
        let worst = match iteration < limit / 2 {
            true => pulling.min_by(|&i, &j| held[i].total_cmp(&held[j])),
            false => pulling.min_by_key(|&i| working[i]),
        };
        match worst {
            Some(i) => {
                working.remove(i);
            }
            // A last step that was long leaves its rounding behind: go once more.
            None if step.amax() + snap.amax() > 1e-8 * point.amax() && iteration + 1 < limit => {}
            None => break,
        }
    }
    Held { point, multipliers }
}

/// The row that a step meets first, and after which fraction of it.
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

/// The row most violated beyond rounding that can still be held beside the others.
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
