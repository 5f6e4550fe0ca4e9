//! The noise that is declared.

use super::{Notice, Severity};
use crate::frame::{Fabric, Sequence};

/// Refuses a noise by which nothing can be weighed. Files cannot hold one; a caller's set can.
pub(super) fn check(_: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    let Some(noise) = sequence.noise else { return };
    for (field, deviation) in [("position_m", noise.position_m), ("force_n", noise.force_n)] {
        let Some(deviation) = deviation.filter(|&deviation| !(deviation > 0.0 && deviation.is_finite()))
        else {
            continue;
        };
        notices.push(Notice {
            severity: Severity::Refusal,
            sequence: sequence.name.clone(),
            place: format!("test.toml noise.{field}"),
            found: deviation.to_string(),
            expected: "a standard deviation above 0, or none where it is not known".into(),
        });
    }
}
