//! An implicit time step: an equilibrium of the energy plus the terms of the step.

use super::outcome::{Equilibrium, Status};
use super::remedies::Remedies;
use super::settings::Settings;
use super::solver::Solver;
use crate::element::HessianKind;
use crate::material::Curves;

/// Most time steps take two to ten iterations; one that exceeds this limit is restarted with the energy falling in
/// every iteration.
const BRISK_ITERATIONS: usize = 40;

/// A rise of the energy below this share of it is rounding.
const ROUNDING: f64 = 1e-12;

impl Solver<'_> {
    /// Solves the step's equation from its start or, if the potential is lower there, from the position predicted by
    /// the velocity. The potential never ends higher than it started, even if the equation is not solved.
    pub(crate) fn time_step(
        &mut self,
        curves: &Curves,
        x: &mut [f64],
        predicted: &[f64],
        settings: &Settings,
    ) -> Equilibrium {
        let mut start = self.energy(curves, x);
        let ahead = self.energy(curves, predicted);
        if ahead < start {
            start = ahead;
            x.copy_from_slice(predicted);
        }
        self.before.clear();
        self.before.extend_from_slice(x);
        self.mixed.clear();
        let brisk = Settings { max_iterations: settings.max_iterations.min(BRISK_ITERATIONS), ..*settings };
        let found = self.minimise(curves, x, &brisk);
        // If the energy may rise in between, it may also end above its start.
        if found.status == Status::Converged && found.energy <= start + ROUNDING * start.abs() {
            return found;
        }
        x.copy_from_slice(&self.before);
        self.mixed.clear();
        self.careful = true;
        let careful = self.minimise(curves, x, settings);
        self.careful = false;
        let mut remedies = found.remedies;
        remedies += careful.remedies;
        remedies.careful += 1;
        Equilibrium {
            iterations: found.iterations + careful.iterations,
            factorisations: found.factorisations + careful.factorisations,
            remedies,
            ..careful
        }
    }

    /// Solves the step's equation linearised at its start; `None` if it has no finite solution.
    ///
    /// Source: Baraff and Witkin 1998, §4.
    pub(crate) fn linearised_step(&mut self, curves: &Curves, x: &mut [f64]) -> Option<Remedies> {
        self.evaluate(curves, x);
        let clamped = [HessianKind::Full, HessianKind::Clamped].into_iter().position(|curvature| {
            self.assemble(curves, x, curvature);
            self.direction_of(0.0).is_some()
        })?;
        x.iter_mut().zip(&self.step).for_each(|(x, d)| *x += d);
        self.step.iter().all(|d| d.is_finite()).then_some(Remedies { clamped, ..Remedies::default() })
    }

    /// Number of factorisations so far.
    pub(crate) fn factorisations(&self) -> usize {
        self.linear.factorisations()
    }

    /// Number of conjugate gradient iterations so far.
    pub(crate) fn linear_iterations(&self) -> usize {
        self.linear.iterations()
    }
}
