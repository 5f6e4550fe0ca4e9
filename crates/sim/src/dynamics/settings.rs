//! Settings of the time integration: step, integrator, damping and wind.

use super::damping::Damping;
use super::wind::Wind;
use crate::error::{Error, Result};

/// Settings of the time integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Length of a step, s; default 0.01.
    pub step: f64,
    /// Integrator; default implicit Euler.
    pub integrator: Integrator,
    /// Damping; default none.
    pub damping: Damping,
    /// The air; default none.
    pub wind: Option<Wind>,
}

impl Default for Settings {
    fn default() -> Self {
        let integrator =
            Integrator::ImplicitEuler { newton: Newton::default(), linear: LinearSolver::Direct };
        Self { step: 0.01, integrator, damping: Damping::default(), wind: None }
    }
}

/// Time integrator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// First order, stable at any step, dissipative: motion faster than a few steps dies out.
    ImplicitEuler {
        /// Solver of the step's equation.
        newton: Newton,
        /// Solver of its linear systems.
        linear: LinearSolver,
    },
    /// Fourth order, explicit: stable up to [`stable_step`](super::stable_step).
    RungeKutta,
}

/// Solver of an implicit step's equation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Newton {
    /// Iterates until the largest nodal imbalance is at most a share of the typical force or weight at a node; default
    /// 1e-6.
    Converged {
        /// The share.
        tolerance: f64,
    },
    /// Linearises once, as published: faster, but neither exact nor always stable.
    Single,
}

impl Default for Newton {
    fn default() -> Self {
        Self::Converged { tolerance: 1e-6 }
    }
}

/// Solver of linear systems.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LinearSolver {
    /// Sparse Cholesky factorisation.
    Direct,
    /// Conjugate gradients with a diagonal preconditioner.
    ConjugateGradient {
        /// γ: stop at rᵀP⁻¹r ≤ γ² bᵀP⁻¹b; 1e-5 as published.
        tolerance: f64,
        /// Maximum number of iterations per system.
        max_iterations: usize,
    },
}

impl Settings {
    /// Checks the range of every number.
    pub(super) fn check(&self) -> Result<()> {
        let positive = |field, value: f64| match value > 0.0 && value.is_finite() {
            true => Ok(()),
            false => Err(Error::InvalidValue { field, value, expected: "a number above 0" }),
        };
        let not_negative = |field, value: f64| match value >= 0.0 && value.is_finite() {
            true => Ok(()),
            false => Err(Error::InvalidValue { field, value, expected: "0 or more" }),
        };
        positive("step", self.step)?;
        not_negative("damping.mass", self.damping.mass)?;
        not_negative("damping.stiffness", self.damping.stiffness)?;
        if let Integrator::ImplicitEuler { newton, linear } = self.integrator {
            if let Newton::Converged { tolerance } = newton {
                positive("newton.tolerance", tolerance)?;
            }
            if let LinearSolver::ConjugateGradient { tolerance, max_iterations } = linear {
                positive("linear.tolerance", tolerance)?;
                positive("linear.max_iterations", max_iterations as f64)?;
            }
        }
        self.wind.map_or(Ok(()), |wind| wind.check())
    }
}
