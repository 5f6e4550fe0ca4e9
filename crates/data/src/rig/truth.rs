//! Simulates the sheet in every frame of a test.
//!
//! Uses continuation: each frame starts from the previous equilibrium, moved with the support. A sheet that has buckled
//! to one side therefore stays there, as in the laboratory.

use super::fabric::KnownFabric;
use super::test::{Support, Test, moved};
use crate::error::{Error, Result};
use crate::frame::Kind;
use cloth_sim::cloth::{Cloth, Problem, Rest};
use cloth_sim::equilibrium::{Settings, Solver, Status};
use cloth_sim::load::Held;
use cloth_sim::material::{Component, Curves};
use cloth_sim::mesh::{Grid, Mesh};
use nalgebra::{Isometry3, Vector3};

/// Maximum number of halvings of a step without equilibrium.
const HALVINGS: u32 = 5;

/// State of a frame.
pub(super) struct State {
    /// Motion of every clip, or of the sheet on the table.
    pub(super) motions: Vec<Isometry3<f64>>,
    /// Position of every vertex, m.
    pub(super) positions: Vec<Vector3<f64>>,
    /// Force that holds each clip, excluding its own weight, N; empty for a sheet at rest without weight.
    pub(super) holds: Vec<Vector3<f64>>,
}

/// Result of a solve: the forces that hold the clips, or the failure status.
type Attempt = std::result::Result<Vec<Vector3<f64>>, Status>;

/// A sheet under test.
pub(super) struct Truth<'a> {
    test: &'a Test,
    mesh: &'a Mesh,
    grid: &'a Grid,
    fabric: &'a KnownFabric,
    curves: &'a Curves,
    drive: f64,
    /// 3 stacked coordinates per vertex, m.
    x: Vec<f64>,
    /// The cloth under its latest constraints, and the motions that hold each vertex.
    held: Option<(Vec<Vec<usize>>, Cloth)>,
}

impl<'a> Truth<'a> {
    /// A sheet at rest.
    pub(super) fn new(
        test: &'a Test,
        mesh: &'a Mesh,
        grid: &'a Grid,
        fabric: &'a KnownFabric,
        curves: &'a Curves,
    ) -> Self {
        Self { test, mesh, grid, fabric, curves, drive: 0.0, x: stacked(&mesh.positions), held: None }
    }

    /// Computes all frames of the test.
    ///
    /// # Errors
    /// A frame without a stable equilibrium; a problem rejected by the simulation.
    pub(super) fn frames(mut self) -> Result<Vec<State>> {
        let steps = &self.test.steps;
        steps.iter().enumerate().map(|(frame, step)| self.frame(frame, step.drive)).collect()
    }

    fn frame(&mut self, frame: usize, drive: f64) -> Result<State> {
        let holds = if drive == 0.0 && self.test.is_planar() {
            // Without weight the rest state needs no solve, and without bending a solve could not find it.
            (self.drive, self.x) = (drive, stacked(&self.mesh.positions));
            Ok(Vec::new())
        } else {
            self.advance(drive, HALVINGS)?
        };
        let positions = self.x.chunks_exact(3).map(Vector3::from_column_slice).collect();
        holds.map(|holds| State { motions: (self.test.motion)(drive), positions, holds }).map_err(|status| {
            Error::Geometry {
                sequence: self.test.kind.to_string(),
                found: format!("frame {frame}: {status}"),
                expected: "a fabric that has an equilibrium in every frame (smaller ranges, more frames)"
                    .into(),
            }
        })
    }

    /// Advances the drive, in halves where a single step fails.
    fn advance(&mut self, drive: f64, halvings: u32) -> Result<Attempt> {
        let from = self.drive;
        let at_once = self.solve(drive)?;
        if at_once.is_ok() || halvings == 0 || drive == from {
            return Ok(at_once);
        }
        match self.advance(0.5 * (from + drive), halvings - 1)? {
            Ok(_) => self.advance(drive, halvings - 1),
            failed => Ok(failed),
        }
    }

    /// Advances the drive in one step. On failure the state is unchanged.
    fn solve(&mut self, drive: f64) -> Result<Attempt> {
        let motions = (self.test.motion)(drive);
        let holders = self.test.holders(self.mesh, &motions);
        let mut x = self.start(&motions, &holders);
        let cloth = match self.held.take() {
            Some((before, cloth)) if before == holders => cloth,
            _ => self.cloth(&holders)?,
        };
        let mut solver = Solver::new(&cloth);
        let found = solver.solve(self.curves, &mut x, &Settings::default());
        let holds = self.holds(&motions, &holders, solver.gradient());
        self.held = Some((holders, cloth));
        if !found.converged() {
            return Ok(Err(found.status));
        }
        (self.drive, self.x) = (drive, x);
        Ok(Ok(holds))
    }

