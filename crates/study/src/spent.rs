//! What a run has cost.

use crate::memory;
use cloth_fit::equilibria::{Counters, Meter};
use std::time::Instant;

/// What a run has cost.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spent {
    /// Wall time, s.
    pub seconds: f64,
    /// Equilibria sought, Newton steps, factorisations.
    pub counters: Counters,
    /// Largest resident memory of the program during the run, MiB; `None` where the system does not tell.
    pub peak_memory_mib: Option<f64>,
}

/// Does something, and tells what it has cost.
pub(crate) fn spend<T>(meter: &Meter, work: impl FnOnce() -> T) -> (T, Spent) {
    memory::reset_peak();
    let before = meter.read();
    let clock = Instant::now();
    let done = work();
    let seconds = clock.elapsed().as_secs_f64();
    let counters = meter.read().since(&before);
    (done, Spent { seconds, counters, peak_memory_mib: memory::peak_mib() })
}
