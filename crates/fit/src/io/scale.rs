//! Millimetres read as metres: lengths that no cloth can reach.

use super::shapes;
use crate::error::{Error, Result};
use crate::frame::{Clip, Frame};
use cloth_sim::mesh::Mesh;
use nalgebra::{Point3, Vector3};
use std::path::Path;

/// No specimen is larger, m.
const LARGEST_SPECIMEN: f64 = 10.0;
/// What is expected instead.
const METRES: &str = "metres (convert millimetres to metres?)";
/// No fabric stretches so far.
const LARGEST_STRETCH: f64 = 10.0;

/// Refuses a specimen of more than 10 m, a shape most of whose edges are ten times as long as at rest, and clips that
/// are ten specimens apart.
pub(super) fn check(folder: &Path, mesh: &Mesh, clips: &[Clip], frames: &[Frame]) -> Result<()> {
    let refuse = |file: &str, field: String, found: String| {
        Err(Error::input(&folder.join(file), None, field, found, METRES))
    };
    let (low, high) = mesh
        .positions
        .iter()
        .fold((mesh.positions[0], mesh.positions[0]), |(low, high), p| (low.inf(p), high.sup(p)));
    let size = (high - low).norm();
    if size > LARGEST_SPECIMEN {
        return refuse("mesh.obj", "v".into(), format!("a specimen of {size} m across"));
    }
    let centres: Vec<Point3<f64>> = clips.iter().map(|clip| centre(mesh, clip)).collect();
    for (index, frame) in frames.iter().enumerate() {
        let moved: Vec<_> = frame.poses.iter().zip(&centres).map(|(pose, centre)| pose * centre).collect();
        let apart = moved.iter().map(|centre| (centre - moved[0]).norm()).fold(0.0, f64::max);
        if apart > LARGEST_STRETCH * size {
            return refuse("clips.csv", format!("frame {index}"), format!("clips {apart} m apart"));
        }
        if let Some(shape) = &frame.positions {
            let (long, all) = long_edges(mesh, shape);
            if 2 * long > all {
                let found = format!("{long} of {all} edges more than ten times as long as at rest");
                let file = shapes::file_of(folder, index);
                return Err(Error::input(&file, None, format!("frame {index}"), found, METRES));
            }
        }
    }
    Ok(())
}

fn centre(mesh: &Mesh, clip: &Clip) -> Point3<f64> {
    let sum: Vector3<f64> = clip.vertices.iter().map(|&vertex| mesh.positions[vertex]).sum();
    Point3::from(sum / clip.vertices.len() as f64)
}

/// How many triangle sides are far too long, of all those observed. Single outliers are for the fit to flag.
fn long_edges(mesh: &Mesh, shape: &[Vector3<f64>]) -> (usize, usize) {
    let sides = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    sides.fold((0, 0), |(long, all), [from, to]| {
        let length = (shape[to] - shape[from]).norm();
        let rest = (mesh.positions[to] - mesh.positions[from]).norm();
        // An edge that was not observed has no length: NaN.
        (long + usize::from(length > LARGEST_STRETCH * rest), all + usize::from(!length.is_nan()))
    })
}
