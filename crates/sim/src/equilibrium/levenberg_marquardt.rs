//! Additive Levenberg–Marquardt: the published method, and the last resort of ours.
//!
//! Source: Miguel et al. 2012, §5.1; how μ is chosen is ours.

use super::newton::DAMPING;
use super::outcome::Status;
use super::settings::Settings;
use super::solver::Solver;
use crate::element::Curvature;
use crate::material::Curves;

impl Solver<'_> {
    /// (K + μI) d = −g with μ a tenth after each success, ten times after each failure.
    pub(super) fn levenberg_marquardt(
        &mut self,
        curves: &Curves,
        x: &mut [f64],
        settings: &Settings,
        energy: &mut f64,
        iterations: &mut usize,
    ) -> Status {
        // Before the first step there is no μ, whatever a former solve has left.
        self.shift = 0.0;
        let mut shift = None;
        while *iterations < settings.max_iterations {
            if self.is_balanced(x, settings) {
                return Status::Converged;
            }
            self.assemble(curves, x, Curvature::Full);
            let mean = self.mean_diagonal();
            let mut damping = shift.unwrap_or(DAMPING * mean);
            let norm = self.cloth.norm(&self.gradient);
            *iterations += 1;
            loop {
                // Written so that a NaN stops it too.
                if !(damping <= 1e9 * mean) {
                    return Status::Stalled;
                }
                if self.direction_of(damping).is_some() {
                    let trial_energy = self.try_step(curves, x, 1.0);
                    let smaller = self.cloth.norm(&self.trial_gradient) < 0.5 * norm;
                    if trial_energy.is_finite()
                        && (trial_energy < *energy || smaller)
                        && !self.cloth.hinge_jumps(x, &self.trial)
                    {
                        *energy = self.accept(x, trial_energy);
                        break;
                    }
                }
                damping *= 10.0;
            }
            shift = Some(0.1 * damping);
        }
        if self.is_balanced(x, settings) { Status::Converged } else { Status::IterationLimit }
    }

    /// The true matrix + μI with the μ of the last step; ten times more, and so on, where it is not positive definite.
    pub(super) fn factorise_damped(&mut self, curves: &Curves, x: &[f64]) {
        let last = self.shift;
        self.assemble(curves, x, Curvature::Full);
        let least = if last > 0.0 { last } else { DAMPING * self.mean_diagonal() };
        let _ = (0..16).any(|power| self.factorise(least * 10f64.powi(power)));
    }
}
