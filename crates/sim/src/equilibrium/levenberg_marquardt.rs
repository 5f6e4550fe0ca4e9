//! Additive Levenberg–Marquardt: the published method, used here as a fallback.
//!
//! Source: Miguel et al. 2012, §5.1; the choice of μ is specific to this project.

use super::newton::DAMPING;
use super::outcome::Status;
use super::settings::Settings;
use super::solver::Solver;
use crate::element::HessianKind;
use crate::material::Curves;

impl Solver<'_> {
    /// Iterates (K + μI) d = −g; μ falls to a tenth after each success and rises tenfold after each failure.
    pub(super) fn levenberg_marquardt(
        &mut self,
        curves: &Curves,
        x: &mut [f64],
        settings: &Settings,
        energy: &mut f64,
        iterations: &mut usize,
    ) -> Status {
        // The first step starts without μ, whatever an earlier solve has left.
        self.shift = 0.0;
        let mut shift = None;
        while *iterations < settings.max_iterations {
            if self.is_balanced(x, settings) {
                return Status::Converged;
            }
            self.assemble(curves, x, HessianKind::Full);
            let mean = self.mean_diagonal();
            let mut damping = shift.unwrap_or(DAMPING * mean);
            let norm = self.cloth.norm(&self.gradient);
            *iterations += 1;
            loop {
                // Negated to stop at NaN.
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

    /// Factorises the true matrix + μI with μ of the last step, increased tenfold until the matrix is positive
    /// definite.
    pub(super) fn factorise_damped(&mut self, curves: &Curves, x: &[f64]) {
        let last = self.shift;
        self.assemble(curves, x, HessianKind::Full);
        let least = if last > 0.0 { last } else { DAMPING * self.mean_diagonal() };
        let _ = (0..16).any(|power| self.factorise(least * 10f64.powi(power)));
    }
}
