//! Repairs an unstable curve: finds the stable curve nearest in stress.
//!
//! ```text
//! minimise   ∫ (σ̂ − σ)² dε  over [0, εₙ]                           by Simpson's rule on every segment
//! subject to dσ̂/dε ≥ κ,   κ = 10⁻³ of the largest secant stiffness of σ̂
//!            max dσ̂/dε ≤ 10⁴ min dσ̂/dε                            where that is passed
//! ```
//!
//! Stress is linear in the control values, and so are the [rows](stability_rows) that bound its tangent: a convex
//! quadratic program. Its scale κ follows the curve in a few rounds. The rows are sufficient, not necessary; they
//! certify 98 % of the curves that rise. A curve that passes the check is returned unchanged.

use crate::optimise::least_squares::LeastSquares;
use cloth_sim::curve::soundness::{Context, Finding, Flaw, LEAST_TANGENT, TANGENT_RATIO, check, extremes};
use cloth_sim::curve::{StiffnessCurve, stability_rows};
use nalgebra::{DMatrix, DVector};
use std::fmt;

/// Relative margin of κ and of the ratio beyond the limits of the check.
const MARGIN: f64 = 2e-3;
/// Rounds in which κ follows the curve's own scale.
const ROUNDS: usize = 12;
/// A curve whose stiffness stays below this share of the given curve's largest control value counts as zero.
const VANISHED: f64 = 1e-6;

/// A repaired curve, and its distance from the given one.
#[derive(Debug, Clone, PartialEq)]
pub struct Repair {
    /// Control points at the same strains.
    pub curve: StiffnessCurve,
    /// Root mean square of the change of stress from zero to the last control point, N/m (bending: N).
    pub rms: f64,
    /// Largest absolute change of stress at a control point or midway.
    pub largest: f64,
    /// The strain of the largest change.
    pub at: f64,
}

impl Repair {
    /// True if the curve needed no repair.
    pub fn is_unchanged(&self) -> bool {
        self.largest == 0.0
    }
}

/// Reason why a curve cannot be repaired.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unrepairable {
    /// Implausible magnitude: a change of unit is not a repair.
    Magnitude(Finding),
    /// Stress so strongly negative that zero is the nearest curve that never falls.
    NoStiffness,
    /// The quadratic program has no solution in floating point.
    Unsolved,
}

impl fmt::Display for Unrepairable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Magnitude(finding) => write!(
                f,
                "a largest stiffness of {:.3e}, where {} {:.0e} is plausible: probably another unit, which a repair \
                 cannot correct",
                finding.value,
                if finding.value < finding.limit { "at least" } else { "at most" },
                finding.limit
            ),
            Self::NoStiffness => {
                write!(
                    f,
                    "stress of the wrong sign over so much of its range that the nearest stable curve is zero"
                )
            }
            Self::Unsolved => {
                write!(f, "no solution of the quadratic program: its values differ too much in magnitude")
            }
        }
    }
}

impl std::error::Error for Unrepairable {}

/// Repairs a curve. A curve that passes the check is returned bit for bit.
///
/// * `context` — the context of the check that the result passes
///
/// # Errors
/// A curve that cannot be repaired.
pub fn repair(curve: &StiffnessCurve, context: &Context) -> Result<Repair, Unrepairable> {
    let found = check(curve, context);
    if let Some(&finding) = found.iter().find(|finding| finding.kind == Flaw::Magnitude) {
        return Err(Unrepairable::Magnitude(finding));
    }
    let problem = Problem::new(curve);
    if !found.iter().any(Finding::is_unstable) {
        return Ok(problem.repaired(curve.clone()));
    }
    let given = curve.stiffnesses().iter().fold(0.0, |largest: f64, k| largest.max(k.abs()));
    let mut scale = extremes(curve).largest_stiffness.max(VANISHED * given);
    let mut ratio = found.iter().any(|finding| finding.kind == Flaw::TangentRatio);
    let mut nearest = curve.clone();
    for _ in 0..ROUNDS {
        nearest = problem.nearest(LEAST_TANGENT * (1.0 + MARGIN) * scale, ratio)?;
        let largest = extremes(&nearest).largest_stiffness;
        if !(largest > VANISHED * given) {
            return Err(Unrepairable::NoStiffness);
        }
        let too_steep = check(&nearest, context).iter().any(|finding| finding.kind == Flaw::TangentRatio);
        if (largest / scale - 1.0).abs() <= 0.5 * MARGIN && (ratio || !too_steep) {
            break;
        }
        (scale, ratio) = (largest, ratio || too_steep);
    }
    problem.made_sound(&nearest, context).map(|curve| problem.repaired(curve))
}

/// Linear algebra of one curve: effect of its control values on the stress.
struct Problem<'a> {
    curve: &'a StiffnessCurve,
    /// Control points and the midpoints between them.
    strains: Vec<f64>,
    /// Simpson weights; their sum is 1.
    weights: Vec<f64>,
    /// ∂σ/∂k there.
    stress: DMatrix<f64>,
}

