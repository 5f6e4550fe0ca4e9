//! Clips in a replica: the nodes that they hold, and the components of their forces.

use super::force_component::ForceComponent;
use crate::twin::specimen::Specimen;
use cloth_data::error::{Error, Result};
use cloth_data::frame::{Frame, Kind, Sequence};
use cloth_data::kind::{Extension, Holding};
use cloth_data::measure::effective_shear;
use cloth_data::rectangle::bounds;
use cloth_sim::mesh::Grid;
use nalgebra::{Matrix3, Vector2, Vector3};

/// The nodes held by clips, in groups: one per clip, and one for every pair of clips that share nodes, as two bars of
/// a picture frame share a corner.
#[derive(Debug, Clone)]
pub(super) struct Grip {
    /// The group of each held node.
    pub(super) group_of: Vec<Option<usize>>,
    /// The clips of each group.
    pub(super) groups: Vec<[usize; 2]>,
}

impl Grip {
    /// Holds the nodes on the grid lines nearest to each clip's vertices, and between them.
    ///
    /// The box around a clip's vertices is widened to whole lines: the centre node of a crossed cell is held if all
    /// of its cell is. A limit by distance, half a cell, would make a clamp hold a row of centres beyond its edge,
    /// and a bias strip would be too short to first order in the cell.
    ///
    /// # Errors
    /// Clips that claim the same node and disagree on its position; a clip without a node of its own.
    pub(super) fn new(sequence: &Sequence, specimen: &Specimen) -> Result<Self> {
        let clips = sequence.clips.len();
        let mut grip = Self {
            group_of: vec![None; specimen.mesh.len()],
            groups: (0..clips).map(|clip| [clip, clip]).collect(),
        };
        for (clip, gripped) in sequence.clips.iter().enumerate() {
            let places = gripped.vertices.iter().map(|&v| specimen.place(&sequence.mesh.positions[v]).xy());
            let ends = bounds(places);
            // If two lines are equally near, both are held.
            let [low, high] = [0, 1].map(|end| {
                let line = |axis: usize| specimen.lines[axis].nearest(ends[end][axis])[end];
                Vector2::new(line(0), line(1))
            });
            let tie = Vector2::new(specimen.lines[0].tie(), specimen.lines[1].tie());
            for node in 0..specimen.mesh.len() {
                let place = specimen.mesh.positions[node].xy();
                if place >= low - tie && place <= high + tie {
                    grip.claim(node, clip, sequence, specimen)?;
                }
            }
        }
        match (0..clips).find(|&clip| !grip.group_of.contains(&Some(clip))) {
            Some(clip) => Err(Error::geometry(
                &sequence.name,
                format!("clip {} holds no node of its own", sequence.clips[clip].name),
                "clips on the specimen, without overlap",
            )),
            None => Ok(grip),
        }
    }

    fn claim(&mut self, node: usize, clip: usize, sequence: &Sequence, specimen: &Specimen) -> Result<()> {
        let Some(group) = self.group_of[node] else {
            self.group_of[node] = Some(clip);
            return Ok(());
        };
        let other = self.groups[group][0];
        let world = specimen.rest_in_world(node);
        let apart = |frame: &Frame| (moved(frame, clip, &world) - moved(frame, other, &world)).norm();
        if let Some(frame) = sequence.frames.iter().position(|frame| apart(frame) > 1e-6) {
            return Err(Error::geometry(
                &sequence.name,
                format!(
                    "clips {} and {} both hold a node and put it {:.2e} m apart in frame {frame}",
                    sequence.clips[other].name,
                    sequence.clips[clip].name,
                    apart(&sequence.frames[frame])
                ),
                "clips that do not overlap (they grip nodes within half a simulation cell), and poses that map \
                 rest points to their positions, x = R(q) x_rest + t",
            ));
        }
        let pair = [other, clip];
        let known = self.groups.iter().position(|group| *group == pair);
        self.group_of[node] = Some(known.unwrap_or_else(|| {
            self.groups.push(pair);
            self.groups.len() - 1
        }));
        Ok(())
    }

