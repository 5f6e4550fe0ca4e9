//! The verdict on a stage or a fit.

use super::band::sure;
use super::list::list;
use super::range::seen;
use super::unit::unit;
use cloth_data::notice::Notice;
use cloth_fit::incremental::FitReport;
use cloth_fit::judge::verdict::{Verdict, of_fit, of_stage, widest_band};
use cloth_fit::stage::report::{SequenceReport, StageReport};
use cloth_fit::twin::replica::SkippedFrame;
use std::fmt::Write;

/// Grade and reasons, limits, and the next measurement, followed by the reason why the fit stopped.
///
/// * `notices` — contradictions found in the measurements
pub fn verdict(stage: &StageReport, notices: &[Notice]) -> String {
    let Verdict { grade, reasons } = of_stage(stage, notices);
    let mut said = vec![limit(stage)];
    said.extend(next(stage, &reasons));
    // Levels that brought no improvement come after the one that was kept.
    let kept = stage.levels.iter().find(|level| level.points == stage.curve.curve.len());
    let end = kept.map_or("", |level| &level.status[..]);
    let converged = if stage.converged { "converged" } else { "NOT converged" };
    let trust = if reasons.is_empty() { trusted(stage) } else { reasons.join("; ") };
    format!(
        "{}: {grade}: {trust}; {}.{} ({converged}: {}, and {end})",
        stage.name(),
        said.join("; "),
        oddities(stage),
        stage.growth
    )
}

/// The uncertainty and range of a curve without reservations.
fn trusted(stage: &StageReport) -> String {
    let sure = widest_band(stage).map_or(String::new(), |(_, share)| format!(" to ± {}", sure(share)));
    let [stress, unit] = if stage.components[0].is_bending() { ["moment", " 1/m"] } else { ["stress", ""] };
    format!("known{sure} of its largest {stress} from {}{unit}", seen(stage))
}

/// A whole fit in one line: the worst grade, and the reasons for it.
pub fn verdict_of_fit(report: &FitReport) -> String {
    let Verdict { grade, reasons } = of_fit(report);
    match reasons.is_empty() {
        true => format!("Verdict: {grade}"),
        false => format!("Verdict: {grade}: {}", reasons.join(" | ")),
    }
}

/// The misfit beyond the noise.
fn limit(stage: &StageReport) -> String {
    let (name, factor) = unit(stage);
    let compared = if name == "N" { "forces" } else { "shapes" };
    let scatter = stage.scatter.times(factor);
    let origin = if scatter.known { "given" } else { "estimated" };
    let noise = format!("the {origin} noise of {:.2e} {name}", scatter.noise);
    if scatter.misfit > 0.0 {
        format!(
            "it misses the {compared} by {:.2e} {name} beyond {noise} (hysteresis, too few control points, or a law that the model cannot follow); the band includes this misfit",
            scatter.misfit
        )
    } else {
        format!("no misfit beyond {noise}")
    }
}

/// The next measurement to make; `None` if a reason for the grade says so already.
fn next(stage: &StageReport, reasons: &[String]) -> Option<String> {
    let odd = stage.sequences.iter().filter(|sequence| !sequence.outliers.is_empty());
    let odd: Vec<String> = odd.map(|s| format!("frame {} of {}", some(&s.outliers), s.name)).collect();
    if !odd.is_empty() {
        let robust = if stage.interventions.residuals_bent == 0 { ", or fit with --robust" } else { "" };
        return Some(format!("outliers: {}: check them and their neighbours first{robust}", list(odd)));
    }
    if !stage.curve.observed {
        return Some("another test is needed to observe this curve".into());
    }
    let Some((place, share)) = widest_band(stage) else {
        return Some("too few frames to judge the whole curve: measure more".into());
    };
    let [at, of] = match stage.components[0].is_bending() {
        true => [format!("curvature {place:.2} 1/m"), "moment".into()],
        false => [format!("strain {place:.4}"), "stress".into()],
    };
    let said = format!(
        "the 95 % band is widest at {at}, ± {} of the largest {of}{}: more frames there would narrow it most",
        sure(share),
        parts(stage)
    );
    reasons.is_empty().then_some(said)
}

/// The sources of the widest band, the largest first, as shares of the largest stress.
fn parts(stage: &StageReport) -> String {
    let largest = stage.curve.largest_stress();
    let mut parts: Vec<(f64, String)> = stage
        .curve
        .band
        .iter()
        .map(|(source, half)| (half / largest, format!("{source} {}", sure(half / largest))))
        .collect();
    parts.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    let parts: Vec<String> = parts.into_iter().map(|(_, part)| part).collect();
    if parts.is_empty() { String::new() } else { format!(" ({})", parts.join(", ")) }
}

/// Skipped frames, and frames whose positions are ambiguous.
fn oddities(stage: &StageReport) -> String {
    let mut text = String::new();
    for dropped in &stage.dropped {
        let _ =
            write!(text, " Frame {} of {} is skipped: {}.", dropped.frame, dropped.sequence, dropped.status);
    }
    for sequence in &stage.sequences {
        let SequenceReport { name, multi_stable, skipped, .. } = sequence;
        for SkippedFrame { frame, skip } in skipped.iter().filter(|skipped| !skipped.skip.is_rest()) {
            let _ = write!(text, " Frame {frame} of {name} takes no part: {skip}.");
        }
        if !multi_stable.is_empty() {
            let _ = write!(
                text,
                " Frame {} of {name} may have several equilibria; positions there carry little information.",
                some(multi_stable)
            );
        }
    }
    text
}

/// The first eight frames.
fn some(frames: &[usize]) -> String {
    let more = if frames.len() > 8 { " and others" } else { "" };
    list(frames.iter().take(8)) + more
}
