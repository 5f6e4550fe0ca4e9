//! `test.toml`: the test procedure and its instruments.

use super::source::shown;
use super::toml_file::{TomlFile, written};
use crate::error::{Error, Result};
use crate::frame::{Clip, Kind, Noise, Sequence, Table};
use crate::kind::Holding;
use crate::store::write_file;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::path::Path;

/// Allowed deviation of directions and quaternions from unit length.
pub(super) const UNIT_LENGTH: f64 = 1e-6;

/// The keys of `test.toml`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TestFile {
    pub(super) kind: Kind,
    pub(super) gravity_m_s2: [f64; 3],
    /// The only direction measured by the load cell; absent = all three components.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) force_direction: Option<[f64; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) noise: Option<Noise>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) table: Option<Table>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) clips: Vec<Clip>,
}

/// True for overhang tests, which have a table and no clips.
pub(super) fn bends(kind: Kind) -> bool {
    kind.holding() == Holding::Table
}

/// Reads and checks `test.toml` for a mesh with the given number of vertices.
pub(super) fn read(path: &Path, vertices: usize) -> Result<TestFile> {
    let file = TomlFile::read(path)?;
    let test: TestFile = file.value()?;
    check_vector(&file, "gravity_m_s2", test.gravity_m_s2, false)?;
    if let Some(direction) = test.force_direction {
        check_vector(&file, "force_direction", direction, true)?;
    }
    if let Some(noise) = test.noise {
        for (key, value) in [("noise.position_m", noise.position_m), ("noise.force_n", noise.force_n)] {
            if let Some(value) = value.filter(|&value| !(value > 0.0 && value.is_finite())) {
                return Err(file.invalid(key, value.to_string(), "a standard deviation above 0"));
            }
        }
    }
    if let Some(value) = test.noise.and_then(|noise| noise.clip_m)
        && !(value >= 0.0 && value.is_finite())
    {
        return Err(file.invalid(
            "noise.clip_m",
            value.to_string(),
            "a standard deviation of 0 (exact poses) or more",
        ));
    }
    match (test.table, bends(test.kind)) {
        (Some(table), true) => check_table(&file, &table)?,
        (None, true) => return Err(file.invalid("table", "nothing", "[table], for a bending test")),
        (Some(_), false) => {
            return Err(file.invalid("table", "[table]", format!("none for a {} test", test.kind)));
        }
        (None, false) => {}
    }
    match (test.clips.is_empty(), bends(test.kind)) {
        (false, true) => Err(file.invalid("clips", "[[clips]]", "none for a bending test")),
        (true, false) => Err(file.invalid("clips", "nothing", "at least one [[clips]]")),
        _ => check_clips(&file, &test.clips, vertices),
    }?;
    Ok(test)
}

/// Writes `test.toml`.
pub(super) fn write(path: &Path, sequence: &Sequence) -> Result<()> {
    let test = TestFile {
        kind: sequence.kind,
        gravity_m_s2: sequence.gravity.into(),
        force_direction: sequence.force_direction.map(Into::into),
        noise: sequence.noise,
        table: sequence.table,
        clips: sequence.clips.clone(),
    };
    write_file(path, written(path, &test)?.as_bytes())
}

fn check_vector(file: &TomlFile, key: &str, vector: [f64; 3], unit: bool) -> Result<()> {
    // Deserialising an array of three ignores a fourth number.
    if file.has(&format!("{key}[3]")) {
        return Err(file.invalid(key, "more than three numbers", "an array of length 3"));
    }
    if let Some(axis) = vector.iter().position(|value| !value.is_finite()) {
        return Err(file.invalid(&format!("{key}[{axis}]"), vector[axis].to_string(), "a finite number"));
    }
    let length = nalgebra::Vector3::from(vector).norm();
    if unit && (length - 1.0).abs() > UNIT_LENGTH {
        return Err(file.invalid(key, format!("a vector of length {length}"), "unit length"));
    }
    Ok(())
}

fn check_table(file: &TomlFile, table: &Table) -> Result<()> {
    check_vector(file, "table.edge_point_m", table.edge_point_m, false)?;
    check_vector(file, "table.edge_direction", table.edge_direction, true)?;
    check_vector(file, "table.outward", table.outward, true)?;
    let [edge, outward] = [table.edge_direction, table.outward].map(nalgebra::Vector3::from);
    if edge.dot(&outward).abs() > UNIT_LENGTH {
        return Err(file.invalid(
            "table.outward",
            shown(&format!("{:?}", table.outward)),
            "a right angle to edge_direction",
        ));
    }
    Ok(())
}

fn check_clips(file: &TomlFile, clips: &[Clip], vertices: usize) -> Result<()> {
    let mut names = HashSet::new();
    for (index, clip) in clips.iter().enumerate() {
        let refuse = |key: &str, found: String, expected: &str| -> Result<()> {
            Err::<(), Error>(file.invalid(&format!("clips[{index}].{key}"), found, expected))
        };
        let name = clip.name.as_str();
        if name.is_empty() || name.trim() != name || name.contains(char::is_control) {
            return refuse("name", shown(name), "a name without spaces around it");
        }
        if !names.insert(name) {
            return refuse("name", format!("{} twice", shown(name)), "another name for every clip");
        }
        if !(clip.mass_kg >= 0.0 && clip.mass_kg.is_finite()) {
            return refuse("mass_kg", clip.mass_kg.to_string(), "a mass of 0 or more");
        }
        if clip.vertices.is_empty() {
            return refuse("vertices", "nothing".into(), "the vertices that the clip holds");
        }
        let mut seen = HashSet::new();
        for (place, &vertex) in clip.vertices.iter().enumerate() {
            let key = format!("vertices[{place}]");
            if vertex >= vertices {
                let expected =
                    format!("0 to {}, for mesh.obj has {vertices} vertices", vertices.saturating_sub(1));
                return refuse(&key, vertex.to_string(), &expected);
            }
            if !seen.insert(vertex) {
                return refuse(&key, format!("{vertex} twice"), "every vertex once");
            }
        }
    }
    Ok(())
}
