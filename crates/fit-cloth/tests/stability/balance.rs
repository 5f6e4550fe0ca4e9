//! Whether a state is an equilibrium, judged without the solver's own account of it.

use crate::table::Row;
use cloth_sim::cloth::{Cloth, ForceScale};
use cloth_sim::equilibrium::{Equilibrium, Limit, Settings, Solver};
use cloth_sim::material::Curves;
use cloth_sim::samples::Sample;
use nalgebra::Vector3;
use rand::{Rng, SeedableRng, rngs::StdRng};

/// What a balance is measured by.
pub(crate) const IMBALANCE: (&str, f64) = ("imbalance/tolerance", 1.0);

/// A row of equilibria.
pub(crate) fn row(case: u8, condition: impl Into<String>) -> Row {
    Row::measured(case, condition, IMBALANCE.0, IMBALANCE.1)
}

/// Solves a sample from its start: a run of the row, which survives if the status says that it has converged and the forces
/// say so too. Returns how it ended, and where.
pub(crate) fn solve(row: &mut Row, sample: &Sample, settings: &Settings, input: &str) -> (bool, Vec<f64>) {
    let cloth = sample.cloth().unwrap();
    let mut x = sample.start.clone();
    let found = Solver::new(&cloth).solve(&sample.curves, &mut x, settings);
    (judge(row, &cloth, sample, &x, &found, Ok(()), input), x)
}

/// Judges an equilibrium: a run of the row.
///
/// * `also` — what else must hold of the state
pub(crate) fn judge(
    row: &mut Row,
    cloth: &Cloth,
    sample: &Sample,
    x: &[f64],
    found: &Equilibrium,
    also: Result<(), String>,
    input: &str,
) -> bool {
    row.iterations = row.iterations.max(found.iterations);
    if !found.converged() {
        return row.holds(false, || {
            format!("{}, {:.1e} of {:.1e} N: {input}", found.status, found.imbalance, found.tolerance)
        });
    }
    if let Err(failure) = also {
        return row.holds(false, || format!("{failure}: {input}"));
    }
    row.by_rounding += u64::from(found.limit == Limit::Rounding);
    row.measure(imbalance(cloth, sample, x), || input.to_string())
}

/// Largest force on a free node over what it may be: a millionth of the typical force or weight at a node, or a hundred times
/// what rounding the coordinates makes of it.
pub(crate) fn imbalance(cloth: &Cloth, sample: &Sample, x: &[f64]) -> f64 {
    let (forces, scale) = forces(cloth, &sample.curves, x);
    let free: Vec<usize> = (0..cloth.nodes()).filter(|&node| is_free(sample, node)).collect();
    let weight = |node: usize| cloth.masses()[node] * sample.gravity.norm();
    let typical =
        free.iter().map(|&node| scale.magnitude[node].max(weight(node))).sum::<f64>() / free.len() as f64;
    let asked = (1e-6 * typical).max(100.0 * rounding(cloth, sample, x, &forces, &free));
    let largest = free.iter().map(|&node| forces[node].norm()).fold(0.0, larger);
    if largest == 0.0 { 0.0 } else { largest / asked }
}

/// The largest change of a force when every coordinate is off by one machine epsilon of the largest, one way or the other;
/// and of the sum at a node, by as much of its terms.
fn rounding(cloth: &Cloth, sample: &Sample, x: &[f64], forces: &[Vector3<f64>], free: &[usize]) -> f64 {
    let mut rng = StdRng::seed_from_u64(1);
    let unit = f64::EPSILON * x.iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
    let mut worst = 0.0;
    for _ in 0..4 {
        let mut moved = x.to_vec();
        for &node in free {
            for i in 0..if sample.planar { 2 } else { 3 } {
                // By more than the coordinate's own last digit, or nothing would move: the change is linear.
                moved[3 * node + i] += 1e3 * unit * if rng.random_bool(0.5) { 1.0 } else { -1.0 };
            }
        }
        let (there, scale) = self::forces(cloth, &sample.curves, &moved);
        for &node in free {
            let change = 1e-3 * (there[node] - forces[node]).norm();
            worst = larger(worst, change + f64::EPSILON * scale.magnitude[node]);
        }
    }
    worst
}

/// The force on every node, N, and its scale.
pub(crate) fn forces(cloth: &Cloth, curves: &Curves, x: &[f64]) -> (Vec<Vector3<f64>>, ForceScale) {
    let mut gradient = vec![0.0; x.len()];
    let mut scale = ForceScale::new(cloth.nodes());
    let _ = cloth.gradient(curves, x, &mut gradient, &mut scale);
    (gradient.chunks_exact(3).map(|force| -Vector3::from_column_slice(force)).collect(), scale)
}

fn is_free(sample: &Sample, node: usize) -> bool {
    !sample.held.iter().any(|held| held.node == node)
}

/// The larger of two numbers; a NaN is larger than any.
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b <= a { a } else { b }
}
