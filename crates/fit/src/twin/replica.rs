//! The simulated replica of a measured sequence: a cloth with the measured clips or table and, per frame, their
//! positions, the measurements and a start shape.
//!
//! Source: Miguel et al. 2012, §5.1. Held nodes, selection of frames and blending of shapes: docs/model.md.

mod as_seen;
mod blend;
mod clip_poses;
mod clips;
mod edge_pose;
mod force_component;
mod layout;
mod merging;
mod overhang;
mod parts;
mod point;
mod profile;
mod skip;

use crate::twin::in_place;
use crate::twin::specimen::{Cells, Specimen, near_square};
use as_seen::AsSeen;
use blend::Blend;
use clips::Grip;
use cloth_data::error::{Error, Result};
use cloth_data::frame::{HEIGHT_SEEN, Kind, Phase, Sequence};
use cloth_data::kind::Holding;
use cloth_data::rectangle::FLAT_SLOPE;
use cloth_sim::cloth::{Cloth, Problem, Rest};
use cloth_sim::load::Held;
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::{Diagonals, Grid, Mesh};
use layout::Layout;
use nalgebra::{Vector2, Vector3};
use rayon::prelude::*;
use std::borrow::Cow;

pub use clip_poses::ClipPoses;
pub use edge_pose::EdgePose;
pub use force_component::ForceComponent;
pub use merging::Merging;
pub use overhang::Overhang;
pub use parts::{Parts, TableHold};
pub(crate) use point::lagrange;
pub use point::{MeasuredPoint, Term};
pub use skip::{Skip, SkippedFrame};

/// In longer cells a diagonal lies within 22.5° of a yarn, and its spring would act as that yarn.
const LONGEST_SPRING_CELL: f64 = 1.0 + std::f64::consts::SQRT_2;

/// Assumed noise of a vertex if none is given, m. Waves hidden by it change shear little; waves of a millimetre make
/// a sheet of 0.1 m softer by a fifth.
const CLEAR: f64 = 1e-4;

/// Bending strains up to this are rounding, 1/m; those of springs, which are dimensionless, are as small.
const FLAT: f64 = 1e-9;

/// A measured sequence prepared for simulation, in the specimen's own frame.
#[derive(Debug)]
pub struct Replica {
    /// Name of the sequence.
    pub name: String,
    /// Kind of test.
    pub kind: Kind,
    /// The grid of the whole sheet. Off a table it serves the display; what is simulated is each frame's overhang.
    pub specimen: Specimen,
    /// The cloths: one between clips, one for every frame off a table.
    pub cloths: Vec<Cloth>,
    /// For each group of held nodes, a weight per node: 1 at its own nodes, 0 at the others', harmonic in between. It
    /// is the virtual displacement in which that group alone does work. Empty on a table, and on a finer grid.
    pub fields: Vec<Vec<f64>>,
    /// The used frames.
    pub frames: Vec<ReplicaFrame>,
    /// Frames that take no part.
    pub skipped: Vec<SkippedFrame>,
    /// Vertices, over all frames, too far off the profile of an overhang to be used.
    pub vertices_left_out: usize,
    /// True if nodes move in the plane only: two unknowns per node.
    pub planar: bool,
    /// Errors of the clips' poses; `None` if these are exact.
    pub clip_poses: Option<ClipPoses>,
    /// Order of the grid's error in the size of its cells: 1 where a clip ends within a side, else 2.
    pub grid_order: i32,
    /// Number of vertices of the measured mesh.
    pub vertices: usize,
    /// Standard deviation of a force component, N, if known.
    pub force_noise: Option<f64>,
    /// Standard deviation of a vertex coordinate, m, if known.
    pub position_noise: Option<f64>,
    /// kg/m².
    pub areal_density: f64,
    /// Weight per area, N/m².
    pub weight: Vector3<f64>,
}

