//! Cases 34 and 35: the least squares of a linearised step, against exact fractions and the optimality conditions,
//! formed here from their definition.

use crate::property::for_all;
use crate::table::{Extent, Row};
use cloth_fit::optimise::gauss_newton::{
    Evaluation, LinearConstraints, Options, Residuals, Status as FitStatus, minimise,
};
use cloth_fit::optimise::least_squares::{Bound, LeastSquares, Smoothing, Solution, Status};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use rand::{Rng, SeedableRng, rngs::StdRng};

/// Largest ratios of column scales.
const SPREADS: [f64; 5] = [1.0, 1e2, 1e4, 1e6, 1e8];

pub(crate) fn case_34(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for spread in SPREADS {
        let row =
            Row::measured(34, format!("exact fractions, columns {spread:.0e} apart"), "relative error", 1e-8);
        rows.push(for_all(row, extent.runs(200, 20_000), any::<u64>(), |row, seed| {
            fractions(row, seed, spread)
        }));
    }
    for spread in SPREADS {
        let row = Row::measured(34, format!("under inequalities, columns {spread:.0e} apart"), "KKT", 1e-8);
        rows.push(for_all(row, extent.runs(200, 20_000), any::<u64>(), |row, seed| {
            let problem = random_problem(seed, spread, false);
            let solution = problem.solve();
            let largest = match solution.status {
                Status::Optimal => conditions(&problem, &solution),
                _ => f64::NAN,
            };
            row.measure(largest, || format!("seed {seed}: {}", solution.status))
        }));
    }
    for spread in [1.0, 1e4, 1e8] {
        let row = Row::measured(
            34,
            format!(
                "directions without data, columns {spread:.0e} apart: rank, and KKT of what the data see"
            ),
            "KKT",
            1e-8,
        );
        rows.push(for_all(row, extent.runs(200, 10_000), any::<u64>(), |row, seed| {
            let problem = random_problem(seed, spread, true);
            let solution = problem.solve();
            let hidden = DMatrix::from_columns(&scaled_columns(&problem)).rank(1e-8) == solution.rank;
            let largest = match solution.status {
                Status::Optimal if hidden => conditions(&problem, &solution),
                _ => f64::NAN,
            };
            row.measure(largest, || {
                format!(
                    "seed {seed}: {}, {:?}, rank {} of {}",
                    solution.status,
                    solution.kkt,
                    solution.rank,
                    problem.jacobian.ncols()
                )
            })
        }));
    }
    rows
}

fn scaled_columns(problem: &LeastSquares) -> Vec<DVector<f64>> {
    let unit = |column: DVector<f64>| if column.norm() > 0.0 { column.normalize() } else { column };
    problem.jacobian.column_iter().map(|column| unit(column.into_owned())).collect()
}

/// A system of small integers with normal equations solved exactly (Cramer); columns are then scaled by powers of two,
/// without rounding.
fn fractions(row: &mut Row, seed: u64, spread: f64) -> bool {
    let mut random = StdRng::seed_from_u64(seed);
    let n = random.random_range(1..5);
    let m = n + random.random_range(0..5);
    let jacobian: Vec<Vec<i128>> =
        (0..m).map(|_| (0..n).map(|_| random.random_range(-9..10)).collect()).collect();
    let target: Vec<i128> = (0..m).map(|_| random.random_range(-99..100)).collect();
    let dot = |f: &dyn Fn(usize) -> i128| (0..m).map(f).sum::<i128>();
    let gram: Vec<Vec<i128>> =
        (0..n).map(|i| (0..n).map(|j| dot(&|r| jacobian[r][i] * jacobian[r][j])).collect()).collect();
    let right: Vec<i128> = (0..n).map(|i| dot(&|r| jacobian[r][i] * target[r])).collect();
    let whole = determinant(&gram);
    if whole == 0 {
        return row.measure(0.0, String::new);
    }
    let exact: Vec<f64> = (0..n)
        .map(|j| {
            let mut replaced = gram.clone();
            (0..n).for_each(|i| replaced[i][j] = right[i]);
            determinant(&replaced) as f64 / whole as f64
        })
        .collect();
    let most = spread.log2();
    let scales: Vec<f64> =
        (0..n).map(|_| 2f64.powi(random.random_range(-0.5 * most..=0.5 * most) as i32)).collect();
    let problem = LeastSquares::new(
        DMatrix::from_fn(m, n, |i, j| jacobian[i][j] as f64 * scales[j]),
        DVector::from_fn(m, |i, _| target[i] as f64),
    );
    let solution = problem.solve();
    let largest = exact.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
    // An exact zero is accurate to the rounding of the target.
    let largest = if largest > 0.0 { largest } else { 1.0 };
    let error =
        (0..n).map(|j| (solution.point[j] * scales[j] - exact[j]).abs() / largest).fold(0.0, f64::max);
    let error = if solution.status == Status::Optimal { error } else { f64::NAN };
    row.measure(error, || {
        format!("seed {seed}: {jacobian:?} {target:?} times {scales:?}, {}", solution.status)
    })
}

