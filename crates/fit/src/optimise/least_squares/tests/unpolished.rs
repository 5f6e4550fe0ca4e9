//! The interior-point method alone, against the polished solution.

use super::*;

#[test]
fn unpolished_solutions_agree_with_polished_ones() {
    for seed in 0..100 {
        let mut generator = StdRng::seed_from_u64(900 + seed);
        let n = generator.random_range(2..12);
        let mut problem =
            LeastSquares::new(random(&mut generator, 2 * n, n), random_vector(&mut generator, 2 * n) * 10.0);
        problem.rows = random(&mut generator, 5, n);
        problem.bounds = DVector::from_fn(5, |_, _| -generator.random_range(0.0..1.0));
        // One row has no bound, one is zero.
        problem.bounds[0] = f64::NEG_INFINITY;
        problem.rows.row_mut(1).fill(0.0);
        problem.lower.fill(-1.0);
        let polished = problem.solve();
        assert_optimal(&problem, &polished, 1e-11);
        let found = problem.solve_unpolished().unwrap();
        // The worst of the hundred is 6e-6.
        assert!((&found - &polished.point).amax() < 2e-5, "seed {seed}: {found} {}", polished.point);
    }
}

#[test]
fn an_unknown_that_no_target_sees_is_placed_by_its_rows() {
    let mut problem = LeastSquares::new(matrix(&[[2.0, 0.0]]), vector(&[6.0]));
    // From 1 above the other to 6.
    problem.rows = matrix(&[[-1.0, 1.0], [0.0, -1.0]]);
    problem.bounds = vector(&[1.0, -6.0]);
    let found = problem.solve_unpolished().unwrap();
    assert!((found[0] - 3.0).abs() < 1e-6 && found[1] > 4.0 - 1e-6 && found[1] < 6.0 + 1e-6, "{found}");
}

#[test]
fn what_has_no_solution_has_none_unpolished() {
    let mut problem = LeastSquares::new(DMatrix::identity(2, 2), vector(&[1.0, 2.0]));
    problem.rows = matrix(&[[1.0, 1.0], [-1.0, -1.0]]);
    problem.bounds = vector(&[1.0, -0.5]);
    assert_eq!(problem.solve_unpolished(), None);
    problem.bounds[1] = -2.0;
    assert!(problem.solve_unpolished().is_some());
    problem.target[0] = f64::NAN;
    assert_eq!(problem.solve_unpolished(), None);
}

#[test]
fn every_status_is_said_in_words() {
    let said = |status: Status| status.to_string();
    assert_eq!(said(Status::Optimal), "solved");
    let inaccurate = "the optimality conditions hold only to 2.0e-7, not to 1e-10";
    assert_eq!(said(Status::Inaccurate { kkt: 2e-7 }), inaccurate);
    assert_eq!(said(Status::Infeasible), "the inequalities contradict one another");
    assert_eq!(said(Status::NotFinite), "the least-squares problem contains NaN or infinite numbers");
}
