//! The folder that a fit writes: curve files, residuals, forces and `material.json`.

use crate::error::{Error, Result};
use crate::frame::MeasurementSet;
use crate::material_file::MaterialFile;
use crate::report::{CurveReport, StageReport};
use crate::stage::Settings;
use crate::store::write_file;
use cloth_sim::material::Model;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Refuses an output folder that holds something other than a former result.
///
/// # Errors
/// A file, or a folder with anything in it but what a fit writes, of one model or a folder each of several. Hidden files
/// do not count.
pub fn check_output(folder: &Path) -> Result<()> {
    let refuse = |found: &str| {
        Err(Error::input(
            folder,
            None,
            "--out",
            found,
            "a new or empty folder, or a former result, which is replaced",
        ))
    };
    if !folder.exists() {
        return Ok(());
    }
    if !folder.is_dir() {
        return refuse("a file");
    }
    std::fs::read_dir(folder).map_err(|source| Error::io(folder, source))?;
    let name =
        |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let visible = |folder: &Path| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
        entries.filter(|path| !name(path).starts_with('.')).collect()
    };
    // Nothing but what a fit writes: what stands beside it must not go with it.
    let is_result = |folder: &Path| {
        folder.join("material.json").is_file()
            && visible(folder).iter().all(|path| WRITTEN.contains(&&name(path)[..]))
    };
    let is_model = |folder: &PathBuf| {
        Model::ALL.iter().any(|model| model.to_string() == name(folder)) && is_result(folder)
    };
    let entries = visible(folder);
    if entries.is_empty() || is_result(folder) || entries.iter().all(is_model) {
        return Ok(());
    }
    refuse("a folder with other things in it")
}

/// What stands in a result folder.
const WRITTEN: [&str; 5] = ["material.json", "curves", "plots", "residuals.csv", "forces.csv"];

/// Writes the result of one model into a folder that exists.
///
/// # Errors
/// What the operating system refuses.
pub fn write_result(
    folder: &Path,
    set: &MeasurementSet,
    settings: &Settings,
    stages: &[StageReport],
) -> Result<()> {
    let curves = folder.join("curves");
    std::fs::create_dir_all(&curves).map_err(|source| Error::io(&curves, source))?;
    for stage in stages {
        let file = curves.join(format!("{}.csv", stage.components[0]));
        write_file(&file, curve_table(&stage.curve).as_bytes())?;
    }
    write_file(&folder.join("residuals.csv"), residual_table(stages).as_bytes())?;
    write_file(&folder.join("forces.csv"), force_table(stages).as_bytes())?;
    write_file(&folder.join("material.json"), MaterialFile::new(set, settings, stages).to_json().as_bytes())
}

/// 201 rows; the band's columns are absent where the data do not see all of the curve.
fn curve_table(curve: &CurveReport) -> String {
    let banded = curve.samples.iter().all(|sample| sample.band.is_some());
    let mut table = String::from("strain,stiffness_n_per_m,stress_n_per_m");
    table.push_str(if banded { ",stress_low_n_per_m,stress_high_n_per_m\n" } else { "\n" });
    for sample in &curve.samples {
        let _ = write!(table, "{},{},{}", sample.strain, sample.stiffness, sample.stress);
        if let Some([low, high]) = sample.band.filter(|_| banded) {
            let _ = write!(table, ",{low},{high}");
        }
        table.push('\n');
    }
    table
}

/// One row a sequence; a position that was not measured is empty.
fn residual_table(stages: &[StageReport]) -> String {
    let mut table = String::from(
        "sequence,kind,rms_force_n,largest_force_n,rms_position_m,frames,frames_left_out,iterations,seconds\n",
    );
    for stage in stages {
        let iterations: usize = stage.levels.iter().map(|level| level.iterations.len()).sum();
        for s in &stage.sequences {
            let position = s.position_rms.map(|rms| rms.to_string()).unwrap_or_default();
            let dropped = stage.dropped.iter().filter(|dropped| dropped.sequence == s.name).count();
            let _ = writeln!(
                table,
                "{},{},{},{},{position},{},{},{iterations},{:.3}",
                s.name,
                s.kind,
                s.force_rms.unwrap_or(0.0),
                s.force_largest,
                s.frames,
                s.at_rest + dropped,
                stage.seconds
            );
        }
    }
    table
}

/// Every measured force component (its direction x, y, z in the specimen's frame) beside its simulation, for plots.
fn force_table(stages: &[StageReport]) -> String {
    let mut table = String::from("sequence,frame,clip,x,y,z,extension,measured_n,simulated_n\n");
    for s in stages.iter().flat_map(|stage| &stage.sequences) {
        for row in &s.forces {
            let _ = writeln!(
                table,
                "{},{},{},{},{},{},{},{},{}",
                s.name,
                row.frame,
                row.clip,
                row.direction.x,
                row.direction.y,
                row.direction.z,
                row.extension,
                row.measured,
                row.simulated
            );
        }
    }
    table
}
