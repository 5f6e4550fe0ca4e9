//! Measured shapes of a sequence: one array, or one mesh file per frame.

use super::entries::{Entries, entries};
use super::npy::{self, Shape};
use super::obj::Obj;
use super::ply;
use super::source::shown;
use crate::error::{Error, Result};
use crate::frame::Frame;
use crate::store::write_file;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Reads the shapes of all frames; `None` if the folder has none. A frame without observed vertices is `None` too.
pub(super) fn read(folder: &Path, present: &Entries, vertices: usize) -> Result<Option<Vec<Option<Shape>>>> {
    let has = |name: &str| present.contains_key(name);
    let (array, files) = (folder.join("positions.npy"), folder.join("frames"));
    let shapes = match (has("positions.npy"), has("frames")) {
        (false, false) => return Ok(None),
        (true, true) => {
            let expected = "either the array or the folder frames/, not both";
            return Err(Error::input(&array, None, "file", "positions.npy and frames/", expected));
        }
        (true, false) => {
            npy::read(&array, vertices)?.into_iter().map(|shape| (array.clone(), shape)).collect()
        }
        (false, true) => read_files(&files, vertices)?,
    };
    let checked = shapes.into_iter().enumerate().map(|(frame, (path, shape))| checked(&path, frame, shape));
    checked.collect::<Result<_>>().map(Some)
}

/// File that holds the shape of a frame.
pub(super) fn file_of(folder: &Path, frame: usize) -> PathBuf {
    let files = folder.join("frames");
    let is_its = |name: &String| name.split('.').next().and_then(|stem| stem.parse().ok()) == Some(frame);
    let name = entries(&files).ok().and_then(|names| names.into_keys().find(is_its));
    name.map_or_else(|| folder.join("positions.npy"), |name| files.join(name))
}

/// Writes `positions.npy` if any frame has a shape.
pub(super) fn write(folder: &Path, frames: &[Frame], vertices: usize) -> Result<()> {
    let shapes: Vec<_> = frames.iter().map(|frame| frame.positions.as_ref()).collect();
    if shapes.iter().all(Option::is_none) {
        return Ok(());
    }
    write_file(&folder.join("positions.npy"), &npy::written(&shapes, vertices))
}

/// Reads `0000.obj`, `0001.ply`, … from a folder.
fn read_files(folder: &Path, vertices: usize) -> Result<Vec<(PathBuf, Shape)>> {
    let mut files = BTreeMap::new();
    for name in entries(folder)?.into_keys() {
        let path = folder.join(&name);
        let (stem, kind) = name.rsplit_once('.').unwrap_or((&name, ""));
        match (stem.parse::<usize>(), kind) {
            (_, "mtl") => {}
            (Ok(frame), "obj" | "ply") => {
                if let Some(other) = files.insert(frame, path.clone()) {
                    let found = format!("frame {frame} twice, also {}", other.display());
                    return Err(Error::input(&path, None, "file", found, "one file a frame"));
                }
            }
            _ => {
                return Err(Error::input(&path, None, "file", shown(&name), "0000.obj, 0001.obj, … or .ply"));
            }
        }
    }
    if files.is_empty() {
        return Err(Error::input(folder, None, "folder", "no file", "0000.obj, 0001.obj, … or .ply"));
    }
    if let Some((expected, (found, path))) =
        files.iter().enumerate().find(|(expected, (found, _))| expected != *found)
    {
        return Err(Error::input(
            path,
            None,
            "file",
            format!("frame {found}"),
            format!("frame {expected}: frames are numbered without gaps"),
        ));
    }
    let read = |path: PathBuf| {
        let ply = path.extension().is_some_and(|kind| kind == "ply");
        let shape = if ply { ply::read(&path)? } else { Obj::read(&path)?.positions() };
        if shape.len() != vertices {
            let expected = format!("{vertices}, as in mesh.obj");
            return Err(Error::input(&path, None, "vertices", shape.len().to_string(), expected));
        }
        Ok((path, shape))
    };
    files.into_values().map(read).collect()
}

/// Checks that each vertex is observed in all three coordinates or in none.
fn checked(path: &Path, frame: usize, shape: Shape) -> Result<Option<Shape>> {
    for (vertex, position) in shape.iter().enumerate() {
        let refuse = |found: String, expected: &str| {
            Err(Error::input(path, None, format!("frame {frame} vertex {vertex}"), found, expected))
        };
        // Shapes are written as float32: larger values would come back as infinite.
        if let Some(value) = position.iter().find(|value| (**value as f32).is_infinite()) {
            let expected = "a coordinate below 3.4e38 m, or NaN where the vertex was not observed";
            return refuse(format!("{value:e}"), expected);
        }
        let unseen = position.iter().filter(|value| value.is_nan()).count();
        if unseen == 1 || unseen == 2 {
            return refuse(format!("NaN in {unseen} of 3 coordinates"), "NaN in all three or in none");
        }
    }
    Ok(shape.iter().any(|position| !position.x.is_nan()).then_some(shape))
}
