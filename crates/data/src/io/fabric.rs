//! `fabric.toml`: the sample.

use super::number::check_length;
use super::schema::Schema;
use super::source::shown;
use super::toml_file::{TomlFile, written};
use crate::error::Result;
use crate::frame::Fabric;
use crate::store::write_file;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The version of a whole set, which stands in this file; a file without one, as written by hand, is of version 1.
const SET: Schema = Schema::new("set", &[]);

/// The keys of `fabric.toml`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FabricFile {
    name: String,
    width_m: f64,
    height_m: f64,
    areal_density_kg_m2: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    thickness_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    source: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    notes: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    schema: Option<String>,
}

/// Reads and checks `fabric.toml`.
pub(super) fn read(path: &Path) -> Result<Fabric> {
    let file = TomlFile::read(path)?;
    let FabricFile { name, width_m, height_m, areal_density_kg_m2, thickness_m, source, notes, schema } =
        file.value()?;
    if let Some(id) = schema.filter(|id| SET.version_of(id) != Some(SET.version())) {
        return Err(file.invalid("schema", shown(&id), SET.expected(&id)));
    }
    let fabric = Fabric { name, width_m, height_m, areal_density_kg_m2, thickness_m, source, notes };
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
    let Fabric { name, width_m, height_m, areal_density_kg_m2, thickness_m, source, notes } = fabric.clone();
    let schema = Some(SET.id());
    let file =
        FabricFile { name, width_m, height_m, areal_density_kg_m2, thickness_m, source, notes, schema };
    write_file(path, written(path, &file)?.as_bytes())
}
