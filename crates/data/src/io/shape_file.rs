//! Writes a series of shapes of a sheet as files for other programs and for [`read_sequence`](super::read_sequence).

use super::{npy, obj, ply};
use crate::error::{Error, Result};
use crate::store::write_file;
use cloth_sim::mesh::Mesh;
use nalgebra::Vector3;
use std::path::Path;

/// File format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShapeFormat {
    /// `frames/0000.obj` and so on.
    Obj,
    /// `frames/0000.ply` and so on.
    Ply,
    /// One `positions.npy`: (frames, vertices, 3), float32.
    Npy,
}

/// Writes the rest mesh `mesh.obj` and the shapes into an existing folder.
///
/// * `shapes` — a position of every vertex, m
///
/// # Errors
/// A failed system call.
pub fn write_shapes(
    folder: &Path,
    mesh: &Mesh,
    shapes: &[Vec<Vector3<f64>>],
    format: ShapeFormat,
) -> Result<()> {
    write_file(&folder.join("mesh.obj"), obj::written(mesh).as_bytes())?;
    type Written = fn(&Mesh, &[Vector3<f64>]) -> String;
    let (ending, written): (_, Written) = match format {
        ShapeFormat::Obj => ("obj", obj::shape),
        ShapeFormat::Ply => ("ply", ply::shape),
        ShapeFormat::Npy => {
            let shapes: Vec<_> = shapes.iter().map(Some).collect();
            return write_file(&folder.join("positions.npy"), &npy::written(&shapes, mesh.len()));
        }
    };
    let frames = folder.join("frames");
    std::fs::create_dir_all(&frames).map_err(|source| Error::io(&frames, source))?;
    for (index, shape) in shapes.iter().enumerate() {
        write_file(&frames.join(format!("{index:04}.{ending}")), written(mesh, shape).as_bytes())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::shapes;
    use cloth_sim::mesh::{Diagonals, Grid};

    #[test]
    fn every_format_is_read_back() {
        let grid = Grid { columns: 3, rows: 2, width: 0.2, height: 0.1, diagonals: Diagonals::Forward };
        let mesh = grid.mesh().unwrap();
        let moved = |by: f64| mesh.positions.iter().map(|p| p.add_scalar(by)).collect::<Vec<_>>();
        let written = [moved(0.0), moved(1.0 / 3.0)];
        for (format, exact) in [(ShapeFormat::Obj, 0.0), (ShapeFormat::Ply, 0.0), (ShapeFormat::Npy, 1e-7)] {
            let folder = tempfile::tempdir().unwrap();
            write_shapes(folder.path(), &mesh, &written, format).unwrap();
            let present = crate::io::entries(folder.path()).unwrap();
            let read = shapes::read(folder.path(), &present, mesh.len()).unwrap().unwrap();
            assert_eq!(read.len(), 2, "{format:?}");
            for (read, written) in read.into_iter().flatten().flatten().zip(written.iter().flatten()) {
                assert!((read - written).amax() <= exact, "{format:?}: {read} {written}");
            }
        }
    }
}
