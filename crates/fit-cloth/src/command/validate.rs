//! `fit-cloth validate`: tests fitted curves on motions and samples that the fit did not use.

use super::kinds::{has_any, nothing};
use crate::failure::{Failure, with_option};
use crate::options::{SetFlags, parse_kind, refuse_within};
use crate::outcome::Outcome;
use crate::plot::write_validation_plots;
use crate::printing::{Printing, print_result, warn, warn_of_defects};
use crate::progress::Progress;
use crate::text;
use clap::Args;
use cloth_data::error::Error;
use cloth_data::frame::{Kind, MeasurementSet};
use cloth_fit::judge::compare::validation_kinds;
use cloth_fit::judge::validation::validate;
use cloth_fit::material::check::check_material;
use cloth_fit::material::file::MaterialFile;
use cloth_fit::result::write_validation;
use cloth_fit::stage::Settings;
use cloth_sim::material::Curves;
use serde_json::Value;
use std::io::Write;
use std::path::PathBuf;

const EXAMPLE: &str = "\
Example:
  fit-cloth fit fixtures/cotton-denim --out out/fit
  fit-cloth validate fixtures/cotton-denim --material out/fit/material.json --out out/motions

A second sample of the same fabric:
  fit-cloth rig --fabric cotton-denim --sample 2 --sequences complex-shear --out sets/second
  fit-cloth validate sets/second --material out/fit/material.json --all --out out/second

Writes validation.json, validation.csv, measures.csv, forces.csv and plots/*.svg.";

/// `fit-cloth validate`.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXAMPLE)]
pub struct ValidateOptions {
    /// Set, output folder, grid, threads.
    #[command(flatten)]
    pub on: SetFlags,
    /// The material.json whose curves are tested
    #[arg(long, value_name = "FILE")]
    pub material: PathBuf,
    /// Kinds of test to use [default: complex-shear and corner-pull, which no fit uses; all, if a set has neither]
    #[arg(long, value_delimiter = ',', value_parser = parse_any_kind, value_name = "KIND")]
    pub kinds: Vec<Kind>,
    /// Use all tests of the set
    #[arg(long, conflicts_with = "kinds")]
    pub all: bool,
}

/// Simulates the tests with the given curves and compares them with the measurements.
///
/// # Errors
/// Bad input; a set without the requested tests; an output folder that is not a previous result; I/O errors.
pub fn run(
    options: &ValidateOptions,
    printing: Printing,
    output: &mut impl Write,
) -> Result<Outcome, Failure> {
    let (set, out) = options.on.open("-validation")?;
    refuse_within("--material", &options.material, out.path())?;
    let material = MaterialFile::read(&options.material)?;
    let curves = curves(options, &material)?;
    let kinds = options.kinds_of(&set);
    if !has_any(&set, &kinds) {
        return Err(with_option(nothing(&options.on.set, &set, &kinds), "--kinds, --all").into());
    }
    if options.kinds.is_empty() && !options.all && kinds.len() == Kind::ALL.len() {
        let kinds: Vec<&str> =
            Kind::ALL.iter().filter(|kind| kind.shows().is_empty()).map(|kind| kind.name()).collect();
        let taken = format!(
            "using all tests of the set, since it has neither {}: for curves fitted to these tests this is no validation",
            kinds.join(" nor ")
        );
        warn(printing, &taken);
    }
    warn_of_defects(printing, &options.material.display().to_string(), &check_material(&material)?);
    let progress = Progress::new("validating", !printing.quiet);
    let validation =
        validate(&set, &kinds, &curves, &material.assumed(), &options.settings(&material), &progress.watch());
    progress.finish();
    let validation = validation?;
    let mut json = String::new();
    out.replace(|temporary| {
        json = write_validation(temporary, &set, &material, &validation)?;
        write_validation_plots(temporary, &set, material.model, &validation)
    })?;
    let text = text::validation(&set, &material, &validation);
    let text = format!("{text}\nWritten to {}", out.path().display());
    for notice in &validation.prediction.notices {
        warn(printing, &text::notice(notice));
    }
    if let Some(warning) = text::other_grid(&material, &validation, options.on.nodes.is_some()) {
        warn(printing, &warning);
    }
    print_result(printing, output, &text, &serde_json::from_str(&json).unwrap_or(Value::Null))?;
    Ok(if validation.lost().is_empty() { Outcome::Done } else { Outcome::NotConverged })
}

/// The observed curves of the material.
fn curves(options: &ValidateOptions, material: &MaterialFile) -> Result<Curves, Failure> {
    let curves = material.curves()?;
    if curves.components().next().is_some() {
        return Ok(curves);
    }
    let (found, expected) = ("no observed curve", "at least one (another --material)");
    Err(Error::input(&options.material, None, "curves", found, expected).into())
}

impl ValidateOptions {
    /// Kinds of test to simulate.
    fn kinds_of(&self, set: &MeasurementSet) -> Vec<Kind> {
        let has = |kind: &Kind| set.sequences.iter().any(|sequence| sequence.kind == *kind);
        if !self.kinds.is_empty() {
            self.kinds.clone()
        } else if self.all || !validation_kinds().iter().any(has) {
            Kind::ALL.to_vec()
        } else {
            validation_kinds()
        }
    }

    /// The settings of the fit that the curves come from. Its nodes depend on the specimen; cells of a mesh do not.
    fn settings(&self, material: &MaterialFile) -> Settings {
        let defaults = Settings::default();
        let provenance = &material.provenance;
        Settings {
            model: material.model,
            variant: material.variant,
            compression: material.compression,
            diagonals: provenance.diagonals.unwrap_or(defaults.diagonals),
            nodes: self.on.nodes,
            for_mesh: provenance.for_mesh_m.filter(|_| self.on.nodes.is_none()),
            corrected: !provenance.is_for_one_grid(),
            ..defaults
        }
    }
}

fn parse_any_kind(name: &str) -> Result<Kind, String> {
    parse_kind(name, &Kind::ALL)
}
