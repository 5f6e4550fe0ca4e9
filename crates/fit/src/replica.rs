//! The simulated replica of a measured sequence: a cloth held by the measured clips, and per frame where they are, what
//! they were pulled with, and a shape to start from.
//!
//! Source: Miguel et al. 2012, §5.1. What is held, which frames are used and how shapes are blended: docs/model.md.

use crate::error::{Error, Result};
use crate::frame::{Frame, Kind, Phase, Sequence};
use crate::specimen::Specimen;
use cloth_sim::cloth::{Cloth, Problem};
use cloth_sim::load::Held;
use cloth_sim::material::{Component, Model};
use nalgebra::{Vector2, Vector3};

/// Largest strain that flattening the clips' motion into the plane may change before the replica moves in space.
const FLATTENING_STRAIN: f64 = 1e-5;

/// In longer cells a diagonal lies within 22.5° of a yarn, and its spring would be one of that yarn.
const LONGEST_SPRING_CELL: f64 = 1.0 + std::f64::consts::SQRT_2;

/// A measured sequence made ready for simulation; all in the specimen's own frame.
#[derive(Debug)]
pub struct Replica {
    /// Name of the sequence.
    pub name: String,
    /// Which test it is.
    pub kind: Kind,
    /// The grid.
    pub specimen: Specimen,
    /// The cloth.
    pub cloth: Cloth,
    /// Per clip a weight a node: 1 at its own nodes, 0 at the other clips', harmonic between. It blends the clips'
    /// motions into a shape, and is the virtual displacement under which that clip alone does work.
    pub fields: Vec<Vec<f64>>,
    /// The frames that are used.
    pub frames: Vec<ReplicaFrame>,
    /// How many frames of the sequence were left out because nothing was stretched there, or no force was measured.
    pub frames_at_rest: usize,
    /// Two unknowns a node.
    pub planar: bool,
    /// Standard deviation of a force component, N, where known.
    pub force_noise: Option<f64>,
}

/// One frame of a replica.
#[derive(Debug, Clone)]
pub struct ReplicaFrame {
    /// Index in the sequence.
    pub index: usize,
    /// Loading or unloading; measured, or from the extension.
    pub phase: Phase,
    /// Mean relative change of distance between the clips.
    pub extension: f64,
    /// A state to start from, 3 stacked coordinates a node, m: clips in place, the cloth blended between them.
    pub start: Vec<f64>,
    /// Where the nodes were seen, 3 stacked coordinates a node, m; `None` = no shape measured, NaN = this node not.
    pub observed: Option<Vec<f64>>,
    /// The components of clip forces that were measured.
    pub forces: Vec<ForceComponent>,
}

/// One measured component of the force that cords exert on a clip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceComponent {
    /// Index of the clip.
    pub clip: usize,
    /// Unit direction.
    pub direction: Vector3<f64>,
    /// What the cords pull with along it, less the clip's weight: what the cloth must balance, N.
    pub force: f64,
    /// What was measured along it, N.
    pub measured: f64,
}