    /// True if a clip ends within a side of the sheet. A clamp over several lines ends at a corner of the free cloth, which
    /// does not count.
    pub(super) fn ends_within_a_side(&self, grid: &Grid) -> bool {
        let [columns, rows] = [grid.columns, grid.rows];
        let side = |end: usize, inner: usize, along: usize, node: &dyn Fn(usize, usize) -> usize| {
            let held = |i: usize, at: usize| self.group_of[node(i, at)].is_some();
            (0..along).any(|i| {
                let next = [i.checked_sub(1), Some(i + 1).filter(|&i| i < along)];
                let ends = next.iter().flatten().any(|&next| !held(next, end));
                held(i, end) && ends && !held(i, inner)
            })
        };
        let upright = |i: usize, at: usize| grid.node(at, i);
        let lying = |i: usize, at: usize| grid.node(i, at);
        side(0, 1, columns, &lying)
            || side(rows - 1, rows - 2, columns, &lying)
            || side(0, 1, rows, &upright)
            || side(columns - 1, columns - 2, rows, &upright)
    }

    /// Position of a held node in a frame of the sequence, in specimen coordinates.
    pub(super) fn place(&self, specimen: &Specimen, frame: &Frame, node: usize) -> Vector3<f64> {
        match self.group_of[node] {
            Some(group) => {
                specimen.place(&moved(frame, self.groups[group][0], &specimen.rest_in_world(node)))
            }
            None => specimen.mesh.positions[node],
        }
    }

    /// Mean relative change of distance between the clips' centres.
    fn separation(&self, specimen: &Specimen, x: &[f64]) -> f64 {
        let clips = self.groups.iter().filter(|[a, b]| a == b).count();
        let centres = |position: &dyn Fn(usize) -> Vector3<f64>| -> Vec<Vector3<f64>> {
            let nodes =
                |clip| (0..self.group_of.len()).filter(move |&node| self.group_of[node] == Some(clip));
            (0..clips)
                .map(|clip| nodes(clip).map(position).sum::<Vector3<f64>>() / nodes(clip).count() as f64)
                .collect()
        };
        let now = centres(&|node| Vector3::from_column_slice(&x[3 * node..3 * node + 3]));
        let rest = centres(&|node| specimen.mesh.positions[node]);
        let mut strains = Vec::new();
        for a in 0..clips {
            for b in 0..a {
                strains.push((now[a] - now[b]).norm() / (rest[a] - rest[b]).norm() - 1.0);
            }
        }
        strains.iter().sum::<f64>() / strains.len().max(1) as f64
    }

    /// Extension of a test: the effective shear angle (rad) if bars shear, else the mean relative change of distance
    /// between the clips' centres.
    pub(super) fn extension(&self, kind: Kind, specimen: &Specimen, x: &[f64]) -> f64 {
        match kind.extension() {
            Extension::ShearAngle => {
                let held = || (0..self.group_of.len()).filter(|&node| self.group_of[node].is_some());
                let material: Vec<_> = held().map(|node| specimen.mesh.material[node]).collect();
                let now: Vec<_> =
                    held().map(|node| Vector3::from_column_slice(&x[3 * node..3 * node + 3])).collect();
                effective_shear(&material, &now).map_or(0.0, f64::abs)
            }
            Extension::Elongation | Extension::Overhang => self.separation(specimen, x),
        }
    }

    /// The measured components of a frame's clip forces: along the load cell; along each bar's own axis in a picture
    /// frame; else both components in the plane, or all three.
    ///
    /// * `weights` — weight of each clip with the cloth inside it, N
    ///
    /// Source of the rule for shear: Miguel et al. 2012, §5.1.
    pub(super) fn forces(
        &self,
        sequence: &Sequence,
        frame: &Frame,
        specimen: &Specimen,
        weights: &[Vector3<f64>],
        planar: bool,
    ) -> Vec<ForceComponent> {
        let axes: Vec<Vector3<f64>> = (0..sequence.clips.len())
            .map(|clip| specimen.turn(&(frame.poses[clip].rotation * long_axis(sequence, clip))))
            .collect();
        let mut components = Vec::new();
        for (clip, weight) in weights.iter().enumerate() {
            let Some(force) = frame.clip_force(clip) else { continue };
            let force = specimen.turn(&force);
            // Balance of a clip: cord forces + its weight = pull of the cloth.
            let balanced = force + weight;
            let directions = match (sequence.force_direction, sequence.kind.holding()) {
                (Some(direction), _) => vec![specimen.turn(&direction)],
                (None, Holding::PictureFrame) => vec![axes[clip]],
                (None, _) if planar => vec![Vector3::x(), Vector3::y()],
                (None, _) => vec![Vector3::x(), Vector3::y(), Vector3::z()],
            };
            components.extend(directions.into_iter().enumerate().map(|(number, direction)| ForceComponent {
                clip,
                number,
                direction,
                parts: self.parts(clip, &direction, &axes),
                force: balanced.dot(&direction),
                measured: force.dot(&direction),
            }));
        }
        components
    }

