//! Stretch: one curve for weft or warp, from the clip forces of strips pulled along it.
//!
//! Shear and bending are left out. The curve across the strip keeps a constant stiffness, which does not matter
//! without Poisson coupling. Loading and unloading have equal weight, so the curve runs through the middle of the
//! hysteresis band.
//!
//! Source: Miguel et al. 2012, §5.2.

use super::course;
use super::knowledge::Knowledge;
use super::plan::{Plan, kinds_of_all};
use super::report::StageReport;
use super::settings::Settings;
use super::watch::Watch;
use crate::equilibria::Objective;
use cloth_data::error::Result;
use cloth_data::frame::MeasurementSet;
use cloth_sim::material::Component;

/// The plan of the stage.
///
/// * `components` — weft or warp; both if they share a curve
pub fn plan(components: &[Component]) -> Plan {
    Plan {
        fitted: components.to_vec(),
        components: vec![Component::StretchWeft, Component::StretchWarp],
        objective: Objective::Forces,
        kinds: kinds_of_all(components),
        flat: false,
        pass: 1,
    }
}

/// Fits one component on all sequences of a set that stretch along it; `None` without such a sequence.
///
/// # Errors
/// As [`super::fit`].
pub fn fit(
    set: &MeasurementSet,
    component: Component,
    settings: &Settings,
    watch: &mut Watch<'_>,
) -> Result<Option<StageReport>> {
    course::fit(set, &plan(&[component]), &mut Knowledge::default(), settings, watch)
}
