//! Detects other units read as metres: lengths implausible for cloth.

use super::npy::are_far;
use super::shapes;
use crate::error::{Error, Result};
use crate::frame::{Clip, Frame};
use cloth_sim::mesh::Mesh;
use nalgebra::{Point3, Vector3};
use std::path::Path;

/// Largest plausible specimen, m.
const LARGEST_SPECIMEN: f64 = 10.0;
/// Expectation if the length does not reveal the unit.
const METRES: &str = "metres (convert millimetres or centimetres to metres?)";
/// Largest plausible stretch ratio of a fabric.
const LARGEST_STRETCH: f64 = 10.0;

/// Refuses specimens of more than 10 m, shapes with most edges ten times as long as at rest, and clips more than ten
/// specimen sizes apart.
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
    let far = are_far(frames.iter().filter_map(|frame| frame.positions.as_ref()));
    let centres: Vec<Point3<f64>> = clips.iter().map(|clip| centre(mesh, clip)).collect();
    for (index, frame) in frames.iter().enumerate() {
        let moved: Vec<_> = frame.poses.iter().zip(&centres).map(|(pose, centre)| pose * centre).collect();
        let apart = moved.iter().map(|centre| (centre - moved[0]).norm()).fold(0.0, f64::max);
        if apart > LARGEST_STRETCH * size {
            return refuse("clips.csv", format!("frame {index}"), format!("clips {apart} m apart"));
        }
        if let Some(shape) = &frame.positions {
            let stretches = stretches(mesh, shape, far);
            let (long, all) = (stretches.iter().filter(|&&by| by > LARGEST_STRETCH).count(), stretches.len());
            if 2 * long > all {
                let found = format!("{long} of {all} edges more than ten times as long as at rest");
                let file = shapes::file_of(folder, index);
                let expected = in_metres(stretches);
                return Err(Error::input(&file, None, format!("frame {index}"), found, expected));
            }
        }
    }
    Ok(())
}

fn centre(mesh: &Mesh, clip: &Clip) -> Point3<f64> {
    let sum: Vector3<f64> = clip.vertices.iter().map(|&vertex| mesh.positions[vertex]).sum();
    Point3::from(sum / clip.vertices.len() as f64)
}

/// Stretch ratio of each observed triangle side. Single outliers are left to the fit. Shapes are evaluated in the
/// precision in which they are written, so that a set that was read can be written and read again.
///
/// * `far` — double precision if true, else single
fn stretches(mesh: &Mesh, shape: &[Vector3<f64>], far: bool) -> Vec<f64> {
    let sides = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let written = |vertex: usize| shape[vertex].map(|c| if far { c } else { f64::from(c as f32) });
    let stretch = |[from, to]: [usize; 2]| {
        let rest = (mesh.positions[to] - mesh.positions[from]).norm();
        (written(to) - written(from)).norm() / rest
    };
    // Unobserved edges have length NaN.
    sides.map(stretch).filter(|stretch| !stretch.is_nan()).collect()
}

/// The expectation for shapes that are too long by these ratios.
fn in_metres(mut stretches: Vec<f64>) -> &'static str {
    stretches.sort_by(f64::total_cmp);
    match stretches[stretches.len() / 2] {
        500.0..2000.0 => "metres (convert millimetres to metres?)",
        50.0..200.0 => "metres (convert centimetres to metres?)",
        _ => "the shape of this specimen in metres, its vertices in the order of mesh.obj",
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use nalgebra::Vector2;

    #[test]
    fn a_shape_is_judged_alike_before_and_after_it_was_written() {
        let corners = [[0.0, 0.0], [0.08, 0.0], [0.0, 0.04]];
        let material = corners.map(|[u, v]| Vector2::new(u, v)).to_vec();
        let positions = corners.map(|[u, v]| Vector3::new(u, v, 0.0)).to_vec();
        let mesh = Mesh::new(positions, material, vec![[0, 1, 2]]).unwrap();
        // Two of three sides are ten times as long as at rest, slightly more, or slightly less after rounding to
        // single precision.
        for length in [0.8, 0.8 * (1.0 + 1e-9), 0.8 * (1.0 - 1e-9), 0.8000001] {
            let shape = [[0.0, 0.0, 0.0], [length, 0.0, 0.0], [0.0, 0.5 * length, 0.0]].map(Vector3::from);
            let written = shape.map(|place| place.map(|c| f64::from(c as f32)));
            let long = |shape: &[Vector3<f64>]| {
                stretches(&mesh, shape, false).iter().filter(|&&by| by > LARGEST_STRETCH).count()
            };
            assert_eq!(long(&shape), long(&written), "{length}");
        }
    }
}
