//! The specimen in the simulation: a regular grid over the measured rest rectangle, in a frame of its own.
//!
//! ```text
//! measured mesh (any triangulation, any place in space)        specimen frame
//!        ______                                             y │
//!       /\ /| /                                               │▒▒▒▒▒▒▒▒   rest rectangle at z = 0, corner at 0,
//!      /  \/|/           ── isometry ──▶                      │▒▒▒▒▒▒▒▒   x along its side nearer to weft
//!      ‾‾‾‾‾‾                                                 └────────x
//! ```

use super::lines::Lines;
use cloth_data::error::{Error, Result};
use cloth_data::frame::{MeshPoint, Sequence};
use cloth_data::locator::Locator;
use cloth_data::rectangle::{Rectangle, bounds};
use cloth_sim::mesh::{Diagonals, Grid, Mesh};
use nalgebra::{Isometry3, Vector2, Vector3};

/// Most nodes along a side.
pub(crate) const MOST_NODES: usize = 1000;

/// True if cells serve for those of a given side: within 10 %, so that the error of the grid is the same within a fifth.
///
/// * `cell`, `side` — m
pub fn is_alike(cell: f64, side: f64) -> bool {
    (cell / side - 1.0).abs() <= 0.1
}

/// Default number of cells along each side of a square specimen: 25×25 nodes.
const DEFAULT_CELLS: usize = 24;

/// The simulation's grid over a measured specimen.
#[derive(Debug, Clone)]
pub struct Specimen {
    /// Maps world coordinates into the specimen's frame.
    pub frame: Isometry3<f64>,
    /// The grid as a mesh, in the specimen's frame; material coordinates are the measured ones.
    pub mesh: Mesh,
    /// The grid.
    pub grid: Grid,
    /// Position of each grid node in the measured mesh.
    pub samples: Vec<MeshPoint>,
    /// The grid's lines across x and across y.
    pub lines: [Lines; 2],
    /// Cloth inside each clip, cut off from the grid, m².
    pub gripped: Vec<f64>,
}

/// Size of a specimen's grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GridSize {
    /// As many cells as 25×25 nodes have, near square.
    NearSquare,
    /// Columns and rows.
    Nodes([usize; 2]),
    /// Side of a cell within 10 %, m; at least two cells a side.
    Cell(f64),
}

impl GridSize {
    /// Columns and rows on a rectangle.
    fn nodes(self, width: f64, height: f64, diagonals: Diagonals) -> [usize; 2] {
        match self {
            Self::NearSquare => near_square(width, height, diagonals),
            Self::Nodes(nodes) => nodes,
            Self::Cell(side) => [width, height]
                .map(|length| (length / side).round().clamp(2.0, MOST_NODES as f64) as usize + 1),
        }
    }
}

/// The grid of a specimen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cells {
    /// Columns and rows.
    pub size: GridSize,
    /// Split of the cells.
    pub diagonals: Diagonals,
    /// Every cell is cut into so many along each side.
    pub refinement: usize,
    /// Lines run where clips end; else all cells are equal.
    pub to_clips: bool,
}

