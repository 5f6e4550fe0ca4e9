//! Cost of a run.

use crate::memory;
use cloth_fit::equilibria::{Counters, Meter};
use std::time::Instant;

/// Cost of a run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spent {
    /// Wall-clock time, s.
    pub seconds: f64,
    /// Equilibria attempted, Newton steps, factorisations.
    pub counters: Counters,
    /// Peak resident memory of the program during the run, MiB; `None` if the system does not report it.
    pub peak_memory_mib: Option<f64>,
}

/// Runs a task and measures its cost.
pub(crate) fn spend<T>(meter: &Meter, work: impl FnOnce() -> T) -> (T, Spent) {
    memory::reset_peak();
    let before = meter.read();
    let clock = Instant::now();
    let done = work();
    let seconds = clock.elapsed().as_secs_f64();
    let counters = meter.read().since(&before);
    (done, Spent { seconds, counters, peak_memory_mib: memory::peak_mib() })
}
