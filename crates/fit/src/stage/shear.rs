//! Shear: one curve, stretch known, from the forces along the bars of a picture frame or on a strip cut on the bias.
//!
//! The first pass keeps the sheet in its plane and leaves bending out. Where it was seen to buckle, the second lets it,
//! with the bending that was found meanwhile.
//!
//! Source: Miguel et al. 2012, §5.2; the strip cut on the bias is ours, for those without a picture frame.

use super::plan::{Plan, kinds_of_all};
use crate::equilibria::Objective;
use cloth_sim::material::Component;

/// What the stage fits, and on what.
///
/// * `pass` — 1: in the plane; 2: in space, where the sheet was seen to leave its plane
pub fn plan(pass: usize) -> Plan {
    let components = Component::ALL.into_iter().filter(|component| pass > 1 || !component.is_bending());
    Plan {
        fitted: vec![Component::Shear],
        components: components.collect(),
        objective: Objective::Forces,
        kinds: kinds_of_all(&[Component::Shear]),
        flat: pass == 1,
        pass,
    }
}