/// One frame of a replica.
#[derive(Debug, Clone)]
pub struct ReplicaFrame {
    /// Index in the sequence.
    pub index: usize,
    /// Index of its cloth.
    pub cloth: usize,
    /// Loading or unloading: measured, or derived from the extension.
    pub phase: Phase,
    /// Extension of the test: mean relative change of distance between the clips; effective shear angle, rad, if bars
    /// shear; length of the overhang at a table, m.
    pub extension: f64,
    /// Start state, 3 stacked coordinates per node, m: held nodes in place; the others blended between clips, or as
    /// observed on a table. An overhang is in the axes of its edge, its place 0.
    pub start: Vec<f64>,
    /// Observed positions of the nodes, 3 stacked coordinates per node, m; `None` without a measured shape, NaN for
    /// unobserved nodes.
    pub observed: Option<Vec<f64>>,
    /// Measured components of clip forces.
    pub forces: Vec<ForceComponent>,
    /// Measured points of the free cloth.
    pub points: Vec<MeasuredPoint>,
    /// The points merged, off a table.
    pub merging: Option<Box<Merging>>,
    /// The overhang, off a table.
    pub overhang: Option<Box<Overhang>>,
    /// Flexural rigidity by Peirce's formula, N·m, and a typical curvature, 1/m, of an overhang.
    pub peirce: Option<[f64; 2]>,
}

impl ReplicaFrame {
    /// The axes compared of the points: off a table those that bending moves.
    pub fn compared_axes(&self) -> &'static [usize] {
        if self.overhang.is_some() { &[0, 2] } else { &[0, 1, 2] }
    }

    /// The pose of the edge at the start, off a table.
    pub fn edge(&self) -> Option<EdgePose> {
        self.overhang.as_ref().map(|overhang| overhang.pose)
    }
}

impl Replica {
    /// Makes the replica of a sequence.
    ///
    /// # Errors
    /// A rest mesh that is not a rectangle; neither clips nor a table; clips that claim the same node and disagree;
    /// no frame that is deformed and measured; springs in long cells; errors of the mechanics.
    pub fn new(sequence: &Sequence, parts: &Parts) -> Result<Self> {
        let sequence = &*in_place(sequence);
        // On the bias the yarns run along the cells' diagonals: triangles without an edge along each yarn would lock.
        let diagonals = match sequence.kind.is_on_the_bias() && !parts.model.is_of_springs() {
            true => Diagonals::Crossed,
            false => parts.diagonals,
        };
        let specimen = Specimen::new(
            sequence,
            &Cells {
                size: parts.grid,
                diagonals,
                // Off a table the overhang is refined.
                refinement: if sequence.clips.is_empty() { 1 } else { parts.refinement },
                // What springs resist depends on their length.
                to_clips: !parts.model.is_of_springs(),
            },
        )?;
        check_cells(sequence, &specimen, parts.model)?;
        let gravity = specimen.turn(&sequence.gravity);
        // Drops components of gravity that are rounding of the rotation.
        let mut gravity = gravity.map(|g| if g.abs() <= 1e-9 * gravity.norm() { 0.0 } else { g });
        if parts.flat {
            gravity.z = 0.0;
        }
        let observed = |positions: &Vec<Vector3<f64>>| -> Vec<f64> {
            let places = specimen.samples.iter().map(|s| s.interpolate(&sequence.mesh, positions));
            places.map(|p| specimen.place(&p)).flat_map(|p| [p.x, p.y, p.z]).collect()
        };
        let shapes = sequence.frames.iter().map(|frame| frame.positions.as_ref().map(observed)).collect();
        let noise = sequence.noise;
        let mut replica = Self {
            name: sequence.name.clone(),
            kind: sequence.kind,
            cloths: Vec::new(),
            fields: Vec::new(),
            frames: Vec::new(),
            skipped: Vec::new(),
            vertices_left_out: 0,
            planar: false,
            clip_poses: None,
            grid_order: 2,
            vertices: sequence.mesh.len(),
            areal_density: parts.areal_density,
            weight: gravity * parts.areal_density,
            force_noise: noise.and_then(|noise| noise.force_n),
            position_noise: noise.and_then(|noise| noise.position_m),
            specimen,
        };
        match (sequence.clips.is_empty(), sequence.table) {
            (false, _) => replica.hold_by_clips(sequence, parts, gravity, shapes)?,
            (true, Some(_)) => replica.lay_on_table(sequence, parts, gravity, shapes)?,
            (true, None) => {
                return Err(Error::geometry(
                    &sequence.name,
                    "no clip and no table",
                    "a sequence held by clips, or pushed over the edge of a table",
                ));
            }
        }
        if replica.frames.is_empty() {
            let why = replica.skipped.iter().map(|skipped| skipped.skip).find(|skip| !skip.is_rest());
            let why = why.map_or(String::new(), |skip| format!(" ({skip})"));
            return Err(Error::geometry(
                &sequence.name,
                format!("no frame in which the specimen is deformed and measured{why}"),
                match sequence.clips.is_empty() {
                    true => "shapes with an overhang (positions.npy), on cells that are not too long",
                    false => "clips that move apart, with their forces (clips.csv, forces.csv)",
                },
            ));
        }
        Ok(replica)
    }

