//! The observed range of a curve.

use cloth_fit::stage::report::StageReport;

/// The strains or curvatures between which a stage's curve was observed.
pub(super) fn seen(stage: &StageReport) -> String {
    let digits = if stage.components[0].is_bending() { 2 } else { 4 };
    let [low, high] = stage.curve.seen.map(|strain| {
        let text = format!("{strain:.digits$}");
        // A value that rounds to zero is printed without a sign.
        if text.trim_start_matches(['-', '0', '.']).is_empty() { text.replace('-', "") } else { text }
    });
    format!("{low} to {high}")
}
