//! Escape from an unstable equilibrium.
//!
//! ```text
//!       ╭─╮            from the hilltop a small way down on both sides along the direction of most negative
//!   ╰──╯   ╰──╯        curvature, on to the valley's floor on each, and the lower valley is kept
//! ```

use super::outcome::{Equilibrium, Status};
use super::settings::Settings;
use super::solver::{SINGULAR, Solver};
use crate::material::Curves;

/// Displacement of the node that moves most, as a share of the mean edge: far above rounding, but too small for a
/// triangle or hinge to flip.
const STEP: f64 = 1e-2;

/// Maximum number of doublings of the step while the energy falls: up to two and a half edges.
const DOUBLINGS: u32 = 8;

/// The second side wins if its energy falls by this share more than that of the first. The two sides of a symmetric
/// problem differ by rounding only, which must not decide.
const TIE: f64 = 1e-6;

/// A decrease of the energy below this share of it is rounding.
const ROUNDING: f64 = 1e-13;

/// Maximum number of consecutive unstable states to leave.
const ESCAPES: usize = 6;

impl Solver<'_> {
    /// Solves; the first matrix uses the strains in `mixed`, if there are any.
    pub(super) fn settle(&mut self, curves: &Curves, x: &mut [f64], settings: &Settings) -> Equilibrium {
        let (before, remedies) = (self.linear.factorisations(), self.remedies);
        let mut found = self.minimise(curves, x, settings);
        for _ in 0..ESCAPES {
            let unstable = found.status == Status::Unstable;
            if !(settings.escape && unstable && self.leave(curves, x, settings, &mut found)) {
                break;
            }
            self.remedies.escapes += 1;
        }
        let (factorisations, remedies) = (self.linear.factorisations() - before, self.remedies - remedies);
        Equilibrium { factorisations, remedies, ..found }
    }

    /// Moves from an unstable equilibrium to a balanced state of lower energy, if there is one, and describes it in
    /// `found`. Counters accumulate; the solver's state belongs to `x` again.
    fn leave(
        &mut self,
        curves: &Curves,
        x: &mut [f64],
        settings: &Settings,
        found: &mut Equilibrium,
    ) -> bool {
        let Some(direction) = self.way_down() else { return false };
        let origin = x.to_vec();
        let mut limit = found.energy - ROUNDING * found.energy.abs();
        let mut best = None;
        let mut iterations = found.iterations;
        for side in [1.0, -1.0] {
            let mut moved = self.downhill(curves, &origin, &direction, side);
            self.mixed.clear();
            let state = self.minimise(curves, &mut moved, settings);
            iterations += state.iterations;
            if matches!(state.status, Status::Converged | Status::Unstable) && state.energy < limit {
                limit = state.energy - TIE * (found.energy - state.energy);
                x.copy_from_slice(&moved);
                best = Some(state);
            }
        }
        self.refresh(curves, x);
        let left = best.is_some();
        *found = Equilibrium { iterations, escaped: found.escaped || left, ..best.unwrap_or(*found) };
        left
    }

    /// Lowest state along a direction, in doubling steps: a mode that is barely unstable has so little force that one
    /// step, or many, would still count as balanced.
    fn downhill(&mut self, curves: &Curves, origin: &[f64], direction: &[f64], side: f64) -> Vec<f64> {
        let moved = |length: f64| -> Vec<f64> {
            origin.iter().zip(direction).map(|(x, d)| x + side * length * d).collect()
        };
        let mut best = moved(1.0);
        let mut lowest = self.energy(curves, &best);
        for doubling in 1..=DOUBLINGS {
            let trial = moved(f64::from(1 << doubling));
            let energy = self.energy(curves, &trial);
            if !(energy < lowest) || self.cloth.hinge_jumps(origin, &trial) {
                break;
            }
            (best, lowest) = (trial, energy);
        }
        best
    }

    /// Direction of most negative curvature, scaled to the length of the step; `None` if no curvature is negative
    /// beyond rounding. Needs the shifted factor of the true Hessian.
    fn way_down(&mut self) -> Option<Vec<f64>> {
        let curvature = self.linear.softest(self.cloth.pattern(), self.shift, &mut self.reduced);
        // Negated to reject NaN.
        if !(curvature < -SINGULAR * self.mean_diagonal()) {
            return None;
        }
        let mut direction = vec![0.0; 3 * self.cloth.points()];
        self.cloth.spread(&self.reduced, &mut direction);
        let length = |node: &[f64]| node.iter().map(|d| d * d).sum::<f64>().sqrt();
        let largest = direction.chunks_exact(3).map(length).fold(0.0, f64::max);
        let scale = STEP * self.cloth.mean_edge() / largest;
        direction.iter_mut().for_each(|d| *d *= scale);
        Some(direction)
    }
}
