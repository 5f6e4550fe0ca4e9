//! The frame of a sequence shown in figures, on a mesh coarsened for drawing.

use crate::shown::vector;
use cloth_data::frame::{Kind, Table};
use cloth_data::kind::Extension;
use cloth_fit::stage::shapes::{FrameShape, Place, Shapes};
use cloth_sim::mesh::{Diagonals, Grid, Mesh};
use nalgebra::Vector3;

/// Maximum nodes per side: more would enlarge the file without showing more.
const FINEST: usize = 26;

/// One frame of a sequence.
pub(super) struct Sheet {
    /// Index of the frame in its sequence.
    pub(super) frame: usize,
    /// Extension of the test in this frame.
    pub(super) extension: f64,
    /// Columns and rows of nodes.
    pub(super) grid: Grid,
    /// The sheet in equilibrium.
    pub(super) mesh: Mesh,
    /// Observed positions of the nodes, m, NaN if not observed; empty if no shape was measured.
    pub(super) measured: Vec<Vector3<f64>>,
    /// Root mean square distance over all observed nodes, m.
    pub(super) rms: Option<f64>,
}

impl Sheet {
    /// The frame of largest extension, preferably with a measured shape.
    pub(super) fn farthest(shapes: &Shapes) -> Option<Self> {
        let order = |frame: &&FrameShape| (!frame.measured.is_empty(), frame.extension);
        let frame = shapes.frames.iter().max_by(|a, b| {
            let [(a_seen, a), (b_seen, b)] = [order(a), order(b)];
            a_seen.cmp(&b_seen).then(a.total_cmp(&b))
        })?;
        let finest = shapes.grid.columns.max(shapes.grid.rows);
        let (grid, nodes, triangles) = match finest > FINEST {
            true => coarser(&shapes.grid, (finest - 1).div_ceil(FINEST - 1))?,
            false => (shapes.grid, (0..shapes.material.len()).collect(), shapes.triangles.clone()),
        };
        let places = |places: &[Place]| -> Vec<Vector3<f64>> {
            nodes.iter().filter_map(|&node| places.get(node)).map(|place| vector(*place)).collect()
        };
        let material = nodes.iter().map(|&node| shapes.material[node]).collect();
        let mesh = Mesh { positions: places(&frame.simulated), material, triangles, grid: None };
        let distances =
            frame.simulated.iter().zip(&frame.measured).map(|(a, b)| (vector(*b) - vector(*a)).norm());
        let seen: Vec<f64> = distances.filter(|distance| distance.is_finite()).collect();
        let mean = seen.iter().map(|distance| distance * distance).sum::<f64>() / seen.len() as f64;
        Some(Self {
            frame: frame.frame,
            extension: frame.extension,
            grid,
            mesh,
            measured: places(&frame.measured),
            rms: (!seen.is_empty()).then(|| mean.sqrt()),
        })
    }

    /// Appends frame and extension to a figure's title.
    pub(super) fn titled(&self, title: &str, kind: Kind) -> String {
        let extension = match kind.extension() {
            Extension::ShearAngle => format!("shear angle {:.3} rad", self.extension),
            Extension::Overhang => format!("overhang {:.1} mm", 1e3 * self.extension),
            Extension::Elongation => format!("extension {:.2} %", 100.0 * self.extension),
        };
        format!("{title}: frame {}, {extension}", self.frame)
    }

    /// Grid lines in both directions.
    pub(super) fn lines(&self) -> impl Iterator<Item = Vec<Vector3<f64>>> + '_ {
        let Grid { columns, rows, .. } = self.grid;
        let at = |column: usize, row: usize| self.mesh.positions[self.grid.node(column, row)];
        let along = (0..rows).map(move |row| (0..columns).map(|column| at(column, row)).collect());
        along.chain((0..columns).map(move |column| (0..rows).map(|row| at(column, row)).collect()))
    }

    /// Corners of the table below the sheet, from one end of the edge to the other.
    pub(super) fn table_top(&self, table: &Table) -> [Vector3<f64>; 4] {
        let [origin, edge, outward] =
            [table.edge_point_m, table.edge_direction, table.outward].map(Vector3::from);
        let along = |direction: Vector3<f64>, start: f64, rule: fn(f64, f64) -> f64| {
            self.mesh.positions.iter().map(|p| (p - origin).dot(&direction)).fold(start, rule)
        };
        let [from, to] = [along(edge, f64::MAX, f64::min), along(edge, f64::MIN, f64::max)];
        let (inner, more) = (along(outward, 0.0, f64::min), 0.06 * (to - from));
        let corner = |across: f64, out: f64| origin + across * edge + out * outward;
        [
            corner(from - more, 0.0),
            corner(to + more, 0.0),
            corner(to + more, inner - more),
            corner(from - more, inner - more),
        ]
    }
}

/// Keeps every `stride`-th grid line and the last; returns the grid, the nodes kept and their triangles.
fn coarser(grid: &Grid, stride: usize) -> Option<(Grid, Vec<usize>, Vec<[usize; 3]>)> {
    let kept = |count: usize| -> Vec<usize> {
        (0..count - 1).step_by(stride).chain(std::iter::once(count - 1)).collect()
    };
    let [columns, rows] = [kept(grid.columns), kept(grid.rows)];
    let nodes = rows.iter().flat_map(|&row| columns.iter().map(move |&column| grid.node(column, row)));
    let coarse =
        Grid { columns: columns.len(), rows: rows.len(), diagonals: Diagonals::Alternating, ..*grid };
    Some((coarse, nodes.collect(), coarse.mesh().ok()?.triangles))
}
