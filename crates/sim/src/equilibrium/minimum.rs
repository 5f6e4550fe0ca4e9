//! Minimisation: Newton's method, with Levenberg–Marquardt as a fallback.

use super::outcome::{Equilibrium, Status};
use super::settings::{Method, Settings};
use super::solver::Solver;
use crate::material::Curves;

impl Solver<'_> {
    /// Descends to a balanced state, stable or not.
    pub(super) fn minimise(&mut self, curves: &Curves, x: &mut [f64], settings: &Settings) -> Equilibrium {
        let (before, remedies) = (self.linear.factorisations(), self.remedies);
        let mut iterations = 0;
        self.damping = 0.0;
        self.clamped = 0;
        let mut energy = self.evaluate(curves, x);
        // An angle at a collapsed wing has finite energy but non-finite forces; these act on held nodes only if all are
        // held.
        let finite = energy.is_finite()
            && self.gradient.iter().all(|force| force.is_finite())
            && self.cloth.norm(&self.gradient).is_finite();
        let mut status = if finite { Status::Stalled } else { Status::NotFinite };
        if status == Status::Stalled && settings.method == Method::MixedNewton {
            status = self.mixed_newton(curves, x, settings, &mut energy, &mut iterations);
        }
        if status == Status::Stalled {
            self.remedies.levenberg_marquardt += usize::from(settings.method == Method::MixedNewton);
            status = self.levenberg_marquardt(curves, x, settings, &mut energy, &mut iterations);
        }
        match settings.method {
            _ if status == Status::NotFinite => (),
            // The stability of a time step does not matter.
            _ if self.increment.is_some() => (),
            Method::LevenbergMarquardt => self.factorise_damped(curves, x),
            Method::MixedNewton => {
                let stable = self.factorise_true_hessian(curves, x);
                if status == Status::Converged && !stable {
                    status = Status::Unstable;
                }
            }
        }
        let (imbalance, tolerance, limit) = self.balance(x, settings);
        let factorisations = self.linear.factorisations() - before;
        let remedies = self.remedies - remedies;
        let escaped = false;
        Equilibrium {
            status,
            escaped,
            limit,
            energy,
            imbalance,
            tolerance,
            iterations,
            factorisations,
            remedies,
        }
    }
}
