//! The part of a sheet that hangs off a table, as a cylinder held by its first segment.
//!
//! ```text
//!            edge                          z
//!   table  │ s = 0  h   2h                 │   x: outward, horizontal as the table tells
//!  ─────●──┼──●───●╲                       └── x
//!          │  ↑     ●╲      line i of nodes at s = (i − ½) h
//!     held: lines 0 and 1      the segment between them is centred on the edge: p ± ½ h (cos θ, sin θ)
//! ```
//!
//! The sheet bends at the edge itself, which falls between two lines of any mesh. So the place p and the slope θ of
//! the sheet there, and the tilt of its lines by a sheet or an edge that lies askew, are unknown in every frame and are
//! found with the curve ([`EdgePose`]). Nothing behind the edge is simulated. What is held does not depend on the grid:
//! the half segment past the edge is as stiff as a half cell, an error of second order.

use super::edge_pose::EdgePose;
use super::layout::{Layout, Seen, Sheet};
use super::merging::Merging;
use super::parts::Parts;
use super::point::{MeasuredPoint, Term, lagrange};
use super::profile::{Along, Profile};
use super::skip::Skip;
use crate::twin::specimen::{GridSize, Specimen};
use cloth_data::error::{Error, Result};
use cloth_data::frame::{Frame, Sequence};
use cloth_sim::cloth::Cloth;
use cloth_sim::load::Held;
use cloth_sim::mesh::{Diagonals, Grid, Mesh};
use nalgebra::{Isometry3, Vector2, Vector3};

/// Cells of an overhang and of a bending length: with the correction for the grid the error is then below 0.1 %.
const CELLS: f64 = 48.0;
const CELLS_OF_BENDING_LENGTH: f64 = 24.0;
/// Cells of a bending length below which a shape is not resolved.
const FEWEST_CELLS: f64 = 4.0;
/// Most cells.
const MOST_CELLS: f64 = 192.0;

/// Largest difference of the slope at the edge from the measured one, rad: noise of 0.1 mm tilts a millimetre by 0.1. A
/// slope between lines that lie far apart is known no better than the sheet turns from one to the next.
const WANDER: f64 = 0.2;

/// Fewest cells of the sheet's own grid past the edge: two held lines, and two bends.
const FEWEST_OWN_CELLS: usize = 4;

/// Fewest points past the edge: five unknowns of the edge, and some that tell the curve.
const FEWEST_POINTS: usize = 6;

/// The overhang in one frame.
#[derive(Debug, Clone)]
pub struct Overhang {
    /// From the specimen's axes to those of the edge: x outward, y along the edge, z = x × y; origin on the edge.
    pub axes: Isometry3<f64>,
    /// Grid past the edge: columns are the lines.
    pub grid: Grid,
    /// Length of cloth past the edge, m.
    pub length: f64,
    /// Pose at the start.
    pub pose: EdgePose,
    /// Largest difference of the slope from that, rad.
    wander: f64,
    /// Points too far off the profile to be used.
    pub left_out: usize,
    /// Flexural rigidity by Peirce's formula, N·m, and a typical curvature, 1/m.
    pub peirce: [f64; 2],
    /// The mesh at rest: x from the middle of the first segment on, y from the middle of the sheet.
    mesh: Mesh,
    /// Lines of nodes along the edge, then the centres of crossed cells.
    lines: Vec<Vec<usize>>,
    /// Angles of the segments at the start, rad.
    angles: Vec<f64>,
    /// Position along the edge of the middle of the sheet, m.
    lateral: f64,
    sheet: Sheet,
    /// The vertices seen past the edge.
    seen: Vec<Seen>,
}

/// A grid whose first segment is centred on the edge. Cells are square, so that diagonals lie along the yarns of a sheet
/// cut on the bias. Two across stand for the whole width: a cylinder is the same all along its lines.
fn strip(length: f64, cells: usize, diagonals: Diagonals) -> Grid {
    let cell = length / (cells as f64 - 0.5);
    Grid { columns: cells + 1, rows: 3, width: cell * cells as f64, height: 2.0 * cell, diagonals }
}