    /// The cloth of a frame.
    pub fn cloth(&self, frame: &ReplicaFrame) -> &Cloth {
        &self.cloths[frame.cloth]
    }

    /// True if the sheet lies on a table.
    pub fn is_on_table(&self) -> bool {
        self.kind.holding() == Holding::Table
    }

    /// True if the replica carries information on a component. A sheet that bends as a cylinder leaves the hinges
    /// across its lines flat.
    pub fn shows(&self, component: Component) -> bool {
        let bends = |component: Component| {
            let strains = self.frames.iter().flat_map(|f| self.cloth(f).strains(component, &f.start));
            component.is_bending() && strains.into_iter().any(|[strain, _]| strain.abs() > FLAT)
        };
        let rolls = self.frames.iter().any(|frame| frame.overhang.is_some());
        !rolls || bends(component) || !Component::ALL.into_iter().any(bends)
    }

    /// The mesh simulated in a frame.
    pub fn mesh<'r>(&'r self, frame: &'r ReplicaFrame) -> &'r Mesh {
        frame.overhang.as_ref().map_or(&self.specimen.mesh, |overhang| overhang.mesh())
    }

    /// The mesh of a frame at rest, 3 stacked coordinates per node, m.
    pub fn rest(&self, frame: &ReplicaFrame) -> Vec<f64> {
        self.mesh(frame).coordinates()
    }

    /// Puts the held nodes of a state in place.
    ///
    /// * `clips` — errors of the clips' poses, in standard deviations; empty if exact
    pub fn hold(&self, frame: &ReplicaFrame, edge: Option<&EdgePose>, clips: &[f64], x: &mut [f64]) {
        match (&frame.overhang, edge, &self.clip_poses) {
            (Some(overhang), Some(edge), _) => overhang.hold(edge.slope, x),
            (_, _, Some(poses)) if !clips.is_empty() => poses.hold(&frame.start, clips, x),
            _ => (),
        }
    }

