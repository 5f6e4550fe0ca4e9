//! PLY files: reads vertices from text or binary, writes a shape as text.

use super::number::number_or_unseen;
use super::source::{decoded, read_bytes, shown};
use crate::error::{Error, Result};
use cloth_sim::mesh::Mesh;
use nalgebra::Vector3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, KeyMap, Property, PropertyAccess, PropertyAccessResult, PropertyType,
};
use std::fmt::Write;
use std::path::Path;

/// Reads x, y and z of the element `vertex`; NaN (`nan` in text) = unobserved.
pub(super) fn read(path: &Path) -> Result<Vec<Vector3<f64>>> {
    let mut bytes = read_bytes(path)?;
    if !is_binary(&bytes) {
        bytes = decoded(path, bytes)?.into_bytes();
    }
    let refuse = |error: ParseError, text: bool| {
        let message = error.to_string();
        let reason = message.lines().next().unwrap_or_default();
        let reason =
            reason.split_once(": ").filter(|_| error.line().is_some()).map_or(reason, |(_, reason)| reason);
        // The library counts one line too many if the file ends within a line.
        let lines = bytes.split(|&byte| byte == b'\n').count();
        let line = error.line().filter(|_| text).map(|line| line.min(lines));
        Error::input(path, line, "PLY", shown(reason), "a PLY file with x, y and z of every vertex")
    };
    let mut reader = Reader::new(bytes.as_slice());
    let parser = Parser::<Vertex>::new();
    let header = parser.read_header(&mut reader).map_err(|error| refuse(error, true))?;
    for (_, element) in &header.elements {
        check_size(path, element, bytes.len())?;
    }
    let Some(vertex) = header.elements.get("vertex") else {
        return Err(Error::input(path, None, "element vertex", "nothing", "the vertices"));
    };
    if let Some(axis) = AXES.into_iter().find(|axis| !vertex.properties.contains_key(*axis)) {
        return Err(Error::input(path, None, axis, "nothing", "x, y and z of the element vertex"));
    }
    if header.encoding == Encoding::Ascii {
        return of_text(path, &String::from_utf8_lossy(&bytes), &header.elements);
    }
    let mut vertices = Vec::new();
    for (name, element) in &header.elements {
        vertices = parser
            .read_payload_for_element(&mut reader, element, &header)
            .map_err(|error| refuse(error, false))?;
        if name == "vertex" {
            break;
        }
    }
    Ok(vertices.into_iter().map(|vertex| vertex.0).collect())
}

/// Coordinate properties of a vertex.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Reads vertices from a text file, one line per row; the library parser does not accept `nan`.
fn of_text(path: &Path, text: &str, elements: &KeyMap<ElementDef>) -> Result<Vec<Vector3<f64>>> {
    let rows = (1..).zip(text.lines()).skip_while(|(_, line)| line.trim() != "end_header").skip(1);
    let mut vertices = Vec::new();
    let mut first = 0;
    for (name, element) in elements {
        if name == "vertex" {
            let rows = rows.skip(first).take(element.count);
            vertices = rows.map(|(line, row)| vertex_of(path, line, row, element)).collect::<Result<_>>()?;
            if vertices.len() < element.count {
                let found = format!("{} rows", vertices.len());
                return Err(Error::input(path, None, "element vertex", found, element.count.to_string()));
            }
            break;
        }
        first += element.count;
    }
    Ok(vertices)
}

/// Parses the vertex in a text row.
fn vertex_of(path: &Path, line: usize, row: &str, element: &ElementDef) -> Result<Vector3<f64>> {
    let mut words = row.split_whitespace();
    let mut vertex = Vector3::zeros();
    for (name, property) in &element.properties {
        let word = words.next().unwrap_or_default();
        let refuse = |expected: &str| Error::input(path, line, shown(name), shown(word), expected);
        match AXES.iter().position(|axis| axis == name) {
            Some(axis) => vertex[axis] = number_or_unseen(word).map_err(refuse)?,
            None if word.is_empty() => return Err(refuse("a value for every property")),
            None => {
                if let PropertyType::List(..) = property.data_type
                    && let Some(last) = word.parse::<usize>().ok().and_then(|count| count.checked_sub(1))
                {
                    words.nth(last);
                }
            }
        }
    }
    match words.next() {
        Some(word) => Err(Error::input(path, line, "row", shown(word), "nothing after the last property")),
        None => Ok(vertex),
    }
}

/// True if the header declares a binary format; the body is not text then.
fn is_binary(bytes: &[u8]) -> bool {
    const FORMAT: &[u8] = b"format binary";
    let header = bytes.windows(10).position(|words| words == b"end_header").unwrap_or(bytes.len());
    bytes[..header].windows(FORMAT.len()).any(|words| words == FORMAT)
}

/// Text PLY of a mesh with the given vertex positions.
pub(super) fn shape(mesh: &Mesh, positions: &[Vector3<f64>]) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        positions.len(),
        mesh.triangles.len()
    );
    // Writing into a String cannot fail.
    for p in positions {
        let _ = writeln!(text, "{} {} {}", p.x, p.y, p.z);
    }
    for [a, b, c] in &mesh.triangles {
        let _ = writeln!(text, "3 {a} {b} {c}");
    }
    text
}

/// Checks the declared row count against the file size: each row takes at least one byte, and a false count would
/// keep the reader busy indefinitely.
fn check_size(path: &Path, element: &ElementDef, bytes: usize) -> Result<()> {
    if element.properties.is_empty() {
        let field = format!("element {}", shown(&element.name));
        return Err(Error::input(path, None, field, "no property", "at least one"));
    }
    if element.count > bytes {
        let field = format!("element {}", shown(&element.name));
        return Err(Error::input(
            path,
            None,
            field,
            element.count.to_string(),
            "at most the number of rows in the file",
        ));
    }
    Ok(())
}

/// A vertex while it is read; other properties are skipped.
struct Vertex(Vector3<f64>);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self(Vector3::zeros())
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let coordinate = match name {
            "x" => &mut self.0.x,
            "y" => &mut self.0.y,
            "z" => &mut self.0.z,
            _ => return PropertyAccessResult::Ignored,
        };
        match property {
            Property::Float(value) => *coordinate = value.into(),
            Property::Double(value) => *coordinate = value,
            _ => return PropertyAccessResult::UnsupportedType,
        }
        PropertyAccessResult::Set
    }
}
