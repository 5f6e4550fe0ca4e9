//! Units of residuals.

use cloth_fit::equilibria::Objective;
use cloth_fit::stage::report::StageReport;

/// In what a stage's residuals are shown: the unit, and how many of it make one of SI.
pub(super) fn unit(stage: &StageReport) -> (&'static str, f64) {
    match stage.objective {
        Objective::Forces => ("N", 1.0),
        Objective::Positions => ("mm", 1e3),
    }
}
