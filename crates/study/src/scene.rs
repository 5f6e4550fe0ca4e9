//! A scene: one test of a known fabric, simulated as in a fit, with or without some parts.

use crate::memory;
use crate::physical::Reference;
use crate::run::Ending;
use crate::spent::Spent;
use cloth_data::error::{Error, Result};
use cloth_data::frame::{Kind, MeasurementSet};
use cloth_data::rig::{KnownFabric, Rig};
use cloth_fit::equilibria::Counters;
use cloth_fit::stage::{Plan, Settings};
use cloth_fit::twin::replica::{Replica, ReplicaFrame};
use cloth_sim::equilibrium::{Equilibrium, Solver};
use cloth_sim::mesh::Grid;
use nalgebra::Vector3;
use rayon::prelude::*;
use std::time::Instant;

/// Gravity across the sheet, m/s².
pub(crate) const WEIGHT: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

/// Gravity too small to have an effect, but the replica moves in space, m/s².
pub(crate) const IN_SPACE: Vector3<f64> = Vector3::new(0.0, 0.0, -1e-9);

/// A test and the parts included in it.
#[derive(Debug, Clone)]
pub(crate) struct TestScene {
    /// Name of the scene.
    pub(crate) name: String,
    /// A set with this single sequence: how the sheet is held in every frame.
    pub(crate) set: MeasurementSet,
    /// Components that store energy, and whether motion is planar.
    pub(crate) plan: Plan,
}

/// Frames of a scene in equilibrium, each solved once from its start, without a fit's fallbacks.
pub(crate) struct Balanced {
    /// The frames that reached equilibrium.
    pub(crate) frames: Vec<BalancedFrame>,
    pub(crate) replica: Replica,
    pub(crate) spent: Spent,
    pub(crate) ending: Ending,
}

/// One frame in equilibrium.
pub(crate) struct BalancedFrame {
    /// Index among the replica's frames.
    pub(crate) place: usize,
    /// Simulated forces along the measured components, N.
    pub(crate) forces: Vec<f64>,
    /// Positions of the nodes, 3 stacked coordinates per node, m.
    pub(crate) x: Vec<f64>,
}

impl TestScene {
    /// A test of the rig without noise.
    ///
    /// * `plan` — the parts included, as in a stage of a fit
    ///
    /// # Errors
    /// Those of [`Rig::measure`].
    pub(crate) fn new(fabric: &KnownFabric, kind: Kind, rig: Rig, plan: Plan) -> Result<Self> {
        let rig = Rig { sequences: vec![kind], noise: false, ..rig };
        let mut plan = plan;
        plan.kinds = vec![kind];
        Ok(Self { name: kind.to_string(), set: rig.measure(fabric)?, plan })
    }

    /// Copies the scene with another gravity, m/s².
    pub(crate) fn with_gravity(mut self, gravity: Vector3<f64>) -> Self {
        self.set.sequences.iter_mut().for_each(|sequence| sequence.gravity = gravity);
        self
    }

    /// Copies the scene without measured shapes; it starts interpolated between its clips.
    pub(crate) fn without_shapes(mut self) -> Self {
        let frames = self.set.sequences.iter_mut().flat_map(|sequence| &mut sequence.frames);
        frames.for_each(|frame| frame.positions = None);
        self
    }

    /// Copies the scene under another name.
    pub(crate) fn called(mut self, name: &str) -> Self {
        self.name = name.into();
        self
    }

    /// Solves all frames. Only the solver is timed.
    ///
    /// # Errors
    /// A replica that cannot be built.
    pub(crate) fn balance(&self, reference: &Reference, settings: &Settings) -> Result<Balanced> {
        let mut plan = self.plan.clone();
        plan.components.retain(|&component| reference.curves.get(component).is_some());
        let mut replicas = plan.replicas(&self.set, settings)?;
        let Some(replica) = replicas.pop() else { return Err(self.failed("no sequence".into())) };
        let mechanics = |source| Error::Mechanics { context: self.name.clone(), source };
        let curves = reference.told_in(settings.model, &replica.specimen.mesh).map_err(mechanics)?;
        let starts =
            replica.frames.iter().map(|frame| (Solver::new(replica.cloth(frame)), start(&replica, frame)));
        let starts: Vec<_> = starts.collect();
        memory::reset_peak();
        let clock = Instant::now();
        let solve = |(mut solver, mut x): (Solver<'_>, Vec<f64>)| {
            let found = solver.solve(&curves, &mut x, &settings.equilibrium);
            (found, solver.clip_forces(), x)
        };
        let solved: Vec<_> = starts.into_par_iter().map(solve).collect();
        let seconds = clock.elapsed().as_secs_f64();
        let found: Vec<Equilibrium> = solved.iter().map(|(found, ..)| *found).collect();
        let spent = Spent { seconds, counters: counted(&found), peak_memory_mib: memory::peak_mib() };
        let kept = solved.into_iter().enumerate().filter(|(_, (found, ..))| found.converged());
        let frames = kept.map(|(place, (_, clips, x))| BalancedFrame {
            place,
            forces: replica.frames[place].forces.iter().map(|component| component.of(&clips)).collect(),
            x: {
                let frame = &replica.frames[place];
                replica.displayed(frame, &x, frame.edge().as_ref()).into_owned()
            },
        });
        Ok(Balanced { frames: frames.collect(), ending: ending(&found), spent, replica })
    }

