//! An implicit time step: the equilibrium of the energy and what the step adds to it.

use super::outcome::{Equilibrium, Status};
use super::remedies::Remedies;
use super::settings::Settings;
use super::solver::Solver;
use crate::element::Curvature;
use crate::material::Curves;

/// Most time steps take two to ten; one that has not come to its end by then is begun anew, downhill all the way.
const BRISK_ITERATIONS: usize = 40;

/// An energy higher by less than this share of it is higher by rounding.
const ROUNDING: f64 = 1e-12;

impl Solver<'_> {
    /// Solves the step's equation from where it starts or, if the potential is lower there, from where the velocity leads. The
    /// potential ends no higher than it was, whether the equation is solved or not.
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
        // Where the energy may rise on the way, it may also have ended above that of the start.
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

    /// Solves the step's equation linearised where it starts; `None` if it has no finite solution.
    ///
    /// Source: Baraff and Witkin 1998, §4.
    pub(crate) fn linearised_step(&mut self, curves: &Curves, x: &mut [f64]) -> Option<Remedies> {
        self.evaluate(curves, x);
        let clamped = [Curvature::Full, Curvature::Clamped].into_iter().position(|curvature| {
            self.assemble(curves, x, curvature);
            self.direction_of(0.0).is_some()
        })?;
        x.iter_mut().zip(&self.step).for_each(|(x, d)| *x += d);
        self.step.iter().all(|d| d.is_finite()).then_some(Remedies { clamped, ..Remedies::default() })
    }

    /// Factorisations so far.
    pub(crate) fn factorisations(&self) -> usize {
        self.linear.factorisations()
    }

    /// Iterations of conjugate gradients so far.
    pub(crate) fn linear_iterations(&self) -> usize {
        self.linear.iterations()
    }
}
