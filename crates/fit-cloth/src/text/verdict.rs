//! A stage in one sentence.

use super::overall::widest_band;
use super::{list, unit};
use cloth_fit::report::{SequenceReport, StageReport};
use std::fmt::Write;

/// Why it stopped, how good it is, what limits it, what to measure next.
pub fn verdict(stage: &StageReport) -> String {
    // Levels that did not pay come after the one that was kept.
    let kept = stage.levels.iter().find(|level| level.points == stage.curve.curve.len());
    let end = kept.map_or("", |level| &level.status[..]);
    let state = match (stage.converged, stage.curve.observed) {
        (true, true) => "converged",
        (true, false) => "converged, but NOT observed",
        (false, _) => "NOT converged",
    };
    format!(
        "{}: {state}: {}, and {end}; {}; {}.{}",
        stage.name(),
        stage.growth,
        limit(stage),
        next(stage),
        oddities(stage)
    )
}

/// What is left beyond the noise.
fn limit(stage: &StageReport) -> String {
    let (name, factor) = unit(stage);
    let compared = if name == "N" { "forces" } else { "shapes" };
    let scatter = stage.scatter.times(factor);
    let origin = if scatter.known { "given" } else { "estimated" };
    let noise = format!("the {origin} noise of {:.2e} {name}", scatter.noise);
    if scatter.misfit > 0.0 {
        format!(
            "it misses the {compared} by {:.2e} {name} beyond {noise} (hysteresis, too few control points, or another law than the model's), and the band includes that",
            scatter.misfit
        )
    } else {
        format!("nothing is left beyond {noise}")
    }
}

/// What to measure next.
fn next(stage: &StageReport) -> String {
    if !stage.curve.observed {
        return "it takes another test to see this curve".into();
    }
    let Some((place, share)) = widest_band(stage) else {
        return "too few frames to judge all of the curve by: measure more".into();
    };
    let [at, of] = match stage.components[0].is_bending() {
        true => [format!("curvature {place:.2} 1/m"), "moment".into()],
        false => [format!("strain {place:.4}"), "stress".into()],
    };
    format!(
        "the 95 % band is widest at {at}, ± {:.1} % of the largest {of}: more frames there would narrow it most",
        100.0 * share
    )
}

/// Frames that take no part, and frames to look at.
fn oddities(stage: &StageReport) -> String {
    let mut text = String::new();
    for dropped in &stage.dropped {
        let _ = write!(
            text,
            " Frame {} of {} takes no part: {}.",
            dropped.frame, dropped.sequence, dropped.status
        );
    }
    for sequence in &stage.sequences {
        let SequenceReport { name, outliers, multi_stable, .. } = sequence;
        if !outliers.is_empty() {
            let _ = write!(text, " Look at frame {} of {name}: far off the rest.", some(outliers));
        }
        if !multi_stable.is_empty() {
            let _ = write!(
                text,
                " Frame {} of {name} may have several equilibria; a position there tells little.",
                some(multi_stable)
            );
        }
    }
    text
}

/// The first few frames.
fn some(frames: &[usize]) -> String {
    let more = if frames.len() > 8 { " and others" } else { "" };
    list(frames.iter().take(8)) + more
}