    fn failed(&self, found: String) -> Error {
        Error::Geometry { sequence: self.name.clone(), found, expected: "one sequence".into() }
    }
}

/// The measured shape if it leaves its plane, otherwise the replica's start.
fn start(replica: &Replica, frame: &ReplicaFrame) -> Vec<f64> {
    let mut x = frame.start.clone();
    if let Some(observed) = frame.observed.as_ref().filter(|_| replica.is_buckled(frame)) {
        for &(coordinate, _) in replica.cloth(frame).free_coordinates() {
            x[coordinate] = observed[coordinate];
        }
    }
    x
}

fn counted(found: &[Equilibrium]) -> Counters {
    let mut counters = Counters::default();
    found.iter().for_each(|found| counters.add(found));
    counters
}

fn ending(found: &[Equilibrium]) -> Ending {
    match found.iter().find(|found| !found.converged()) {
        Some(failed) => Ending::Failed(failed.status.to_string()),
        None if found.iter().any(|found| found.escaped) => Ending::SeveralEquilibria,
        None => Ending::Converged,
    }
}

impl Balanced {
    /// Positions of the nodes shared with a coarser square grid, m, frame after frame.
    pub(crate) fn shared(&self, nodes: usize) -> Vec<f64> {
        let grid: &Grid = &self.replica.specimen.grid;
        let [right, up] = [grid.columns, grid.rows].map(|all| (all - 1) / (nodes - 1));
        let mut places = Vec::new();
        for frame in &self.frames {
            for (row, column) in (0..nodes * nodes).map(|node| (node / nodes, node % nodes)) {
                let node = grid.node(column * right, row * up);
                places.extend(&frame.x[3 * node..3 * node + 3]);
            }
        }
        places
    }

    /// Index of a frame in its sequence.
    pub(crate) fn index(&self, frame: &BalancedFrame) -> usize {
        self.replica.frames[frame.place].index
    }

    /// The forces without out-of-plane components.
    fn in_plane<'f>(&'f self, frame: &'f BalancedFrame) -> impl Iterator<Item = f64> + 'f {
        let components = self.replica.frames[frame.place].forces.iter();
        let inside = components.zip(&frame.forces).filter(|(component, _)| component.direction.z.abs() < 0.5);
        inside.map(|(_, force)| *force)
    }

    /// Largest difference of a force over the largest force of `other`, over the frames in both; `None` without forces.
    pub(crate) fn force_error(&self, other: &Self) -> Option<f64> {
        let (mut apart, mut largest) = (0.0f64, 0.0f64);
        for frame in &other.frames {
            let own = self.frames.iter().find(|own| self.index(own) == other.index(frame));
            // A planar problem measures no out-of-plane clip force; the first components correspond.
            for (a, b) in own.iter().flat_map(|own| self.in_plane(own).zip(other.in_plane(frame))) {
                apart = apart.max((a - b).abs());
                largest = largest.max(b.abs());
            }
        }
        (largest > 0.0).then(|| apart / largest)
    }

    /// Root mean square distance at the nodes of a coarser grid, mm; `None` if the frames differ.
    pub(crate) fn position_error_mm(&self, other: &Self, nodes: usize) -> Option<f64> {
        let indices = |balanced: &Self| -> Vec<usize> {
            balanced.frames.iter().map(|frame| balanced.index(frame)).collect()
        };
        let same = indices(self) == indices(other) && !self.frames.is_empty();
        same.then(|| 1e3 * root_mean_square_distance(&self.shared(nodes), &other.shared(nodes)))
    }
}

/// Root mean square distance of points in space, 3 stacked coordinates each.
pub(crate) fn root_mean_square_distance(a: &[f64], b: &[f64]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (3.0 * sum / a.len().max(1) as f64).sqrt()
}
