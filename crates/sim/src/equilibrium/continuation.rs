//! Continuation for poor starts: solves with a much softer or stiffer membrane and restores the stiffness stepwise.
//!
//! ```text
//! k/1000 → k/100 → k/10 → k        each from where the last one ended
//! ```
//!
//! A nearly inextensible sheet bends alike for any membrane stiffness. A soft membrane finds the shape, where a stiff
//! one has to follow a narrow curved valley from flat; every further solve takes a few steps. A stiffer membrane helps
//! where the sheet stretches to many times its length.
//!
//! Source: numerical continuation, Allgower and Georg 1990.

use super::outcome::{Equilibrium, Status};
use super::settings::Settings;
use super::solver::Solver;
use crate::material::Curves;

/// Powers of ten by which the membrane's stiffness is first multiplied; tried in turn until one leads to a balanced
/// state.
const FIRST: [i32; 4] = [-3, -6, 3, 6];

impl Solver<'_> {
    /// Restarts from other membranes. On success, `x` and `found` are the balanced state; otherwise they are unchanged.
    /// Counters accumulate.
    pub(super) fn continue_from_others(
        &mut self,
        curves: &Curves,
        x: &mut [f64],
        start: &[f64],
        settings: &Settings,
        found: &mut Equilibrium,
    ) {
        for first in FIRST {
            let mut state = start.to_vec();
            for step in (0..=first.abs()).rev() {
                let Some(other) = scaled(curves, 10f64.powi(step * first.signum())) else { return };
                self.mixed.clear();
                let solved = self.settle(&other, &mut state, settings);
                found.iterations += solved.iterations;
                if !matches!(solved.status, Status::Converged | Status::Unstable) {
                    break;
                }
                if step == 0 {
                    x.copy_from_slice(&state);
                    *found = Equilibrium { iterations: found.iterations, ..solved };
                    return;
                }
            }
        }
        self.refresh(curves, x);
    }
}

/// Curves with the membrane's stiffnesses multiplied by a factor.
fn scaled(curves: &Curves, factor: f64) -> Option<Curves> {
    let mut scaled = curves.clone();
    for component in curves.components().filter(|component| !component.is_bending()) {
        let curve = curves.get(component)?;
        let stiffnesses = curve.stiffnesses().iter().map(|k| factor * k).collect();
        scaled.set(component, curve.with_stiffnesses(stiffnesses).ok()?);
    }
    Some(scaled)
}
