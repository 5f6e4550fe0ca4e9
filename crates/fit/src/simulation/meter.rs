//! What solves cost: counted, so that figures hold on any machine.

use cloth_sim::equilibrium::Equilibrium;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};

/// What the solves of a stage have cost.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Equilibria sought.
    pub equilibria: usize,
    /// Newton steps.
    pub iterations: usize,
    /// Factorisations.
    pub factorisations: usize,
}

impl Counters {
    /// What was spent since an earlier reading.
    pub fn since(&self, earlier: &Self) -> Self {
        Self {
            equilibria: self.equilibria - earlier.equilibria,
            iterations: self.iterations - earlier.iterations,
            factorisations: self.factorisations - earlier.factorisations,
        }
    }
}

/// Counts the cost of a stage while it runs; other threads may read it.
#[derive(Debug, Default)]
pub struct Meter {
    equilibria: AtomicUsize,
    iterations: AtomicUsize,
    factorisations: AtomicUsize,
}

impl Meter {
    /// What was spent so far.
    pub fn read(&self) -> Counters {
        Counters {
            equilibria: self.equilibria.load(Ordering::Relaxed),
            iterations: self.iterations.load(Ordering::Relaxed),
            factorisations: self.factorisations.load(Ordering::Relaxed),
        }
    }

    pub(super) fn add(&self, equilibrium: &Equilibrium) {
        self.equilibria.fetch_add(1, Ordering::Relaxed);
        self.iterations.fetch_add(equilibrium.iterations, Ordering::Relaxed);
        self.factorisations.fetch_add(equilibrium.factorisations, Ordering::Relaxed);
    }
}
