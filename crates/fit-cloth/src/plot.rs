//! Figures of a fit, a validation, a study or a simulation, as SVG: `plots/*.svg`.

mod chart;
mod forces;
mod measure;
mod shape;
mod stress;
mod study;

use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::study::Study;
use cloth_fit::error::{Error, Result};
use cloth_fit::frame::Kind;
use cloth_fit::incremental::FitReport;
use cloth_fit::report::SequenceReport;
use cloth_fit::store::write_file;
use cloth_fit::validation::{Validated, Validation};
use cloth_sim::material::Model;
use plotters::style::RGBColor;
use std::path::Path;

const MODEL: RGBColor = RGBColor(31, 90, 160);
const LOADING: RGBColor = RGBColor(200, 80, 30);
const UNLOADING: RGBColor = RGBColor(120, 120, 120);
const THIRD: RGBColor = RGBColor(0, 140, 110);
const FOURTH: RGBColor = RGBColor(190, 110, 160);

/// Writes a fit's figures into a result folder: every observed curve, and every kind of test on which forces were
/// measured.
///
/// # Errors
/// What the operating system refuses.
pub fn write_plots(folder: &Path, report: &FitReport) -> Result<()> {
    let plots = folder.join("plots");
    std::fs::create_dir_all(&plots).map_err(|source| Error::io(&plots, source))?;
    for stage in report.last_stages().filter(|stage| stage.curve.observed) {
        // Drawing into memory cannot fail but for a figure of a curve without extent; then there is none.
        if let Ok(figure) = stress::draw(stage) {
            let what = if stage.components[0].is_bending() { "moment" } else { "stress" };
            write_file(&plots.join(format!("{}-{what}.svg", stage.components[0])), figure.as_bytes())?;
        }
    }
    let sequences = report.sequences();
    write_forces(&plots, report.model, &sequences.iter().map(|(_, sequence)| *sequence).collect::<Vec<_>>())
}

/// Writes a validation's figures into its folder: the forces of every kind of test, and measures of the whole.
///
/// # Errors
/// What the operating system refuses.
pub fn write_validation_plots(folder: &Path, model: Model, validation: &Validation) -> Result<()> {
    let plots = folder.join("plots");
    std::fs::create_dir_all(&plots).map_err(|source| Error::io(&plots, source))?;
    for Validated { report, measure } in &validation.sequences {
        let figure = measure.as_ref().map(|(name, rows)| {
            measure::draw(&format!("{}, {model}", report.name), report.kind, *name, rows)
        });
        if let Some(Ok(figure)) = figure {
            write_file(&plots.join(format!("{}-measure.svg", report.name)), figure.as_bytes())?;
        }
    }
    let sequences: Vec<&SequenceReport> = validation.sequences.iter().map(|s| &s.report).collect();
    write_forces(&plots, model, &sequences)
}

/// Writes a study's figures into its folder.
///
/// # Errors
/// What the operating system refuses.
pub fn write_study_plots(folder: &Path, study: &Study) -> Result<()> {
    let plots = folder.join("plots");
    std::fs::create_dir_all(&plots).map_err(|source| Error::io(&plots, source))?;
    for (name, figure) in study::figures(study) {
        // What was not run has no figure.
        if let Ok(figure) = figure {
            write_file(&plots.join(format!("{name}.svg")), figure.as_bytes())?;
        }
    }
    Ok(())
}

/// Writes the picture of a simulation's shapes into its folder.
///
/// # Errors
/// What the operating system refuses.
pub fn write_simulation_plots(folder: &Path, scene: &Scene, simulation: &Simulation) -> Result<()> {
    let plots = folder.join("plots");
    std::fs::create_dir_all(&plots).map_err(|source| Error::io(&plots, source))?;
    // Drawing into memory cannot fail but for a sheet without extent; then there is none.
    if let Ok(figure) = shape::draw(scene, simulation) {
        write_file(&plots.join("shapes.svg"), figure.as_bytes())?;
    }
    Ok(())
}

/// A figure for each kind of test on which forces were measured.
fn write_forces(plots: &Path, model: Model, sequences: &[&SequenceReport]) -> Result<()> {
    let mut kinds: Vec<_> = sequences.iter().map(|sequence| sequence.kind).collect();
    kinds.sort();
    kinds.dedup();
    for kind in kinds {
        let shown: Vec<_> = sequences.iter().copied().filter(|s| s.kind == kind).collect();
        if let Ok(figure) = forces::draw(&format!("{kind}, {model}"), kind, &shown) {
            write_file(&plots.join(format!("{kind}-force.svg")), figure.as_bytes())?;
        }
    }
    Ok(())
}

/// What a test's extension is.
fn extension(kind: Kind) -> &'static str {
    if kind == Kind::Shear { "shear angle [rad]" } else { "extension" }
}
