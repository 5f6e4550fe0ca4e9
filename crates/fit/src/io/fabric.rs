//! `fabric.toml`: the sample.

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
    let limits = [
        ("width_m", Some(fabric.width_m), 10.0, "a length above 0 and at most 10 m (millimetres?)"),
        ("height_m", Some(fabric.height_m), 10.0, "a length above 0 and at most 10 m (millimetres?)"),
        (
            "areal_density_kg_m2",
            Some(fabric.areal_density_kg_m2),
            10.0,
            "kilograms per square metre, above 0 and at most 10 (convert g/m² to kg/m²: divide by 1000)",
        ),
        ("thickness_m", fabric.thickness_m, 0.1, "a thickness above 0 and at most 0.1 m (millimetres?)"),
    ];
    for (key, value, most, expected) in limits {
        if let Some(value) = value.filter(|&value| !(value > 0.0 && value <= most)) {
            return Err(file.invalid(key, value.to_string(), expected));
        }
    }
    Ok(fabric)
}

/// Writes `fabric.toml`.
pub(super) fn write(path: &Path, fabric: &Fabric) -> Result<()> {
    write_file(path, written(path, fabric)?.as_bytes())
}