/// Determinant by cofactors, without rounding.
fn determinant(matrix: &[Vec<i128>]) -> i128 {
    if matrix.is_empty() {
        return 1;
    }
    let minor = |column: usize| -> Vec<Vec<i128>> {
        let rest = |row: &Vec<i128>| [&row[..column], &row[column + 1..]].concat();
        matrix[1..].iter().map(rest).collect()
    };
    let sign = |column: usize| if column.is_multiple_of(2) { 1 } else { -1 };
    (0..matrix.len()).map(|column| sign(column) * matrix[0][column] * determinant(&minor(column))).sum()
}

/// A problem of the size of a fit, with constraint rows and a box around a feasible point.
///
/// * `hidden` — leaves directions that the data do not determine
fn random_problem(seed: u64, spread: f64, hidden: bool) -> LeastSquares {
    let mut random = StdRng::seed_from_u64(seed);
    let n = random.random_range(2..12);
    let m = random.random_range(0..40);
    let height = n + random.random_range(1..20);
    let rank = if hidden { random.random_range(1..n) } else { n };
    let most = 0.5 * spread.log10();
    let scales = DVector::from_fn(n, |_, _| 10f64.powf(random.random_range(-most..=most)));
    let mut uniform =
        |rows: usize, columns: usize| DMatrix::from_fn(rows, columns, |_, _| random.random_range(-1.0..1.0));
    let even = if hidden { uniform(height, rank) * uniform(rank, n) } else { uniform(height, n) };
    let inside = uniform(n, 1).column(0) * 0.3;
    let target = uniform(height, 1).column(0) * 3.0;
    let slack = uniform(m, 1).column(0).map(|slack: f64| slack.max(0.0));
    let rows = uniform(m, n);
    let room = uniform(2, 1);
    let stretched = DMatrix::from_diagonal(&scales);
    let mut problem = LeastSquares::new(even * &stretched, target);
    problem.bounds = &rows * &inside - slack;
    problem.rows = rows * &stretched;
    problem.lower = inside.add_scalar(-room[0].abs()).component_div(&scales);
    problem.upper[0] = (inside[0] + room[1].abs()) / scales[0];
    if hidden {
        problem.smoothing =
            Some(Smoothing { roughness: uniform(n, n), point: inside.component_div(&scales) });
    }
    problem
}

/// The largest violation of the optimality conditions, in unknowns with columns of unit length: Jᵀ(Jp − y) = Σ λ g, λ ≥
/// 0, g·p ≥ h, λ or g·p − h = 0.
fn conditions(problem: &LeastSquares, solution: &Solution) -> f64 {
    let lengths: Vec<f64> = problem
        .jacobian
        .column_iter()
        .map(|column| if column.norm() > 0.0 { column.norm() } else { 1.0 })
        .collect();
    let point = &solution.point;
    let size = 1.0 + problem.target.norm();
    let mut gradient = problem.jacobian.tr_mul(&(&problem.jacobian * point - &problem.target));
    let mut worst = 0.0f64;
    // g·p − h over the magnitude of its terms.
    let slack = |bound: Bound| match bound {
        Bound::Row(i) => {
            let row = problem.rows.row(i);
            let terms: f64 = row.iter().zip(point.iter()).map(|(a, p)| (a * p).abs()).sum();
            ((row * point)[0] - problem.bounds[i]) / (1.0 + terms + problem.bounds[i].abs())
        }
        Bound::Lower(j) => lengths[j] * (point[j] - problem.lower[j]) / (1.0 + (lengths[j] * point[j]).abs()),
        Bound::Upper(j) => lengths[j] * (problem.upper[j] - point[j]) / (1.0 + (lengths[j] * point[j]).abs()),
    };
    for active in &solution.active {
        match active.bound {
            Bound::Row(i) => gradient.axpy(-active.multiplier, &problem.rows.row(i).transpose(), 1.0),
            Bound::Lower(j) => gradient[j] -= active.multiplier,
            Bound::Upper(j) => gradient[j] += active.multiplier,
        }
        let pull = active.multiplier / size;
        worst = worst.max(slack(active.bound).abs().min(pull.abs())).max(-pull);
    }
    let n = problem.jacobian.ncols();
    let rows = (0..problem.rows.nrows()).filter(|&i| problem.bounds[i].is_finite()).map(Bound::Row);
    let lower = (0..n).filter(|&j| problem.lower[j].is_finite()).map(Bound::Lower);
    let upper = (0..n).filter(|&j| problem.upper[j].is_finite()).map(Bound::Upper);
    for bound in rows.chain(lower).chain(upper) {
        worst = worst.max(-slack(bound));
    }
    let stationarity = gradient.iter().zip(&lengths).map(|(g, length)| (g / length).abs() / size);
    // A NaN must propagate through the maximum.
    stationarity.chain([worst]).fold(0.0, |worst, figure| if figure <= worst { worst } else { figure })
}

