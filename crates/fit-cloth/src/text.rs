//! Text output: tables, and verdicts as sentences.

mod band;
mod check;
mod comparison;
mod interventions;
mod list;
mod notice;
mod number;
mod overall;
mod range;
mod residuals;
mod simulation;
mod stage;
mod study;
mod summary;
mod unit;
mod validation;
mod verdict;

pub(crate) use band::NO_KNOWLEDGE;
pub use check::{check, repaired};
pub use comparison::{Ranking, comparison, ranking};
pub use notice::notice;
pub use overall::{Overall, overall};
pub use residuals::residuals;
pub use simulation::{other_mesh, simulation};
pub use stage::{course, stage};
pub use study::{Section, sections, study, study_page};
pub use summary::{as_published, for_mesh, missing, summary, summary_rows};
pub use validation::{other_grid, validation};
pub use verdict::{verdict, verdict_of_fit};