/// Flexural rigidity by Peirce's formula, N·m, and a typical curvature, 1/m, of an overhang.
///
/// * `chord` — from the edge to the end, outward and up
pub(super) fn peirce(chord: Vector2<f64>, length: f64, weight: &Vector3<f64>) -> [f64; 2] {
    let drop = (chord.x * weight.x + chord.y * weight.z) / weight.norm();
    let angle = (drop / chord.norm()).asin().clamp(0.01, 1.5);
    let rigidity = weight.norm() * length.powi(3) * (0.5 * angle).cos() / (8.0 * angle.tan());
    [rigidity, (2.0 * angle / length).max(f64::MIN_POSITIVE)]
}

/// Slopes of the segments between places, rad.
fn slopes(places: &[Vector2<f64>]) -> Vec<f64> {
    places.windows(2).map(|pair| pair[1] - pair[0]).map(|step| step.y.atan2(step.x)).collect()
}

impl Overhang {
    /// The overhang in a frame.
    ///
    /// * `weight` — per area, in the specimen's axes, N/m²
    ///
    /// # Errors
    /// The reason why the frame tells nothing of bending; a grid of no size.
    pub(super) fn new(
        layout: &Layout,
        sequence: &Sequence,
        specimen: &Specimen,
        frame: &Frame,
        weight: &Vector3<f64>,
        parts: &Parts,
    ) -> Result<std::result::Result<Self, Skip>> {
        let seen = layout.seen(sequence, specimen, frame);
        if seen.is_empty() {
            return Ok(Err(Skip::NoShape));
        }
        let along = |seen: &Seen| (seen.s, Vector2::new(seen.position.x, seen.position.z));
        let profile = Profile::new(seen.iter().map(along).collect());
        let strays = profile.strays(&seen.iter().map(along).collect::<Vec<Along>>());
        let Some(past) = profile.first_past() else { return Ok(Err(Skip::NothingHangsOver)) };
        let (s, first) = profile.median(past);
        let edge = match past.checked_sub(1).map(|before| profile.median(before)) {
            Some((from, place)) => from - place.x * (s - from) / (first.x - place.x),
            // Nobody saw the part on the table.
            None => s - first.x,
        };
        let mut edge = edge.max(0.0);
        let sheet = Sheet { edge, ..layout.sheet };
        let length = sheet.length - sheet.edge;
        let hanging = |index: &usize| seen[*index].s > edge && !strays[*index];
        let mut hanging: Vec<usize> = (0..seen.len()).filter(hanging).collect();
        let few = hanging.len() < FEWEST_POINTS;
        let outermost = profile.median(profile.len() - 1);
        if few || profile.len() - past < 2 || !(outermost.0 - edge > 0.0) {
            return Ok(Err(Skip::FewPoints { seen: hanging.len() }));
        }
        let weight = layout.axes.rotation * weight;
        let start = profile.at(edge);
        let peirce = peirce(outermost.1 - start, outermost.0 - edge, &weight);
        let bending_lengths = length / (peirce[0] / weight.norm()).cbrt();
        let along = layout.sheet.outward.iamax();
        let cells = match parts.grid {
            GridSize::Nodes(nodes) => (nodes[along] as f64 - 1.0).max(FEWEST_CELLS * bending_lengths),
            _ => CELLS.max(CELLS_OF_BENDING_LENGTH * bending_lengths),
        };
        let mut cells = cells.min(MOST_CELLS).ceil().max(2.0) as usize * parts.refinement;
        // What ring-2 springs resist depends on their length: that of the sheet's own grid.
        if parts.model.is_of_springs() || matches!(parts.grid, GridSize::Cell(_)) {
            let own = specimen.grid.cell()[along];
            cells = (length / own + 0.5).floor() as usize;
            if cells < FEWEST_OWN_CELLS {
                return Ok(Err(Skip::FewCells { cells }));
            }
            edge = sheet.length - (cells as f64 - 0.5) * own;
            hanging.retain(|&index| seen[index].s > edge);
        }
        let sheet = Sheet { edge, ..sheet };
        let grid = strip(sheet.length - edge, cells, parts.diagonals);
        let (mesh, lines) = strip_mesh(specimen, &sheet, grid, &sequence.name)?;
        let cell = grid.cell()[0];
        let places: Vec<Vector2<f64>> =
            (0..=cells).map(|line| profile.at(edge + (line as f64 - 0.5) * cell)).collect();
        let angles = slopes(&places);
        let pose = EdgePose { place: start, slope: angles[0], ..EdgePose::default() };
        let from = past.saturating_sub(1);
        let beside = from..profile.len().min(from + 3);
        let beside: Vec<Vector2<f64>> = beside.map(|line| profile.median(line).1).collect();
        let turn = slopes(&beside).windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        let lateral = seen.iter().map(|seen| seen.position.y - seen.across).sum::<f64>() / seen.len() as f64;
        let left_out = strays.iter().filter(|&&stray| stray).count();
        let overhang = Self {
            axes: layout.axes,
            grid,
            length,
            pose,
            wander: WANDER + turn,
            left_out,
            peirce,
            mesh,
            lines,
            angles,
            lateral,
            sheet,
            seen: hanging.into_iter().map(|index| seen[index]).collect(),
        };
        Ok(Ok(overhang))
    }