    /// A clip's force along a direction, as a sum over its groups.
    ///
    /// The force on nodes shared by two bars is split along the bars' axes: f = α t₁ + β t₂ + rest; the first bar
    /// takes α t₁ and half of the rest. In homogeneous shear, where all traction is along the bars, each bar gets
    /// exactly the force of its own side.
    fn parts(
        &self,
        clip: usize,
        direction: &Vector3<f64>,
        axes: &[Vector3<f64>],
    ) -> Vec<(usize, Vector3<f64>)> {
        let mut parts = vec![(clip, *direction)];
        for (group, &[a, b]) in self.groups.iter().enumerate() {
            if a == b || (a != clip && b != clip) {
                continue;
            }
            let [own, other] = if a == clip { [axes[a], axes[b]] } else { [axes[b], axes[a]] };
            let cosine = own.dot(&other);
            let normal = own.cross(&other);
            let share = if normal.norm() > 0.1 {
                let dual = (own - other * cosine) / (1.0 - cosine * cosine);
                let normal = normal.normalize();
                dual * own.dot(direction) + normal * (0.5 * normal.dot(direction))
            } else {
                direction * 0.5
            };
            parts.push((group, share));
        }
        parts
    }
}

/// Position of a rest point moved by a clip, in world coordinates.
fn moved(frame: &Frame, clip: usize, rest: &Vector3<f64>) -> Vector3<f64> {
    let pose = &frame.poses[clip];
    pose.rotation * rest + pose.translation.vector
}

/// The principal axis of a clip's vertices at rest, in world coordinates.
fn long_axis(sequence: &Sequence, clip: usize) -> Vector3<f64> {
    let points = || sequence.clips[clip].vertices.iter().map(|&vertex| sequence.mesh.positions[vertex]);
    let centre = points().sum::<Vector3<f64>>() / points().count() as f64;
    let spread: Matrix3<f64> = points().map(|p| (p - centre) * (p - centre).transpose()).sum();
    let eigen = spread.symmetric_eigen();
    let axis = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
    // The sign that makes the largest coordinate positive.
    axis * axis[axis.iamax()].signum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_sim::mesh::Diagonals;

    #[test]
    fn clamps_end_at_corners_and_clips_within_sides() {
        let grid = Grid { columns: 7, rows: 5, width: 6.0, height: 4.0, diagonals: Diagonals::Forward };
        let ends = |held: &dyn Fn(usize, usize) -> bool| {
            let nodes = (0..grid.rows).flat_map(|row| (0..grid.columns).map(move |column| (column, row)));
            let group_of = nodes.map(|(column, row)| held(column, row).then_some(0)).collect();
            Grip { group_of, groups: vec![[0, 0]] }.ends_within_a_side(&grid)
        };
        // Clamps of one line and of two, and bars that meet.
        assert!(!ends(&|_, row| row == 0 || row == 4));
        assert!(!ends(&|column, _| column <= 1 || column >= 5));
        assert!(!ends(&|column, row| column == 0 || column == 6 || row == 0 || row == 4));
        // Bars with free corners, and a clip at a corner.
        assert!(ends(&|column, row| row == 0 && (1..6).contains(&column)));
        assert!(ends(&|column, row| column == 6 && (1..4).contains(&row)));
        assert!(ends(&|column, row| row == 4 && column < 3));
    }
}
