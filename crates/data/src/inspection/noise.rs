//! The declared noise.

use crate::frame::{Fabric, Sequence};
use crate::notice::Notice;

/// Refuses a noise value that cannot weight residuals. Files cannot contain one, but a set built in memory can.
pub(super) fn check(_: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    let Some(noise) = sequence.noise else { return };
    for (field, deviation) in [("position_m", noise.position_m), ("force_n", noise.force_n)] {
        let Some(deviation) = deviation.filter(|&deviation| !(deviation > 0.0 && deviation.is_finite()))
        else {
            continue;
        };
        notices.push(Notice::refusal(
            &sequence.name,
            format!("test.toml noise.{field}"),
            deviation.to_string(),
            "a standard deviation above 0, or none where it is not known",
        ));
    }
}
