//! Figures of a fit, a validation, a study or a simulation: `plots/*.svg`.

mod chart;
mod convergence;
mod correlation;
mod cycle;
mod drawing;
mod forces;
mod measure;
mod painter;
mod pair;
mod palette;
mod picture;
mod profiles;
mod residual_field;
mod residual_table;
mod series;
mod shape;
mod sheet;
mod stress;
mod study;
mod view;
mod writing;

use crate::shown::profiles;
use cloth_data::error::{Error, Result};
use cloth_data::frame::MeasurementSet;
use cloth_data::store::write_file;
use cloth_fit::incremental::FitReport;
use cloth_fit::judge::validation::{Validated, Validation};
use cloth_fit::stage::report::SequenceReport;
use cloth_scene::scene::Scene;
use cloth_scene::simulation::Simulation;
use cloth_sim::material::Model;
use cloth_study::study::Study;
use drawing::Drawn;
use std::path::{Path, PathBuf};

/// Writes a fit's figures into a result folder: observed curves, tests, residuals, correlations and convergence.
///
/// # Errors
/// I/O errors.
pub fn write_plots(folder: &Path, set: &MeasurementSet, report: &FitReport) -> Result<()> {
    let plots = Plots::new(folder)?;
    for stage in report.last_stages().filter(|stage| stage.curve.observed) {
        let what = if stage.components[0].is_bending() { "moment" } else { "stress" };
        plots.write(&format!("{}-{what}", stage.components[0]), stress::draw(stage))?;
    }
    plots.write("convergence", convergence::draw(report))?;
    plots.write("correlation", correlation::draw(report))?;
    plots.write("residuals", residual_table::draw(report))?;
    let sequences: Vec<_> = report.sequences().into_iter().map(|(_, sequence)| sequence).collect();
    plots.write_tests(set, report.model, &sequences)
}

/// Writes a validation's figures into its folder: the tests and their measures.
///
/// # Errors
/// I/O errors.
pub fn write_validation_plots(
    folder: &Path,
    set: &MeasurementSet,
    model: Model,
    validation: &Validation,
) -> Result<()> {
    let plots = Plots::new(folder)?;
    for Validated { report, measure } in &validation.sequences {
        if let Some((name, rows)) = measure {
            let title = format!("{}, {model}", report.name);
            plots.write(
                &format!("{}-measure", report.name),
                measure::draw(&title, report.kind, *name, rows),
            )?;
        }
    }
    let sequences: Vec<_> = validation.sequences.iter().map(|sequence| &sequence.report).collect();
    plots.write_tests(set, model, &sequences)
}

/// Writes a study's figures into its folder.
///
/// # Errors
/// I/O errors.
pub fn write_study_plots(folder: &Path, study: &Study) -> Result<()> {
    let plots = Plots::new(folder)?;
    study::figures(study).into_iter().try_for_each(|(name, figure)| plots.write(&name, figure))
}

/// Writes the figure of a simulation's shapes into its folder.
///
/// # Errors
/// I/O errors.
pub fn write_simulation_plots(folder: &Path, scene: &Scene, simulation: &Simulation) -> Result<()> {
    Plots::new(folder)?.write("shapes", shape::draw(scene, simulation))
}

/// The folder for figures.
struct Plots(PathBuf);

impl Plots {
    fn new(folder: &Path) -> Result<Self> {
        let plots = folder.join("plots");
        std::fs::create_dir_all(&plots).map_err(|source| Error::io(&plots, source))?;
        Ok(Self(plots))
    }

    /// Drawing into memory fails only for an empty figure or one without extent; such a figure is omitted.
    fn write(&self, name: &str, figure: Drawn<String>) -> Result<()> {
        match figure {
            Ok(figure) => write_file(&self.0.join(format!("{name}.svg")), figure.as_bytes()),
            Err(_) => Ok(()),
        }
    }

    /// Writes the forces of every kind of test and the shapes of every sequence.
    fn write_tests(&self, set: &MeasurementSet, model: Model, sequences: &[&SequenceReport]) -> Result<()> {
        let mut kinds: Vec<_> = sequences.iter().map(|sequence| sequence.kind).collect();
        kinds.sort();
        kinds.dedup();
        for kind in kinds {
            let shown: Vec<_> = sequences.iter().copied().filter(|s| s.kind == kind).collect();
            let title = format!("{kind}, {model}");
            self.write(&format!("{kind}-force"), forces::draw(&title, kind, &shown))?;
        }
        for found in sequences {
            let Some(sequence) = set.sequences.iter().find(|sequence| sequence.name == found.name) else {
                continue;
            };
            let title = format!("{}, {model}", found.name);
            self.write(&format!("{}-shape", found.name), pair::draw(&title, sequence, found))?;
            self.write(&format!("{}-residual", found.name), residual_field::draw(&title, sequence, found))?;
            let profiles = profiles(sequence, &found.shapes);
            self.write(&format!("{}-profiles", found.name), profiles::draw(&title, &profiles))?;
        }
        Ok(())
    }
}
