//! The table: the lines of a sheet pushed over its edge that are held, frame by frame.
//!
//! ```text
//!        held                     free
//! ───●───●───●───●│  ●   ●╲
//!    table        │ 1   2   ●╲       the lines of nodes up to the second past the edge are held where they were seen:
//!                 edge         ●     the last held segment lies on the free cloth and carries the measured slope
//! ```
//!
//! That is the default. Holding only the part on the table would make the fitted rigidity far too large: the cloth
//! bends at the edge itself, which falls between two lines. Many nodes observe each line; their mean is held.

use crate::twin::specimen::Specimen;
use cloth_data::error::{Error, Result};
use cloth_data::frame::Sequence;
use cloth_sim::load::Held;
use nalgebra::Vector3;

/// Constraint of a sheet on a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TableHold {
    /// Number of held lines of nodes past the edge. Default 2; published 0: only the part on the table.
    pub past_edge: usize,
    /// Lines along the edge are straightened and move as a whole, so that the sheet bends as a cylinder. Default
    /// true; published false: held nodes stay as observed, and every free node moves by itself.
    pub cylinder: bool,
    /// Residuals include the position errors of held lines. Default true; published false.
    pub whitened: bool,
}

impl Default for TableHold {
    fn default() -> Self {
        Self { past_edge: 2, cylinder: true, whitened: true }
    }
}

impl TableHold {
    /// Holds only the part on the table. Source: Miguel et al. 2012, §5.1.
    pub const PUBLISHED: Self = Self { past_edge: 0, cylinder: false, whitened: false };
}

/// A sheet held by a single line could rotate freely.
const FEWEST_HELD: usize = 2;

/// Minimum ratio of a sheet's reach outward to its reach across: its sides are then along the edge within about 4°.
const STRAIGHT: f64 = 12.0;

/// Minimum number of free lines: fewer carry no information on bending.
const FEWEST_FREE: usize = 3;

/// A node farther off its line than this multiple of the median distance is a stray: 9 standard deviations of noise.
/// Distances up to rounding, m, are not.
const STRAY: f64 = 6.0;
const ROUNDING: f64 = 1e-9;

/// The lines of a specimen's grid that run along a table's edge, from the one farthest back on the table to the tip.
#[derive(Debug, Clone)]
pub(super) struct Lines {
    /// Nodes of every line.
    nodes: Vec<Vec<usize>>,
    edge: Vector3<f64>,
    outward: Vector3<f64>,
    hold: TableHold,
}

/// The held lines in one frame, and the start shape.
#[derive(Debug, Clone)]
pub(super) struct Overhang {
    /// Number of held lines.
    pub(super) held: usize,
    /// Length of cloth past the edge, m.
    pub(super) length: f64,
    /// Nodes too far off their line to be used for its position.
    pub(super) left_out: usize,
    /// Every line straightened or, if the sheet is no cylinder, every observed node as observed; 3 stacked
    /// coordinates per node, m.
    pub(super) start: Vec<f64>,
}

impl Lines {
    /// Determines the direction of the lines from the observed shapes.
    ///
    /// # Errors
    /// No table, no shape, or an edge that is not along a side of the specimen.
    pub(super) fn new(
        sequence: &Sequence,
        specimen: &Specimen,
        shapes: &[Option<Vec<f64>>],
        hold: TableHold,
    ) -> Result<Self> {
        let Some(table) = sequence.table else {
            return Err(Error::geometry(&sequence.name, "no table", "a [table] in test.toml, with its edge"));
        };
        let outward = specimen.turn(&Vector3::from(table.outward)).normalize();
        let edge = specimen.place(&Vector3::from(table.edge_point_m));
        let grid = specimen.grid;
        let columns: Vec<Vec<usize>> =
            (0..grid.columns).map(|c| (0..grid.rows).map(|r| grid.node(c, r)).collect()).collect();
        let rows: Vec<Vec<usize>> =
            (0..grid.rows).map(|r| (0..grid.columns).map(|c| grid.node(c, r)).collect()).collect();
        // Reach of the sheet outward along its two sides, over all frames.
        let mut reach = [0.0; 2];
        for shape in shapes.iter().flatten() {
            for (reach, lines) in reach.iter_mut().zip([&columns, &rows]) {
                let mean = |line: &Vec<usize>| {
                    mean(line.iter().filter_map(|&n| point(shape, n)).map(|p| p.dot(&outward)))
                };
                if let (Some(first), Some(last)) = (mean(&lines[0]), mean(&lines[lines.len() - 1])) {
                    *reach += last - first;
                }
            }
        }
        let [along, across] = if f64::abs(reach[0]) > f64::abs(reach[1]) { [0, 1] } else { [1, 0] };
        if !(f64::abs(reach[along]) > STRAIGHT * f64::abs(reach[across])) {
            return Err(Error::geometry(
                &sequence.name,
                "a sheet whose sides are not along the table's edge, or no shape at all",
                "shapes (positions.npy) of a sheet pushed straight over the edge, and the true outward and \
                 edge_direction",
            ));
        }
        let mut nodes = if along == 0 { columns } else { rows };
        if reach[along] < 0.0 {
            nodes.reverse();
        }
        Ok(Self { nodes, edge, outward, hold })
    }