    /// A simulated state on the grid of the whole sheet, in the specimen's axes: 3 stacked coordinates per node, m.
    ///
    /// * `edge` — pose of the sheet at the edge, off a table
    pub fn displayed<'x>(
        &self,
        frame: &ReplicaFrame,
        x: &'x [f64],
        edge: Option<&EdgePose>,
    ) -> Cow<'x, [f64]> {
        let (Some(overhang), Some(edge)) = (&frame.overhang, edge) else { return Cow::Borrowed(x) };
        let rest: Vec<Vector2<f64>> = self.specimen.mesh.positions.iter().map(|p| p.xy()).collect();
        Cow::Owned(rest.into_iter().flat_map(|at| overhang.displayed(at, x, edge).data.0[0]).collect())
    }

    /// True if a sheet between clips moves in space and was not observed to stay flat.
    pub fn may_buckle(&self) -> bool {
        let unsure =
            |frame: &ReplicaFrame| flatness(frame.observed.as_ref(), self.position_noise) != Some(true);
        !self.planar && !self.is_on_table() && self.frames.iter().any(unsure)
    }

    /// True if a sheet between clips was observed to leave its plane, and may do so in the simulation.
    pub fn is_buckled(&self, frame: &ReplicaFrame) -> bool {
        let seen = flatness(frame.observed.as_ref(), self.position_noise) == Some(false);
        seen && !self.planar && !self.is_on_table()
    }

    fn hold_by_clips(
        &mut self,
        sequence: &Sequence,
        parts: &Parts,
        gravity: Vector3<f64>,
        shapes: Vec<Option<Vec<f64>>>,
    ) -> Result<()> {
        let specimen = &self.specimen;
        let grip = Grip::new(sequence, specimen)?;
        // On a finer grid the free nodes start from the coarser equilibrium.
        let blend = (parts.refinement == 1)
            .then(|| Blend::new(&specimen.mesh, grip.group_of.iter().map(Option::is_some).collect()));
        let start = |frame| -> Vec<f64> {
            let place = |node| grip.place(specimen, frame, node);
            match &blend {
                Some(blend) => blend.shape(&specimen.mesh, place),
                None => (0..specimen.mesh.len()).flat_map(|node| place(node).data.0[0]).collect(),
            }
        };
        let mut starts: Vec<Vec<f64>> = sequence.frames.par_iter().map(start).collect();
        let clip_noise = sequence.clip_noise();
        let bends = parts.components.iter().any(|component| component.is_bending());
        // A sheared sheet of unobserved shape may have buckled.
        let leaves_plane = |shape: &Option<Vec<f64>>| match flatness(shape.as_ref(), self.position_noise) {
            Some(flat) => !flat,
            None => sequence.kind.holding() == Holding::PictureFrame,
        };
        self.planar = parts.flat
            || gravity.z.abs() <= FLAT_SLOPE * gravity.norm()
                && starts.iter().all(|x| is_planar(x, &grip.group_of, specimen, clip_noise))
                && !(bends && shapes.iter().any(leaves_plane));
        if parts.flat {
            starts.iter_mut().for_each(|x| x.iter_mut().skip(2).step_by(3).for_each(|z| *z = 0.0));
        }
        if grip.ends_within_a_side(&specimen.grid) {
            self.grid_order = 1;
        }
        self.clip_poses = ClipPoses::new(&grip, &specimen.mesh, clip_noise, self.planar);
        let held = grip
            .group_of
            .iter()
            .enumerate()
            .filter_map(|(node, group)| Some(Held { node, clip: Some((*group)?) }));
        self.cloths.push(cloth(
            sequence,
            parts,
            &specimen.mesh,
            gravity,
            &held.collect::<Vec<_>>(),
            &[],
            self.planar,
        )?);
        let field = |blend: &Blend, group: usize| {
            let own = |holder: &Option<usize>| if *holder == Some(group) { 1.0 } else { 0.0 };
            let mut field: Vec<f64> = grip.group_of.iter().map(own).collect();
            blend.extend(&mut field);
            field
        };
        let fields = |blend: &Blend| (0..grip.groups.len()).map(|group| field(blend, group)).collect();
        self.fields = blend.as_ref().map_or(Vec::new(), fields);
        let extensions: Vec<f64> =
            starts.iter().map(|x| grip.extension(sequence.kind, specimen, x)).collect();
        let largest = extensions.iter().fold(0.0f64, |m, &e| m.max(e));
        // A clip carries its own weight and that of the cloth inside it.
        let weights: Vec<Vector3<f64>> = sequence
            .clips
            .iter()
            .zip(&specimen.gripped)
            .map(|(clip, gripped)| gravity * (clip.mass_kg + parts.areal_density * gripped))
            .collect();
        for (index, ((frame, start), observed)) in sequence.frames.iter().zip(starts).zip(shapes).enumerate()
        {
            // An unstretched sheet without shear stiffness is singular: such a frame carries no information.
            if extensions[index] <= 1e-3 * largest {
                self.skipped.push(SkippedFrame { frame: index, skip: Skip::AtRest });
                continue;
            }
            let forces = grip.forces(sequence, frame, specimen, &weights, self.planar);
            if forces.is_empty() {
                self.skipped.push(SkippedFrame { frame: index, skip: Skip::NoForce });
                continue;
            }
            let phase = frame.phase.unwrap_or_else(|| phase_of(&extensions, index));
            let extension = extensions[index];
            let points = node_points(&self.cloths[0], &self.specimen, observed.as_deref());
            self.frames.push(ReplicaFrame {
                index,
                cloth: 0,
                phase,
                extension,
                start,
                observed,
                forces,
                points,
                merging: None,
                overhang: None,
                peirce: None,
            });
        }
        Ok(())
    }

    fn lay_on_table(
        &mut self,
        sequence: &Sequence,
        parts: &Parts,
        gravity: Vector3<f64>,
        shapes: Vec<Option<Vec<f64>>>,
    ) -> Result<()> {
        let layout = Layout::new(sequence, &self.specimen)?;
        // Weight in the axes of the edge, in which an overhang is simulated.
        let turned = layout.axes.rotation * gravity;
        let mut lengths = vec![0.0; sequence.frames.len()];
        for (index, (frame, observed)) in sequence.frames.iter().zip(shapes).enumerate() {
            let place = self.cloths.len();
            let made = match (parts.table, &observed) {
                (_, None) => Err(Skip::NoShape),
                (TableHold::FoundEdge, Some(_)) => {
                    let found = Overhang::new(&layout, sequence, &self.specimen, frame, &self.weight, parts)?;
                    found.map(|overhang| {
                        let held = overhang.held();
                        let cloth =
                            cloth(sequence, parts, overhang.mesh(), turned, &held, overhang.tied(), false);
                        self.vertices_left_out += overhang.left_out;
                        let start = overhang.start(overhang.pose.slope);
                        (cloth, overhang.length, start, overhang.peirce, Some(Box::new(overhang)))
                    })
                }
                (TableHold::AsSeen, Some(shape)) => as_seen::held(&layout, &self.specimen, shape).map(
                    |AsSeen { held, length, chord, start }| {
                        let cloth = cloth(sequence, parts, &self.specimen.mesh, gravity, &held, &[], false);
                        let weight = layout.axes.rotation * self.weight;
                        let peirce = overhang::peirce(Vector2::new(chord.x, chord.z), length, &weight);
                        (cloth, length, start, peirce, None)
                    },
                ),
            };
            let (cloth, length, start, peirce, overhang) = match made {
                Ok(made) => made,
                Err(skip) => {
                    self.skipped.push(SkippedFrame { frame: index, skip });
                    continue;
                }
            };
            let cloth = cloth?;
            let points = match &overhang {
                Some(overhang) => overhang.points(&cloth),
                None => node_points(&cloth, &self.specimen, observed.as_deref()),
            };
            let merging =
                overhang.as_ref().and_then(|overhang| overhang.merging(&points, &cloth)).map(Box::new);
            self.cloths.push(cloth);
            lengths[index] = length;
            self.frames.push(ReplicaFrame {
                index,
                cloth: place,
                phase: frame.phase.unwrap_or(Phase::Hold),
                extension: length,
                start,
                observed,
                forces: Vec::new(),
                points,
                merging,
                overhang,
                peirce: Some(peirce),
            });
        }
        for frame in &mut self.frames {
            frame.phase =
                sequence.frames[frame.index].phase.unwrap_or_else(|| phase_of(&lengths, frame.index));
        }
        Ok(())
    }
}

