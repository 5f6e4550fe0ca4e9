//! `fabric.toml`: the sample.

use super::number::check_length;
use super::toml_file::{TomlFile, written};
use crate::error::Result;
use crate::frame::Fabric;
use crate::store::write_file;
use std::path::Path;

/// Reads and checks `fabric.toml`.
pub(super) fn read(path: &Path) -> Result<Fabric> {
    let file = TomlFile::read(path)?;
    let fabric: Fabric = file.value()?;
    if fabric.name.trim().is_empty() {
        return Err(file.invalid("name", "nothing", "the fabric's name"));
    }
    let lengths = [
        ("width_m", Some(fabric.width_m), 10.0),
        ("height_m", Some(fabric.height_m), 10.0),
        ("thickness_m", fabric.thickness_m, 0.1),
    ];
    for (key, value, most) in lengths {
        let Some(value) = value else { continue };
        check_length(value, most).map_err(|expected| file.invalid(key, value.to_string(), expected))?;
    }
    let density = fabric.areal_density_kg_m2;
    if !(density > 0.0 && density <= 10.0) {
        let expected =
            "kilograms per square metre, above 0 and at most 10 (convert g/m² to kg/m²: divide by 1000)";
        return Err(file.invalid("areal_density_kg_m2", density.to_string(), expected));
    }
    Ok(fabric)
}

/// Writes `fabric.toml`.
pub(super) fn write(path: &Path, fabric: &Fabric) -> Result<()> {
    write_file(path, written(path, fabric)?.as_bytes())
}
