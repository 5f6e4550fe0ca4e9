//! `fit-cloth stretch | shear | bend | fit`: fits curves to a measurement set.

use super::goal::Goal;
use super::journal::{program, recalled};
use super::kinds::{has_any, nothing};
use crate::failure::{Failure, with_option};
use crate::options::{FitFlags, STABLE, refuse_within};
use crate::outcome::Outcome;
use crate::output::Output;
use crate::page::{Fit, Frames, Page};
use crate::plot::write_plots;
use crate::printing::{Printing, warn, warn_of_defects};
use crate::progress::Progress;
use crate::text;
use cloth_data::error::Error;
use cloth_data::frame::MeasurementSet;
use cloth_data::inspection::inspect;
use cloth_data::notice::Notice;
use cloth_fit::incremental::{self, FailedStage, Finished, FitReport, Memory};
use cloth_fit::material::check::{check_material, refuse_unstable};
use cloth_fit::material::file::MaterialFile;
use cloth_fit::result::write_result;
use cloth_fit::stage::knowledge::Knowledge;
use cloth_sim::material::{Component, Compression, Model};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;

/// Result of one model's fit.
struct Fitted {
    report: FitReport,
    material: MaterialFile,
}

/// Fits the requested curves and those they depend on. With several models, one that fails loses only its own result.
///
/// # Errors
/// Bad input; nothing to fit; an output folder that is not a previous result; I/O errors.
pub fn run(
    goal: Goal,
    flags: &FitFlags,
    printing: Printing,
    output: &mut impl Write,
) -> Result<Outcome, Failure> {
    let (set, out) = flags.on.open("")?;
    let tests = goal.tests();
    if !tests.is_empty() && !has_any(&set, &tests) {
        let error = nothing(&flags.on.set, &set, &tests);
        return Err(with_option(error, "fit-cloth fit uses all tests of a set").into());
    }
    let inspection = inspect(&set);
    if !has_any(&inspection.set, &tests) {
        inspection.check_refusals(&tests)?;
    }
    let models = flags.model.models();
    let given = flags.known.as_deref().map(|path| read_known(path, out.path(), flags)).transpose()?;
    let finished = recall(goal, &set, flags, given.as_ref(), &out, printing)?;
    let (mut results, mut failures) = (Vec::new(), Vec::new());
    for &model in &models {
        let finished = finished.clone();
        let mut memory = Memory { finished, keep: Box::new(|finished| out.keep(finished)) };
        match fit_model(goal, &set, flags, model, given.as_ref(), &mut memory, printing) {
            Ok(fitted) => results.push(fitted),
            // A full disk affects every model.
            Err(failure) if failure.exit_code() == 1 => return Err(failure),
            Err(failure) => failures.push((model, failure)),
        }
    }
    if results.is_empty() {
        return failures.into_iter().next().map_or(Ok(Outcome::Done), |(_, failure)| Err(failure));
    }
    write(&out, &set, models.len() > 1, !flags.no_report, &results)?;
    // Everything is on disk before the first output: a reader that stops early must not cost the result.
    for (model, failure) in &failures {
        warn(printing, &format!("{model} has no result: {}", failure.in_words()));
    }
    // Notices about the measurements are the same for every model.
    for notice in results.iter().take(1).flat_map(|fitted| &fitted.report.notices) {
        warn(printing, &text::notice(notice));
    }
    for Fitted { report, material } in &results {
        // Given curves are checked, too.
        warn_of_defects(printing, &report.model.to_string(), &check_material(material)?);
        // The reason for refusing a sequence has been printed already.
        let is_said = |failure: &&FailedStage| report.notices.iter().any(|n| n.to_string() == failure.reason);
        for failure in report.failures.iter().filter(|failure| !is_said(failure)) {
            warn(printing, &format!("{}: {}", report.model, failure.in_words()));
        }
        let has_failed =
            |component: &Component| report.failures.iter().any(|f| f.components.contains(component));
        let others = goal.components().filter(|component| !has_failed(component));
        for missing in others.filter_map(|component| text::missing(report, component)) {
            warn(printing, &format!("{}: {missing}", report.model));
        }
    }
    if printing.json {
        writeln!(output, "{}", json(&results, &failures))?;
    } else if !printing.quiet {
        for fitted in &results {
            tell_model(goal, &set, fitted, printing, output)?;
        }
        writeln!(output, "Written to {}", out.path().display())?;
    }
    let converged = failures.is_empty() && results.iter().all(|fitted| fitted.report.converged());
    Ok(if converged { Outcome::Done } else { Outcome::NotConverged })
}

