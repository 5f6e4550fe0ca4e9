mod unpolished;

use super::dense::Spectrum;
use super::{Bound, LeastSquares, Smoothing, Solution, Status};
use nalgebra::{DMatrix, DVector};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

fn vector(values: &[f64]) -> DVector<f64> {
    DVector::from_column_slice(values)
}

fn matrix<const N: usize>(rows: &[[f64; N]]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), N, |i, j| rows[i][j])
}

fn random(random: &mut StdRng, rows: usize, columns: usize) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |_, _| random.random_range(-1.0..1.0))
}

fn random_vector(generator: &mut StdRng, rows: usize) -> DVector<f64> {
    random(generator, rows, 1).column(0).into_owned()
}

/// All inequalities of a problem as rows.
fn inequalities(problem: &LeastSquares) -> (DMatrix<f64>, DVector<f64>) {
    let (_, rows, bounds) = problem.inequalities();
    (rows, bounds)
}

/// Optimality conditions from the definition, in the given unknowns, without the solver's own figures.
fn assert_optimal(problem: &LeastSquares, solution: &Solution, tolerance: f64) {
    assert_eq!(solution.status, Status::Optimal, "{:?}", solution.kkt);
    let mut gradient = problem.jacobian.tr_mul(&(&problem.jacobian * &solution.point - &problem.target));
    let scale =
        problem.jacobian.norm() * (problem.target.norm() + (&problem.jacobian * &solution.point).norm());
    for active in &solution.active {
        assert!(active.multiplier >= -tolerance * scale, "{active:?}");
        match active.bound {
            Bound::Row(row) => gradient -= problem.rows.row(row).transpose() * active.multiplier,
            Bound::Lower(j) => gradient[j] -= active.multiplier,
            Bound::Upper(j) => gradient[j] += active.multiplier,
        }
    }
    assert!(gradient.norm() <= tolerance * scale, "gradient left: {:e}", gradient.norm() / scale);
    let (rows, bounds) = inequalities(problem);
    let slack = &rows * &solution.point - bounds;
    assert!(slack.min() >= -tolerance, "violated by {:e}", slack.min());
}

/// The minimiser by enumeration of all sets of rows as equations.
fn by_enumeration(problem: &LeastSquares) -> DVector<f64> {
    let (rows, bounds) = inequalities(problem);
    let (count, n) = rows.shape();
    let hessian = problem.jacobian.tr_mul(&problem.jacobian);
    let force = problem.jacobian.tr_mul(&problem.target);
    let mut best: Option<(f64, DVector<f64>)> = None;
    for set in 0..1usize << count {
        let chosen: Vec<usize> = (0..count).filter(|row| set >> row & 1 == 1).collect();
        if chosen.len() > n {
            continue;
        }
        let size = n + chosen.len();
        let mut system = DMatrix::zeros(size, size);
        let mut right = DVector::zeros(size);
        system.view_mut((0, 0), (n, n)).copy_from(&hessian);
        right.rows_mut(0, n).copy_from(&force);
        for (i, &row) in chosen.iter().enumerate() {
            system.view_mut((n + i, 0), (1, n)).copy_from(&rows.row(row));
            system.view_mut((0, n + i), (n, 1)).copy_from(&rows.row(row).transpose());
            right[n + i] = bounds[row];
        }
        let Some(found) = system.lu().solve(&right) else { continue };
        let point = found.rows(0, n).into_owned();
        let cost = (&problem.jacobian * &point - &problem.target).norm_squared();
        let feasible = (&rows * &point - &bounds).min() > -1e-9;
        if feasible && best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, point));
        }
    }
    best.expect("a feasible problem").1
}

#[test]
fn singular_values_of_matrices_that_broke_others() {
    for (height, n) in [(3, 5), (6, 21), (30, 7)] {
        let spectrum = Spectrum::of(&DMatrix::from_element(height, n, 1.0));
        assert!((spectrum.values[0] - ((height * n) as f64).sqrt()).abs() < 1e-13);
        assert_eq!(spectrum.rank(1e-10), 1);
    }
    let mut generator = StdRng::seed_from_u64(1);
    for n in [1, 2, 5, 40] {
        // Known singular values over twelve decades.
        let [left, right] = [n + 3, n].map(|height| random(&mut generator, height, n).qr().q());
        let values = DVector::from_fn(n, |j, _| 10f64.powf(-12.0 * j as f64 / n as f64));
        let spectrum = Spectrum::of(&(left * DMatrix::from_diagonal(&values) * right.transpose()));
        assert!((&spectrum.values - &values).amax() < 1e-14);
        let identity = DMatrix::identity(n, n);
        assert!((spectrum.right.tr_mul(&spectrum.right) - identity).amax() < 1e-13);
    }
}

