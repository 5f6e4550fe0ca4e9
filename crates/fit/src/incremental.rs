//! The incremental fit: stage after stage, each with what the ones before have found.
//!
//! ```text
//! stretch weft ‖ warp ──▶ shear ──▶ bend weft ‖ warp ──▶ bend diagonal ──▶ once more over shear and bending
//! ```
//!
//! A set that lacks a sequence is fitted as far as it goes; what nobody measured is assumed, and the report says so.
//!
//! Source: Miguel et al. 2012, §5.2.

use crate::stage::Level;
use crate::stage::knowledge::Knowledge;
use crate::stage::report::{Basis, SequenceReport, StageReport};
use crate::stage::{self, Plan, Settings, Variant, Watch, bend, shear, stretch};
use cloth_data::error::Result;
use cloth_data::frame::{Kind, MeasurementSet};
use cloth_data::inspection::inspect;
use cloth_data::notice::Notice;
use cloth_sim::material::{Component, Curves, Model};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A stage of the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Weft and warp stretch.
    Stretch,
    /// Shear.
    Shear,
    /// Weft, warp and diagonal bending.
    Bend,
}

impl Stage {
    /// All stages, in order.
    pub const ALL: [Self; 3] = [Self::Stretch, Self::Shear, Self::Bend];

    /// The components it fits.
    pub fn components(self) -> &'static [Component] {
        match self {
            Self::Stretch => &[Component::StretchWeft, Component::StretchWarp],
            Self::Shear => &[Component::Shear],
            Self::Bend => &[Component::BendWeft, Component::BendWarp, Component::BendDiagonal],
        }
    }

    /// The tests that show it.
    pub fn kinds(self) -> Vec<Kind> {
        stage::kinds_of_all(self.components())
    }
}

/// Result of a fit of several stages.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct FitReport {
    /// The cloth model.
    pub model: Model,
    /// Which of its freedoms were used.
    pub variant: Variant,
    /// Every stage in the order it ran; of a component that was fitted twice, both.
    pub stages: Vec<StageReport>,
    /// Stages that failed; the others stand.
    pub failures: Vec<FailedStage>,
    /// Contradictions within the measurements.
    pub notices: Vec<Notice>,
    /// All known curves: those given and those observed.
    pub knowledge: Knowledge,
}

/// A stage that came to nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct FailedStage {
    /// Component that it was to fit.
    pub components: Vec<Component>,
    /// First or second pass over them; where a second failed the first still counts.
    pub pass: usize,
    /// Why.
    pub reason: String,
}

impl FailedStage {
    /// As a sentence.
    pub fn in_words(&self) -> String {
        let names: Vec<String> = self.components.iter().map(|component| component.to_string()).collect();
        let pass = if self.pass > 1 { ", second pass" } else { "" };
        format!("{}{pass} failed: {}", names.join(" = "), self.reason)
    }
}

impl FitReport {
    /// Components that no sequence shows, or not well enough.
    pub fn missing(&self) -> Vec<Component> {
        self.model.components().into_iter().filter(|&component| !self.knowledge.knows(component)).collect()
    }

    /// The last stage over a component; `None` if no sequence shows it.
    pub fn stage(&self, component: Component) -> Option<&StageReport> {
        self.stages.iter().rev().find(|stage| stage.components.contains(&component))
    }

    /// The stages that count: of two passes over a component the last.
    pub fn last_stages(&self) -> impl Iterator<Item = &StageReport> {
        let last = |stage: &&StageReport| {
            let of_component = stage.components.first().and_then(|&component| self.stage(component));
            of_component.is_some_and(|last| std::ptr::eq(last, *stage))
        };
        self.stages.iter().filter(last)
    }

    /// Final residuals of each sequence, from the stage fitted to it.
    pub fn sequences(&self) -> Vec<(&StageReport, &SequenceReport)> {
        let mut last: Vec<(&StageReport, &SequenceReport)> = Vec::new();
        // The diagonal's stage, which comes later, only borrows those of weft and warp.
        for stage in self.last_stages() {
            for sequence in &stage.sequences {
                if !last.iter().any(|(_, known)| known.name == sequence.name) {
                    last.push((stage, sequence));
                }
            }
        }
        last
    }

    /// The residual after every step tried for a stage's curve, over all passes and numbers of control points, N or m.
    pub fn course(&self, stage: &StageReport) -> Vec<f64> {
        let passes = self.stages.iter().filter(|pass| pass.components == stage.components);
        passes.flat_map(|pass| &pass.levels).flat_map(Level::course).collect()
    }

    /// The curves that were observed or given.
    pub fn curves(&self) -> &Curves {
        self.knowledge.curves()
    }

    /// The stiffnesses that were assumed of what nobody measured: [`Basis::all_assumed`].
    pub fn assumed(&self) -> BTreeMap<Component, f64> {
        Basis::all_assumed(|component| self.stage(component).map(|stage| &stage.basis))
    }

    /// Every curve that was observed came to its minimum.
    pub fn converged(&self) -> bool {
        let done = |stage: &StageReport| stage.converged || !stage.curve.observed;
        self.failures.is_empty() && self.last_stages().all(done)
    }
}

