//! The stages of the fit. Each fits one curve on the sequences that show it, the others known or left out.
//!
//! | stage | fits | on | compares |
//! |---|---|---|---|
//! | [`stretch`] | weft, warp | strips pulled along them | clip forces |
//! | [`shear`] | shear | picture frame, strips cut on the bias | forces along the bars; all forces |
//! | [`bend`] | weft, warp, diagonal | sheets pushed over a table's edge | positions |
//!
//! Source: Miguel et al. 2012, §5.2.

mod average;
pub mod bend;
mod course;
pub mod gap;
mod growth;
mod growth_rule;
pub mod interventions;
pub mod knowledge;
mod level;
mod plan;
mod posterior;
pub mod report;
mod settings;
pub mod shapes;
pub mod shear;
mod start;
pub mod stretch;
mod summary;
mod watch;

pub use course::fit;
pub use growth::{Growth, grow, refit};
pub use growth_rule::{GrowthRule, ResidualMeasure};
pub use level::{Level, domain};
pub use plan::{Plan, kinds_of_all};
pub use settings::{Constraints, FirstStiffness, Settings, Variant};
pub(crate) use start::{softest_bending, unyielding};
pub(crate) use summary::sequence_reports;
pub use watch::{Event, Watch};
