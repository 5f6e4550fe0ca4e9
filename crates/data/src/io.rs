//! Reads and writes measurement sets on disk. No other module does.
//!
//! ```text
//! cotton-denim/
//!   fabric.toml
//!   stretch-weft/
//!     test.toml  mesh.obj  positions.npy (or frames/0000.obj …)  clips.csv  forces.csv  frames.csv
//! ```
//!
//! No value is guessed: invalid input is an [`Error::Input`] with file, line, field and the expected value.

mod clips;
mod entries;
mod fabric;
mod forces;
mod frames;
pub mod json_file;
mod names;
mod npy;
mod number;
mod obj;
mod ply;
mod scale;
pub mod schema;
mod shape_file;
mod shapes;
mod source;
pub mod table;
mod test_file;
#[cfg(test)]
mod tests;
mod toml_file;
mod unit;

pub use number::{check_length, number};
pub use source::{read_text, shortened, shown};

pub use obj::{YarnAxes, read_mesh};
pub use shape_file::{ShapeFormat, write_shapes};
pub use toml_file::TomlFile;

use crate::error::{Error, Result};
use crate::frame::{Fabric, Frame, MeasurementSet, Sequence};
use crate::store::{replace_folder, write_file};
use cloth_sim::mesh::Mesh;
use entries::{Entries, entries};
use nalgebra::Vector3;
use schema::Schema;
use serde::de::DeserializeOwned;
use std::fs;
use std::path::Path;

/// Permitted entries of a sequence folder.
const SEQUENCE: [&str; 7] =
    ["test.toml", "mesh.obj", "positions.npy", "frames", "clips.csv", "forces.csv", "frames.csv"];
/// Unknown files with these extensions count as misspelt, other files as unrelated.
const DATA: [&str; 5] = [".toml", ".obj", ".npy", ".csv", ".ply"];

/// Reads a JSON file of the version that this program writes, or an older one.
///
/// # Errors
/// An unreadable file; text that is not JSON, or of a newer version; an unknown, missing or duplicate key; a value of
/// another type. All with line and key.
pub fn read_json<T: DeserializeOwned>(path: &Path, schema: &Schema) -> Result<T> {
    json_file::parse_version(path, &read_text(path)?, schema)
}

/// Reads a fabric sample and all its sequences, ordered by name.
///
/// # Errors
/// A missing or invalid file.
pub fn read_set(folder: &Path) -> Result<MeasurementSet> {
    let present = entries(folder)?;
    check_set(folder, &present)?;
    let fabric = read_fabric(folder)?;
    let folders = present.into_iter().filter(|(_, is_folder)| *is_folder);
    let sequences = folders.map(|(name, _)| read_sequence(&folder.join(name))).collect::<Result<_>>()?;
    Ok(MeasurementSet { fabric, sequences })
}

/// Reads the sample alone: `fabric.toml` of a set folder.
///
/// # Errors
/// A missing or invalid file.
pub fn read_fabric(folder: &Path) -> Result<Fabric> {
    fabric::read(&folder.join("fabric.toml"))
}

/// Reads one sequence, named after its folder.
///
/// # Errors
/// A missing or invalid file.
pub fn read_sequence(folder: &Path) -> Result<Sequence> {
    let name = folder_name(folder)?;
    let present = entries(folder)?;
    check_names(folder, &present)?;
    let mesh = obj::Obj::read(&folder.join("mesh.obj"))?.mesh()?;
    let test = test_file::read(&folder.join("test.toml"), mesh.len())?;
    let bends = test_file::bends(test.kind);
    for file in ["clips.csv", "forces.csv"] {
        if bends && present.contains_key(file) {
            let found = format!("{file} in a {} test", test.kind);
            return Err(Error::input(
                &folder.join(file),
                None,
                "file",
                found,
                "none: bending tests have no clips",
            ));
        }
    }
    let shapes = shapes::read(folder, &present, mesh.len())?;
    let mut frames =
        if bends { bending_frames(folder, shapes)? } else { clipped_frames(folder, &test, &mesh, shapes)? };
    if present.contains_key("forces.csv") {
        forces::read(&folder.join("forces.csv"), &test.clips, &mut frames)?;
    }
    if present.contains_key("frames.csv") && !frames.is_empty() {
        frames::read(&folder.join("frames.csv"), &mut frames)?;
    }
    scale::check(folder, &mesh, &test.clips, &frames)?;
    Ok(Sequence {
        name,
        kind: test.kind,
        gravity: test.gravity_m_s2.into(),
        noise: test.noise,
        force_direction: test.force_direction.map(Vector3::from),
        table: test.table,
        mesh,
        clips: test.clips,
        frames,
    })
}