pub(crate) fn case_35(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    let honest =
        |row: &mut Row, problem: &LeastSquares, feasible: Option<bool>, input: &dyn Fn() -> String| {
            let solution = problem.solve();
            let finite = solution.point.iter().all(|value| value.is_finite());
            let holds = finite
                && match solution.status {
                    Status::Optimal => feasible != Some(false) && conditions(problem, &solution) <= 1e-8,
                    Status::Infeasible => feasible != Some(true),
                    Status::Inaccurate { kkt } => kkt > 0.0,
                    Status::NotFinite => false,
                };
            row.holds(holds, || {
                format!("{}: {} {:.1e}", input(), solution.status, conditions(problem, &solution))
            })
        };
    let runs = extent.runs(150, 15_000);
    let row = Row::new(
        35,
        "rows that contradict one another by 1e-16 … 1: never called solved beyond the tolerance",
    );
    rows.push(for_all(row, runs, (any::<u64>(), -16.0..0.0), |row, (seed, exponent): (u64, f64)| {
        let mut problem = random_problem(seed, 1e2, false);
        let n = problem.jacobian.ncols();
        let gap = 10f64.powf(exponent);
        let mut random = StdRng::seed_from_u64(!seed);
        let direction = DVector::from_fn(n, |_, _| random.random_range(-1.0..1.0));
        let lengths = DVector::from_iterator(n, problem.jacobian.column_iter().map(|column| column.norm()));
        // Only d·p ≥ 1 + gap and −d·p ≥ −1.
        let direction = direction.component_mul(&lengths);
        problem.rows = DMatrix::from_rows(&[direction.transpose(), -direction.transpose()]);
        problem.bounds = DVector::from_vec(vec![1.0 + gap, -1.0]);
        problem.lower.fill(f64::NEG_INFINITY);
        problem.upper.fill(f64::INFINITY);
        let feasible = (gap > 1e-7).then_some(false);
        honest(row, &problem, feasible, &|| format!("seed {seed}, gap {gap:.1e}"))
    }));
    let row = Row::new(35, "rows 1e-14 … 1e-2 from dependent, all met by one point");
    rows.push(for_all(row, runs, (any::<u64>(), -14.0..-2.0), |row, (seed, exponent): (u64, f64)| {
        let mut problem = random_problem(seed, 1e2, false);
        let mut random = StdRng::seed_from_u64(!seed);
        let tilt = 10f64.powf(exponent);
        let m = problem.rows.nrows();
        // Pairs of nearly parallel rows with nearly equal bounds.
        for i in (1..m).step_by(2) {
            let by = 1.0 + tilt * random.random_range(0.0..1.0);
            let before = problem.rows.row(i - 1) * by;
            problem.rows.set_row(i, &before);
            problem.bounds[i] = problem.bounds[i - 1] * by - tilt * random.random_range(0.0..1.0);
        }
        honest(row, &problem, Some(true), &|| format!("seed {seed}, tilt {tilt:.1e}"))
    }));
    let row = Row::new(35, "columns 1e-16 … 1e-4 from dependent");
    rows.push(for_all(row, runs, (any::<u64>(), -16.0..-4.0), |row, (seed, exponent): (u64, f64)| {
        let mut problem = random_problem(seed, 1e2, false);
        let (first, second) =
            (problem.jacobian.column(0).into_owned(), problem.jacobian.column(1).into_owned());
        problem.jacobian.set_column(1, &(first + second * 10f64.powf(exponent)));
        honest(row, &problem, Some(true), &|| format!("seed {seed}, 1e{exponent}"))
    }));
    let row = Row::new(35, "a box 1e-16 … 1e-2 wide");
    rows.push(for_all(row, runs, (any::<u64>(), -16.0..-2.0), |row, (seed, exponent): (u64, f64)| {
        let mut problem = random_problem(seed, 1e2, false);
        problem.rows = DMatrix::zeros(0, problem.jacobian.ncols());
        problem.bounds = DVector::zeros(0);
        problem.upper = problem.lower.map(|side| side + side.abs() * 10f64.powf(exponent));
        honest(row, &problem, Some(true), &|| format!("seed {seed}, 1e{exponent}"))
    }));
    let row = Row::new(35, "rows over thirty decades");
    rows.push(for_all(row, runs, any::<u64>(), |row, seed| {
        let mut problem = random_problem(seed, 1e2, false);
        let mut random = StdRng::seed_from_u64(!seed);
        for i in 0..problem.rows.nrows() {
            let by = 10f64.powf(random.random_range(-15.0..15.0));
            problem.rows.row_mut(i).scale_mut(by);
            problem.bounds[i] *= by;
        }
        let solution = problem.solve();
        // Judged with rows normalised to unit length.
        let mut even = problem.clone();
        let mut evened = solution.clone();
        for i in 0..even.rows.nrows() {
            let length = even.rows.row(i).norm();
            even.rows.row_mut(i).unscale_mut(length);
            even.bounds[i] /= length;
            let multipliers = evened.active.iter_mut().filter(|active| active.bound == Bound::Row(i));
            multipliers.for_each(|active| active.multiplier *= length);
        }
        let holds = solution.status == Status::Optimal && conditions(&even, &evened) <= 1e-8;
        row.holds(holds, || format!("seed {seed}: {} {:.1e}", solution.status, conditions(&even, &evened)))
    }));
    let row = Row::new(35, "NaN or an infinity anywhere: said, and no number comes of it");
    rows.push(for_all(row, runs, (any::<u64>(), 0usize..4, 0usize..3), |row, (seed, place, value)| {
        let mut problem = random_problem(seed, 1e2, false);
        let value = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][value];
        match place {
            0 => problem.jacobian[0] = value,
            1 => problem.target[0] = value,
            2 if !problem.rows.is_empty() => problem.rows[0] = value,
            _ => problem.lower[0] = if value == f64::NEG_INFINITY { f64::NAN } else { value },
        }
        let solution = problem.solve();
        let said = solution.status == Status::NotFinite && solution.point.iter().all(|value| *value == 0.0);
        row.holds(said, || format!("seed {seed}, place {place}: {}", solution.status))
    }));
    rows.push(unsolvable_steps());
    rows
}

