//! Progress of a study.

use cloth_fit::equilibria::Meter;
use std::sync::Arc;

/// Receives the progress of a study.
pub trait Progress {
    /// Receives a description of the current task.
    fn note(&self, what: &str);

    /// The meter that counts equilibria.
    fn meter(&self) -> Arc<Meter>;
}
