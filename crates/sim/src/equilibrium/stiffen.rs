//! Where stretch is very much stiffer than bending, and the start far away: solve with a softer membrane, and stiffen it.
//!
//! ```text
//! k/1000 → k/100 → k/10 → k        each from where the last one ended
//! ```
//!
//! A sheet that hardly stretches bends alike whatever its membrane, so that a soft one finds the shape and every further solve
//! takes a few steps. From flat, a stiff one has to follow a narrow curved valley.

use super::{Equilibrium, Settings, Solver, Status};
use crate::material::Curves;

/// From so many decades softer on; more where that is not enough.
const DECADES: [i32; 2] = [3, 6];

impl Solver<'_> {
    /// Starts anew with a softer membrane. Where that comes to a balance, `x` and `found` are that; otherwise they stay. The
    /// counters count on.
    pub(super) fn stiffen(
        &mut self,
        curves: &Curves,
        x: &mut [f64],
        start: &[f64],
        settings: &Settings,
        found: &mut Equilibrium,
    ) {
        let mut iterations = found.iterations;
        for decades in DECADES {
            let mut state = start.to_vec();
            for decade in (0..=decades).rev() {
                let Some(softer) = softened(curves, 10f64.powi(-decade)) else { return };
                self.mixed.clear();
                let solved = self.settle(&softer, &mut state, settings);
                iterations += solved.iterations;
                found.iterations = iterations;
                if !matches!(solved.status, Status::Converged | Status::Unstable) {
                    break;
                }
                if decade == 0 {
                    x.copy_from_slice(&state);
                    *found = Equilibrium { iterations, ..solved };
                    return;
                }
            }
        }
        self.refresh(curves, x);
    }
}

/// The curves with the membrane's stiffnesses times a share.
fn softened(curves: &Curves, share: f64) -> Option<Curves> {
    let mut softer = curves.clone();
    for component in curves.components().filter(|component| !component.is_bending()) {
        let curve = curves.get(component)?;
        let stiffnesses = curve.stiffnesses().iter().map(|k| share * k).collect();
        softer.set(component, curve.with_stiffnesses(stiffnesses).ok()?);
    }
    Some(softer)
}