/// A stage that is done, and what is known after it: all that a fit needs to go on from there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finished {
    /// The stage.
    pub stage: StageReport,
    /// Curves given, and those observed by this stage and the ones before it.
    pub knowledge: Knowledge,
}

/// Keeps a stage.
pub type Keep<'a> = dyn FnMut(&Finished) -> Result<()> + 'a;

/// Keeps the finished stages of a fit that may be interrupted.
pub struct Memory<'a> {
    /// Those of a former run on the same set with the same settings; of other models and variants too.
    pub finished: Vec<Finished>,
    /// Is given every stage that is fitted now; its error ends the fit.
    pub keep: Box<Keep<'a>>,
}

impl Default for Memory<'_> {
    /// None.
    fn default() -> Self {
        Self { finished: Vec::new(), keep: Box::new(|_| Ok(())) }
    }
}

impl Memory<'_> {
    fn recall(&self, plan: &Plan, settings: &Settings) -> Option<&Finished> {
        let is_same = |stage: &StageReport| {
            (&stage.components, stage.pass) == (&plan.fitted, plan.pass)
                && (stage.model, stage.variant) == (settings.model, settings.variant)
        };
        self.finished.iter().find(|finished| is_same(&finished.stage))
    }
}

/// Fits the wanted stages of a set in order, from what is known; curves that are known are not fitted.
///
/// # Errors
/// As [`stage::fit`], where no stage comes to anything; if another does, what failed stands in the report.
pub fn fit(
    set: &MeasurementSet,
    wanted: &[Stage],
    known: &Knowledge,
    settings: &Settings,
    watch: &mut Watch<'_>,
) -> Result<FitReport> {
    resume(set, wanted, known, settings, &mut Memory::default(), watch)
}

/// As [`fit`], except that finished stages are taken from memory; the report equals that of an uninterrupted run to the bit.
/// A failed stage is tried again.
///
/// # Errors
/// As [`fit`], and those of [`Memory::keep`].
pub fn resume(
    set: &MeasurementSet,
    wanted: &[Stage],
    known: &Knowledge,
    settings: &Settings,
    memory: &mut Memory<'_>,
    watch: &mut Watch<'_>,
) -> Result<FitReport> {
    let inspection = inspect(set);
    // What is noticed of other tests is no matter of these curves.
    let kinds: Vec<Kind> = wanted.iter().flat_map(|stage| stage.kinds()).collect();
    let of_kind = |name: &str| set.sequences.iter().any(|s| s.name == name && kinds.contains(&s.kind));
    let notices = inspection.notices.iter().filter(|notice| of_kind(&notice.sequence)).cloned().collect();
    let set = &inspection.set;
    let mut report = FitReport {
        model: settings.model,
        variant: settings.variant,
        stages: Vec::new(),
        failures: Vec::new(),
        notices,
        knowledge: known.clone(),
    };
    let mut first_error = None;
    for plan in plans(wanted, settings.variant) {
        if plan.fitted.iter().all(|&component| known.knows(component)) {
            continue;
        }
        // What the first pass could not see, a second does not either.
        if plan.pass > 1 && !report.knowledge.knows(plan.fitted[0]) {
            continue;
        }
        if let Some(Finished { stage, knowledge }) = memory.recall(&plan, settings) {
            report.stages.push(stage.clone());
            report.knowledge = knowledge.clone();
            continue;
        }
        let fitted = match stage::fit(set, &plan, &mut report.knowledge, settings, watch) {
            // The sequence that shows it may have been refused.
            Ok(None) if plan.pass == 1 => inspection.check_refusals(&plan.kinds).map(|()| None),
            fitted => fitted,
        };
        match fitted {
            Ok(None) => {}
            Ok(Some(stage)) => {
                let finished = Finished { stage, knowledge: report.knowledge.clone() };
                (memory.keep)(&finished)?;
                report.stages.push(finished.stage);
            }
            Err(error) => {
                let (components, pass, reason) = (plan.fitted, plan.pass, error.to_string());
                report.failures.push(FailedStage { components, pass, reason });
                first_error.get_or_insert(error);
            }
        }
    }
    match first_error {
        Some(error) if report.stages.is_empty() => Err(error),
        _ => Ok(report),
    }
}

/// Stages, in order.
fn plans(wanted: &[Stage], variant: Variant) -> Vec<Plan> {
    let pair = |a, b| if variant.is_isotropic() { vec![vec![a, b]] } else { vec![vec![a], vec![b]] };
    let stretches = pair(Component::StretchWeft, Component::StretchWarp);
    let mut bends = pair(Component::BendWeft, Component::BendWarp);
    bends.push(vec![Component::BendDiagonal]);
    let wants = |stage| wanted.contains(&stage);
    let mut plans = Vec::new();
    if wants(Stage::Stretch) {
        plans.extend(stretches.iter().map(|components| stretch::plan(components)));
    }
    for pass in [1, 2] {
        if wants(Stage::Shear) {
            plans.push(shear::plan(pass));
        }
        if wants(Stage::Bend) {
            plans.extend(bends.iter().map(|components| bend::plan(components, pass)));
        }
    }
    plans
}