/// Writes a set folder and replaces an existing set there, including all other contents of that folder.
///
/// Reading it back gives an identical set with two exceptions: observed positions are rounded to float32 (6 nm at 0.1
/// m), and the mesh loses the grid it was made from.
///
/// # Errors
/// A set that no folder can represent or that does not read back; an existing folder that is not a set; a failed
/// system call.
pub fn write_set(folder: &Path, set: &MeasurementSet) -> Result<()> {
    refuse_other_folder(folder, "fabric.toml")?;
    replace_folder(folder, |temporary| fill_set(temporary, folder, set))
}

/// Writes a set into an empty folder that will replace another one; errors name the latter.
///
/// # Errors
/// A set that no folder can represent or that does not read back; a failed system call.
pub fn fill_set(temporary: &Path, folder: &Path, set: &MeasurementSet) -> Result<()> {
    if let Some(pair) = set.sequences.windows(2).find(|pair| pair[0].name >= pair[1].name) {
        return Err(Error::Setting {
            field: "sequences[].name",
            found: format!("{} before {}", pair[0].name, pair[1].name),
            expected: "unique names in ascending order".into(),
        });
    }
    let read_back = |error| relocated(error, temporary, folder);
    fabric::write(&temporary.join("fabric.toml"), &set.fabric)?;
    read_fabric(temporary).map_err(read_back)?;
    for sequence in &set.sequences {
        let place = temporary.join(checked_name(sequence)?);
        fs::create_dir(&place).map_err(|source| Error::io(&place, source))?;
        fill_sequence(&place, sequence).map_err(read_back)?;
    }
    Ok(())
}

/// Adds a sequence folder to an existing set and replaces a sequence of the same name.
///
/// # Errors
/// As for [`write_set`]; a missing set.
pub fn write_sequence(set_folder: &Path, sequence: &Sequence) -> Result<()> {
    read_fabric(set_folder)?;
    let folder = set_folder.join(checked_name(sequence)?);
    refuse_other_folder(&folder, "test.toml")?;
    replace_folder(&folder, |temporary| {
        fill_sequence(temporary, sequence).map_err(|error| relocated(error, temporary, &folder))
    })
}

/// Writes the files of a sequence and reads them back, so that unreadable output is never kept.
fn fill_sequence(folder: &Path, sequence: &Sequence) -> Result<()> {
    let Sequence { mesh, clips, frames, .. } = sequence;
    check_counts(sequence)?;
    test_file::write(&folder.join("test.toml"), sequence)?;
    write_file(&folder.join("mesh.obj"), obj::written(mesh).as_bytes())?;
    shapes::write(folder, frames, mesh.len())?;
    clips::write(&folder.join("clips.csv"), clips, frames)?;
    forces::write(&folder.join("forces.csv"), clips, frames)?;
    frames::write(&folder.join("frames.csv"), frames)?;
    read_sequence(folder).map(|_| ())
}

/// In bending tests the shapes are the only measurement.
fn bending_frames(folder: &Path, shapes: Option<Vec<Option<npy::Shape>>>) -> Result<Vec<Frame>> {
    // A test without shapes carries no information, but the other tests of the set remain usable.
    let shapes = shapes.unwrap_or_default();
    if let Some(frame) = shapes.iter().position(Option::is_none) {
        let path = folder.join("positions.npy");
        let found = format!("no observed vertex in frame {frame}");
        return Err(Error::input(&path, None, "file", found, "at least one in every frame"));
    }
    Ok(shapes.into_iter().map(|positions| Frame { positions, ..Frame::default() }).collect())
}

/// All other tests have clips, and optionally shapes.
fn clipped_frames(
    folder: &Path,
    test: &test_file::TestFile,
    mesh: &Mesh,
    shapes: Option<Vec<Option<npy::Shape>>>,
) -> Result<Vec<Frame>> {
    let reach = mesh.positions.iter().map(Vector3::norm).fold(0.0, f64::max);
    let poses = clips::read(&folder.join("clips.csv"), &test.clips, reach)?;
    let shapes = shapes.unwrap_or_else(|| vec![None; poses.len()]);
    if shapes.len() != poses.len() {
        let found = format!("{} frames", shapes.len());
        let expected = format!("{}, as in clips.csv", poses.len());
        return Err(Error::input(folder, None, "shapes", found, expected));
    }
    let frame = |(poses, positions)| Frame { poses, positions, ..Frame::default() };
    Ok(poses.into_iter().zip(shapes).map(frame).collect())
}

