//! Vertices of a PLY file, text or binary; a shape as one.

use super::source::{decoded, read_bytes, shown};
use crate::error::{Error, Result};
use cloth_sim::mesh::Mesh;
use nalgebra::Vector3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Property, PropertyAccess, PropertyAccessResult};
use std::fmt::Write;
use std::path::Path;

/// Reads x, y and z of the element `vertex`; in a binary file NaN = not observed.
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
        // The reader counts one line more where the file ends within one.
        let lines = bytes.split(|&byte| byte == b'\n').count();
        let line = error.line().filter(|_| text).map(|line| line.min(lines));
        Error::input(path, line, "PLY", shown(reason), "a PLY file with x, y and z of every vertex")
    };
    let mut reader = Reader::new(bytes.as_slice());
    let parser = Parser::<Vertex>::new();
    let header = parser.read_header(&mut reader).map_err(|error| refuse(error, true))?;
    let mut line = 1 + bytes.split(|&byte| byte == b'\n').position(|line| line == b"end_header").unwrap_or(0);
    for (name, element) in &header.elements {
        check_size(path, element, bytes.len())?;
        let vertices = parser
            .read_payload_for_element(&mut reader, element, &header)
            .map_err(|error| refuse(error, header.encoding == Encoding::Ascii))?;
        if name == "vertex" {
            for axis in ["x", "y", "z"] {
                if !element.properties.contains_key(axis) {
                    return Err(Error::input(
                        path,
                        None,
                        axis,
                        "nothing",
                        "x, y and z of the element vertex",
                    ));
                }
            }
            let shape: Vec<Vector3<f64>> = vertices.into_iter().map(|vertex| vertex.0).collect();
            let infinite = |p: &Vector3<f64>| p.iter().any(|value| value.is_infinite());
            return match shape.iter().position(infinite).filter(|_| header.encoding == Encoding::Ascii) {
                Some(vertex) => {
                    let found = shown(&format!("{:?}", shape[vertex].as_slice()));
                    Err(Error::input(path, line + vertex + 1, "vertex", found, "finite numbers"))
                }
                None => Ok(shape),
            };
        }
        // A text has a line a row.
        line += element.count;
    }
    Err(Error::input(path, None, "element vertex", "nothing", "the vertices"))
}

/// True if the header says so: what stands below it is then no text.
fn is_binary(bytes: &[u8]) -> bool {
    const FORMAT: &[u8] = b"format binary";
    let header = bytes.windows(10).position(|words| words == b"end_header").unwrap_or(bytes.len());
    bytes[..header].windows(FORMAT.len()).any(|words| words == FORMAT)
}

/// A mesh with its vertices somewhere, as text.
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

/// An element takes a byte a row at least: a header that promises more would keep the reader busy for ever.
fn check_size(path: &Path, element: &ElementDef, bytes: usize) -> Result<()> {
    if element.properties.is_empty() {
        let field = format!("element {}", shown(&element.name));
        return Err(Error::input(path, None, field, "no property", "one at least"));
    }
    if element.count > bytes {
        let field = format!("element {}", shown(&element.name));
        return Err(Error::input(
            path,
            None,
            field,
            element.count.to_string(),
            "as many rows as the file holds",
        ));
    }
    Ok(())
}

/// A vertex while it is read; every other property is passed over.
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