impl Specimen {
    /// Lays a grid over a sequence's rest mesh, without the cloth inside bars that grip a whole side: it moves
    /// rigidly, and the grid's border lies on the bar's edge, wherever that is.
    ///
    /// # Errors
    /// A rest mesh that is not a flat rectangle; too few nodes; cells too small for it, or no number of which fills it.
    pub fn new(sequence: &Sequence, cells: &Cells) -> Result<Self> {
        let Cells { size, diagonals, refinement, to_clips } = *cells;
        let mechanics = |source| Error::Mechanics { context: sequence.name.clone(), source };
        let rectangle = Rectangle::of(sequence)?;
        let (free, gripped) = free_region(sequence, &rectangle);
        let [corner, opposite] = free;
        let [width, height] = [opposite.x - corner.x, opposite.y - corner.y];
        let [columns, rows] = size.nodes(width, height, diagonals);
        if columns.max(rows) > MOST_NODES {
            let found = format!("{columns}x{rows} nodes");
            return Err(Error::geometry(
                &sequence.name,
                found,
                format!("at most {MOST_NODES} a side (larger cells)"),
            ));
        }
        let cells = [width / (columns - 1) as f64, height / (rows - 1) as f64];
        if let GridSize::Cell(side) = size
            && !cells.iter().all(|&cell| is_alike(cell, side))
        {
            let [width, height, side] = [width, height, side].map(|length| 1e3 * length);
            return Err(Error::geometry(
                &sequence.name,
                format!("{width:.1} mm × {height:.1} mm of free cloth for cells of {side} mm"),
                format!(
                    "at least two cells a side, and a whole number within 10 % (--for-mesh {:.2})",
                    1e3 * cells[0].min(cells[1])
                ),
            ));
        }
        let counts = [columns, rows].map(|nodes| refinement * nodes.saturating_sub(1) + 1);
        let grid = Grid { columns: counts[0], rows: counts[1], width, height, diagonals };
        let mut mesh = grid.mesh().map_err(mechanics)?;
        let ends = if to_clips { clip_ends(sequence, &rectangle, corner) } else { [Vec::new(), Vec::new()] };
        let lines = [(width, columns, &ends[0]), (height, rows, &ends[1])]
            .map(|(length, nodes, ends)| Lines::new(length, nodes - 1, ends).refined(refinement));
        let [dx, dy] = grid.cell();
        for position in &mut mesh.positions {
            *position = Vector3::new(lines[0].at(position.x / dx), lines[1].at(position.y / dy), 0.0);
        }
        let locator = Locator::new(&sequence.mesh, &rectangle.flat, rectangle.size);
        let samples: Vec<MeshPoint> = mesh.positions.iter().map(|p| locator.find(p.xy() + corner)).collect();
        for (material, sample) in mesh.material.iter_mut().zip(&samples) {
            *material = sample.interpolate(&sequence.mesh, &sequence.mesh.material);
        }
        let checked = Mesh::new(mesh.positions, mesh.material, mesh.triangles).map_err(mechanics)?;
        let mut frame = rectangle.frame;
        frame.translation.vector -= Vector3::new(corner.x, corner.y, 0.0);
        Ok(Self { frame, mesh: Mesh { grid: Some(grid), ..checked }, grid, samples, lines, gripped })
    }

    /// The grid's nodes at rest, in world coordinates, m.
    pub fn rest_in_world(&self, node: usize) -> Vector3<f64> {
        let inverse = self.frame.inverse();
        inverse.rotation * self.mesh.positions[node] + inverse.translation.vector
    }

    /// Material coordinates of a point of the rest rectangle, m: bilinear in equal cells, and beyond its border.
    pub fn material(&self, at: Vector2<f64>) -> Vector2<f64> {
        let [dx, dy] = self.grid.cell();
        let place = |at: f64, cell: f64, nodes: usize| {
            let first = (at / cell).floor().clamp(0.0, (nodes - 2) as f64);
            (first as usize, at / cell - first)
        };
        let ((column, u), (row, v)) = (place(at.x, dx, self.grid.columns), place(at.y, dy, self.grid.rows));
        let corner = |i: usize, j: usize| self.mesh.material[self.grid.node(column + i, row + j)];
        (corner(0, 0) * (1.0 - u) + corner(1, 0) * u) * (1.0 - v)
            + (corner(0, 1) * (1.0 - u) + corner(1, 1) * u) * v
    }

    /// A world position in the specimen's frame.
    pub fn place(&self, world: &Vector3<f64>) -> Vector3<f64> {
        self.frame.rotation * world + self.frame.translation.vector
    }

    /// A world direction (force, gravity) in the specimen's frame.
    pub fn turn(&self, world: &Vector3<f64>) -> Vector3<f64> {
        self.frame.rotation * world
    }
}

/// The rectangle between the bars that grip whole sides, as two corners, and the area inside each bar.
fn free_region(sequence: &Sequence, rectangle: &Rectangle) -> ([Vector2<f64>; 2], Vec<f64>) {
    let [width, height] = rectangle.size;
    let size = Vector2::new(width, height);
    let (mut low, mut high) = (Vector2::zeros(), size);
    let boxes = sequence.clips.iter().map(|clip| bounds(clip.vertices.iter().map(|&v| rectangle.flat[v])));
    let mut gripped = Vec::new();
    for [from, to] in boxes {
        let mut area = 0.0;
        for (along, across) in [(0, 1), (1, 0)] {
            let near = 1e-3 * size[along];
            let whole_side = to[across] - from[across] > 0.98 * size[across];
            let deep = to[along] - from[along];
            // Anything deeper than half the specimen is not a bar.
            if !whole_side || deep > 0.5 * size[along] {
                continue;
            }
            if from[along] < near {
                low[along] = f64::max(low[along], to[along]);
            } else if to[along] > size[along] - near {
                high[along] = f64::min(high[along], from[along]);
            } else {
                continue;
            }
            area += deep * size[across];
        }
        gripped.push(area);
    }
    ([low, high], gripped)
}

