//! Who is told how far a study is.

use cloth_fit::equilibria::Meter;
use std::sync::Arc;

/// Who is told how far a study is.
pub trait Progress {
    /// Is told what is done now.
    fn note(&self, what: &str);

    /// What the study counts equilibria with.
    fn meter(&self) -> Arc<Meter>;
}
