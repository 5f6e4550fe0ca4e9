//! An implicit time step: the equilibrium of the energy and what the step adds to it.

use super::{Equilibrium, Settings, Solver};
use crate::element::Curvature;
use crate::material::Curves;

impl Solver<'_> {
    /// Solves the step's equation from where it starts or, if the potential is lower there, from where the velocity leads.
    pub(crate) fn time_step(
        &mut self,
        curves: &Curves,
        x: &mut [f64],
        predicted: &[f64],
        settings: &Settings,
    ) -> Equilibrium {
        if self.energy(curves, predicted) < self.energy(curves, x) {
            x.copy_from_slice(predicted);
        }
        self.mixed.clear();
        self.minimise(curves, x, settings)
    }

    /// Solves the step's equation linearised where it starts; false if it has no finite solution.
    ///
    /// Source: Baraff and Witkin 1998, §4.
    pub(crate) fn linearised_step(&mut self, curves: &Curves, x: &mut [f64]) -> bool {
        self.evaluate(curves, x);
        let solved = [Curvature::Full, Curvature::Clamped].into_iter().any(|curvature| {
            self.assemble(curves, x, curvature);
            self.direction_of(0.0).is_some()
        });
        x.iter_mut().zip(&self.step).for_each(|(x, d)| *x += d);
        solved && self.step.iter().all(|d| d.is_finite())
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