impl Replica {
    /// Makes the replica of a sequence held by clips.
    ///
    /// # Errors
    /// A rest mesh that is no rectangle; no clip; clips that claim the same node and disagree; no frame in which
    /// anything is stretched or measured; springs in long cells; what the mechanics refuse.
    pub fn new(
        sequence: &Sequence,
        specimen: Specimen,
        model: Model,
        components: &[Component],
        areal_density: f64,
    ) -> Result<Self> {
        check_cells(sequence, &specimen, model)?;
        let clamped = clamped_nodes(sequence, &specimen)?;
        let blend = Blend::new(&specimen, &clamped);
        let gravity = specimen.turn(&sequence.gravity);
        // A component of gravity that rounding left after turning is none.
        let gravity = gravity.map(|g| if g.abs() <= 1e-9 * gravity.norm() { 0.0 } else { g });
        let starts: Vec<Vec<f64>> =
            sequence.frames.iter().map(|frame| blend.shape(&specimen, frame)).collect();
        let planar = gravity.z == 0.0 && starts.iter().all(|x| is_planar(x, &clamped, &specimen));
        let held: Vec<Held> = clamped
            .iter()
            .enumerate()
            .filter_map(|(node, clip)| clip.map(|clip| Held { node, clip: Some(clip) }))
            .collect();
        let problem =
            Problem { mesh: &specimen.mesh, model, components, areal_density, gravity, held: &held, planar };
        let mechanics = |source| Error::Mechanics { context: sequence.name.clone(), source };
        let cloth = Cloth::new(&problem).map_err(mechanics)?;
        let extensions: Vec<f64> = starts.iter().map(|x| blend.extension(&specimen, x)).collect();
        let largest = extensions.iter().fold(0.0f64, |m, &e| m.max(e));
        // A clip bears its own weight, and that of the cloth inside it.
        let clips = sequence.clips.iter().zip(&specimen.gripped);
        let weights: Vec<Vector3<f64>> =
            clips.map(|(clip, gripped)| gravity * (clip.mass_kg + areal_density * gripped)).collect();
        let mut frames = Vec::new();
        for (index, (frame, start)) in sequence.frames.iter().zip(starts).enumerate() {
            // A sheet without shear that is not stretched is singular: such a frame carries no information.
            if extensions[index] <= 1e-3 * largest {
                continue;
            }
            let forces = force_components(sequence, frame, &specimen, &weights, planar);
            if forces.is_empty() {
                continue;
            }
            let phase = frame.phase.unwrap_or_else(|| phase_of(&extensions, index));
            let observed = frame.positions.as_ref().map(|positions| observed(sequence, &specimen, positions));
            frames.push(ReplicaFrame { index, phase, extension: extensions[index], start, observed, forces });
        }
        if frames.is_empty() {
            return Err(Error::Geometry {
                sequence: sequence.name.clone(),
                found: "no frame in which the clips are apart and their force is measured".into(),
                expected: "clip poses and clip forces of a stretched specimen (clips.csv, forces.csv)".into(),
            });
        }
        let frames_at_rest = sequence.frames.len() - frames.len();
        let force_noise = sequence.noise.and_then(|noise| noise.force_n);
        let (name, kind, fields) = (sequence.name.clone(), sequence.kind, blend.weights);
        Ok(Self { name, kind, specimen, cloth, fields, frames, frames_at_rest, planar, force_noise })
    }

    /// Number of measured force components over all frames.
    pub fn observations(&self) -> usize {
        self.frames.iter().map(|frame| frame.forces.len()).sum()
    }
}

/// Refuses cells in which springs would not be what they are meant for.
fn check_cells(sequence: &Sequence, specimen: &Specimen, model: Model) -> Result<()> {
    let [dx, dy] = specimen.grid.cell();
    if model != Model::Springs || dx.max(dy) < LONGEST_SPRING_CELL * dx.min(dy) {
        return Ok(());
    }
    Err(Error::Geometry {
        sequence: sequence.name.clone(),
        found: format!("springs in cells of {dx:.2e} m × {dy:.2e} m"),
        expected: "cells at most 2.4 times as long as wide (choose the nodes by the specimen's sides)".into(),
    })
}

/// Which clip holds each node: what lies in the bounding box of the clip's vertices, give or take half a cell.
fn clamped_nodes(sequence: &Sequence, specimen: &Specimen) -> Result<Vec<Option<usize>>> {
    let bad = |found: String, expected: &str| Error::Geometry {
        sequence: sequence.name.clone(),
        found,
        expected: expected.into(),
    };
    if sequence.clips.is_empty() {
        return Err(bad("no clip".into(), "a sequence held by clips"));
    }
    let [dx, dy] = specimen.grid.cell();
    let margin = Vector2::new(dx, dy) * (0.5 * (1.0 + 1e-9));
    let mut clamped: Vec<Option<usize>> = vec![None; specimen.mesh.len()];
    for (clip, gripped) in sequence.clips.iter().enumerate() {
        let places = gripped.vertices.iter().map(|&v| specimen.place(&sequence.mesh.positions[v]).xy());
        let (low, high) = places
            .fold((Vector2::repeat(f64::MAX), Vector2::repeat(f64::MIN)), |(low, high), p| {
                (low.inf(&p), high.sup(&p))
            });
        for (node, position) in specimen.mesh.positions.iter().enumerate() {
            let p = position.xy();
            let inside = p >= low - margin && p <= high + margin;
            if !inside {
                continue;
            }
            match clamped[node] {
                None => clamped[node] = Some(clip),
                Some(other) => {
                    let world = specimen.rest_in_world(node);
                    let apart =
                        |frame: &Frame| (place(frame, clip, &world) - place(frame, other, &world)).norm();
                    if let Some(frame) = sequence.frames.iter().position(|frame| apart(frame) > 1e-6) {
                        return Err(bad(
                            format!(
                                "clips {} and {} both hold a node and put it {:.2e} m apart in frame {frame}",
                                sequence.clips[other].name,
                                gripped.name,
                                apart(&sequence.frames[frame])
                            ),
                            "clips that do not overlap (they grip what lies within half a simulation cell)",
                        ));
                    }
                }
            }
        }
    }
    match (0..sequence.clips.len()).find(|&clip| !clamped.contains(&Some(clip))) {
        Some(clip) => Err(bad(
            format!("clip {} holds no node of its own", sequence.clips[clip].name),
            "clips that do not overlap, on the specimen",
        )),
        None => Ok(clamped),
    }
}