#[test]
fn without_inequalities_it_is_the_qr_solution() {
    let mut generator = StdRng::seed_from_u64(2);
    for (height, n) in [(6, 6), (400, 12), (3000, 40)] {
        let problem =
            LeastSquares::new(random(&mut generator, height, n), random_vector(&mut generator, height));
        let factors = problem.jacobian.clone().qr();
        let plain = factors.r().solve_upper_triangular(&factors.q().tr_mul(&problem.target)).unwrap();
        let solution = problem.solve();
        assert_optimal(&problem, &solution, 1e-14);
        assert!(
            (&solution.point - &plain).amax() <= 1e-13 * plain.amax() * (1.0 + 1e2 * f64::from(height == n))
        );
        assert_eq!(solution.rank, n);
    }
}

#[test]
fn inactive_inequalities_change_nothing() {
    let mut generator = StdRng::seed_from_u64(3);
    let free = LeastSquares::new(random(&mut generator, 50, 5), random_vector(&mut generator, 50));
    let mut boxed = free.clone();
    boxed.lower.fill(-100.0);
    boxed.rows = random(&mut generator, 20, 5);
    boxed.bounds = DVector::from_element(20, -100.0);
    let solution = boxed.solve();
    assert_eq!(solution.point, free.solve().point);
    assert!(solution.active.is_empty());
}

#[test]
fn two_hundred_small_problems_agree_with_enumeration() {
    for seed in 0..200 {
        let mut generator = StdRng::seed_from_u64(seed);
        let n = generator.random_range(1..5);
        let m = generator.random_range(0..6);
        let mut problem =
            LeastSquares::new(random(&mut generator, n + 4, n), random_vector(&mut generator, n + 4) * 3.0);
        problem.rows = random(&mut generator, m, n);
        let inside = random_vector(&mut generator, n) * 0.2;
        problem.bounds =
            &problem.rows * &inside - DVector::from_fn(m, |_, _| generator.random_range(0.0..0.3));
        problem.lower = inside.add_scalar(-generator.random_range(0.0..1.0));
        problem.upper[0] = inside[0] + generator.random_range(0.0..1.0);
        let solution = problem.solve();
        assert_optimal(&problem, &solution, 1e-12);
        let reference = by_enumeration(&problem);
        let error = (&solution.point - &reference).amax();
        assert!(error <= 1e-9 * reference.amax().max(1.0), "seed {seed}: {error:e}");
    }
}

#[test]
fn two_hundred_problems_as_large_as_a_fit_are_solved_to_rounding() {
    for seed in 0..200 {
        let mut generator = StdRng::seed_from_u64(1000 + seed);
        let n = generator.random_range(5..30);
        let m = generator.random_range(0..150);
        // Columns over eight decades, rows over six.
        let mut spread = |most: f64| 10f64.powf(generator.random_range(-most..most));
        let columns = DVector::from_fn(n, |_, _| spread(4.0));
        let lengths = DVector::from_fn(m, |_, _| spread(3.0));
        let jacobian = random(&mut generator, 2 * n, n) * DMatrix::from_diagonal(&columns);
        let mut problem = LeastSquares::new(jacobian, random_vector(&mut generator, 2 * n) * 10.0);
        let rows = random(&mut generator, m, n) * DMatrix::from_diagonal(&columns);
        problem.bounds = -DVector::from_fn(m, |i, _| lengths[i] * generator.random_range(0.0..0.5));
        problem.rows = DMatrix::from_diagonal(&lengths) * rows;
        problem.upper = DVector::from_fn(n, |j, _| generator.random_range(0.0..3.0) / columns[j]);
        problem.lower = -&problem.upper;
        let solution = problem.solve();
        assert_eq!(solution.status, Status::Optimal, "seed {seed}: {:?}", solution.kkt);
        assert!(solution.kkt.largest() < 1e-13, "seed {seed}: {:?}", solution.kkt);
        // From the definition, in unknowns of one size.
        let inverse = DMatrix::from_diagonal(&columns.map(|column| 1.0 / column));
        let mut even = problem.clone();
        even.jacobian *= &inverse;
        even.rows *= &inverse;
        even.lower.component_mul_assign(&columns);
        even.upper.component_mul_assign(&columns);
        let mut solution = solution;
        solution.point.component_mul_assign(&columns);
        for active in &mut solution.active {
            if let Bound::Lower(j) | Bound::Upper(j) = active.bound {
                active.multiplier /= columns[j];
            }
        }
        assert_optimal(&even, &solution, 1e-11);
    }
}

