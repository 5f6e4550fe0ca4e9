//! A whole fit in four sentences: state, residuals, uncertainty, next measurement.

use super::band::half_band;
use super::list::list;
use cloth_fit::incremental::FitReport;
use cloth_fit::judge::verdict::{self, Verdict, widest_band};
use cloth_fit::stage::report::{SequenceReport, StageReport};
use cloth_sim::material::Component;

/// Summary of a fit for a reader who does not need the details.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Overall {
    /// Verdict, given by the worst curve.
    pub verdict: Verdict,
    /// Numbers of curves fitted, given and not observed.
    pub state: String,
    /// Largest residuals.
    pub good: String,
    /// Bands at the ends of the observed ranges.
    pub sure: String,
    /// The most informative next measurement.
    pub next: String,
}

/// Summarises a fit by its weakest parts.
pub fn overall(report: &FitReport) -> Overall {
    let observed: Vec<&StageReport> = report.last_stages().filter(|stage| stage.curve.observed).collect();
    let missing: Vec<Component> = report
        .model
        .components()
        .into_iter()
        .filter(|&component| !report.knowledge.knows(component))
        .collect();
    Overall {
        verdict: verdict::of_fit(report),
        state: state(report, &observed, &missing),
        good: good(report),
        sure: sure(&observed),
        next: next(report, &observed, &missing),
    }
}

fn state(report: &FitReport, observed: &[&StageReport], missing: &[Component]) -> String {
    let fitted: usize = observed.iter().map(|stage| stage.components.len()).sum();
    let given = report.model.components().len() - missing.len() - fitted;
    let converged = if report.converged() { "Converged" } else { "NOT converged" };
    let mut said = format!("{converged}: {fitted} of {} curves fitted", report.model.components().len());
    if given > 0 {
        said += &format!(", {given} given");
    }
    if !missing.is_empty() {
        said += &format!(", without a curve: {}", list(missing));
    }
    said + "."
}

fn good(report: &FitReport) -> String {
    let sequences = report.sequences();
    let worst = |value: &dyn Fn(&SequenceReport) -> Option<f64>| {
        let valued = sequences.iter().filter_map(|(_, sequence)| {
            Some((&sequence.name[..], value(sequence).filter(|value| value.is_finite())?))
        });
        valued.max_by(|a, b| a.1.total_cmp(&b.1))
    };
    let force = worst(&|sequence| Some(sequence.force_rms? / sequence.force_largest))
        .map(|(name, share)| format!("forces {:.2} % of the largest ({name})", 100.0 * share));
    let shape = worst(&|sequence| sequence.position_rms)
        .map(|(name, far)| format!("shapes {:.2} mm ({name})", 1e3 * far));
    match [force, shape].into_iter().flatten().collect::<Vec<_>>().join(", ") {
        said if said.is_empty() => "Nothing was compared.".into(),
        said => format!("Worst rms residuals: {said}."),
    }
}

fn sure(observed: &[&StageReport]) -> String {
    let known = |stage: &StageReport| stage.curve.samples.last().and_then(half_band);
    let banded = observed.iter().filter_map(|stage| Some((stage.name(), known(stage)?)));
    let widest = banded.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(name, half)| {
        format!(
            "At the ends of the observed ranges, curves are known to ± {:.1} % (95 %) or better; {name} is the least certain.",
            100.0 * half
        )
    });
    let unknown = list(observed.iter().filter(|stage| known(stage).is_none()).map(|stage| stage.name()));
    let unknown = (!unknown.is_empty()).then(|| format!("Uncertainty not known: {unknown}."));
    match [widest, unknown].into_iter().flatten().collect::<Vec<_>>().join(" ") {
        said if said.is_empty() => "No curve was fitted.".into(),
        said => said,
    }
}

fn next(report: &FitReport, observed: &[&StageReport], missing: &[Component]) -> String {
    let failed =
        |component: &Component| report.failures.iter().any(|failure| failure.components.contains(component));
    // If a test exists but does not determine the curve, the same test is not suggested again.
    let unseen =
        list(missing.iter().filter(|component| report.stage(**component).is_none() && !failed(component)));
    let untold = list(missing.iter().filter(|component| report.stage(**component).is_some()));
    let widest = observed.iter().filter_map(|stage| Some((stage, widest_band(stage)?)));
    let widest = widest.max_by(|a, b| a.1.1.total_cmp(&b.1.1));
    let frames = widest.map(|(stage, (place, _))| {
        let place = match stage.components[0].is_bending() {
            true => format!("a curvature of {place:.0} 1/m"),
            false => format!("a strain of {place:.3}"),
        };
        format!("more frames of {} near {place}", stage.name())
    });
    let unseen = (!unseen.is_empty()).then(|| format!("a test that observes {unseen}"));
    let untold = (!untold.is_empty()).then(|| format!("other frames, or another model, for {untold}"));
    match [unseen, untold, frames].into_iter().flatten().collect::<Vec<_>>().join(", then ") {
        said if said.is_empty() => "No measurement to suggest.".into(),
        said => format!("Most informative next: {said}."),
    }
}
