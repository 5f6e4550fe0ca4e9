//! Bending: weft, warp and diagonal curves from the shapes of sheets pushed over a table's edge; stretch and shear
//! known.
//!
//! Source: Miguel et al. 2012, §5.2; the constraint at the edge is ours: docs/model.md.

use super::plan::{Plan, kinds_of_all};
use crate::equilibria::Objective;
use cloth_sim::material::Component;

/// The plan of the stage.
///
/// * `components` — weft, warp or diagonal; weft and warp if they share a curve
pub fn plan(components: &[Component], pass: usize) -> Plan {
    Plan {
        fitted: components.to_vec(),
        components: Component::ALL.to_vec(),
        objective: Objective::Positions,
        kinds: kinds_of_all(components),
        flat: false,
        pass,
    }
}