/// The free nodes that were seen, as measured points.
fn node_points(cloth: &Cloth, specimen: &Specimen, observed: Option<&[f64]>) -> Vec<MeasuredPoint> {
    let is_free = |node: usize| (0..3).any(|axis| cloth.unknown(3 * node + axis).is_some());
    let place = |shape: &[f64], node: usize| Vector3::from_column_slice(&shape[3 * node..3 * node + 3]);
    let point = |shape: &[f64], node: usize| MeasuredPoint {
        source: node,
        terms: vec![Term::new(node, 1.0, cloth)],
        place: 0.0,
        across: 0.0,
        position: place(shape, node),
        // A node between vertices averages them.
        spread: specimen.samples[node].weights.iter().map(|w| w * w).sum::<f64>().sqrt(),
    };
    observed.map_or(Vec::new(), |shape| {
        let seen = (0..specimen.mesh.len())
            .filter(|&node| is_free(node) && place(shape, node).iter().all(|c| c.is_finite()));
        seen.map(|node| point(shape, node)).collect()
    })
}

fn cloth(
    sequence: &Sequence,
    parts: &Parts,
    mesh: &Mesh,
    gravity: Vector3<f64>,
    held: &[Held],
    tied: &[Vec<usize>],
    planar: bool,
) -> Result<Cloth> {
    // A sheet that stays in its plane does not bend.
    let bends = |component: &Component| component.is_bending() && planar;
    let components: Vec<Component> = parts.components.iter().copied().filter(|c| !bends(c)).collect();
    Cloth::new(&Problem {
        mesh,
        model: parts.model,
        components: &components,
        areal_density: parts.areal_density,
        gravity,
        held,
        tied,
        guided: &[],
        planar,
        rest: Rest::Flat,
    })
    .map_err(|source| Error::Mechanics { context: sequence.name.clone(), source })
}

/// Rejects cells too long for springs.
fn check_cells(sequence: &Sequence, specimen: &Specimen, model: Model) -> Result<()> {
    let [dx, dy] = specimen.grid.cell();
    if !model.is_of_springs() || dx.max(dy) < LONGEST_SPRING_CELL * dx.min(dy) {
        return Ok(());
    }
    let Grid { width, height, diagonals, .. } = specimen.grid;
    let [columns, rows] = near_square(width, height, diagonals);
    Err(Error::geometry(
        &sequence.name,
        format!("springs in cells of {dx:.2e} m × {dy:.2e} m"),
        format!(
            "cells at most 2.4 times as long as wide: nodes in proportion to the specimen's sides, e.g. \
             {columns}x{rows}"
        ),
    ))
}

/// Heights of clips in one plane differ by up to this multiple of their noise.
const CHANCE: f64 = 6.0;

