//! Units of residuals.

use cloth_fit::equilibria::Objective;
use cloth_fit::stage::report::StageReport;

/// Unit of a stage's residuals in the output, and the factor from SI to it.
pub(super) fn unit(stage: &StageReport) -> (&'static str, f64) {
    match stage.objective {
        Objective::Forces => ("N", 1.0),
        Objective::Positions => ("mm", 1e3),
    }
}