/// Where a clip takes a rest point, in world coordinates.
fn place(frame: &Frame, clip: usize, rest: &Vector3<f64>) -> Vector3<f64> {
    let pose = &frame.poses[clip];
    pose.rotation * rest + pose.translation.vector
}

/// Blends the clips' rigid motions over the cloth: every clip has a weight at every node, 1 at its own nodes, 0 at the
/// other clips', harmonic between. Between two bars that is linear.
struct Blend {
    /// Per clip, a weight a node.
    weights: Vec<Vec<f64>>,
}

impl Blend {
    fn new(specimen: &Specimen, clamped: &[Option<usize>]) -> Self {
        let clips = clamped.iter().flatten().max().map_or(0, |last| last + 1);
        let mut weights: Vec<Vec<f64>> = (0..clips).map(|clip| harmonic(specimen, clamped, clip)).collect();
        // They sum to one but for rounding; exactly, so that a rigid motion of all clips stays one.
        for node in 0..clamped.len() {
            let sum: f64 = weights.iter().map(|weights| weights[node]).sum();
            weights.iter_mut().for_each(|weights| weights[node] /= sum);
        }
        Self { weights }
    }

    /// The blended shape of a frame, in the specimen's frame.
    fn shape(&self, specimen: &Specimen, frame: &Frame) -> Vec<f64> {
        (0..specimen.mesh.len())
            .flat_map(|node| {
                let rest = specimen.rest_in_world(node);
                let blended = self.weights.iter().enumerate().map(|(clip, weights)| {
                    // Skipped, not multiplied by zero: at a clip's own nodes the place is exact.
                    if weights[node] == 0.0 {
                        Vector3::zeros()
                    } else {
                        place(frame, clip, &rest) * weights[node]
                    }
                });
                let p = specimen.place(&blended.sum());
                [p.x, p.y, p.z]
            })
            .collect()
    }

    /// Mean relative change of distance between the clips' centres.
    fn extension(&self, specimen: &Specimen, x: &[f64]) -> f64 {
        let centres = |position: &dyn Fn(usize) -> Vector3<f64>| -> Vec<Vector3<f64>> {
            let centre = |weights: &Vec<f64>| {
                let held = (0..weights.len()).filter(|&node| weights[node] == 1.0);
                held.clone().map(position).sum::<Vector3<f64>>() / held.count() as f64
            };
            self.weights.iter().map(centre).collect()
        };
        let now = centres(&|node| Vector3::from_column_slice(&x[3 * node..3 * node + 3]));
        let rest = centres(&|node| specimen.mesh.positions[node]);
        let mut strains = Vec::new();
        for a in 0..now.len() {
            for b in 0..a {
                strains.push((now[a] - now[b]).norm() / (rest[a] - rest[b]).norm() - 1.0);
            }
        }
        strains.iter().sum::<f64>() / strains.len().max(1) as f64
    }
}

