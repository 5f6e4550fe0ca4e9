//! An independent judge of equilibria, which does not rely on the solver's status.

use crate::table::Row;
use cloth_sim::cloth::{Cloth, ForceScale};
use cloth_sim::equilibrium::{Equilibrium, Limit, Settings, Solver};
use cloth_sim::material::Curves;
use cloth_sim::samples::Sample;
use nalgebra::Vector3;
use rand::{Rng, SeedableRng, rngs::StdRng};

/// The measure of an equilibrium and its limit.
pub(crate) const IMBALANCE: (&str, f64) = ("imbalance/tolerance", 1.0);

/// A row whose runs are equilibria.
pub(crate) fn row(case: u8, condition: impl Into<String>) -> Row {
    Row::measured(case, condition, IMBALANCE.0, IMBALANCE.1)
}

/// Solves a sample from its start as a run of the row; it survives if both the status and the forces say that it has
/// converged. Returns that, and the final state.
pub(crate) fn solve(row: &mut Row, sample: &Sample, settings: &Settings, input: &str) -> (bool, Vec<f64>) {
    let cloth = sample.cloth().unwrap();
    let mut x = sample.start.clone();
    let found = Solver::new(&cloth).solve(&sample.curves, &mut x, settings);
    (judge(row, &cloth, sample, &x, &found, Ok(()), input), x)
}

/// Judges an equilibrium as a run of the row.
///
/// * `also` — a further condition on the state
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

/// Largest force on a free node over its limit: a millionth of the typical force or weight at a node, or a hundred
/// times the error from rounding the coordinates.
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

/// Rounding error of a force: its largest change when every coordinate is off by one machine epsilon of the largest
/// coordinate, in a random direction, plus one epsilon of the magnitude of the terms summed at a node.
fn rounding(cloth: &Cloth, sample: &Sample, x: &[f64], forces: &[Vector3<f64>], free: &[usize]) -> f64 {
    let mut rng = StdRng::seed_from_u64(1);
    let unit = f64::EPSILON * x.iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
    let mut worst = 0.0;
    for _ in 0..4 {
        let mut moved = x.to_vec();
        for &node in free {
            for i in 0..if sample.planar { 2 } else { 3 } {
                // Larger steps than the coordinate's own rounding, or nothing would move; the change is linear.
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
    let mut scale = ForceScale::new(cloth.points());
    let _ = cloth.gradient(curves, x, &mut gradient, &mut scale);
    (gradient.chunks_exact(3).map(|force| -Vector3::from_column_slice(force)).collect(), scale)
}

fn is_free(sample: &Sample, node: usize) -> bool {
    !sample.held.iter().any(|held| held.node == node)
}

/// The larger of two numbers; NaN is larger than any number.
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b <= a { a } else { b }
}