    /// A pose after a step of its unknowns. The slope stays near the measured one: a curve that is far off would turn the
    /// sheet instead.
    pub fn pose_after(&self, pose: &EdgePose, step: &[f64]) -> EdgePose {
        let after = pose.after(step);
        let [least, most] = [-self.wander, self.wander].map(|off| self.pose.slope + off);
        EdgePose { slope: after.slope.clamp(least, most), ..after }
    }

    /// True if a step would take the slope farther from the measured one than it may be.
    pub fn is_pinned(&self, pose: &EdgePose, step: &[f64]) -> bool {
        let off = pose.slope - self.pose.slope;
        off.abs() >= self.wander * (1.0 - 1e-9) && off * step[4] > 0.0
    }

    /// The mesh at rest.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The points seen past the edge.
    pub(super) fn points(&self, cloth: &Cloth) -> Vec<MeasuredPoint> {
        let point = |&Seen { vertex, s, across, position }: &Seen| {
            let weights = lagrange((s - self.sheet.edge) / self.grid.cell()[0] + 0.5, self.grid.columns);
            let term = |(line, weight): (usize, f64)| Term::new(self.lines[line][0], weight, cloth);
            let terms = weights.into_iter().map(term).collect();
            MeasuredPoint { source: vertex, terms, place: 1.0, across, position, spread: 1.0 }
        };
        self.seen.iter().map(point).collect()
    }

    /// The points merged.
    pub(super) fn merging(&self, points: &[MeasuredPoint], cloth: &Cloth) -> Option<Merging> {
        let line = |line: &Vec<usize>| Term::new(line[0], 1.0, cloth);
        Merging::new(points, &self.lines[..self.grid.columns].iter().map(line).collect::<Vec<_>>())
    }

    /// The nodes of the first segment, its lines as clips 0 and 1.
    pub(super) fn held(&self) -> Vec<Held> {
        let clips = self.lines[..2].iter().enumerate();
        clips.flat_map(|(clip, line)| line.iter().map(move |&node| Held { node, clip: Some(clip) })).collect()
    }

    /// The lines that move as a whole, so that the sheet bends as a cylinder: all.
    ///
    /// Hinges of a triangulated sheet couple bending to twist. Split all one way, a sheet hanging off a table twists
    /// (by 5 mm at its tip where Γ = 10); split alternately, every other node yields, which makes the sheet softer by
    /// a fifth. A cylinder has neither effect: its flexural rigidity is 3 × the hinges' stiffness, as in the curve
    /// files.
    pub(super) fn tied(&self) -> &[Vec<usize>] {
        &self.lines
    }

    /// The sheet as laid out flat, 3 stacked coordinates per node, m.
    pub fn rest(&self) -> Vec<f64> {
        self.mesh.positions.iter().flat_map(|p| [p.x, p.y, p.z]).collect()
    }

    /// The start shape with a given slope at the edge: the measured angles, turned.
    pub fn start(&self, slope: f64) -> Vec<f64> {
        let cell = self.grid.cell()[0];
        let step = |angle: f64| cell * Vector2::new(angle.cos(), angle.sin());
        let turned = self.angles.iter().map(|angle| angle + slope - self.angles[0]);
        let mut place = -0.5 * step(slope);
        let mut places = vec![place];
        for angle in turned {
            place += step(angle);
            places.push(place);
        }
        let between: Vec<Vector2<f64>> = places.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        places.extend(between);
        let mut x = self.rest();
        for (line, place) in self.lines.iter().zip(places) {
            line.iter().for_each(|&node| (x[3 * node], x[3 * node + 2]) = (place.x, place.y));
        }
        x
    }

