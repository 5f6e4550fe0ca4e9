//! Cases 18 and 19: sheets a thousand times too large, and sheets that are not held.

use crate::meshes::{Parts, spoilt};
use crate::property::for_all;
use crate::table::{Extent, Row};
use cloth_data::frame::MeasurementSet;
use cloth_data::io::{read_set, write_set};
use cloth_sim::cloth::Cloth;
use cloth_sim::error::{Error, Part};
use cloth_sim::load::Held;
use cloth_sim::material::Model;
use cloth_sim::mesh::{Diagonals, Grid, Mesh};
use cloth_sim::samples::{self, Sample};
use nalgebra::Vector3;
use proptest::prelude::*;
use std::path::Path;

/// Millimetres read as metres: in one of two places, the lengths disagree; in all places, the specimen is too large.
pub(crate) fn case_18(extent: Extent) -> Vec<Row> {
    let asked = |error: &Error, _: &Parts| {
        matches!(error, Error::EdgeLength { .. }).then(|| "(millimetres?)".to_string())
    };
    let mut rows = vec![
        spoilt(
            18,
            "rest positions",
            extent,
            |sheet, _| {
                sheet.positions.iter_mut().for_each(|p| *p *= 1e3);
            },
            asked,
        ),
        spoilt(
            18,
            "material coordinates",
            extent,
            |sheet, _| {
                sheet.material.iter_mut().for_each(|m| *m *= 1e3);
            },
            asked,
        ),
    ];
    for what in ["the whole specimen", "clip poses", "measured shapes"] {
        rows.push(in_millimetres(what));
    }
    rows
}

/// Every sequence of a fixture, written with some of its lengths a thousand times larger.
fn in_millimetres(what: &str) -> Row {
    let mut row = Row::new(18, format!("{what}, in a set's files"));
    let set = read_set(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/cotton-denim")).unwrap();
    for mut sequence in set.sequences {
        let folder = tempfile::tempdir().unwrap();
        match what {
            "the whole specimen" => {
                sequence.mesh.positions.iter_mut().for_each(|p| *p *= 1e3);
                sequence.mesh.material.iter_mut().for_each(|m| *m *= 1e3);
            }
            "clip poses" => {
                let poses = sequence.frames.iter_mut().flat_map(|frame| &mut frame.poses);
                poses.for_each(|pose| pose.translation.vector *= 1e3);
                // A single or fixed clip has no distances that would disagree.
                if sequence.clips.len() < 2 {
                    continue;
                }
            }
            _ => {
                let shapes = sequence.frames.iter_mut().filter_map(|frame| frame.positions.as_mut());
                let mut any = false;
                shapes.flatten().for_each(|p| (any, *p) = (true, *p * 1e3));
                if !any {
                    continue;
                }
            }
        }
        let name = sequence.name.clone();
        // The writer reads back its output, and fails if it is refused.
        let one = MeasurementSet { fabric: set.fabric.clone(), sequences: vec![sequence] };
        let message = write_set(folder.path(), &one).err().map(|error| error.to_string());
        let named = message.as_ref().is_some_and(|message| message.contains("millimetres"));
        row.holds(named, || format!("{name}: {message:?}"));
    }
    row
}

/// Separate sheets, some of them held: the message names each of the others.
pub(crate) fn case_19(extent: Extent) -> Vec<Row> {
    let conditions = Model::ALL.into_iter().flat_map(|model| [false, true].map(|planar| (model, planar)));
    conditions
        .map(|(model, planar)| {
            let free = if planar { 3 } else { 6 };
            let row = Row::new(19, format!("{model}, {free} rigid motions free"));
            let inputs = (prop::collection::vec((prop::bool::ANY, 2..6usize), 1..6), -3.0..1.0);
            for_all(row, extent.runs(100, 5_000), inputs, |row, (sheets, size): (Vec<_>, f64)| {
                apart(row, model, planar, &sheets, 10f64.powf(size))
            })
        })
        .collect()
}

/// Sheets with the given nodes per side, each held at one node or not.
fn apart(row: &mut Row, model: Model, planar: bool, sheets: &[(bool, usize)], size: f64) -> bool {
    let (mut positions, mut material, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    let (mut held, mut loose) = (Vec::new(), Vec::new());
    for (index, &(pinned, nodes)) in sheets.iter().enumerate() {
        let (width, height, diagonals) = (size, size, Diagonals::Alternating);
        let one = Grid { columns: nodes, rows: nodes, width, height, diagonals }.mesh().unwrap();
        let first = positions.len();
        positions.extend(one.positions.iter().map(|p| p + Vector3::x() * (2.0 * size * index as f64)));
        material.extend(one.material);
        triangles.extend(one.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + first)));
        match pinned {
            true => held.push(Held { node: first + nodes, clip: None }),
            false => loose.push(Part { vertex: first, vertices: nodes * nodes }),
        }
    }
    // Connected parts are checked first: springs would require a grid.
    let mesh = Mesh::new(positions, material, triangles).unwrap();
    let stiffnesses = [300.0, 30.0, if planar { 0.0 } else { 1e-6 }];
    let mut sample = Sample::at_rest(mesh, model, samples::fabric(model, stiffnesses).unwrap());
    sample.held = held;
    sample.planar = planar;
    let components: Vec<_> = sample.curves.components().filter(|c| !planar || !c.is_bending()).collect();
    let error = Cloth::new(&sample.problem(&components, &[])).err();
    let message = error.as_ref().map(Error::to_string).unwrap_or_default();
    let expected = if planar { 3 } else { 6 };
    let holds = match &error {
        Some(Error::Unpinned { parts, free }) => {
            let named = |part: &Part| message.contains(&format!("vertex {} ({}", part.vertex, part.vertices));
            *parts == loose
                && parts.iter().all(named)
                && *free == expected
                && message.contains(&format!("{expected} rigid motions free"))
        }
        Some(Error::NeedsGrid { .. }) => model == Model::SPRINGS && loose.is_empty(),
        None => loose.is_empty(),
        _ => false,
    };
    row.holds(holds, || format!("{sheets:?}, {size}: {error:?}"))
}
