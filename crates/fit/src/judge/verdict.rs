//! Grades a fitted curve by its uncertainty and its residuals, not by convergence.
//!
//! ```text
//!                                          green      amber      red
//! 95 % band / largest stress, at its widest   ≤ 10 %     ≤ 30 %     above, or unknown
//! rms residual / largest force or overhang    ≤  5 %     ≤ 15 %     above
//! contradictions, assumptions that matter     none       any
//! ```
//!
//! Two laboratories differ by 15–25 % on one fabric (Cao et al. 2008): a tenth is good, a third is poor.

use crate::incremental::FitReport;
use crate::stage::report::{CurveRow, SequenceReport, StageReport};
use cloth_data::notice::{Notice, Severity};
use cloth_sim::material::Component;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Trust in a curve, or in a whole fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Grade {
    /// Reliable within its band.
    Green,
    /// Reliable with the stated reservation.
    Amber,
    /// Not reliable without another measurement.
    Red,
}

impl fmt::Display for Grade {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Green => "green",
            Self::Amber => "AMBER",
            Self::Red => "RED",
        })
    }
}

/// A grade, and each reason why it is not green.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Verdict {
    /// The worst grade of all reasons; green without any.
    pub grade: Grade,
    /// Reasons as clauses, the worst first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reasons: Vec<String>,
}

impl Verdict {
    fn of(mut reasons: Vec<(Grade, String)>) -> Self {
        reasons.sort_by_key(|(grade, _)| std::cmp::Reverse(*grade));
        let grade = reasons.first().map_or(Grade::Green, |(grade, _)| *grade);
        Self { grade, reasons: reasons.into_iter().map(|(_, reason)| reason).collect() }
    }
}

/// Upper limits of band and residual, as shares, for green and amber.
const BAND: [f64; 2] = [0.1, 0.3];
const RESIDUAL: [f64; 2] = [0.05, 0.15];
/// One or two frames agree with almost any curve.
const FEWEST: usize = 3;
/// More frames without an equilibrium than this share are no accident.
const DROPPED: f64 = 0.25;

fn grade(share: f64, [green, amber]: [f64; 2]) -> Grade {
    // Ordered so that NaN is red.
    if share <= green {
        Grade::Green
    } else if share <= amber {
        Grade::Amber
    } else {
        Grade::Red
    }
}

/// Judges the curve of a stage.
///
/// * `notices` — notices on the measurements
pub fn of_stage(stage: &StageReport, notices: &[Notice]) -> Verdict {
    let doubted = |notice: &&Notice| {
        notice.severity == Severity::Doubt && stage.sequences.iter().any(|s| s.name == notice.sequence)
    };
    let mut reasons: Vec<(Grade, String)> =
        notices.iter().filter(doubted).map(|notice| (Grade::Amber, notice.to_string())).collect();
    if !stage.curve.observed {
        reasons.push((Grade::Red, "the measurements do not determine it".into()));
        return Verdict::of(reasons);
    }
    reasons.extend(unsure(stage));
    reasons.extend(stage.sequences.iter().filter_map(far_off));
    reasons.extend(assumed(stage));
    let odd = stage.sequences.iter().filter(|sequence| !sequence.outliers.is_empty());
    reasons.extend(odd.map(|sequence| {
        let frames: Vec<String> = sequence.outliers.iter().take(4).map(usize::to_string).collect();
        (
            Grade::Amber,
            format!("frame {} of {} stands out from its neighbours", frames.join(", "), sequence.name),
        )
    }));
    let used: usize = stage.sequences.iter().map(|sequence| sequence.frames).sum();
    let dropped = stage.dropped.len() as f64 / (stage.dropped.len() + used).max(1) as f64;
    if dropped > DROPPED {
        let found = format!("{:.0} % of its frames have no equilibrium", 100.0 * dropped);
        reasons.push((Grade::Amber, found));
    }
    if let Some(given) = stage.scatter.contradicted {
        let ratio = stage.scatter.noise / given;
        let found = format!(
            "the measurements scatter {ratio:.2} times as much as the given noise: the band follows the \
             measurements; check noise in test.toml"
        );
        reasons.push((Grade::Amber, found));
    }
    if stage.scatter.noise_is_overstated() {
        let found = "the residual is below the given noise, which may be too large";
        reasons.push((Grade::Amber, found.into()));
    }
    if used > 0 && used < FEWEST {
        reasons.push((
            Grade::Amber,
            format!("only {used} of the {FEWEST} frames needed to reveal a contradiction"),
        ));
    }
    if !stage.converged {
        reasons.push((Grade::Amber, "the fit did not converge".into()));
    }
    Verdict::of(reasons)
}