/// Reads the --known curves. They must match the settings of the fit, and the file must lie outside the output folder.
fn read_known(path: &Path, folder: &Path, flags: &FitFlags) -> Result<MaterialFile, Failure> {
    let refuse = |field: &str, found: String, expected: String| {
        Err(Failure::from(Error::input(path, None, field, found, expected)))
    };
    refuse_within("--known", path, folder)?;
    let file = MaterialFile::read(path)?;
    if !flags.allow_unstable {
        refuse_unstable(&file.curves()?, path, STABLE)?;
    }
    for settings in flags.model.models().into_iter().map(|model| flags.settings(model)) {
        if file.model != settings.model {
            let expected =
                format!("{}, as --model says (--model {}, or another --known)", settings.model, file.model);
            return refuse("model", file.model.to_string(), expected);
        }
        if file.provenance.for_mesh_m != settings.for_mesh {
            let of = |side: Option<f64>| {
                side.map_or("the continuum".into(), |side| format!("a mesh with cells of {} mm", 1e3 * side))
            };
            let remedy = match file.provenance.for_mesh_m {
                Some(side) => format!("--for-mesh {}", 1e3 * side),
                None => "no --for-mesh".into(),
            };
            let expected =
                format!("curves of {}, as this fit ({remedy}, or another --known)", of(settings.for_mesh));
            return refuse(
                "provenance.for_mesh_m",
                format!("curves of {}", of(file.provenance.for_mesh_m)),
                expected,
            );
        }
        if settings.variant.is_isotropic() && !file.variant.is_isotropic() {
            let expected = format!(
                "one with shared weft and warp curves, as --variant {} (--variant {}, or another --known)",
                settings.variant, file.variant
            );
            return refuse("variant", file.variant.to_string(), expected);
        }
        if file.compression != settings.compression {
            let [found, asked] =
                [file.compression, settings.compression].map(|compression| match compression {
                    Compression::ZeroStrain => "zero-strain",
                    Compression::None => "none",
                });
            let expected =
                format!("{asked}, as --compression says (--compression {found}, or another --known)");
            return refuse("compression", found.into(), expected);
        }
    }
    Ok(file)
}

/// Stages finished by an earlier, stopped run of the same command.
fn recall(
    goal: Goal,
    set: &MeasurementSet,
    flags: &FitFlags,
    given: Option<&MaterialFile>,
    out: &Output,
    printing: Printing,
) -> Result<Vec<Finished>, Failure> {
    let settings: Vec<String> =
        flags.model.models().into_iter().map(|model| format!("{:?}", flags.settings(model))).collect();
    let key = (program(), "fit", goal.components().collect::<Vec<_>>(), goal.anew(), settings, given, set);
    Ok(recalled(out.recall(&key)?, printing, |Finished { stage, .. }| {
        let pass = if stage.pass > 1 { ", second pass" } else { "" };
        format!("{} {}{pass}", stage.model, stage.name())
    }))
}

fn fit_model(
    goal: Goal,
    set: &MeasurementSet,
    flags: &FitFlags,
    model: Model,
    given: Option<&MaterialFile>,
    memory: &mut Memory<'_>,
    printing: Printing,
) -> Result<Fitted, Failure> {
    let settings = flags.settings(model);
    let known = match given {
        Some(file) => Knowledge::exact(file.curves()?).without(goal.anew()),
        None => Knowledge::default(),
    };
    let progress = Progress::new(&model.to_string(), !printing.quiet);
    let report = incremental::resume(set, goal.stages(), &known, &settings, memory, &mut progress.watch());
    progress.finish();
    let mut report = report?;
    if let Some(file) = given.filter(|file| file.fabric.name != set.fabric.name) {
        doubt_known(&mut report, &file.fabric.name, &set.fabric.name);
    }
    if report.stages.is_empty() {
        return Err(nothing(&flags.on.set, set, &goal.kinds(&known)).into());
    }
    let material = MaterialFile::new(set, &settings, &report, given);
    Ok(Fitted { report, material })
}