    /// Start of a solve: the previous state moved with the four corners of the sheet, and held vertices in place.
    fn start(&self, motions: &[Isometry3<f64>], holders: &[Vec<usize>]) -> Vec<f64> {
        let before = (self.test.motion)(self.drive);
        let corners = self.corners(holders);
        let mut x = self.x.clone();
        for (vertex, rest) in self.mesh.positions.iter().enumerate() {
            let place = &mut x[3 * vertex..3 * vertex + 3];
            let now = match holders[vertex].first() {
                Some(&by) => moved(&motions[by], rest),
                None => {
                    let own = self.test.sheet.own(&self.mesh.material[vertex]);
                    let [s, t] = [own.x / self.test.sheet.size[0], own.y / self.test.sheet.size[1]];
                    let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t];
                    let taken = corners.iter().zip(weights).map(|(&(corner, by), weight)| {
                        let rest = &self.mesh.positions[corner];
                        (moved(&motions[by], rest) - moved(&before[by], rest)) * weight
                    });
                    Vector3::from_column_slice(place) + taken.sum::<Vector3<f64>>()
                }
            };
            place.copy_from_slice(now.as_slice());
        }
        x
    }

    /// The four corners of the sheet, and the motion that each follows: its own holder, else that of any vertex.
    fn corners(&self, holders: &[Vec<usize>]) -> [(usize, usize); 4] {
        let [right, above] = [self.grid.columns - 1, self.grid.rows - 1];
        [[0, 0], [right, 0], [0, above], [right, above]]
            .map(|[column, row]| self.grid.node(column, row))
            .map(|corner| (corner, holders[corner].first().copied().unwrap_or(0)))
    }

    fn cloth(&self, holders: &[Vec<usize>]) -> Result<Cloth> {
        let planar = self.test.is_planar();
        let components: Vec<Component> =
            self.curves.components().filter(|component| !(planar && component.is_bending())).collect();
        let nodes = (0..holders.len()).filter(|&node| !holders[node].is_empty());
        let held: Vec<Held> = nodes.map(|node| Held { node, clip: None }).collect();
        Cloth::new(&Problem {
            mesh: self.mesh,
            model: self.fabric.model,
            components: &components,
            areal_density: self.fabric.areal_density_kg_m2,
            gravity: self.test.gravity,
            held: &held,
            tied: &self.lines(holders),
            guided: &[],
            planar,
            rest: Rest::Flat,
        })
        .map_err(|source| Error::Mechanics { context: format!("rig, {}", self.test.kind), source })
    }

    /// On a table: the free lines along the edge, each moved as a rigid line, so that the sheet bends as a cylinder.
    /// Otherwise hinges would let it twist with the diagonals, which cloth does not do.
    fn lines(&self, holders: &[Vec<usize>]) -> Vec<Vec<usize>> {
        let Grid { columns, rows, .. } = *self.grid;
        let line = |along_rows: bool, index: usize| -> Vec<usize> {
            match along_rows {
                true => (0..columns).map(|column| self.grid.node(column, index)).collect(),
                false => (0..rows).map(|row| self.grid.node(index, row)).collect(),
            }
        };
        let lines = match (&self.test.support, self.test.kind) {
            (Support::Clips(_), _) => Vec::new(),
            (_, Kind::BendWarp) => (0..rows).map(|row| line(true, row)).collect(),
            _ => (0..columns).map(|column| line(false, column)).collect(),
        };
        let free = |line: &Vec<usize>| line.iter().all(|&node| holders[node].is_empty());
        lines.into_iter().filter(free).collect()
    }

    /// Sums the holding forces over the vertices of each clip.
    fn holds(
        &self,
        motions: &[Isometry3<f64>],
        holders: &[Vec<usize>],
        gradient: &[f64],
    ) -> Vec<Vector3<f64>> {
        let axes = self.test.axes(motions);
        let mut holds = vec![Vector3::zeros(); axes.len()];
        if axes.is_empty() {
            return holds;
        }
        for (holders, force) in holders.iter().zip(gradient.chunks_exact(3)) {
            let force = Vector3::from_column_slice(force);
            match holders[..] {
                [clip] => holds[clip] += force,
                [first, second, ..] => {
                    let parts = split(force, [axes[first], axes[second]]);
                    holds[first] += parts[0];
                    holds[second] += parts[1];
                }
                [] => {}
            }
        }
        holds
    }
}

/// Splits the force at a corner between the two bars hinged there: in their plane each takes the component along
/// itself, out of the plane each takes half. In homogeneous shear the traction on each side is along its bar, so that
/// every bar gets exactly stress × length.
fn split(force: Vector3<f64>, [a, b]: [Vector3<f64>; 2]) -> [Vector3<f64>; 2] {
    let normal = a.cross(&b);
    let area = normal.norm_squared();
    let across = normal * (force.dot(&normal) / area);
    let along_a = a * (force.cross(&b).dot(&normal) / area);
    let along_b = b * (a.cross(&force).dot(&normal) / area);
    [along_a + across * 0.5, along_b + across * 0.5]
}

fn stacked(positions: &[Vector3<f64>]) -> Vec<f64> {
    positions.iter().flat_map(|p| [p.x, p.y, p.z]).collect()
}
