//! Adds a sequence to a measurement set on disk, which is created if missing.

use crate::error::{Error, Result};
use crate::frame::{Fabric, MeasurementSet, Sequence};
use crate::io::{fill_set, read_fabric, refuse_other_folder, write_sequence};
use crate::store::OutputFolder;
use std::path::Path;

/// Relative difference below which two numbers count as equal.
const SAME: f64 = 1e-6;

/// Fields of `fabric.toml`. A new set requires name and areal density; for an existing set the given values must agree.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FabricFields {
    /// Name of the fabric.
    pub name: Option<String>,
    /// Mass per area, kg/m².
    pub areal_density: Option<f64>,
    /// Thickness, m.
    pub thickness: Option<f64>,
}

/// Result of [`add_to_set`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Added {
    /// Created the set with this sequence.
    NewSet,
    /// Added the sequence to an existing set.
    NewSequence,
    /// Replaced the sequence of the same name.
    Replaced,
}

/// Adds a sequence to a set folder; creates the set if there is no `fabric.toml`.
///
/// * `replace` — allows replacing a sequence of the same name, including all contents of its folder
///
/// # Errors
/// Fields that are insufficient for a new set, or contradict an existing one; an existing sequence of that name;
/// a folder that holds something other than a set; a sequence that does not read back. Nothing is written in these
/// cases. A failed system call.
pub fn add_to_set(
    set_folder: &Path,
    sample: &FabricFields,
    sequence: &Sequence,
    replace: bool,
) -> Result<Added> {
    let fabric_file = set_folder.join("fabric.toml");
    if set_folder.exists() && !set_folder.is_dir() {
        return Err(Error::input(set_folder, None, "folder", "something else", "a set's folder, or nothing"));
    }
    if !fabric_file.exists() {
        refuse_other_folder(set_folder, "fabric.toml")?;
        let fabric = new_fabric(&fabric_file, sample, sequence)?;
        let mut claimed = OutputFolder::claim(set_folder)?;
        // Another run may have created it in the meantime.
        if !fabric_file.exists() {
            let set = MeasurementSet { fabric, sequences: vec![sequence.clone()] };
            claimed.replace(|temporary| fill_set(temporary, set_folder, &set))?;
            return Ok(Added::NewSet);
        }
    }
    check_agreement(&fabric_file, sample, &read_fabric(set_folder)?)?;
    let folder = set_folder.join(&sequence.name);
    let exists = folder.exists();
    if exists && !replace {
        return Err(Error::input(
            &folder,
            None,
            "sequence",
            "one of that name",
            "a new name, or leave to replace it",
        ));
    }
    write_sequence(set_folder, sequence)?;
    Ok(if exists { Added::Replaced } else { Added::NewSequence })
}

/// The sample of a new set, with the extents of the specimen along the yarns.
fn new_fabric(path: &Path, sample: &FabricFields, sequence: &Sequence) -> Result<Fabric> {
    let missing = |field: &str, expected: &str| {
        Error::input(
            path,
            None,
            field,
            "no such file and no value given",
            format!("{expected}, for a new set"),
        )
    };
    let extent = |axis: usize| {
        let coordinates = sequence.mesh.material.iter().map(|material| material[axis]);
        coordinates.clone().fold(f64::MIN, f64::max) - coordinates.fold(f64::MAX, f64::min)
    };
    Ok(Fabric {
        name: sample.name.clone().ok_or_else(|| missing("name", "the fabric's name"))?,
        width_m: extent(0),
        height_m: extent(1),
        areal_density_kg_m2: sample
            .areal_density
            .ok_or_else(|| missing("areal_density_kg_m2", "the mass per area"))?,
        thickness_m: sample.thickness,
        source: None,
        notes: None,
    })
}

/// Refuses a sequence of another fabric.
fn check_agreement(path: &Path, sample: &FabricFields, fabric: &Fabric) -> Result<()> {
    let refuse = |field: &str, found: String, given: String| {
        Err(Error::input(path, None, field, found, format!("{given}, the value given (or give none)")))
    };
    if let Some(name) = sample.name.as_ref().filter(|name| **name != fabric.name) {
        return refuse("name", fabric.name.clone(), name.clone());
    }
    let numbers = [
        ("areal_density_kg_m2", sample.areal_density, Some(fabric.areal_density_kg_m2)),
        ("thickness_m", sample.thickness, fabric.thickness_m),
    ];
    for (field, given, found) in numbers {
        let Some(given) = given else { continue };
        if !found.is_some_and(|found| (found - given).abs() <= SAME * given.abs()) {
            let found = found.map_or("nothing".into(), |found| found.to_string());
            return refuse(field, found, given.to_string());
        }
    }
    Ok(())
}
