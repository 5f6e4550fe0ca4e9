//! Newton's method with the matrix at the strains predicted by the last step.
//!
//! ```text
//! K̂ d = −g      K̂ = σ′(ε) ∇ε ∇εᵀ + σ(ε*) ∇²ε      ε* = ε + ∇ε·Δx before the last step Δx
//! ```

use super::outcome::Status;
use super::settings::Settings;
use super::solver::{Solver, shifts};
use crate::element::HessianKind;
use crate::material::Curves;

/// A full step may raise the energy by this many times |g·d|: the mixed matrix overshoots stretch on purpose, and the
/// next step takes it back. A stiff cantilever (stretch : bending = 1e9) from flat needs 28 steps with 1e3, 92 with 20.
const NONMONOTONE: f64 = 1e3;

/// After this many steps the energy must fall in each, to prevent cycling.
pub(super) const NONMONOTONE_STEPS: usize = 40;

/// A factor is reused while each step with it leaves less than this share of the imbalance. Warm cantilevers need 3.0
/// factorisations with 0.5 and 3.7 with 0.25; picture frames 5.0 and 6.0.
const CHORD_CONTRACTION: f64 = 0.5;

/// Number of indefinite matrices that are clamped, element by element, which removes the spurious stress of a poor
/// start.
const CLAMPED_STEPS: usize = 2;

/// Later indefinite matrices are damped, as in a sheet about to buckle: clamping would stiffen the path into the buckle
/// a hundredfold. μ, as a share of the mean diagonal, falls to a tenth from step to step, and to zero below
/// `LEAST_DAMPING`. Levenberg–Marquardt also starts with it.
pub(super) const DAMPING: f64 = 1e-3;
const LEAST_DAMPING: f64 = 2e-6;

impl Solver<'_> {
    /// Steps down to a balanced state; `Stalled` if no step is acceptable.
    pub(super) fn mixed_newton(
        &mut self,
        curves: &Curves,
        x: &mut [f64],
        settings: &Settings,
        energy: &mut f64,
        iterations: &mut usize,
    ) -> Status {
        // A time step takes at least one iteration: its prediction is so good that forces below the tolerance would
        // otherwise never be corrected, and would accumulate.
        let (mut lowest, mut best) = (*energy, x.to_vec());
        while (self.increment.is_some() && *iterations == 0) || !self.is_balanced(x, settings) {
            if *iterations >= settings.max_iterations {
                // The energy may have risen in between.
                if lowest < *energy {
                    x.copy_from_slice(&best);
                    *energy = self.evaluate(curves, x);
                }
                return Status::IterationLimit;
            }
            let Some(slope) = self.newton_direction(curves, x) else { return Status::Stalled };
            let nonmonotone = *iterations < NONMONOTONE_STEPS && !self.careful;
            *iterations += 1;
            if !self.line_search(curves, x, energy, slope, nonmonotone) {
                return Status::Stalled;
            }
            self.chord_steps(curves, x, settings, energy);
            if *energy < lowest {
                lowest = *energy;
                best.copy_from_slice(x);
            }
        }
        Status::Converged
    }

    /// Continues with the factor of the last step, if there is one, while it pays: a solve and a gradient cost about a
    /// sixth of a new factor.
    fn chord_steps(&mut self, curves: &Curves, x: &mut [f64], settings: &Settings, energy: &mut f64) {
        while self.is_direct() && self.contraction < CHORD_CONTRACTION && !self.is_balanced(x, settings) {
            let norm = self.cloth.norm(&self.gradient);
            self.direction();
            let trial_energy = self.try_step(curves, x, 1.0);
            let contraction = self.cloth.norm(&self.trial_gradient) / norm;
            if !(contraction < CHORD_CONTRACTION) || self.cloth.hinge_jumps(x, &self.trial) {
                return;
            }
            *energy = self.accept(x, trial_energy);
        }
    }

    /// Computes the direction of the mixed matrix. If that is not positive definite, uses the clamped matrix; after
    /// `CLAMPED_STEPS` of these, tries the damped one first. Returns the slope g·d.
    fn newton_direction(&mut self, curves: &Curves, x: &[f64]) -> Option<f64> {
        self.assemble_mixed(curves, x);
        let mean = self.mean_diagonal();
        if let Some(slope) = self.direction_of(self.damping * mean) {
            self.remedies.damped += usize::from(self.damping > 0.0);
            self.damping = if self.damping > LEAST_DAMPING { 0.1 * self.damping } else { 0.0 };
            return Some(slope);
        }
        self.clamped += 1;
        if self.damping < DAMPING && self.clamped > CLAMPED_STEPS && !self.careful {
            self.damping = DAMPING;
            if let Some(slope) = self.direction_of(DAMPING * mean) {
                self.remedies.damped += 1;
                return Some(slope);
            }
        }
        self.assemble(curves, x, HessianKind::Clamped);
        self.remedies.clamped += 1;
        // A clamped matrix may still be singular, for example if nothing but bending holds a flat sheet.
        let shifts = shifts(self.mean_diagonal());
        let slope = std::iter::once(0.0).chain(shifts).find_map(|shift| self.direction_of(shift));
        self.remedies.damped += usize::from(self.shift > 0.0);
        slope
    }

    /// Moves along the step, which is halved until it is acceptable.
    fn line_search(
        &mut self,
        curves: &Curves,
        x: &mut [f64],
        energy: &mut f64,
        slope: f64,
        nonmonotone: bool,
    ) -> bool {
        if !(slope < 0.0) {
            return false;
        }
        let norm = self.cloth.norm(&self.gradient);
        let rounding = 1e-9 * energy.abs();
        let mut length = 1.0;
        for halving in 0..30 {
            let trial_energy = self.try_step(curves, x, length);
            let acceptable = if halving == 0 && nonmonotone {
                trial_energy <= *energy + NONMONOTONE * slope.abs()
            } else {
                trial_energy <= *energy + 1e-4 * length * slope
            };
            // Near the end, energy differences drown in rounding: the imbalance decides, and a careful step must also
            // not raise the energy beyond rounding.
            let contraction = self.cloth.norm(&self.trial_gradient) / norm;
            if contraction.is_finite()
                && (acceptable
                    || (contraction < 0.5 && (!self.careful || trial_energy <= *energy + rounding)))
                && !self.cloth.hinge_jumps(x, &self.trial)
            {
                self.step.iter_mut().for_each(|d| *d *= length);
                self.contraction = contraction;
                *energy = self.accept(x, trial_energy);
                return true;
            }
            length *= 0.5;
        }
        false
    }
}
