//! A fit's sequences, frame by frame: shapes, clip forces, profiles.

use crate::shown::{ClipForce, Profile, clip_forces, extension, profiles, pulled_rows, vector};
use base64::{Engine, engine::general_purpose::STANDARD};
use cloth_data::frame::{self, MeasurementSet, Phase};
use cloth_fit::stage::report::{ForceRow, SequenceReport};
use cloth_fit::stage::shapes::{FrameShape, Place, Shapes};
use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

/// Marks a coordinate that was not observed.
const NOT_SEEN: i16 = i16::MIN;

/// Inclusion of the frames' shapes in the page. The shapes of a dozen fits would make it too large to send.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frames {
    /// Shapes are included, for the viewer.
    Shown,
    /// Curves, forces and profiles only.
    LeftOut,
}

/// A sequence; arrays are little-endian in base64.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Sequence {
    name: String,
    /// Name and unit of the extension.
    extension: String,
    /// Direction against gravity, or normal to the sheet without gravity.
    up: [f64; 3],
    /// A coordinate is middle + reach × value / 32767, m.
    middle: [f64; 3],
    reach: f64,
    /// u32, three node indices per triangle.
    triangles: String,
    /// f32, two material coordinates per node, m.
    material: String,
    multi_stable: Vec<usize>,
    /// Maxima that scale colours and arrows: m, –, N.
    largest_distance: f64,
    largest_strain: f64,
    largest_force: f64,
    frames: Vec<Frame>,
    /// The pulling force: see [`pulled_rows`].
    forces: Vec<Force>,
    profiles: Vec<Profile>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Frame {
    frame: usize,
    extension: f64,
    /// i16, three coordinates per node.
    simulated: String,
    measured: Option<String>,
    arrows: Vec<ClipForce>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Force {
    frame: usize,
    extension: f64,
    phase: Phase,
    measured: f64,
    simulated: f64,
}

/// The sequences used by a fit.
pub(super) fn sequences(set: &MeasurementSet, found: &[&SequenceReport], frames: Frames) -> Vec<Sequence> {
    let measured = |name: &str| set.sequences.iter().find(|sequence| sequence.name == name);
    found.iter().filter_map(|found| Some(sequence(measured(&found.name)?, found, frames))).collect()
}

fn sequence(measured: &frame::Sequence, found: &SequenceReport, frames: Frames) -> Sequence {
    let shapes = &found.shapes;
    let shown = match frames {
        Frames::Shown => &shapes.frames[..],
        Frames::LeftOut => &[],
    };
    let (middle, reach) = extent(shown);
    let pack = |places: &[Place]| packed(places, middle, reach);
    let frame = |shape: &FrameShape| Frame {
        frame: shape.frame,
        extension: shape.extension,
        simulated: pack(&shape.simulated),
        measured: (!shape.measured.is_empty()).then(|| pack(&shape.measured)),
        arrows: clip_forces(measured, found, shape.frame),
    };
    let frames: Vec<Frame> = shown.iter().map(frame).collect();
    let forces =
        frames.iter().flat_map(|frame| &frame.arrows).flat_map(|arrow| [arrow.measured, arrow.simulated]);
    let upright = (-measured.gravity).try_normalize(0.0).unwrap_or_else(Vector3::z);
    let force = |row: &&ForceRow| Force {
        frame: row.frame,
        extension: row.extension,
        phase: row.phase,
        measured: row.measured.abs(),
        simulated: row.simulated.abs(),
    };
    // The mesh is omitted if there are no frames.
    let encoded = |bytes: &mut dyn Iterator<Item = u8>| match frames.is_empty() {
        true => String::new(),
        false => STANDARD.encode(bytes.collect::<Vec<u8>>()),
    };
    let mut triangles = shapes.triangles.iter().flatten().flat_map(|&node| (node as u32).to_le_bytes());
    let mut material = shapes.material.iter().flat_map(|m| [m.x, m.y]).flat_map(|c| (c as f32).to_le_bytes());
    Sequence {
        name: found.name.clone(),
        extension: extension(found.kind).into(),
        up: upright.into(),
        middle,
        reach,
        triangles: encoded(&mut triangles),
        material: encoded(&mut material),
        multi_stable: found.multi_stable.clone(),
        largest_distance: largest_distance(shown),
        largest_strain: largest_strain(shapes, shown),
        largest_force: forces.map(|force| Vector3::from(force).norm()).fold(0.0, f64::max),
        forces: pulled_rows(&found.forces).iter().map(force).collect(),
        profiles: profiles(measured, shapes),
        frames,
    }
}

/// Centre of all observed and simulated nodes, and the largest half extent along an axis, m.
fn extent(frames: &[FrameShape]) -> ([f64; 3], f64) {
    if frames.is_empty() {
        return ([0.0; 3], 1.0);
    }
    let places = || frames.iter().flat_map(|frame| frame.simulated.iter().chain(&frame.measured));
    let bound = |axis: usize, start: f32, rule: fn(f32, f32) -> f32| {
        // `min` and `max` ignore NaN.
        f64::from(places().map(|place| place[axis]).fold(start, rule))
    };
    let low = [0, 1, 2].map(|axis| bound(axis, f32::INFINITY, f32::min));
    let high = [0, 1, 2].map(|axis| bound(axis, f32::NEG_INFINITY, f32::max));
    let middle = [0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis]));
    let reach = (0..3).map(|axis| 0.5 * (high[axis] - low[axis])).fold(0.0, f64::max);
    (middle, reach.max(f64::MIN_POSITIVE))
}

fn packed(places: &[Place], middle: [f64; 3], reach: f64) -> String {
    let whole = |axis: usize, c: f32| match (f64::from(c) - middle[axis]) / reach * 32767.0 {
        value if value.is_nan() => NOT_SEEN,
        value => value.round().clamp(-32767.0, 32767.0) as i16,
    };
    let bytes = places.iter().flat_map(|place| [0, 1, 2].map(|axis| whole(axis, place[axis]).to_le_bytes()));
    STANDARD.encode(bytes.flatten().collect::<Vec<u8>>())
}

/// Largest distance between the observed and simulated position of a node, m.
fn largest_distance(frames: &[FrameShape]) -> f64 {
    let pairs = frames.iter().flat_map(|frame| frame.simulated.iter().zip(&frame.measured));
    let distance = |(a, b): (&Place, &Place)| (vector(*a) - vector(*b)).norm();
    pairs.map(distance).fold(0.0, f64::max)
}

/// Largest eigenvalue of the Green strain over all triangles and frames.
fn largest_strain(shapes: &Shapes, frames: &[FrameShape]) -> f64 {
    let strain = |frame: &FrameShape, nodes: &[usize; 3]| {
        let [a, b, c] = nodes.map(|node| vector(frame.simulated[node]));
        let [p, q, r]: [Vector2<f64>; 3] = nodes.map(|node| shapes.material[node]);
        let rest = nalgebra::Matrix2::from_columns(&[q - p, r - p]).try_inverse()?;
        let gradient = nalgebra::Matrix3x2::from_columns(&[b - a, c - a]) * rest;
        let green = 0.5 * (gradient.transpose() * gradient - nalgebra::Matrix2::identity());
        Some(green.symmetric_eigenvalues().max())
    };
    frames
        .iter()
        .flat_map(|frame| shapes.triangles.iter().filter_map(move |nodes| strain(frame, nodes)))
        .fold(0.0, f64::max)
}