/// A line through points.
struct Line;

impl Residuals for Line {
    type Error = std::convert::Infallible;

    fn evaluate(&mut self, point: &DVector<f64>, _: bool) -> Result<Evaluation, Self::Error> {
        let jacobian = DMatrix::from_fn(5, 2, |i, j| (i as f64).powi(j as i32));
        let residual = DVector::from_fn(5, |i, _| 1.0 + 2.0 * i as f64) - &jacobian * point;
        Ok(Evaluation::Values { residual, jacobian: Some(jacobian) })
    }
}

/// A nonlinear fit with an unsolvable linearised step has not converged, and reports the reason.
fn unsolvable_steps() -> Row {
    let mut row = Row::new(35, "a fit whose step cannot be solved: not converged, and why");
    for gap in [1e-6, 1e-3, 1.0] {
        let rows = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, -1.0, -1.0]);
        let domain = LinearConstraints { rows, bounds: DVector::from_vec(vec![gap, 0.0]), roughness: None };
        let start = DVector::from_vec(vec![0.0, 0.0]);
        let Ok(outcome) = minimise(&mut Line, &start, &domain, &Options::default(), &mut |_| ());
        let said = matches!(outcome.status, FitStatus::StepFailed { .. }) && !outcome.status.converged();
        row.holds(said, || format!("gap {gap}: {}", outcome.status));
    }
    row
}