impl<'a> Problem<'a> {
    fn new(curve: &'a StiffnessCurve) -> Self {
        let (mut strains, mut weights) = (vec![curve.strains()[0]], vec![0.0]);
        for pair in curve.strains().windows(2) {
            let sixth = (pair[1] - pair[0]) / 6.0;
            weights.last_mut().into_iter().for_each(|weight| *weight += sixth);
            strains.extend([0.5 * (pair[0] + pair[1]), pair[1]]);
            weights.extend([4.0 * sixth, sixth]);
        }
        let whole = weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        weights.iter_mut().for_each(|weight| *weight /= whole);
        let mut stress = DMatrix::zeros(strains.len(), curve.len());
        let mut row = vec![0.0; curve.len()];
        for (i, &strain) in strains.iter().enumerate() {
            curve.weights(strain, &mut row);
            row.iter().enumerate().for_each(|(j, weight)| stress[(i, j)] = *weight);
        }
        Self { curve, strains, weights, stress }
    }

    /// The nearest curve with tangents of at least `lowest`. The unknowns are the changes of the control values and,
    /// with `ratio`, the least tangent, which bounds all tangents from below and, times the ratio, from above.
    fn nearest(&self, lowest: f64, ratio: bool) -> Result<StiffnessCurve, Unrepairable> {
        // The strains come from a valid curve.
        let tangents = stability_rows(self.curve.strains()).map_err(|_| Unrepairable::Unsolved)?;
        let before = &tangents * DVector::from_column_slice(self.curve.stiffnesses());
        let (count, points) = (tangents.nrows(), self.curve.len());
        let unknowns = points + usize::from(ratio);
        let mut jacobian = DMatrix::zeros(self.strains.len(), unknowns);
        jacobian.columns_mut(0, points).copy_from(&self.stress);
        jacobian.row_iter_mut().zip(&self.weights).for_each(|(mut row, weight)| row *= weight.sqrt());
        let mut problem = LeastSquares::new(jacobian, DVector::zeros(self.strains.len()));
        problem.rows = DMatrix::zeros(count * (1 + usize::from(ratio)), unknowns);
        problem.rows.view_mut((0, 0), (count, points)).copy_from(&tangents);
        problem.bounds = before.map(|tangent| lowest - tangent);
        if ratio {
            let most = TANGENT_RATIO / (1.0 + MARGIN);
            // σ̂′ − L ≥ 0,  rL − σ̂′ ≥ 0,  with L = κ + l and l ≥ 0.
            problem.rows.view_mut((0, points), (count, 1)).fill(-1.0);
            problem.rows.view_mut((count, 0), (count, points)).copy_from(&-&tangents);
            problem.rows.view_mut((count, points), (count, 1)).fill(most);
            problem.bounds = DVector::from_fn(2 * count, |i, _| {
                if i < count { lowest - before[i] } else { before[i - count] - most * lowest }
            });
            problem.lower[points] = 0.0;
        }
        let change = problem.solve_unpolished().ok_or(Unrepairable::Unsolved)?;
        let stiffnesses = self.curve.stiffnesses().iter().zip(change.iter()).map(|(k, change)| k + change);
        self.curve.with_stiffnesses(stiffnesses.collect()).map_err(|_| Unrepairable::Unsolved)
    }

    /// A curve that passes the check: this one, or a blend with as small a share of a straight line as needed. Blends
    /// of sound curves are sound, and a line is the soundest curve.
    fn made_sound(
        &self,
        nearest: &StiffnessCurve,
        context: &Context,
    ) -> Result<StiffnessCurve, Unrepairable> {
        let products = |of: &dyn Fn(f64) -> f64| -> f64 {
            self.strains.iter().zip(&self.weights).map(|(&strain, weight)| weight * of(strain) * strain).sum()
        };
        let line = products(&|strain| nearest.stress(strain)) / products(&|strain| strain);
        let shares = std::iter::once(0.0).chain((0..=18).map(|i| 10f64.powf(f64::from(i) / 2.0 - 9.0)));
        for share in shares {
            let blended = nearest.stiffnesses().iter().map(|k| k + share * (line - k)).collect();
            let blended = nearest.with_stiffnesses(blended).map_err(|_| Unrepairable::Unsolved)?;
            if !check(&blended, context).iter().any(Finding::is_defect) {
                return Ok(blended);
            }
        }
        Err(Unrepairable::NoStiffness)
    }

    fn repaired(&self, curve: StiffnessCurve) -> Repair {
        let changes: Vec<f64> = self
            .strains
            .iter()
            .map(|&strain| (curve.stress(strain) - self.curve.stress(strain)).abs())
            .collect();
        let rms = changes
            .iter()
            .zip(&self.weights)
            .map(|(change, weight)| weight * change * change)
            .sum::<f64>()
            .sqrt();
        let at = (0..changes.len()).fold(0, |worst, i| if changes[i] > changes[worst] { i } else { worst });
        Repair { curve, rms, largest: changes[at], at: self.strains[at] }
    }
}

#[cfg(test)]
mod tests;