#[test]
fn columns_1e8_apart_keep_their_digits() {
    for seed in 0..20 {
        let mut generator = StdRng::seed_from_u64(seed);
        let n = 4;
        let mut even =
            LeastSquares::new(random(&mut generator, 30, n), random_vector(&mut generator, 30) * 3.0);
        even.rows = random(&mut generator, 3, n);
        even.bounds = &even.rows * DVector::from_element(n, 0.5);
        even.lower.fill(0.2);
        let reference = by_enumeration(&even);
        let columns = vector(&[1.0, 1e-8, 1e4, 1e8]);
        let mut spread = even.clone();
        spread.jacobian *= DMatrix::from_diagonal(&columns);
        spread.rows *= DMatrix::from_diagonal(&columns);
        spread.lower.component_div_assign(&columns);
        let solution = spread.solve();
        assert_eq!(solution.status, Status::Optimal);
        let error = (solution.point.component_mul(&columns) - &reference).amax();
        assert!(error <= 1e-12, "seed {seed}: {error:e}");
    }
}

#[test]
fn second_differences_fill_what_data_do_not_see() {
    // Six control values; the data see the first three and, once more, their sum.
    let mut jacobian = DMatrix::zeros(4, 6);
    jacobian.fill_diagonal(1.0);
    jacobian.set_row(3, &matrix(&[[1.0, 1.0, 1.0, 0.0, 0.0, 0.0]]).row(0));
    let target = vector(&[1.0, 2.0, 4.0, 8.0]);
    let seen = LeastSquares::new(jacobian.columns(0, 3).into_owned(), target.clone()).solve().point;
    let roughness = DMatrix::from_fn(4, 6, |i, j| match j.wrapping_sub(i) {
        0 | 2 => 1.0,
        1 => -2.0,
        _ => 0.0,
    });
    let shortest = LeastSquares::new(jacobian.clone(), target);
    let solution = shortest.solve();
    assert_eq!((solution.rank, solution.null_vectors.ncols()), (3, 3));
    assert!((&jacobian * &solution.null_vectors).amax() < 1e-15);
    assert!((solution.point.rows(0, 3) - &seen).amax() < 1e-14);
    assert!(solution.point.rows(3, 3).amax() < 1e-14);

    // p is a step from k: the total continues straight.
    let from = vector(&[0.0, 0.0, 0.0, 5.0, -3.0, 7.0]);
    let smooth =
        LeastSquares { smoothing: Some(Smoothing { roughness, point: from.clone() }), ..shortest.clone() };
    let solution = smooth.solve();
    let total = &solution.point + &from;
    assert_optimal(&smooth, &solution, 1e-12);
    assert!((solution.point.rows(0, 3) - &seen).amax() < 1e-14);
    let slope = seen[2] - seen[1];
    for j in 3..6 {
        assert!((total[j] - seen[2] - slope * (j - 2) as f64).abs() < 1e-12, "{total}");
    }

    // A bound in the unseen part bends the total and still does not change the fit to the data.
    let mut capped = smooth;
    capped.upper[5] = seen[2] - from[5];
    let solution = capped.solve();
    assert_optimal(&capped, &solution, 1e-12);
    assert!((solution.point.rows(0, 3) - &seen).amax() < 1e-14);
    assert!((solution.point[5] + from[5] - seen[2]).abs() < 1e-13);
    assert_eq!(solution.active.len(), 1);
    assert_eq!((solution.active[0].bound, solution.active[0].multiplier), (Bound::Upper(5), 0.0));
}

#[test]
fn the_unseen_part_makes_room_for_the_data() {
    // The data see only p₀; p₀ + p₁ ≤ 1 must not hold it back, though the shortest p₁ is zero.
    let mut problem = LeastSquares::new(matrix(&[[1.0, 0.0]]), vector(&[3.0]));
    problem.rows = matrix(&[[-1.0, -1.0]]);
    problem.bounds = vector(&[-1.0]);
    let solution = problem.solve();
    assert_optimal(&problem, &solution, 1e-13);
    assert!((solution.point - vector(&[3.0, -2.0])).amax() < 1e-13);
}

