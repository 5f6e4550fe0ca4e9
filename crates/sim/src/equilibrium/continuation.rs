//! Where the start is too far away: solve with a much softer membrane, or a much stiffer one, and change it step by step.
//!
//! ```text
//! k/1000 → k/100 → k/10 → k        each from where the last one ended
//! ```
//!
//! A sheet that hardly stretches bends alike whatever its membrane: a soft one finds the shape, where a stiff one has to follow
//! a narrow curved valley from flat, and every further solve takes a few steps. A stiffer one helps where the sheet stretches
//! to many times its length.
//!
//! Source: numerical continuation, Allgower and Georg 1990.

use super::outcome::{Equilibrium, Status};
use super::settings::Settings;
use super::solver::Solver;
use crate::material::Curves;

/// The powers of ten that the membrane's stiffness is first multiplied by, until one leads to a balance.
const FIRST: [i32; 4] = [-3, -6, 3, 6];

impl Solver<'_> {
    /// Starts anew from other membranes. Where that comes to a balance, `x` and `found` are that; otherwise they stay. The
    /// counters count on.
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

/// The curves with the membrane's stiffnesses times a factor.
fn scaled(curves: &Curves, factor: f64) -> Option<Curves> {
    let mut scaled = curves.clone();
    for component in curves.components().filter(|component| !component.is_bending()) {
        let curve = curves.get(component)?;
        let stiffnesses = curve.stiffnesses().iter().map(|k| factor * k).collect();
        scaled.set(component, curve.with_stiffnesses(stiffnesses).ok()?);
    }
    Some(scaled)
}
