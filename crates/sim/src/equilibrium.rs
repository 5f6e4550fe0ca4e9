//! Quasi-static equilibrium: the state where the gradient of the total energy vanishes at every free node.
//!
//! Newton's method with the geometric stiffness taken at the strains predicted by the last step ("mixed" Newton), which
//! keeps spurious stress of stiff directions out of the matrix after a rotation. The gradient is exact, so the
//! equilibria are unchanged. If the matrix is not positive definite, its geometric part is clamped element by element.
//! Additive Levenberg–Marquardt, the published method, is available as a setting and serves as a fallback. If it fails
//! too, a continuation starts from a softer or stiffer membrane. An unstable equilibrium is left for the lower of the
//! two states beside it.
//!
//! Source: Miguel et al. 2012, §5.1 (problem); after Magisano, Leonetti and Garcea 2017 (mixed Newton).

mod continuation;
mod escape;
mod levenberg_marquardt;
mod load_steps;
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
    /// Finds an equilibrium near the state `x`, which it replaces.
    ///
    /// * `x` — 3 stacked coordinates per node, m; held nodes at their prescribed positions, where they stay
    ///
    /// On return, [`Solver::solve_linear`] works with the true stiffness matrix at `x`, shifted if it is not positive
    /// definite. With Levenberg–Marquardt as the method, it works with that matrix + μI, μ of the last step.
    ///
    /// # Panics
    /// If the length of `x` differs from the cloth's number of coordinates.
    pub fn solve(&mut self, curves: &Curves, x: &mut [f64], settings: &Settings) -> Equilibrium {
        assert_eq!(x.len(), 3 * self.cloth.points(), "three coordinates per node");
        if let Some(refused) = self.refused(x) {
            return refused;
        }
        self.mixed.clear();
        let start = x.to_vec();
        let (before, remedies) = (self.linear.factorisations(), self.remedies);
        let mut found = self.settle(curves, x, settings);
        // Low iteration limits serve to see how far a solve gets: no continuation for these.
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
