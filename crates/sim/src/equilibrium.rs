//! Quasi-static equilibrium: the state in which the gradient of the total energy vanishes at every free node.
//!
//! Newton's method with the geometric stiffness taken at the strains that the last step predicted ("mixed" Newton),
//! which keeps stiff directions from filling the matrix with spurious stress after a rotation. The gradient is exact,
//! so the equilibria are the same. Where the matrix is not positive definite, its geometric part is clamped element by
//! element. Additive Levenberg–Marquardt, the published method, is a setting and the last resort. Where that comes to
//! nothing, a softer or stiffer membrane shows the way. A balance that is not stable is left for the lower of the two states beside it.
//!
//! Source: the problem, Miguel et al. 2012, §5.1; mixed Newton, after Magisano, Leonetti and Garcea 2017.

mod continuation;
mod drive;
mod escape;
mod levenberg_marquardt;
mod minimum;
mod newton;
mod outcome;
mod remedies;
mod settings;
mod solver;
mod time_step;

pub use outcome::{Equilibrium, Limit, Status};
pub use remedies::Remedies;
pub use settings::{Method, Settings, Tolerance};
pub use solver::Solver;

use crate::material::Curves;
use newton::NONMONOTONE_STEPS;

impl Solver<'_> {
    /// Finds an equilibrium near a state, which it replaces.
    ///
    /// * `x` — 3 stacked coordinates a node, m; held nodes at their prescribed places, where they stay
    ///
    /// On return [`Solver::solve_linear`] works with the true stiffness matrix there (where that is not positive
    /// definite: shifted until it is); with Levenberg–Marquardt as the method, with that + μI, μ of the last step.
    ///
    /// # Panics
    /// If `x` has another length than the cloth has coordinates.
    pub fn solve(&mut self, curves: &Curves, x: &mut [f64], settings: &Settings) -> Equilibrium {
        assert_eq!(x.len(), 3 * self.cloth.nodes(), "three coordinates a node");
        if let Some(refused) = self.refused(x) {
            return refused;
        }
        self.mixed.clear();
        let start = x.to_vec();
        let (before, remedies) = (self.linear.factorisations(), self.remedies);
        let mut found = self.settle(curves, x, settings);
        // Fewer iterations than that were asked for to see how far they lead.
        if matches!(found.status, Status::IterationLimit | Status::Stalled)
            && settings.method == Method::MixedNewton
            && settings.max_iterations > NONMONOTONE_STEPS
        {
            self.remedies.continued += 1;
            self.continue_from_others(curves, x, &start, settings, &mut found);
        }
        let (factorisations, remedies) = (self.linear.factorisations() - before, self.remedies - remedies);
        Equilibrium { factorisations, remedies, ..found }
    }
}
