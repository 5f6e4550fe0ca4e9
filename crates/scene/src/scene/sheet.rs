//! The sheet of a scene and its position in space.

use super::array::{check_length, vector};
use super::file::{Axis, DiscFile, GridFile, MeshFile, SheetFile};
use cloth_data::error::Result;
use cloth_data::io::{TomlFile, YarnAxes, read_mesh};
use cloth_sim::cloth::Rest;
use cloth_sim::disc::Disc;
use cloth_sim::mesh::{Grid, Mesh};
use nalgebra::Vector3;
use std::path::Path;

/// Axes count as perpendicular up to this cosine of the angle between them.
const PERPENDICULAR: f64 = 1e-6;

/// Node limit, above what any solver here handles in a day; a typing error would otherwise use up all memory.
const MOST_NODES: usize = 1_000_000;

/// Ring limit: a disc with nearly as many nodes, 1 + 3·rings·(rings + 1).
const MOST_RINGS: usize = 576;

/// A sheet this many times its size from the origin loses three of sixteen digits, and more in forces, which are
/// differences.
const FAR: f64 = 1e3;

/// Best origin for a sheet: near the sheet if that is far from zero, in whole metres so that the shift rounds nothing.
pub(super) fn origin(mesh: &Mesh) -> Vector3<f64> {
    let centre = mesh.positions.iter().sum::<Vector3<f64>>() / mesh.len() as f64;
    let size = mesh.positions.iter().map(|position| (position - centre).norm()).fold(0.0, f64::max);
    if centre.norm() > FAR * size { centre.map(f64::round) } else { Vector3::zeros() }
}

/// Builds the mesh that the file describes.
pub(super) fn mesh(sheet: &SheetFile, scene: &Path, file: &TomlFile) -> Result<Mesh> {
    let refuse =
        |key: &str, error: cloth_sim::error::Error| file.invalid(key, error.to_string(), "a valid sheet");
    check_length(file, "sheet.grid.nodes", 2)?;
    if sheet.rest == Rest::AsLaidOut && sheet.mesh.is_none() {
        return Err(file.invalid("sheet.rest", "as-laid-out", "flat, as grids and discs are, or a mesh"));
    }
    let flat = match (&sheet.grid, &sheet.disc, &sheet.mesh) {
        (Some(grid), None, None) => {
            of_grid(grid, file)?.mesh().map_err(|error| refuse("sheet.grid", error))?
        }
        (None, Some(disc), None) => {
            of_disc(disc, file)?.mesh().map_err(|error| refuse("sheet.disc", error))?
        }
        (None, None, Some(mesh)) => {
            let placed = [("origin_m", sheet.origin_m), ("weft", sheet.weft), ("warp", sheet.warp)];
            if let Some((key, _)) = placed.into_iter().find(|(_, value)| value.is_some()) {
                let expected = "none: the mesh file gives the position";
                return Err(file.invalid(&format!("sheet.{key}"), "a position", expected));
            }
            return of_file(mesh, scene, file);
        }
        _ => return Err(file.invalid("sheet", "none or several sheets", "one of grid, disc and mesh")),
    };
    place(flat, sheet, file)
}

fn of_grid(grid: &GridFile, file: &TomlFile) -> Result<Grid> {
    let GridFile { width_m: width, height_m: height, nodes: [columns, rows], diagonals } = *grid;
    if columns.saturating_mul(rows) > MOST_NODES {
        let found = format!("{columns} × {rows} nodes");
        return Err(file.invalid("sheet.grid.nodes", found, format!("at most {MOST_NODES} in all")));
    }
    Ok(Grid { columns, rows, width, height, diagonals })
}

fn of_disc(disc: &DiscFile, file: &TomlFile) -> Result<Disc> {
    let DiscFile { radius_m: radius, rings, kept_ring: kept } = *disc;
    if rings > MOST_RINGS {
        return Err(file.invalid("sheet.disc.rings", rings.to_string(), format!("at most {MOST_RINGS}")));
    }
    if let Some(ring) = kept.filter(|ring| !(1..=rings).contains(ring)) {
        return Err(file.invalid("sheet.disc.kept_ring", ring.to_string(), format!("1 to {rings}")));
    }
    Ok(Disc { radius, rings, kept })
}

fn of_file(mesh: &MeshFile, scene: &Path, file: &TomlFile) -> Result<Mesh> {
    let path = scene.parent().unwrap_or(Path::new("")).join(&mesh.file);
    let axes = match (mesh.weft, mesh.warp) {
        (None, None) => None,
        (Some(weft), Some(warp)) if weft != warp => Some(YarnAxes { weft: unit(weft), warp: unit(warp) }),
        _ => {
            return Err(file.invalid(
                "sheet.mesh",
                "one axis",
                "weft and warp along two axes, or vt in the file",
            ));
        }
    };
    read_mesh(&path, axes)
}

fn unit(axis: Axis) -> Vector3<f64> {
    match axis {
        Axis::X => Vector3::x(),
        Axis::Y => Vector3::y(),
        Axis::Z => Vector3::z(),
    }
}

/// Places material coordinates (u, v) at origin + u·weft + v·warp.
fn place(flat: Mesh, sheet: &SheetFile, file: &TomlFile) -> Result<Mesh> {
    let axis = |key: &str, given: Option<[f64; 3]>, default: Vector3<f64>| {
        let axis = given.map_or(Ok(default), |given| vector(file, key, given))?;
        let length = axis.norm();
        if length > 0.0 {
            return Ok(axis / length);
        }
        Err(file.invalid(key, "zero", "a direction"))
    };
    let weft = axis("sheet.weft", sheet.weft, Vector3::x())?;
    let warp = axis("sheet.warp", sheet.warp, Vector3::y())?;
    if weft.dot(&warp).abs() > PERPENDICULAR {
        let found = format!("{:.4}° from weft", weft.angle(&warp).to_degrees());
        return Err(file.invalid("sheet.warp", found, "a direction across weft, at 90°"));
    }
    let origin = vector(file, "sheet.origin_m", sheet.origin_m.unwrap_or_default())?;
    let positions = flat.material.iter().map(|m| origin + m.x * weft + m.y * warp).collect();
    let grid = flat.grid;
    // A sheet that is valid near the origin may not be where coordinates are too coarse to separate its nodes.
    let mesh = Mesh::new(positions, flat.material, flat.triangles)
        .map_err(|error| file.invalid("sheet.origin_m", error.to_string(), "a position nearer to zero"))?;
    Ok(Mesh { grid, ..mesh })
}
