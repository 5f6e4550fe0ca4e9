//! Counts the cost of solves and their numerical interventions; counts do not depend on the machine.

use cloth_sim::equilibrium::{Equilibrium, Limit, Remedies};
use serde::{Deserialize, Serialize};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The cost of a stage's solves.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Equilibria sought.
    pub equilibria: usize,
    /// Newton steps.
    pub iterations: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// Equilibria whose imbalance was measured against rounding, not against the tolerance.
    pub by_rounding: usize,
    /// Interventions of the solver beside plain Newton steps.
    pub remedies: Remedies,
    /// Solves restarted from the replica's own start.
    pub begun_anew: usize,
    /// Solves that then took load steps from the flat sheet.
    pub in_load_steps: usize,
    /// Frames that continuation from the previous frame did not reach; they start from their measured shape.
    pub not_followed: usize,
}

impl Counters {
    /// The counts since an earlier reading.
    pub fn since(&self, earlier: &Self) -> Self {
        Self {
            equilibria: self.equilibria - earlier.equilibria,
            iterations: self.iterations - earlier.iterations,
            factorisations: self.factorisations - earlier.factorisations,
            by_rounding: self.by_rounding - earlier.by_rounding,
            remedies: self.remedies - earlier.remedies,
            begun_anew: self.begun_anew - earlier.begun_anew,
            in_load_steps: self.in_load_steps - earlier.in_load_steps,
            not_followed: self.not_followed - earlier.not_followed,
        }
    }

    /// Counts one more solve.
    pub fn add(&mut self, equilibrium: &Equilibrium) {
        self.equilibria += 1;
        self.iterations += equilibrium.iterations;
        self.factorisations += equilibrium.factorisations;
        self.by_rounding += usize::from(equilibrium.converged() && equilibrium.limit == Limit::Rounding);
        self.remedies += equilibrium.remedies;
    }
}

/// Counts the cost of a stage while it runs; other threads may read it.
#[derive(Debug, Default)]
pub struct Meter(Mutex<Counters>);

impl Meter {
    /// The counts so far.
    pub fn read(&self) -> Counters {
        *self.counters()
    }

    pub(super) fn add(&self, equilibrium: &Equilibrium) {
        self.counters().add(equilibrium);
    }

    pub(super) fn begins_anew(&self) {
        self.counters().begun_anew += 1;
    }

    pub(super) fn takes_load_steps(&self) {
        self.counters().in_load_steps += 1;
    }

    pub(super) fn does_not_follow(&self) {
        self.counters().not_followed += 1;
    }

    /// Ignores poisoning: the counters are valid in every state.
    fn counters(&self) -> MutexGuard<'_, Counters> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