/// Where clips end, along x and y from a corner, m.
fn clip_ends(sequence: &Sequence, rectangle: &Rectangle, corner: Vector2<f64>) -> [Vec<f64>; 2] {
    let boxes = sequence.clips.iter().map(|clip| bounds(clip.vertices.iter().map(|&v| rectangle.flat[v])));
    let ends: Vec<Vector2<f64>> = boxes.flatten().map(|end| end - corner).collect();
    [0, 1].map(|axis| ends.iter().map(|end| end[axis]).collect())
}

/// Columns and rows for nearly square cells, with about as many nodes as 25×25; crossed cells have one more node
/// each.
pub(crate) fn near_square(width: f64, height: f64, diagonals: Diagonals) -> [usize; 2] {
    let cells =
        (DEFAULT_CELLS * DEFAULT_CELLS) as f64 / if diagonals == Diagonals::Crossed { 2.0 } else { 1.0 };
    let count = |length: f64, side: f64| (length / side).round().max(2.0);
    // The shorter side first: it has fewer cells, and the longer side then matches their size better.
    let shorter = width.min(height);
    let side = shorter / count(shorter, (width * height / cells).sqrt());
    [width, height].map(|length| count(length, side) as usize + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_data::frame::Kind;

    fn sequence(mesh: Mesh) -> Sequence {
        Sequence {
            name: "test".into(),
            kind: Kind::StretchWeft,
            gravity: Vector3::zeros(),
            noise: None,
            force_direction: None,
            table: None,
            mesh,
            clips: Vec::new(),
            frames: Vec::new(),
        }
    }

    fn cells(size: GridSize) -> Cells {
        Cells { size, diagonals: Diagonals::Forward, refinement: 1, to_clips: true }
    }

    fn rectangle(width: f64, height: f64) -> Mesh {
        Grid { columns: 14, rows: 9, width, height, diagonals: Diagonals::Alternating }.mesh().unwrap()
    }

    #[test]
    fn a_grid_is_laid_over_a_specimen_wherever_it_is() {
        let mut mesh = rectangle(0.08, 0.04);
        let motion = Isometry3::new(Vector3::new(0.3, -0.2, 0.9), Vector3::new(0.4, 1.2, -0.7));
        mesh.positions.iter_mut().for_each(|p| *p = motion.rotation * *p + motion.translation.vector);
        let specimen = Specimen::new(&sequence(mesh), &cells(GridSize::NearSquare)).unwrap();
        let [dx, dy] = specimen.grid.cell();
        assert!((dx / dy - 1.0).abs() < 0.05, "{dx} {dy}");
        assert!((specimen.grid.width - 0.08).abs() < 1e-12 && (specimen.grid.height - 0.04).abs() < 1e-12);
        for (node, material) in specimen.mesh.material.iter().enumerate() {
            assert!((material - specimen.mesh.positions[node].xy()).norm() < 1e-12);
            assert!(
                (specimen.place(&specimen.rest_in_world(node)) - specimen.mesh.positions[node]).norm()
                    < 1e-12
            );
        }
    }

    #[test]
    fn a_strip_cut_on_the_bias_keeps_its_yarns() {
        let mut mesh = rectangle(0.03, 0.1);
        let turn = nalgebra::Rotation2::new(std::f64::consts::FRAC_PI_4);
        mesh.material.iter_mut().for_each(|m| *m = turn * *m);
        let specimen = Specimen::new(&sequence(mesh), &cells(GridSize::Nodes([5, 13]))).unwrap();
        assert_eq!(specimen.grid.columns * specimen.grid.rows, 65);
        let along = specimen.mesh.material[1] - specimen.mesh.material[0];
        assert!((along.x.abs() - along.y.abs()).abs() < 1e-9 * along.norm());
    }

    #[test]
    fn what_is_no_rectangle_is_refused() {
        let mut mesh = rectangle(0.1, 0.1);
        let shear = |p: f64, q: f64| p + 0.3 * q;
        mesh.positions.iter_mut().for_each(|p| p.x = shear(p.x, p.y));
        assert!(Specimen::new(&sequence(mesh), &cells(GridSize::NearSquare)).is_err());
    }
}
