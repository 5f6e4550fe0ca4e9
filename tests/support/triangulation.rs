//! One rectangle, triangulated in five ways.

use cloth_sim::mesh::{Diagonals, Grid, Mesh};
use nalgebra::{Rotation2, Vector2, Vector3};
use rand::{Rng, SeedableRng, rngs::StdRng};

/// How a rectangle is split into triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Triangulation {
    /// Squares with one diagonal, all the same way.
    Uniform,
    /// Squares with one diagonal, as on a chessboard.
    Alternating,
    /// Squares with both diagonals.
    Crossed,
    /// Triangles with equal sides, but for halves at two borders.
    Equilateral,
    /// Delaunay triangles of nodes that lie within 0.3 cells of a grid's.
    Irregular,
}

impl Triangulation {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::Uniform, Self::Alternating, Self::Crossed, Self::Equilateral, Self::Irregular];

    /// A flat rectangle in the plane z = 0 with straight columns of nodes at its first two.
    ///
    /// * `cells` — along x and y
    /// * `cell` — along x, m; its corner is at the origin
    /// * `degrees` — from the x axis to the weft
    ///
    /// # Panics
    /// If there are no cells.
    pub fn mesh(self, cells: [usize; 2], cell: f64, degrees: f64) -> Mesh {
        let [width, height] = cells.map(|count| count as f64 * cell);
        let grid = |diagonals| {
            let grid = Grid { columns: cells[0] + 1, rows: cells[1] + 1, width, height, diagonals };
            grid.mesh().expect("a grid with cells")
        };
        let mut mesh = match self {
            Self::Uniform => grid(Diagonals::Forward),
            Self::Alternating => grid(Diagonals::Alternating),
            Self::Crossed => grid(Diagonals::Crossed),
            Self::Equilateral => {
                let rows = (0.75f64.sqrt() * cells[1] as f64).round().max(1.0) as usize;
                delaunay(
                    &(0..=cells[0])
                        .flat_map(|column| lattice_column(column, rows, [cell, height]))
                        .collect::<Vec<_>>(),
                )
            }
            Self::Irregular => {
                let mut random = StdRng::seed_from_u64(11);
                let nodes: Vec<Vector2<f64>> = grid(Diagonals::Forward)
                    .material
                    .iter()
                    .map(|node| {
                        let inside = node.x > 1.5 * cell && node.x < width - 0.5 * cell;
                        let inside = inside && node.y > 0.5 * cell && node.y < height - 0.5 * cell;
                        let shift = Vector2::from_fn(|_, _| random.random_range(-0.3..0.3) * cell);
                        if inside { node + shift } else { *node }
                    })
                    .collect();
                delaunay(&nodes)
            }
        };
        let to_weft = Rotation2::new(-degrees.to_radians());
        mesh.material.iter_mut().for_each(|place| *place = to_weft * *place);
        mesh
    }
}

/// Nodes of a column, every other one shifted by half a cell, with both ends at the border.
fn lattice_column(column: usize, rows: usize, [cell, height]: [f64; 2]) -> Vec<Vector2<f64>> {
    let step = height / rows as f64;
    let x = column as f64 * cell;
    let places: Vec<f64> = match column % 2 {
        0 => (0..=rows).map(|row| row as f64 * step).collect(),
        _ => std::iter::once(0.0)
            .chain((0..rows).map(|row| (row as f64 + 0.5) * step))
            .chain([height])
            .collect(),
    };
    places.into_iter().map(|y| Vector2::new(x, y)).collect()
}

/// The Delaunay triangulation of nodes.
fn delaunay(nodes: &[Vector2<f64>]) -> Mesh {
    let points: Vec<delaunator::Point> =
        nodes.iter().map(|node| delaunator::Point { x: node.x, y: node.y }).collect();
    let triangles = delaunator::triangulate(&points).triangles;
    let double = |[a, b, c]: [usize; 3]| (nodes[b] - nodes[a]).perp(&(nodes[c] - nodes[a]));
    let largest = triangles.chunks_exact(3).map(|t| double([t[0], t[1], t[2]]).abs()).fold(0.0, f64::max);
    let triangles = triangles.chunks_exact(3).map(|t| [t[0], t[1], t[2]]);
    // Three nodes of a straight border are no triangle.
    let triangles = triangles.filter(|&t| double(t).abs() > 1e-6 * largest);
    let upwards = |[a, b, c]: [usize; 3]| if double([a, b, c]) > 0.0 { [a, b, c] } else { [a, c, b] };
    let places = nodes.iter().map(|node| Vector3::new(node.x, node.y, 0.0)).collect();
    Mesh::new(places, nodes.to_vec(), triangles.map(upwards).collect()).expect("a triangulation")
}
