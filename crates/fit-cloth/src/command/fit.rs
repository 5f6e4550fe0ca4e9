//! `fit-cloth stretch | shear | bend | fit`: curves from a measurement set.

use super::{Outcome, warn};
use crate::failure::Failure;
use crate::options::{FitFlags, Telling, is_inside};
use crate::plot::write_plots;
use crate::progress::Progress;
use crate::text;
use cloth_fit::error::Error;
use cloth_fit::frame::{Kind, MeasurementSet};
use cloth_fit::incremental::{self, FitReport, Stage};
use cloth_fit::knowledge::Knowledge;
use cloth_fit::material_file::MaterialFile;
use cloth_fit::result::write_result;
use cloth_fit::stage::Settings;
use cloth_fit::store::replace_folder;
use cloth_sim::material::Component;
use serde_json::{Map, Value};
use std::io::Write;
use std::path::Path;

/// The example of `fit-cloth stretch`.
pub const STRETCH_EXAMPLE: &str = "\
Example:
  fit-cloth stretch fixtures/cotton-denim --out out
  fit-cloth stretch fixtures/cotton-denim --model all --nodes 13x13 --out out

Writes material.json, curves/*.csv, residuals.csv, forces.csv and plots/*.svg; with --model all, a folder for each model.";

/// The example of `fit-cloth shear`.
pub const SHEAR_EXAMPLE: &str = "\
Example:
  fit-cloth shear fixtures/cotton-denim --out out

Uses sequences of kind shear and stretch-bias; without them only the stretch curves are fitted, and a warning says so.
With --known FILE the stretch curves of a former fit are taken from its material.json.";

/// The example of `fit-cloth bend`.
pub const BEND_EXAMPLE: &str = "\
Example:
  fit-cloth bend fixtures/cotton-denim --out out

Uses sequences of kind bend-weft, bend-warp and bend-bias; what a set lacks is not fitted, and a warning says so.
With --known FILE the stretch and shear curves of a former fit are taken from its material.json.";

/// The example of `fit-cloth fit`.
pub const FIT_EXAMPLE: &str = "\
Example:
  fit-cloth fit fixtures/cotton-denim --out out
  fit-cloth fit fixtures/cotton-denim --variant isotropic --robust --verbose --out out

Fits stretch, shear and bending in this order, then shear and bending once more. What a set lacks is not fitted, and a
warning says so.";

/// What a command is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Goal {
    /// Stretch.
    Stretch,
    /// Shear, and what it builds on.
    Shear,
    /// Bending, and what it builds on.
    Bend,
    /// All that is not given.
    All,
}

impl Goal {
    fn stages(self) -> &'static [Stage] {
        match self {
            Self::Stretch => &Stage::ALL[..1],
            Self::Shear => &Stage::ALL[..2],
            Self::Bend | Self::All => &Stage::ALL,
        }
    }

    /// What is fitted even if it is given.
    fn anew(self) -> &'static [Component] {
        match self {
            Self::Stretch => Stage::Stretch.components(),
            Self::Shear => Stage::Shear.components(),
            Self::Bend => Stage::Bend.components(),
            Self::All => &[],
        }
    }

    fn components(self) -> impl Iterator<Item = Component> {
        self.stages().iter().flat_map(|stage| stage.components()).copied()
    }

    /// The tests that show what is not known.
    fn kinds(self, known: &Knowledge) -> Vec<Kind> {
        let fits = |stage: &&Stage| !stage.components().iter().all(|&component| known.knows(component));
        self.stages().iter().filter(fits).flat_map(|stage| stage.kinds()).copied().collect()
    }
}

/// What one model's fit has found.
struct Fitted {
    report: FitReport,
    material: MaterialFile,
}

/// Fits what the command is about, and what that builds on.
///
/// # Errors
/// Bad input, nothing to fit, or an output folder that is no former result; what the operating system refuses.
pub fn run(
    goal: Goal,
    flags: &FitFlags,
    telling: Telling,
    output: &mut impl Write,
) -> Result<Outcome, Failure> {
    let (set, folder) = flags.on.open()?;
    let all_settings: Vec<Settings> =
        flags.model.models().into_iter().map(|model| flags.settings(model)).collect();
    let given = flags.known.as_deref().map(|path| read_known(path, &folder, &all_settings)).transpose()?;
    let mut results = Vec::new();
    for settings in &all_settings {
        let known = match &given {
            Some(file) => Knowledge::exact(file.curves()?).without(goal.anew()),
            None => Knowledge::default(),
        };
        let progress = Progress::new(&settings.model.to_string(), !telling.quiet);
        let report = incremental::fit(&set, goal.stages(), &known, settings, &mut progress.watch())?;
        progress.finish();
        if report.stages.is_empty() {
            return Err(nothing(&flags.on.set, &set, &goal.kinds(&known)));
        }
        let material = MaterialFile::new(&set, settings, &report, given.as_ref());
        results.push(Fitted { report, material });
    }
    write(&folder, &results)?;
    // All is on disk before the first word: a reader who has read enough must not cost the result.
    for Fitted { report, .. } in &results {
        for missing in goal.components().filter_map(|component| text::missing(report, component)) {
            warn(telling, &format!("{}: {missing}", report.model));
        }
    }
    if telling.json {
        writeln!(output, "{}", json(&results))?;
    } else if !telling.quiet {
        for fitted in &results {
            tell_model(goal, &set, &fitted.report, telling, output)?;
        }
        writeln!(output, "Written to {}", folder.display())?;
    }
    let converged = results.iter().all(|fitted| fitted.report.converged());
    Ok(if converged { Outcome::Done } else { Outcome::NotConverged })
}

/// The given curves; they must be over the strains of the model that is fitted, and must outlive the fit.
fn read_known(path: &Path, folder: &Path, all_settings: &[Settings]) -> Result<MaterialFile, Failure> {
    if is_inside(path, folder) {
        let found = format!("a file in {}, which will be replaced", folder.display());
        return Err(Error::input(path, None, "--known", found, "another --out").into());
    }
    let file = MaterialFile::read(path)?;
    for settings in all_settings {
        if file.model != settings.model {
            let (found, expected) = (file.model.to_string(), format!("{}, as --model says", settings.model));
            return Err(Error::input(path, None, "model", found, expected).into());
        }
        if file.compression != settings.compression {
            let found = format!("{:?}", file.compression);
            return Err(Error::input(path, None, "compression", found, "the same as --compression").into());
        }
    }
    Ok(file)
}

/// No sequence of a set is of the kinds that are wanted.
pub(super) fn nothing(path: &Path, set: &MeasurementSet, kinds: &[Kind]) -> Failure {
    let names =
        |kinds: &mut dyn Iterator<Item = Kind>| kinds.map(|kind| kind.to_string()).collect::<Vec<_>>();
    let found = match set.sequences.len() {
        0 => "no sequence at all".to_string(),
        _ => names(&mut set.sequences.iter().map(|sequence| sequence.kind)).join(", "),
    };
    let expected = match names(&mut kinds.iter().copied()).join(" or ") {
        kinds if kinds.is_empty() => "a --known file that lacks a curve".into(),
        kinds => format!("a sequence of kind {kinds}"),
    };
    Error::input(path, None, "kind", found, expected).into()
}

fn write(folder: &Path, results: &[Fitted]) -> Result<(), Failure> {
    replace_folder(folder, |temporary| {
        results.iter().try_for_each(|Fitted { report, material }| {
            let folder = match results.len() {
                1 => temporary.to_path_buf(),
                _ => temporary.join(report.model.to_string()),
            };
            write_result(&folder, report, material)?;
            write_plots(&folder, report)
        })
    })?;
    Ok(())
}

/// Each model's `material.json` under its name.
fn json(results: &[Fitted]) -> Value {
    let entry = |Fitted { report, material }: &Fitted| {
        (report.model.to_string(), serde_json::to_value(material).unwrap_or(Value::Null))
    };
    Value::Object(results.iter().map(entry).collect::<Map<_, _>>())
}

/// What one model's fit has found, for a person.
fn tell_model(
    goal: Goal,
    set: &MeasurementSet,
    report: &FitReport,
    telling: Telling,
    output: &mut impl Write,
) -> Result<(), Failure> {
    let told: Vec<_> = match telling.verbose {
        true => report.stages.iter().collect(),
        false => report.last_stages().collect(),
    };
    for stage in told {
        writeln!(output, "{}", text::stage(stage, telling.verbose))?;
    }
    for missing in goal.components().filter_map(|component| text::missing(report, component)) {
        writeln!(output, "{missing}\n")?;
    }
    let used = report.sequences();
    for sequence in set.sequences.iter().filter(|s| !used.iter().any(|(_, used)| used.name == s.name)) {
        writeln!(output, "{} ({}) takes no part in this fit\n", sequence.name, sequence.kind)?;
    }
    writeln!(output, "{}", text::residuals(report))?;
    for stage in report.last_stages() {
        writeln!(output, "{}", text::verdict(stage))?;
    }
    writeln!(output)?;
    if goal == Goal::All {
        writeln!(output, "{}", text::summary(report))?;
    }
    Ok(())
}