/// Solves Laplace's equation on the grid by conjugate gradients: a weight of 1 at a clip's nodes, 0 at the others', nothing
/// flowing out at the border.
fn harmonic(specimen: &Specimen, clamped: &[Option<usize>], clip: usize) -> Vec<f64> {
    let grid = &specimen.grid;
    let [dx, dy] = grid.cell();
    // Conductances along the grid's lines; those at the border carry half.
    let line = |at: usize, count: usize| if at == 0 || at == count - 1 { 0.5 } else { 1.0 };
    let flow = |weights: &[f64]| -> Vec<f64> {
        let mut flow = vec![0.0; weights.len()];
        let mut exchange = |a: usize, b: usize, conductance: f64| {
            let current = conductance * (weights[a] - weights[b]);
            flow[a] += current;
            flow[b] -= current;
        };
        for row in 0..grid.rows {
            for column in 1..grid.columns {
                let conductance = dy / dx * line(row, grid.rows);
                exchange(grid.node(column - 1, row), grid.node(column, row), conductance);
            }
        }
        for row in 1..grid.rows {
            for column in 0..grid.columns {
                let conductance = dx / dy * line(column, grid.columns);
                exchange(grid.node(column, row - 1), grid.node(column, row), conductance);
            }
        }
        flow.iter_mut().zip(clamped).filter(|(_, clip)| clip.is_some()).for_each(|(f, _)| *f = 0.0);
        flow
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut weights: Vec<f64> =
        clamped.iter().map(|&holder| if holder == Some(clip) { 1.0 } else { 0.0 }).collect();
    let mut residual: Vec<f64> = flow(&weights).iter().map(|f| -f).collect();
    let mut direction = residual.clone();
    let mut square = dot(&residual, &residual);
    let enough = 1e-26 * square;
    // In exact arithmetic as many steps as unknowns would do; rounding may ask for a few more.
    for _ in 0..4 * weights.len() {
        if square <= enough {
            break;
        }
        let image = flow(&direction);
        let length = square / dot(&direction, &image);
        weights.iter_mut().zip(&direction).for_each(|(w, d)| *w += length * d);
        residual.iter_mut().zip(&image).for_each(|(r, i)| *r -= length * i);
        let before = std::mem::replace(&mut square, dot(&residual, &residual));
        direction.iter_mut().zip(&residual).for_each(|(d, r)| *d = r + square / before * *d);
    }
    weights
}

/// True if the clips' nodes leave their common plane z = const so little that flattening changes no strain noticeably.
fn is_planar(x: &[f64], clamped: &[Option<usize>], specimen: &Specimen) -> bool {
    let heights = (0..clamped.len()).filter(|&node| clamped[node].is_some()).map(|node| x[3 * node + 2]);
    let [low, high] = heights.fold([f64::MAX, f64::MIN], |[low, high], z| [low.min(z), high.max(z)]);
    let side = specimen.grid.width.min(specimen.grid.height);
    0.5 * ((high - low) / side).powi(2) <= FLATTENING_STRAIN
}

/// Loading while the extension grows.
fn phase_of(extensions: &[f64], index: usize) -> Phase {
    let [before, after] = [index.saturating_sub(1), (index + 1).min(extensions.len() - 1)];
    match extensions[index] - extensions[before] {
        growth if growth > 0.0 => Phase::Loading,
        growth if growth < 0.0 => Phase::Unloading,
        _ if extensions[after] > extensions[index] => Phase::Loading,
        _ => Phase::Hold,
    }
}

fn observed(sequence: &Sequence, specimen: &Specimen, positions: &[Vector3<f64>]) -> Vec<f64> {
    let places = specimen.samples.iter().map(|s| specimen.place(&s.interpolate(&sequence.mesh, positions)));
    places.flat_map(|p| [p.x, p.y, p.z]).collect()
}

/// The measured components of a frame: along the load cell, or all the plane's, or all three.
fn force_components(
    sequence: &Sequence,
    frame: &Frame,
    specimen: &Specimen,
    weights: &[Vector3<f64>],
    planar: bool,
) -> Vec<ForceComponent> {
    let directions = match sequence.force_direction {
        Some(direction) => vec![specimen.turn(&direction)],
        None if planar => vec![Vector3::x(), Vector3::y()],
        None => vec![Vector3::x(), Vector3::y(), Vector3::z()],
    };
    let mut components = Vec::new();
    for (clip, weight) in weights.iter().enumerate() {
        let Some(force) = frame.clip_force(clip) else { continue };
        let force = specimen.turn(&force);
        // A clip is in balance: cords + its weight = what the cloth pulls with.
        let balanced = force + weight;
        components.extend(directions.iter().map(|direction| ForceComponent {
            clip,
            direction: *direction,
            force: balanced.dot(direction),
            measured: force.dot(direction),
        }));
    }
    components
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_sim::mesh::{Diagonals, Grid};

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
            let specimen = Specimen::new(&sequence, Some(nodes), Diagonals::Forward).unwrap();
            Replica::new(&sequence, specimen, model, &[Component::StretchWeft], 0.2).unwrap_err().to_string()
        };
        let long = "sequence square: found springs in cells of 8.33e-3 m × 2.50e-2 m";
        assert!(message(Model::Springs, [13, 5]).starts_with(long));
        assert!(message(Model::Springs, [13, 7]).contains("found no clip"));
        assert!(message(Model::Stvk, [13, 5]).contains("found no clip"));
    }
}
