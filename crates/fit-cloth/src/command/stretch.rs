//! `fit-cloth stretch`: weft and warp stretch curves from a measurement set.

use super::Outcome;
use crate::failure::Failure;
use crate::options::{FitFlags, Telling};
use crate::plot::write_plots;
use crate::progress::Progress;
use crate::text;
use clap::Args;
use cloth_fit::error::Error;
use cloth_fit::frame::{Kind, MeasurementSet};
use cloth_fit::io::read_set;
use cloth_fit::material_file::MaterialFile;
use cloth_fit::report::StageReport;
use cloth_fit::result::{check_output, write_result};
use cloth_fit::stage::{Settings, stretch};
use cloth_fit::store::replace_folder;
use cloth_sim::material::{Component, Model};
use serde_json::{Map, Value};
use std::io::Write;
use std::path::Path;

const EXAMPLE: &str = "\
Example:
  fit-cloth stretch fixtures/cotton-denim --out out
  fit-cloth stretch fixtures/cotton-denim --model all --nodes 13x13 --out out

Writes material.json, curves/*.csv, residuals.csv, forces.csv and plots/*.svg; with --model all, a folder for each model.";

/// `fit-cloth stretch`.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXAMPLE)]
pub struct StretchOptions {
    /// How to fit.
    #[command(flatten)]
    pub fit: FitFlags,
}

/// Fits weft and warp.
///
/// # Errors
/// Bad input, nothing to fit, or an output folder that is no former result; what the operating system refuses.
pub fn run(options: &StretchOptions, telling: Telling, output: &mut impl Write) -> Result<Outcome, Failure> {
    let flags = &options.fit;
    let folder = flags.output_folder();
    flags.use_threads()?;
    check_output(&folder)?;
    refuse_inside(&folder, &flags.set)?;
    let set = read_set(&flags.set)?;
    let mut results: Vec<(Settings, Vec<StageReport>)> = Vec::new();
    for model in flags.model.models() {
        let settings = flags.settings(model);
        let stages = fit_model(&set, &flags.set, &settings, telling)?;
        results.push((settings, stages));
    }
    let in_folder = |model: Model, folder: &Path| match results.len() {
        1 => folder.to_path_buf(),
        _ => folder.join(model.to_string()),
    };
    replace_folder(&folder, |temporary| {
        results.iter().try_for_each(|(settings, stages)| {
            let folder = in_folder(settings.model, temporary);
            write_result(&folder, &set, settings, stages)?;
            write_plots(&folder, stages)
        })
    })?;
    // All is on disk before the first word: a reader who has read enough must not cost the result.
    if telling.json {
        let mut models = Map::new();
        for (settings, stages) in &results {
            let file = MaterialFile::new(&set, settings, stages).to_json();
            let value = serde_json::from_str(&file).unwrap_or(Value::Null);
            models.insert(settings.model.to_string(), value);
        }
        writeln!(output, "{}", Value::Object(models))?;
    } else if !telling.quiet {
        for (_, stages) in &results {
            tell_model(&set, stages, output)?;
        }
        writeln!(output, "Written to {}", folder.display())?;
    }
    let converged = results.iter().flat_map(|(_, stages)| stages).all(|stage| stage.converged);
    Ok(if converged { Outcome::Done } else { Outcome::NotConverged })
}

/// A result in the place of its own measurements, or among them, would destroy the set.
fn refuse_inside(folder: &Path, set: &Path) -> Result<(), Failure> {
    let absolute = |path: &Path| path.canonicalize().or_else(|_| std::path::absolute(path));
    match (absolute(folder), absolute(set)) {
        (Ok(out), Ok(measured)) if out.starts_with(&measured) => {
            let found = folder.display().to_string();
            Err(Error::input(set, None, "--out", found, "a folder outside the measurement set").into())
        }
        _ => Ok(()),
    }
}

fn fit_model(
    set: &MeasurementSet,
    path: &Path,
    settings: &Settings,
    telling: Telling,
) -> Result<Vec<StageReport>, Failure> {
    let mut stages = Vec::new();
    for component in COMPONENTS {
        let progress = Progress::new(&format!("{component}, {}", settings.model), !telling.quiet);
        let report = stretch::fit(set, component, settings, &mut progress.watch())?;
        progress.finish();
        stages.extend(report);
    }
    if stages.is_empty() {
        let found = match set.sequences.len() {
            0 => "no sequence at all".to_string(),
            _ => set.sequences.iter().map(|s| s.kind.to_string()).collect::<Vec<_>>().join(", "),
        };
        let expected = "a sequence of kind stretch-weft or stretch-warp";
        return Err(Error::input(path, None, "kind", found, expected).into());
    }
    Ok(stages)
}

/// What one model's fit has found, for a person.
fn tell_model(set: &MeasurementSet, stages: &[StageReport], output: &mut impl Write) -> Result<(), Failure> {
    for stage in stages {
        writeln!(output, "{}\n{}", text::iterations(stage), text::curve(stage))?;
    }
    for component in COMPONENTS {
        if !stages.iter().any(|stage| stage.components.contains(&component)) {
            writeln!(output, "{component}: no sequence shows it; it is not fitted\n")?;
        }
    }
    for sequence in set.sequences.iter().filter(|s| ![Kind::StretchWeft, Kind::StretchWarp].contains(&s.kind))
    {
        writeln!(output, "{} ({}) takes no part in a fit of stretch\n", sequence.name, sequence.kind)?;
    }
    writeln!(output, "{}", text::residuals(stages))?;
    for stage in stages {
        writeln!(output, "{}", text::verdict(stage))?;
    }
    writeln!(output)?;
    Ok(())
}

/// What this command fits.
const COMPONENTS: [Component; 2] = [Component::StretchWeft, Component::StretchWarp];