    /// The overhang in one observed shape; `None` if too little hangs over, or a line that matters was hardly
    /// observed. On the table, where a line may be hidden, the next observed one gives its position.
    pub(super) fn overhang(&self, specimen: &Specimen, shape: &[f64]) -> Option<Overhang> {
        let seen: Vec<Option<Line>> =
            self.nodes.iter().map(|line| Line::through(specimen, line, shape)).collect();
        let past = |line: &Line| (line.centre - self.edge).dot(&self.outward);
        // The table ends before the first line past its edge; the hanging part may swing back under it.
        let on_table = seen.iter().position(|line| line.as_ref().is_some_and(|line| past(line) > 0.0))?;
        let held = on_table + self.hold.past_edge;
        if on_table == 0 || held < FEWEST_HELD || held + FEWEST_FREE > self.nodes.len() {
            return None;
        }
        let hanging: Vec<&Line> = seen[on_table - 1..].iter().map(Option::as_ref).collect::<Option<_>>()?;
        // All lines are parallel: individual tilts, due to noise, would strain a sheet that bends as a cylinder.
        let along = seen.iter().flatten().map(|line| line.slope).sum::<Vector3<f64>>().normalize();
        let mut start = vec![0.0; shape.len()];
        for (line, nodes) in self.nodes.iter().enumerate() {
            let (later, nearest) =
                seen.iter().enumerate().skip(line).find_map(|(later, l)| Some((later, l.as_ref()?)))?;
            let [from, to] = [line, later].map(|line| specimen.mesh.positions[self.nodes[line][0]]);
            let back = self.outward * (to - from).norm();
            for &node in nodes {
                let straight = nearest.at(specimen.mesh.positions[node] + (to - from), &along) - back;
                let place = point(shape, node).filter(|_| !self.hold.cylinder).unwrap_or(straight);
                start[3 * node..3 * node + 3].copy_from_slice(place.as_slice());
            }
        }
        let lengths = hanging[1..].windows(2).map(|pair| (pair[1].centre - pair[0].centre).norm());
        let length = lengths.sum::<f64>() + past(hanging[1]);
        let left_out = seen.iter().flatten().map(|line| line.left_out).sum();
        Some(Overhang { held, length, left_out, start })
    }

