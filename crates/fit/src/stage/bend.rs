//! Bending: weft, warp and diagonal curves, stretch and shear known, from the shapes of sheets pushed over a table's edge.
//!
//! Source: Miguel et al. 2012, §5.2. What is held at the edge is ours: docs/model.md.

use super::Plan;
use crate::frame::Kind;
use crate::simulation::Objective;
use cloth_sim::material::Component;

/// The tests that show a component.
pub fn kinds_of(component: Component) -> &'static [Kind] {
    match component {
        Component::BendWeft => &[Kind::BendWeft],
        Component::BendWarp => &[Kind::BendWarp],
        _ => &[Kind::BendWeft, Kind::BendWarp, Kind::BendBias],
    }
}

/// What the stage fits, and on what.
///
/// * `components` — weft, warp or diagonal; weft and warp, if they share a curve
pub fn plan(components: &[Component], pass: usize) -> Plan {
    Plan {
        fitted: components.to_vec(),
        components: Component::ALL.to_vec(),
        objective: Objective::Positions,
        kinds: components.iter().flat_map(|&component| kinds_of(component)).copied().collect(),
        flat: false,
        pass,
    }
}
