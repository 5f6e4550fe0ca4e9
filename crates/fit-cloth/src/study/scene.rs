//! A scene: one test of a known fabric, simulated as a fit simulates it, with or without some of its parts.

use super::physical::Reference;
use super::run::{Ending, Spent, spend};
use cloth_fit::error::{Error, Result};
use cloth_fit::frame::{Kind, MeasurementSet};
use cloth_fit::replica::Replica;
use cloth_fit::rig::{KnownFabric, Rig};
use cloth_fit::simulation::{Meter, Objective, Settled, Simulation, Task};
use cloth_fit::stage::{Plan, Settings};
use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use cloth_sim::mesh::Grid;
use nalgebra::Vector3;
use std::sync::Arc;

/// Standard gravity across the sheet, m/s².
pub(super) const WEIGHT: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

/// So little gravity that nothing feels it, but the replica moves in space, m/s².
pub(super) const IN_SPACE: Vector3<f64> = Vector3::new(0.0, 0.0, -1e-9);

/// A test and the parts that take part in it.
#[derive(Debug, Clone)]
pub(super) struct Scene {
    /// What it is called.
    pub(super) name: String,
    /// The set that it is the only sequence of: how the sheet is held in every frame.
    pub(super) set: MeasurementSet,
    /// Which components store energy, and whether the sheet stays in its plane.
    pub(super) plan: Plan,
}

/// All frames of a scene in equilibrium.
pub(super) struct Balanced {
    /// Index of each frame.
    pub(super) frames: Vec<usize>,
    /// Simulated forces along the measured components, frame by frame, N.
    pub(super) forces: Vec<Vec<f64>>,
    /// Places of the nodes, frame by frame, 3 stacked coordinates a node, m.
    pub(super) shapes: Vec<Vec<f64>>,
    pub(super) grid: Grid,
    pub(super) spent: Spent,
    pub(super) ending: Ending,
}

impl Scene {
    /// A test of the rig, without noise.
    ///
    /// * `plan` — what takes part, as in a stage of a fit
    ///
    /// # Errors
    /// As [`Rig::measure`].
    pub(super) fn new(fabric: &KnownFabric, kind: Kind, rig: Rig, plan: Plan) -> Result<Self> {
        let rig = Rig { sequences: vec![kind], noise: false, ..rig };
        let mut plan = plan;
        plan.kinds = vec![kind];
        Ok(Self { name: kind.to_string(), set: rig.measure(fabric)?, plan })
    }

    /// The same with another gravity, m/s².
    pub(super) fn with_gravity(mut self, gravity: Vector3<f64>) -> Self {
        self.set.sequences.iter_mut().for_each(|sequence| sequence.gravity = gravity);
        self
    }

    /// The same without its measured shapes, so that it starts between its clips.
    pub(super) fn without_shapes(mut self) -> Self {
        let frames = self.set.sequences.iter_mut().flat_map(|sequence| &mut sequence.frames);
        frames.for_each(|frame| frame.positions = None);
        self
    }

    /// The same under another name.
    pub(super) fn called(mut self, name: &str) -> Self {
        self.name = name.into();
        self
    }

    /// Its replicas.
    fn replicas(&self, reference: &Reference, settings: &Settings) -> Result<Vec<Replica>> {
        let mut plan = self.plan.clone();
        plan.components.retain(|&component| reference.curves.get(component).is_some());
        plan.replicas(&self.set, settings)
    }

    /// Brings all frames to equilibrium. Only the solving is timed, not what a fit does once for all of it.
    ///
    /// # Errors
    /// A replica that cannot be made.
    pub(super) fn balance(
        &self,
        reference: &Reference,
        settings: &Settings,
        meter: &Arc<Meter>,
    ) -> Result<Balanced> {
        self.read(reference, settings, meter, |_, _| ()).map(|(balanced, _)| balanced)
    }

    /// The same, and what is read off each frame with its forces.
    ///
    /// # Errors
    /// As [`Scene::balance`].
    pub(super) fn read<T>(
        &self,
        reference: &Reference,
        settings: &Settings,
        meter: &Arc<Meter>,
        read: impl Fn(Settled<'_>, &[f64]) -> T,
    ) -> Result<(Balanced, Vec<T>)> {
        let replicas = self.replicas(reference, settings)?;
        let [replica] = &replicas[..] else { return Err(self.failed("no sequence, or several".into())) };
        let mechanics = |source| Error::Mechanics { context: self.name.clone(), source };
        let task = Task {
            fitted: Vec::new(),
            objective: Objective::Forces,
            known: reference.told_in(settings.model, &replica.specimen.mesh).map_err(mechanics)?,
            settings: settings.equilibrium,
            robust: None,
        };
        let none = StiffnessCurve::constant(0.0, NegativeStrain::Odd).map_err(mechanics)?;
        let mut simulation = Simulation::unsettled(&replicas, task, none, Arc::clone(meter));
        let (forces, spent) = spend(meter, || simulation.settle());
        let ending = match simulation.dropped().first() {
            Some(dropped) => Ending::Failed(dropped.status.to_string()),
            None if simulation.settled().any(|settled| settled.multi_stable) => Ending::SeveralEquilibria,
            None => Ending::Converged,
        };
        let found = simulation.settled().zip(&forces).map(|(settled, forces)| read(settled, forces)).collect();
        let balanced = Balanced {
            frames: simulation.settled().map(|settled| settled.frame.index).collect(),
            shapes: simulation.settled().map(|settled| settled.x.to_vec()).collect(),
            grid: replica.specimen.grid,
            forces,
            spent,
            ending,
        };
        Ok((balanced, found))
    }

    fn failed(&self, found: String) -> Error {
        Error::Geometry { sequence: self.name.clone(), found, expected: "one sequence".into() }
    }
}

impl Balanced {
    /// Places of the nodes that a coarser square grid has too, all frames after one another, m.
    pub(super) fn shared(&self, nodes: usize) -> Vec<f64> {
        let [right, up] = [self.grid.columns, self.grid.rows].map(|all| (all - 1) / (nodes - 1));
        let mut places = Vec::new();
        for shape in &self.shapes {
            for (row, column) in (0..nodes * nodes).map(|node| (node / nodes, node % nodes)) {
                let node = self.grid.node(column * right, row * up);
                places.extend(&shape[3 * node..3 * node + 3]);
            }
        }
        places
    }

    /// Largest difference of a force over the largest force of the other, over the frames that both have; `None` without
    /// forces.
    pub(super) fn force_error(&self, other: &Self) -> Option<f64> {
        let (mut apart, mut largest) = (0.0f64, 0.0f64);
        for (frame, forces) in other.frames.iter().zip(&other.forces) {
            let Some(own) = self.frames.iter().position(|own| own == frame) else { continue };
            for (a, b) in self.forces[own].iter().zip(forces) {
                apart = apart.max((a - b).abs());
                largest = largest.max(b.abs());
            }
        }
        (largest > 0.0).then(|| apart / largest)
    }

    /// Root mean square distance of the nodes of a coarser grid, mm; `None` where the frames differ.
    pub(super) fn position_error_mm(&self, other: &Self, nodes: usize) -> Option<f64> {
        let same = self.frames == other.frames && !self.frames.is_empty();
        same.then(|| 1e3 * root_mean_square_distance(&self.shared(nodes), &other.shared(nodes)))
    }
}

/// Of points in space, 3 stacked coordinates each.
pub(super) fn root_mean_square_distance(a: &[f64], b: &[f64]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (3.0 * sum / a.len().max(1) as f64).sqrt()
}