/// Explains a folder that is not a set: it may contain sets, or be part of one.
fn check_set(folder: &Path, present: &Entries) -> Result<()> {
    if present.contains_key("fabric.toml") {
        return Ok(());
    }
    let refuse = |found: String, expected: &str| Err(Error::input(folder, None, "folder", found, expected));
    if present.contains_key("test.toml") {
        return refuse("a sequence of a set".into(), "the set, which is the folder above it");
    }
    let is_set = |(name, _): &(&String, &bool)| folder.join(name).join("fabric.toml").exists();
    let sets: Vec<&str> = present.iter().filter(is_set).map(|(name, _)| name.as_str()).collect();
    match sets.is_empty() {
        true => Ok(()),
        false => refuse(format!("a folder of sets: {}", shortened(&sets.join(", "), 300)), "one of them"),
    }
}

/// A misspelt file would otherwise be ignored silently.
fn check_names(folder: &Path, present: &Entries) -> Result<()> {
    let strange = |(name, is_folder): &(&String, &bool)| {
        !SEQUENCE.contains(&name.as_str()) && (**is_folder || DATA.iter().any(|kind| name.ends_with(kind)))
    };
    match present.iter().find(strange) {
        Some((name, _)) => {
            let expected = format!("only {}", SEQUENCE.join(", "));
            Err(Error::input(&folder.join(name), None, "file", "a name that no sequence has", expected))
        }
        None => Ok(()),
    }
}

fn folder_name(folder: &Path) -> Result<String> {
    let whole = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_path_buf());
    let name = folder.file_name().or_else(|| whole.file_name());
    name.and_then(|name| name.to_str())
        .map(str::to_string)
        .ok_or_else(|| Error::input(folder, None, "name", "no name in UTF-8", "a folder with a name"))
}

/// The name of a sequence, checked for use as a folder name.
fn checked_name(sequence: &Sequence) -> Result<&str> {
    let name = sequence.name.as_str();
    if name.is_empty()
        || name.starts_with('.')
        || name.contains(['/', '\\', ',', '"'])
        || name.contains(char::is_control)
    {
        return Err(Error::Setting {
            field: "sequences[].name",
            found: source::shown(name),
            expected: "the name of a folder that is not hidden, without comma or quote".into(),
        });
    }
    Ok(name)
}

/// Refuses to replace a folder that holds other files: writing replaces whole folders.
pub fn refuse_other_folder(folder: &Path, mark: &str) -> Result<()> {
    let occupied = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some());
    if occupied && !folder.join(mark).exists() {
        let expected = format!("a new folder, an empty one, or one with {mark} to replace");
        return Err(Error::input(folder, None, "folder", "other files", expected));
    }
    Ok(())
}

/// Checks counts and indices that would otherwise be truncated silently or point nowhere.
fn check_counts(sequence: &Sequence) -> Result<()> {
    let clips = sequence.clips.len();
    let refuse = |field, found: usize, expected: String| {
        Err(Error::Setting { field, found: found.to_string(), expected })
    };
    for frame in &sequence.frames {
        if frame.poses.len() != clips {
            return refuse("frames[].poses", frame.poses.len(), format!("{clips}, one for every clip"));
        }
        if let Some(cord) = frame.cords.iter().find(|cord| cord.clip >= clips) {
            return refuse(
                "frames[].cords[].clip",
                cord.clip,
                format!("less than {clips}, the number of clips"),
            );
        }
        if let Some(shape) = frame.positions.as_ref().filter(|shape| shape.len() != sequence.mesh.len()) {
            let expected = format!("{}, one for every vertex", sequence.mesh.len());
            return refuse("frames[].positions", shape.len(), expected);
        }
    }
    Ok(())
}

/// Replaces the temporary folder in an error by the requested one.
fn relocated(error: Error, temporary: &Path, folder: &Path) -> Error {
    match error {
        Error::Input { path, line, field, found, expected } => {
            let path = path.strip_prefix(temporary).map(|rest| folder.join(rest)).unwrap_or(path);
            Error::Input { path, line, field, found, expected }
        }
        other => other,
    }
}