/// True if the clips' nodes leave their common plane z = const so little that flattening hardly changes any strain, or no
/// more than the noise of their poses may make them.
fn is_planar(x: &[f64], group_of: &[Option<usize>], specimen: &Specimen, noise: f64) -> bool {
    let heights = (0..group_of.len()).filter(|&node| group_of[node].is_some()).map(|node| x[3 * node + 2]);
    let [low, high] = heights.fold([f64::MAX, f64::MIN], |[low, high], z| [low.min(z), high.max(z)]);
    let side = specimen.grid.width.min(specimen.grid.height);
    high - low <= f64::max(FLAT_SLOPE * side, CHANCE * noise)
}

/// True if an observed shape stays in its plane within noise; `None` if less than half of it was observed, no height
/// was, or noise could hide a buckle.
fn flatness(shape: Option<&Vec<f64>>, noise: Option<f64>) -> Option<bool> {
    let shape = shape?;
    let heights: Vec<f64> = shape.iter().skip(2).step_by(3).copied().filter(|z| z.is_finite()).collect();
    if 6 * heights.len() < shape.len() {
        return None;
    }
    let count = heights.len() as f64;
    let mean = heights.iter().sum::<f64>() / count;
    let deviation = (heights.iter().map(|z| (z - mean) * (z - mean)).sum::<f64>() / count).sqrt();
    if deviation <= HEIGHT_SEEN {
        return None;
    }
    if deviation > 3.0 * noise.unwrap_or(CLEAR) {
        return Some(false);
    }
    (deviation <= 3.0 * CLEAR).then_some(true)
}

/// Loading while the extension increases.
fn phase_of(extensions: &[f64], index: usize) -> Phase {
    let [before, after] = [index.saturating_sub(1), (index + 1).min(extensions.len() - 1)];
    match extensions[index] - extensions[before] {
        growth if growth > 0.0 => Phase::Loading,
        growth if growth < 0.0 => Phase::Unloading,
        _ if extensions[after] > extensions[index] => Phase::Loading,
        _ => Phase::Hold,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::twin::specimen::GridSize;
    use cloth_sim::mesh::Grid;

    #[test]
    fn a_sheet_is_flat_only_where_it_was_seen_to_be() {
        let waves = |height: f64, seen: usize| -> Vec<f64> {
            let z = |node: usize| if node >= seen { f64::NAN } else { height * f64::from(node as u8 % 2) };
            (0..100).flat_map(|node| [0.0, 0.0, z(node)]).collect()
        };
        // The deviation of waves is half their height.
        assert_eq!(flatness(Some(&waves(1e-4, 100)), Some(7.5e-5)), Some(true));
        assert_eq!(flatness(Some(&waves(1e-3, 100)), Some(7.5e-5)), Some(false));
        assert_eq!(flatness(Some(&waves(1e-3, 100)), None), Some(false));
        assert_eq!(flatness(Some(&waves(1e-3, 100)), Some(7.5e-4)), None);
        assert_eq!(flatness(Some(&waves(1e-6, 100)), Some(7.5e-4)), Some(true));
        assert_eq!(flatness(Some(&waves(0.0, 100)), Some(7.5e-4)), None);
        assert_eq!(flatness(Some(&waves(1e-4, 49)), Some(7.5e-5)), None);
        assert_eq!(flatness(None, None), None);
    }

    #[test]
    fn springs_in_long_cells_are_refused() {
        let side = 0.1;
        let square = Grid { columns: 2, rows: 2, width: side, height: side, diagonals: Diagonals::Forward };
        let sequence = Sequence {
            name: "square".into(),
            kind: Kind::StretchWeft,
            gravity: Vector3::zeros(),
            noise: None,
            force_direction: None,
            table: None,
            mesh: square.mesh().unwrap(),
            clips: Vec::new(),
            frames: Vec::new(),
        };
        let message = |model, nodes| {
            let parts = Parts {
                model,
                components: vec![Component::StretchWeft],
                areal_density: 0.2,
                grid: GridSize::Nodes(nodes),
                diagonals: Diagonals::Forward,
                refinement: 1,
                table: TableHold::default(),
                flat: false,
            };
            Replica::new(&sequence, &parts).unwrap_err().to_string()
        };
        let long = "sequence square: found springs in cells of 8.33e-3 m × 2.50e-2 m";
        assert!(message(Model::SPRINGS, [13, 5]).starts_with(long));
        assert!(message(Model::SPRINGS, [13, 7]).contains("found no clip"));
        assert!(message(Model::STVK, [13, 5]).contains("found no clip"));
    }
}
