//! The declared noise, and what is assumed where none is.

use crate::frame::{Fabric, Sequence};
use crate::notice::Notice;

/// Refuses a noise value that cannot weight residuals: files cannot contain one, but a set built in memory can. Says that
/// clips are taken to err as vertices do where nothing is declared.
pub(super) fn check(_: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    let Some(noise) = sequence.noise else { return };
    let mut refuse = |field: &str, deviation: Option<f64>, allowed: fn(f64) -> bool, expected: &str| {
        let Some(deviation) = deviation.filter(|&deviation| !(allowed(deviation) && deviation.is_finite()))
        else {
            return;
        };
        let place = format!("test.toml noise.{field}");
        notices.push(Notice::refusal(&sequence.name, place, deviation.to_string(), expected));
    };
    let known = "a standard deviation above 0, or none where it is not known";
    refuse("position_m", noise.position_m, |deviation| deviation > 0.0, known);
    refuse("force_n", noise.force_n, |deviation| deviation > 0.0, known);
    let exact = "a standard deviation of 0 (exact poses) or more";
    refuse("clip_m", noise.clip_m, |deviation| deviation >= 0.0, exact);
    if let (Some(vertex), None, false) = (noise.position_m, noise.clip_m, sequence.clips.is_empty()) {
        notices.push(Notice::remark(
            &sequence.name,
            "test.toml noise.clip_m",
            "nothing",
            format!(
                "the noise of the clips' poses; taken as that of a vertex, {vertex} m (0 for exact poses)"
            ),
        ));
    }
}