/// Grades a fit by its worst curve; a failure or a refusal is at least amber.
pub fn of_fit(report: &FitReport) -> Verdict {
    let mut reasons: Vec<(Grade, String)> = Vec::new();
    for stage in report.last_stages() {
        let Verdict { grade, reasons: why } = of_stage(stage, &report.notices);
        if grade > Grade::Green {
            reasons.push((grade, format!("{}: {}", stage.name(), why.join("; "))));
        }
    }
    reasons.extend(report.failures.iter().map(|failure| (Grade::Red, failure.in_words())));
    // Skips refusals that a failed stage already reports.
    let refused = report.notices.iter().filter(|notice| notice.severity == Severity::Refusal);
    let told = |said: &String| report.failures.iter().any(|failure| failure.reason == *said);
    let left_out = refused.map(Notice::to_string).filter(|said| !told(said));
    reasons.extend(left_out.map(|said| (Grade::Amber, said)));
    if reasons.is_empty() && report.stages.is_empty() {
        reasons.push((Grade::Red, "nothing was fitted".into()));
    }
    Verdict::of(reasons)
}

/// Strain at which the band is widest, and half its width as a share of the curve's largest stress.
pub fn widest_band(stage: &StageReport) -> Option<(f64, f64)> {
    let samples = &stage.curve.samples;
    let largest = stage.curve.largest_stress();
    let widths = samples.iter().filter_map(|sample| {
        let [low, high] = sample.band?;
        Some((sample.strain, 0.5 * (high - low) / largest))
    });
    widths.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Reason: a wide band, or no band where the curve was observed.
fn unsure(stage: &StageReport) -> Option<(Grade, String)> {
    let seen = |sample: &&CurveRow| sample.strain >= stage.curve.seen[0] && sample.strain != 0.0;
    let widest =
        widest_band(stage).filter(|_| stage.curve.samples.iter().filter(seen).all(|s| s.band.is_some()));
    let Some((place, share)) = widest else {
        return Some((Grade::Red, "its uncertainty is not known over all of its range".into()));
    };
    let grade = grade(share, BAND);
    let (quantity, at) = match stage.components[0].is_bending() {
        true => ("moment", format!("{place:.1} 1/m")),
        false => ("stress", format!("{place:.4}")),
    };
    let said = format!("known only to ± {:.1} % of its largest {quantity}, at {at}", 100.0 * share);
    (grade > Grade::Green).then_some((grade, said))
}

/// Reason: a sequence that the curve misses.
fn far_off(sequence: &SequenceReport) -> Option<(Grade, String)> {
    let name = &sequence.name;
    let (share, of) = match (sequence.force_rms, sequence.position_rms) {
        (Some(rms), _) => (rms / sequence.force_largest, "forces"),
        (None, Some(rms)) => (rms / sequence.extension, "shapes"),
        (None, None) => return None,
    };
    let grade = grade(share, RESIDUAL);
    let whole = if of == "forces" { "largest" } else { "overhang" };
    let said = format!("misses the {of} of {name} by {:.1} % of the {whole}", 100.0 * share);
    (grade > Grade::Green).then_some((grade, said))
}

/// Reason: an assumed curve that shear depends on, bending of a sheet that may buckle, else stretch of its yarns; or the
/// shear by which a sheet cut on the bias lengthens.
fn assumed(stage: &StageReport) -> Option<(Grade, String)> {
    let names = |is_meant: &dyn Fn(Component) -> bool| {
        let meant = stage.basis.assumed.iter().filter(|&&component| is_meant(component));
        meant.map(|component| component.to_string()).collect::<Vec<_>>().join(", ")
    };
    if stage.components == [Component::BendDiagonal] && stage.basis.assumed.contains(&Component::Shear) {
        let said = "a sheet cut on the bias lengthens under its weight by its shear, which is assumed nearly inextensible: a \
                    soft fabric comes out wrong; a shear test (fit) would settle it";
        return Some((Grade::Amber, said.into()));
    }
    if stage.components != [Component::Shear] {
        return None;
    }
    let bends = names(&Component::is_bending);
    if !bends.is_empty() {
        let said = format!(
            "the sheet may buckle and its bending is assumed ({bends}): the band includes the case of a flat \
             sheet; bending tests (fit) would narrow it"
        );
        return Some((Grade::Amber, said));
    }
    let stretches = names(&Component::is_stretch);
    (!stretches.is_empty()).then(|| {
        let said = format!(
            "nearly inextensible yarns are assumed ({stretches}): if they stretch, the fitted shear is too \
             soft; stretch tests would settle it"
        );
        (Grade::Amber, said)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_graded_and_no_number_is_red() {
        let grades = [0.0, 0.1, 0.11, 0.3, 0.31, f64::INFINITY, f64::NAN].map(|share| grade(share, BAND));
        use Grade::{Amber, Green, Red};
        assert_eq!(grades, [Green, Green, Amber, Amber, Red, Red, Red]);
    }

    #[test]
    fn the_worst_reason_comes_first_and_decides() {
        let verdict = Verdict::of(vec![(Grade::Amber, "a".into()), (Grade::Red, "b".into())]);
        assert_eq!((verdict.grade, &verdict.reasons[..]), (Grade::Red, &["b".to_string(), "a".into()][..]));
        assert_eq!(Verdict::of(Vec::new()).grade, Grade::Green);
    }
}
