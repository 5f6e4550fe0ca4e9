//! Result folders of fits and validations: tables, and a JSON file with the complete result.

mod tables;
mod validation;

pub use validation::write_validation;

use crate::incremental::FitReport;
use crate::material::file::MaterialFile;
use cloth_data::error::{Error, Result};
use cloth_data::io::shown;
use cloth_data::store::write_file;
use cloth_sim::material::Model;
use std::path::{Path, PathBuf};

/// Rejects an output folder that contains anything but an earlier result.
///
/// * `field` — name of the folder in the error, such as the caller's option for it
///
/// # Errors
/// A file; a folder with other content than the result of a fit (one model, or one folder per model), comparison,
/// validation, study or simulation. Hidden files are ignored.
pub fn check_output(folder: &Path, field: &str) -> Result<()> {
    let refuse = |found: String| {
        Err(Error::input(
            folder,
            None,
            field,
            found,
            "a new or empty folder, or an earlier result, which is replaced",
        ))
    };
    if !folder.exists() {
        return Ok(());
    }
    if !folder.is_dir() {
        return refuse("a file".into());
    }
    std::fs::read_dir(folder).map_err(|source| Error::io(folder, source))?;
    let name =
        |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let visible = |folder: &Path| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
        entries.filter(|path| !name(path).starts_with('.')).collect()
    };
    // Accepts only files that this program writes: replacing the folder deletes all of its content.
    let holds = |folder: &Path, main: &str, all: &[&str]| {
        folder.join(main).is_file() && visible(folder).iter().all(|path| all.contains(&&name(path)[..]))
    };
    let is_result = |folder: &Path| holds(folder, "material.json", &WRITTEN);
    let is_model = |folder: &PathBuf| {
        Model::ALL.iter().any(|model| model.to_string() == name(folder)) && is_result(folder)
    };
    let entries = visible(folder);
    let others = [
        ("compare.json", &COMPARED[..]),
        ("validation.json", &VALIDATED),
        ("study.csv", &STUDIED),
        ("simulation.json", &SIMULATED),
    ];
    let is_other = others.iter().any(|(main, all)| holds(folder, main, all));
    // Several models share one report.
    let of_models =
        |entry: &PathBuf| is_model(entry) || ["report.json", "report.html"].contains(&&name(entry)[..]);
    let are_models = entries.iter().all(of_models) && (entries.is_empty() || entries.iter().any(is_model));
    if is_other || is_result(folder) || are_models {
        return Ok(());
    }
    // Prefers to name a file that no fit writes.
    let names: Vec<String> = entries.iter().map(|path| name(path)).collect();
    let other = names.iter().find(|name| !WRITTEN.contains(&&name[..])).or(names.first());
    refuse(format!("a folder with other things in it, such as {}", shown(other.map_or("", |name| name))))
}

/// Files and folders of a fit.
const WRITTEN: [&str; 7] =
    ["material.json", "curves", "plots", "residuals.csv", "forces.csv", "report.json", "report.html"];

/// Files and folders of a [comparison](crate::judge::compare).
const COMPARED: [&str; 4] = ["compare.csv", "compare.json", "report.json", "report.html"];

/// Files and folders of a [validation](crate::judge::validation).
const VALIDATED: [&str; 5] = ["validation.json", "validation.csv", "measures.csv", "forces.csv", "plots"];

/// Files and folders of a study.
const STUDIED: [&str; 4] = ["study.csv", "ablation.csv", "study.md", "plots"];

/// Files and folders of a simulation.
const SIMULATED: [&str; 6] =
    ["simulation.json", "mesh.obj", "frames", "positions.npy", "energies.csv", "plots"];

/// Writes the result of one model into an existing folder. A curve that no frame observes has no file.
///
/// # Errors
/// Errors of the file system.
pub fn write_result(folder: &Path, report: &FitReport, material: &MaterialFile) -> Result<()> {
    let curves = folder.join("curves");
    std::fs::create_dir_all(&curves).map_err(|source| Error::io(&curves, source))?;
    for stage in report.last_stages().filter(|stage| stage.curve.observed) {
        let table = tables::curve_table(stage);
        for component in &stage.components {
            write_file(&curves.join(format!("{component}.csv")), table.as_bytes())?;
        }
    }
    let forces = tables::force_table(report.sequences().into_iter().map(|(_, sequence)| sequence));
    write_file(&folder.join("residuals.csv"), tables::residual_table(report).as_bytes())?;
    write_file(&folder.join("forces.csv"), forces.as_bytes())?;
    write_file(&folder.join("material.json"), material.to_json().as_bytes())
}