#[test]
fn nearly_dependent_columns_are_seen_down_to_the_threshold() {
    for (difference, rank) in [(1e-6, 2), (1e-9, 2), (1e-12, 1)] {
        let jacobian = matrix(&[[1.0, 1.0], [0.0, difference]]);
        let solution = LeastSquares::new(jacobian, vector(&[2.0, difference])).solve();
        assert_eq!(solution.rank, rank);
        // Both the exact and the shortest solution are (1, 1).
        assert!((solution.point - vector(&[1.0, 1.0])).amax() < 1e-6);
    }
}

#[test]
fn degenerate_rows_are_no_trouble() {
    // Five rows meet at the corner (1, 1), two of them identical, two an equation; one column is zero.
    let mut problem = LeastSquares::new(matrix(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), vector(&[3.0, 4.0]));
    problem.rows = matrix(&[
        [-1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [-1.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [0.0, 0.0, 0.0],
    ]);
    problem.bounds = vector(&[-1.0, -1.0, -2.0, 0.5, -0.5, -1.0]);
    problem.upper[1] = 1.0;
    let solution = problem.solve();
    assert_optimal(&problem, &solution, 1e-12);
    assert!((solution.point - vector(&[1.0, 1.0, 0.5])).amax() < 1e-13);
}

#[test]
fn contradictions_and_nan_are_said() {
    let mut problem = LeastSquares::new(DMatrix::identity(2, 2), vector(&[1.0, 2.0]));
    problem.rows = matrix(&[[1.0, 1.0], [-1.0, -1.0]]);
    problem.bounds = vector(&[1.0, -0.5]);
    assert_eq!(problem.solve().status, Status::Infeasible);
    problem.rows.fill(0.0);
    assert_eq!(problem.solve().status, Status::Infeasible);
    problem.bounds.fill(f64::NEG_INFINITY);
    assert!((problem.solve().point - vector(&[1.0, 2.0])).amax() < 1e-15);
    problem.target[0] = f64::NAN;
    let solution = problem.solve();
    assert_eq!(solution.status, Status::NotFinite);
    assert!(solution.point.iter().all(|value| value.is_finite()) && solution.kkt.largest().is_nan());
}

#[test]
fn a_hundred_thousand_rows_reduce_to_the_same_answer() {
    let mut generator = StdRng::seed_from_u64(7);
    let truth = random_vector(&mut generator, 20);
    let jacobian = random(&mut generator, 100_000, 20);
    let mut problem = LeastSquares::new(jacobian.clone(), &jacobian * &truth);
    problem.lower.fill(-10.0);
    assert!((problem.solve().point - &truth).amax() < 1e-13);
}

#[test]
fn many_rows_through_one_point_and_hidden_directions_are_no_trouble() {
    for seed in 0..300 {
        let mut generator = StdRng::seed_from_u64(50_000 + seed);
        let n = generator.random_range(2..25);
        let rank = generator.random_range(1..=n);
        let m = generator.random_range(0..120);
        let jacobian = random(&mut generator, 2 * n, rank) * random(&mut generator, rank, n);
        let mut problem = LeastSquares::new(jacobian, random_vector(&mut generator, 2 * n) * 10.0);
        // A cone of small integers with its tip at zero; every other one is cut off before the tip.
        problem.rows = DMatrix::from_fn(m, n, |_, _| match generator.random_bool(0.3) {
            true => f64::from(generator.random_range(-2..3)),
            false => 0.0,
        });
        problem.bounds = DVector::from_fn(m, |_, _| -generator.random_range(0.0..0.3)) * (seed % 2) as f64;
        problem.lower.fill(if seed % 5 == 0 { 0.0 } else { -1.0 });
        problem.upper.fill(1.0);
        if seed % 7 == 0 {
            let point = random_vector(&mut generator, n);
            problem.smoothing = Some(Smoothing { roughness: random(&mut generator, n, n), point });
        }
        let solution = problem.solve();
        assert_eq!(solution.rank, rank, "seed {seed}");
        assert_optimal(&problem, &solution, 1e-11);
    }
}
