//! Shear: one curve, from the forces along the bars of a picture frame or on a bias strip; stretch known.
//!
//! The first pass keeps the sheet in its plane, without bending. If the sheet was seen to buckle, the second pass
//! lets it, with the bending curves found in between.
//!
//! Source: Miguel et al. 2012, §5.2; the bias strip is ours, for laboratories without a picture frame.

use super::plan::{Plan, kinds_of_all};
use crate::equilibria::Objective;
use cloth_sim::material::Component;

/// The plan of the stage.
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