    /// The nodes of the first lines, all held; the last two lines as clips 0 and 1, since the free cloth depends on
    /// their positions and the slope between them.
    pub(super) fn held(&self, lines: usize) -> impl Iterator<Item = Held> + '_ {
        let clip = move |line: usize| (line + 2).checked_sub(lines);
        let nodes = self.nodes[..lines].iter().enumerate();
        nodes.flat_map(move |(line, nodes)| nodes.iter().map(move |&node| Held { node, clip: clip(line) }))
    }

    /// Noise of a line's mean, given that of its nodes.
    pub(super) fn spread(&self, of_nodes: &[f64]) -> f64 {
        let line = &self.nodes[0];
        let square = line.iter().map(|&node| of_nodes[node] * of_nodes[node]).sum::<f64>();
        square.sqrt() / line.len() as f64
    }

    /// The lines that move as a whole, so that the sheet bends as a cylinder: all.
    ///
    /// Hinges of a triangulated sheet couple bending to twist. Split all one way, a sheet hanging off a table twists
    /// (by 5 mm at its tip where Γ = 10); split alternately, every other node yields, which makes the sheet softer by
    /// a fifth. A cylinder has neither effect: its flexural rigidity is 3 × the hinges' stiffness, as in the curve
    /// files.
    pub(super) fn tied(&self) -> &[Vec<usize>] {
        if self.hold.cylinder { &self.nodes } else { &[] }
    }

    /// From the edge to the tip, m; `None` if the sheet does not reach the edge.
    pub(super) fn chord(&self, x: &[f64]) -> Option<Vector3<f64>> {
        let centre = |line: &Vec<usize>| {
            let places = line.iter().map(|&n| Vector3::from_column_slice(&x[3 * n..3 * n + 3]));
            places.sum::<Vector3<f64>>() / line.len() as f64
        };
        let centres: Vec<Vector3<f64>> = self.nodes.iter().map(centre).collect();
        let past = |p: &Vector3<f64>| (p - self.edge).dot(&self.outward);
        let after = centres.iter().position(|p| past(p) > 0.0).filter(|&after| after > 0)?;
        let [before, after] = [centres[after - 1], centres[after]];
        let edge = before + (after - before) * (-past(&before) / (past(&after) - past(&before)));
        Some(centres[centres.len() - 1] - edge)
    }
}

/// A straight line through the positions of its nodes: position = centre + slope × (rest position along the line).
struct Line {
    centre: Vector3<f64>,
    slope: Vector3<f64>,
    /// Centre of the observed nodes at rest, and the direction of the line there.
    rest: Vector3<f64>,
    along: Vector3<f64>,
    /// Nodes observed too far off the line.
    left_out: usize,
}

impl Line {
    fn through(specimen: &Specimen, nodes: &[usize], shape: &[f64]) -> Option<Self> {
        let mut seen: Vec<(Vector3<f64>, Vector3<f64>)> = nodes
            .iter()
            .filter_map(|&node| Some((specimen.mesh.positions[node], point(shape, node)?)))
            .collect();
        let all = seen.len();
        // Nodes observed far off the line are measurement errors.
        let mut line = Self::through_all(&seen)?;
        loop {
            let off =
                |(rest, place): &(Vector3<f64>, Vector3<f64>)| (place - line.at(*rest, &line.slope)).norm();
            let mut distances: Vec<f64> = seen.iter().map(off).collect();
            distances.sort_by(f64::total_cmp);
            let limit = f64::max(STRAY * distances[distances.len() / 2], ROUNDING);
            let near: Vec<_> = seen.iter().copied().filter(|node| off(node) <= limit).collect();
            if near.len() == seen.len() {
                return Some(Self { left_out: all - seen.len(), ..line });
            }
            seen = near;
            line = Self::through_all(&seen)?;
        }
    }

    fn through_all(seen: &[(Vector3<f64>, Vector3<f64>)]) -> Option<Self> {
        if seen.len() < 2 {
            return None;
        }
        let count = seen.len() as f64;
        let rest = seen.iter().map(|(rest, _)| rest).sum::<Vector3<f64>>() / count;
        let centre = seen.iter().map(|(_, place)| place).sum::<Vector3<f64>>() / count;
        let along = (seen[seen.len() - 1].0 - seen[0].0).normalize();
        let (mut product, mut square) = (Vector3::zeros(), 0.0);
        for (at, place) in seen {
            let s = (at - rest).dot(&along);
            product += (place - centre) * s;
            square += s * s;
        }
        Some(Self { centre, slope: product / square, rest, along, left_out: 0 })
    }

    /// Position of a node of the line if the line has a given direction.
    fn at(&self, rest: Vector3<f64>, direction: &Vector3<f64>) -> Vector3<f64> {
        self.centre + direction * (rest - self.rest).dot(&self.along)
    }
}

/// A node's position, if observed.
fn point(shape: &[f64], node: usize) -> Option<Vector3<f64>> {
    let p = Vector3::from_column_slice(&shape[3 * node..3 * node + 3]);
    p.iter().all(|c| c.is_finite()).then_some(p)
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    (count > 0.0).then(|| sum / count)
}