    /// Moves the first segment to a slope.
    pub fn hold(&self, slope: f64, x: &mut [f64]) {
        let half = 0.5 * self.grid.cell()[0] * Vector2::new(slope.cos(), slope.sin());
        for (line, place) in self.lines.iter().zip([-half, half]) {
            line.iter().for_each(|&node| (x[3 * node], x[3 * node + 2]) = (place.x, place.y));
        }
    }

    /// Derivative of the first segment's lines by the slope, outward and up, m/rad.
    pub fn turning(&self, slope: f64) -> [Vector2<f64>; 2] {
        let half = 0.5 * self.grid.cell()[0] * Vector2::new(-slope.sin(), slope.cos());
        [-half, half]
    }

    /// Derivative of a point by the slope through the held lines alone, outward and up, m/rad.
    pub fn turned(&self, point: &MeasuredPoint, slope: f64) -> Vector2<f64> {
        let held = self.lines[..2].iter().zip(self.turning(slope));
        let of_line = |(line, turning): (&Vec<usize>, Vector2<f64>)| {
            let own = point.terms.iter().filter(|term| term.node == line[0]);
            own.map(|term| term.weight * turning).sum::<Vector2<f64>>()
        };
        held.map(of_line).sum()
    }

    /// Distance of a point past the edge along the sheet, m.
    pub fn past_edge(&self, point: &MeasuredPoint) -> f64 {
        point.terms.iter().map(|term| term.weight * self.mesh.positions[term.node].x).sum()
    }

    /// The shape on this grid of an overhang simulated on another one, 3 stacked coordinates per node, m.
    pub fn of(&self, other: &Self, x: &[f64]) -> Vec<f64> {
        let mut own = self.rest();
        for line in &self.lines {
            let place = other.shape(self.mesh.positions[line[0]].x, x);
            line.iter().for_each(|&node| (own[3 * node], own[3 * node + 2]) = (place.x, place.y));
        }
        own
    }

    /// Position at a distance past the edge if the sheet's place is 0, outward and up, m.
    fn shape(&self, s: f64, x: &[f64]) -> Vector2<f64> {
        let weights = lagrange(s / self.grid.cell()[0] + 0.5, self.grid.columns);
        weights.into_iter().fold(Vector2::zeros(), |sum, (line, weight)| {
            let node = 3 * self.lines[line][0];
            sum + weight * Vector2::new(x[node], x[node + 2])
        })
    }

    /// Position of a point of the rest rectangle, in the specimen's axes, m. Behind the edge the sheet lies straight.
    pub(super) fn displayed(&self, at: Vector2<f64>, x: &[f64], pose: &EdgePose) -> Vector3<f64> {
        let [s, across] = self.sheet.unrolled(at);
        let place = if s >= 0.0 { self.shape(s, x) } else { Vector2::new(s, 0.0) };
        let [outward, up] = [0, 1].map(|side| pose.coordinate(place[side], side, [1.0, across]));
        let back = self.axes.inverse();
        back.rotation * Vector3::new(outward, across + self.lateral, up) + back.translation.vector
    }
}

/// The mesh past the edge and its lines.
fn strip_mesh(
    specimen: &Specimen,
    sheet: &Sheet,
    grid: Grid,
    sequence: &str,
) -> Result<(Mesh, Vec<Vec<usize>>)> {
    let mechanics = |source| Error::Mechanics { context: sequence.into(), source };
    let mut mesh = grid.mesh().map_err(mechanics)?;
    let half = Vector3::new(0.5 * grid.cell()[0], 0.5 * grid.height, 0.0);
    mesh.positions.iter_mut().for_each(|position| *position -= half);
    for (material, position) in mesh.material.iter_mut().zip(&mesh.positions) {
        *material = specimen.material(sheet.at(position.x, position.y));
    }
    let checked = Mesh::new(mesh.positions, mesh.material, mesh.triangles).map_err(mechanics)?;
    let line = |column: usize| (0..grid.rows).map(|row| grid.node(column, row)).collect();
    let mut lines: Vec<Vec<usize>> = (0..grid.columns).map(line).collect();
    if grid.diagonals == Diagonals::Crossed {
        let first = grid.columns * grid.rows;
        let centres =
            |column: usize| (0..grid.rows - 1).map(move |row| first + row * (grid.columns - 1) + column);
        lines.extend((0..grid.columns - 1).map(|column| centres(column).collect()));
    }
    Ok((Mesh { grid: Some(grid), ..checked }, lines))
}
