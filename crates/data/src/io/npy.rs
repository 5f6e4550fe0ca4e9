//! `positions.npy`: the measured shapes as one NumPy array (frames, vertices, 3).
//!
//! The parser is written by hand: the format is a short header before plain numbers, and a header with a wrong size
//! must give an error rather than an overflow.

use super::source::{read_bytes, shown};
use crate::error::{Error, Result};
use nalgebra::Vector3;
use std::path::Path;

/// The shape of one frame; NaN = vertex not observed.
pub(super) type Shape = Vec<Vector3<f64>>;

const MAGIC: &[u8] = b"\x93NUMPY";

/// Reads an array of float32 or float64, little-endian, in C order.
pub(super) fn read(path: &Path, vertices: usize) -> Result<Vec<Shape>> {
    let bytes = read_bytes(path)?;
    let refuse =
        |field: &str, found: String, expected: &str| Error::input(path, None, field, found, expected);
    let (header, data) = split(&bytes)
        .ok_or_else(|| refuse("header", "no NumPy array".into(), "a file written by numpy.save"))?;
    let entry = |key: &str| {
        value(header, key).ok_or_else(|| refuse(key, "nothing".into(), "a header as numpy.save writes it"))
    };
    let size = match entry("descr")?.trim_matches(['\'', '"']) {
        "<f4" => 4,
        "<f8" => 8,
        other => return Err(refuse("descr", shown(other), "<f4 or <f8 (little-endian float32 or float64)")),
    };
    match entry("fortran_order")? {
        "False" => {}
        other => {
            return Err(refuse(
                "fortran_order",
                shown(other),
                "False (save numpy.ascontiguousarray of the array)",
            ));
        }
    }
    let shape = entry("shape")?;
    let expected = format!("(frames, {vertices}, 3), as mesh.obj has {vertices} vertices");
    let frames = match numbers(shape).as_deref() {
        Some(&[frames, found, 3]) if frames > 0 && found == vertices => frames,
        _ => return Err(refuse("shape", shown(shape), &expected)),
    };
    let wanted = vertices.checked_mul(3 * size).and_then(|frame| frame.checked_mul(frames));
    if wanted != Some(data.len()) {
        let expected = wanted.map_or("fewer frames".into(), |wanted| {
            format!("{wanted} bytes, for the shape {}", shown(shape))
        });
        return Err(refuse("data", format!("{} bytes", data.len()), &expected));
    }
    let number = |bytes: &[u8]| match *bytes {
        [a, b, c, d] => f32::from_le_bytes([a, b, c, d]).into(),
        [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
        _ => f64::NAN,
    };
    let vertex = |bytes: &[u8]| Vector3::from_iterator(bytes.chunks_exact(size).map(number));
    let frames = data.chunks_exact(3 * size * vertices);
    let shapes: Vec<Shape> = frames.map(|frame| frame.chunks_exact(3 * size).map(vertex).collect()).collect();
    let largest = shapes.iter().flatten().map(|position| position.amax()).fold(0.0, f64::max);
    // Infinite values are refused later, where frame and vertex are known.
    if size == 4 && largest > FAR && largest.is_finite() {
        let found = format!("float32 coordinates of {largest:.0} m");
        let expected = "float64 at this distance, or a nearer origin (millimetres? divide by 1000)";
        return Err(refuse("data", found, expected));
    }
    Ok(shapes)
}

/// Coordinate beyond which float32 resolves no better than 0.06 mm, the accuracy of cameras, m.
const FAR: f64 = 1e3;

/// True if shapes reach so far that float32 is coarser than the instruments.
pub(super) fn are_far<'a>(shapes: impl IntoIterator<Item = &'a Shape>) -> bool {
    shapes.into_iter().flatten().any(|position| position.amax() > FAR)
}

/// Encodes the array as float32 (6 nm at 0.1 m, finer than any camera), or as float64 if it reaches [`FAR`]. A frame
/// without a shape is all NaN.
pub(super) fn written(shapes: &[Option<&Shape>], vertices: usize) -> Vec<u8> {
    let far = are_far(shapes.iter().copied().flatten());
    let (descr, frames) = (if far { "<f8" } else { "<f4" }, shapes.len());
    let mut header =
        format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({frames}, {vertices}, 3), }}");
    // The header ends with a line feed, and the data start at a multiple of 64 bytes.
    while !(MAGIC.len() + 4 + header.len() + 1).is_multiple_of(64) {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0]);
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    for shape in shapes {
        for vertex in 0..vertices {
            let position =
                shape.and_then(|shape| shape.get(vertex).copied()).unwrap_or(Vector3::repeat(f64::NAN));
            match far {
                true => bytes.extend(position.iter().flat_map(|value| value.to_le_bytes())),
                false => bytes.extend(position.iter().flat_map(|&value| (value as f32).to_le_bytes())),
            }
        }
    }
    bytes
}

/// Header text and data.
fn split(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let rest = bytes.strip_prefix(MAGIC)?;
    let (length, rest) = match *rest {
        [1, _, a, b, ref rest @ ..] => (u16::from_le_bytes([a, b]).into(), rest),
        [2 | 3, _, a, b, c, d, ref rest @ ..] => (u32::from_le_bytes([a, b, c, d]).try_into().ok()?, rest),
        _ => return None,
    };
    let (header, data) = rest.split_at_checked(length)?;
    Some((std::str::from_utf8(header).ok()?, data))
}

/// Text of an entry of the header, a Python dictionary.
fn value<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let at = [format!("'{key}'"), format!("\"{key}\"")]
        .iter()
        .find_map(|quoted| header.find(quoted.as_str()).map(|at| at + quoted.len()))?;
    let text = header[at..].trim_start().strip_prefix(':')?.trim_start();
    let end = if text.starts_with('(') { text.find(')')? + 1 } else { text.find([',', '}'])? };
    Some(text[..end].trim())
}

/// Numbers of a tuple such as `(12, 100, 3)`.
fn numbers(shape: &str) -> Option<Vec<usize>> {
    let inner = shape.strip_prefix('(')?.strip_suffix(')')?;
    inner.split(',').map(str::trim).filter(|text| !text.is_empty()).map(|text| text.parse().ok()).collect()
}