/// Adds a notice to every fitted sequence if the known curves belong to another fabric.
fn doubt_known(report: &mut FitReport, known: &str, fabric: &str) {
    let names: BTreeSet<&String> = report.sequences().iter().map(|(_, sequence)| &sequence.name).collect();
    let notice = |name: &String| {
        Notice::doubt(
            name,
            "--known",
            format!("curves of {known}, taken as exact"),
            format!("curves of {fabric}, which was measured"),
        )
    };
    let notices: Vec<Notice> = names.into_iter().map(notice).collect();
    report.notices.extend(notices);
}

/// * `several` — several models: a folder for each, and one page for all
/// * `paged` — write the page
fn write(
    out: &Output,
    set: &MeasurementSet,
    several: bool,
    paged: bool,
    results: &[Fitted],
) -> Result<(), Failure> {
    out.replace(|temporary| {
        for Fitted { report, material } in results {
            let folder = match several {
                true => temporary.join(report.model.to_string()),
                false => temporary.to_path_buf(),
            };
            write_result(&folder, report, material)?;
            write_plots(&folder, set, report)?;
        }
        if paged {
            let fit = |Fitted { report, material }: &Fitted| {
                Fit::new(set, report, None, Frames::Shown).for_mesh(material.provenance.for_mesh_m)
            };
            Page::new(&set.fabric.name, results.iter().map(fit).collect(), None).write(temporary)?;
        }
        Ok(())
    })?;
    Ok(())
}

/// Each model's `material.json` under its name, or the reason for its failure.
fn json(results: &[Fitted], failures: &[(Model, Failure)]) -> Value {
    let fitted = results.iter().map(|Fitted { report, material }| {
        (report.model.to_string(), serde_json::to_value(material).unwrap_or(Value::Null))
    });
    let failed =
        failures.iter().map(|(model, failure)| (model.to_string(), json!({ "failure": failure.in_words() })));
    Value::Object(fitted.chain(failed).collect::<Map<_, _>>())
}

/// Prints one model's fit as text.
fn tell_model(
    goal: Goal,
    set: &MeasurementSet,
    Fitted { report, material }: &Fitted,
    printing: Printing,
    output: &mut impl Write,
) -> Result<(), Failure> {
    if material.provenance.as_published {
        writeln!(output, "{}\n", text::as_published(report))?;
    }
    if let Some(side) = material.provenance.for_mesh_m {
        writeln!(output, "{}\n", text::for_mesh(side))?;
    }
    let told: Vec<_> = match printing.verbose {
        true => report.stages.iter().collect(),
        false => report.last_stages().collect(),
    };
    for stage in told {
        writeln!(output, "{}", text::stage(stage, printing.verbose))?;
    }
    for missing in goal.components().filter_map(|component| text::missing(report, component)) {
        writeln!(output, "{missing}\n")?;
    }
    for failure in &report.failures {
        writeln!(output, "{}\n", failure.in_words())?;
    }
    let used = report.sequences();
    for sequence in set.sequences.iter().filter(|s| !used.iter().any(|(_, used)| used.name == s.name)) {
        writeln!(output, "{} ({}) is not used in this fit\n", sequence.name, sequence.kind)?;
    }
    writeln!(output, "{}", text::residuals(report))?;
    for stage in report.last_stages() {
        writeln!(output, "{}", text::verdict(stage, &report.notices))?;
    }
    writeln!(output, "\n{}", text::verdict_of_fit(report))?;
    writeln!(output)?;
    if goal == Goal::All {
        writeln!(output, "{}", text::summary(report))?;
    }
    Ok(())
}
