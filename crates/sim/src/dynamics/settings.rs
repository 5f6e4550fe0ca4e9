//! How a cloth is moved on: the step, the integrator, and what acts on the way.

use super::damping::Damping;
use super::wind::Wind;
use crate::error::{Error, Result};

/// How a cloth is moved on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Length of a step, s; default 0.01.
    pub step: f64,
    /// Default implicit Euler.
    pub integrator: Integrator,
    /// Default none.
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

/// The way from one time to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// First order, stable at any step, and lossy: motion faster than some steps dies.
    ImplicitEuler {
        /// How the step's equation is solved.
        newton: Newton,
        /// How its linear systems are.
        linear: LinearSolver,
    },
    /// Fourth order, explicit: stable up to [`stable_step`](super::stable_step).
    RungeKutta,
}

/// How an implicit step's equation is solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Newton {
    /// Until the largest imbalance of a node is at most this share of the typical force or weight at a node; default 1e-6.
    Converged {
        /// That share.
        tolerance: f64,
    },
    /// Linearised once, as published: faster, and neither exact nor always stable.
    Single,
}

impl Default for Newton {
    fn default() -> Self {
        Self::Converged { tolerance: 1e-6 }
    }
}

/// How linear systems are solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LinearSolver {
    /// Sparse Cholesky factorisation.
    Direct,
    /// Conjugate gradients with a diagonal preconditioner.
    ConjugateGradient {
        /// γ: stop at rᵀP⁻¹r ≤ γ² bᵀP⁻¹b; 1e-5 as published.
        tolerance: f64,
        /// Most iterations of one system.
        max_iterations: usize,
    },
}

impl Settings {
    /// Every number in its range.
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
