//! The frames of one stage under unknown curves.

use super::meter::Meter;
use super::observation::{Objective, Observation};
use super::state::{State, start_state};
use super::task::Task;
use super::unknowns::{Unknown, Unknowns};
use crate::optimise::robust::Robust;
use crate::twin::replica::{ClipPoses, EdgePose, Replica, ReplicaFrame};
use cloth_sim::equilibrium::{Solver, Status};
use cloth_sim::material::{Component, Curves};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// A skipped frame: its equilibrium was not found.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DroppedFrame {
    /// Name of the sequence.
    pub sequence: String,
    /// Index of the frame in the sequence.
    pub frame: usize,
    /// Status of the solve.
    pub status: Status,
}

/// One frame of a simulation, read-only.
#[derive(Debug, Clone, Copy)]
pub struct Settled<'s> {
    /// The sequence's replica.
    pub replica: &'s Replica,
    /// The frame.
    pub frame: &'s ReplicaFrame,
    /// Its equilibrium, 3 stacked coordinates per node, m.
    pub x: &'s [f64],
    /// Pose of the sheet at a table's edge.
    pub edge: Option<&'s EdgePose>,
    /// The solve met an unstable equilibrium and left it: the frame may have several equilibria.
    pub multi_stable: bool,
    /// Error of the grid in the compared coordinates of each point, m, or empty.
    pub correction: &'s [f64],
}

/// The states of all frames at one evaluation.
pub struct States(Vec<State>);

/// A gap wider than this multiple of the widest gap between frames is not bridged: frames are rarely spaced evenly.
const BRIDGED: f64 = 2.0;

pub(super) type SolverPool<'a> = Mutex<Vec<Solver<'a>>>;

/// A stage's replicas under unknown curves.
pub struct Equilibria<'a> {
    pub(super) replicas: &'a [Replica],
    /// Replicas on finer grids, by which simulated values are corrected; empty = not corrected.
    pub(super) finer: &'a [Replica],
    /// Per replica, per cloth.
    pub(super) solvers: Vec<Vec<SolverPool<'a>>>,
    pub(super) task: Task,
    pub(super) unknowns: Unknowns,
    /// (replica, frame) of every frame in use.
    pub(super) frames: Vec<(usize, usize)>,
    pub(super) states: Vec<State>,
    pub(super) dropped: Vec<DroppedFrame>,
    pub(super) meter: Arc<Meter>,
}

impl<'a> Equilibria<'a> {
    /// Finds the first equilibria and drops frames without one.
    ///
    /// * `unknowns` — the curves to start from; their strains are those of the fitted control points
    pub fn new(replicas: &'a [Replica], task: Task, unknowns: Unknowns, meter: Arc<Meter>) -> Self {
        let mut simulation = Self::unsettled(replicas, task, unknowns, meter);
        simulation.settle();
        simulation
    }

    /// All frames at their starting shapes, not yet in equilibrium.
    pub fn unsettled(replicas: &'a [Replica], task: Task, unknowns: Unknowns, meter: Arc<Meter>) -> Self {
        let frames: Vec<(usize, usize)> = replicas
            .iter()
            .enumerate()
            .flat_map(|(replica, r)| (0..r.frames.len()).map(move |frame| (replica, frame)))
            .collect();
        let pools = |replica: &Replica| replica.cloths.iter().map(|_| Mutex::default()).collect();
        let mut simulation = Self {
            replicas,
            finer: &[],
            solvers: replicas.iter().map(pools).collect(),
            task,
            unknowns,
            states: Vec::new(),
            frames,
            dropped: Vec::new(),
            meter,
        };
        let curves = simulation.curves();
        simulation.states = simulation
            .frames
            .par_iter()
            .map(|&(replica, frame)| {
                let replica = &replicas[replica];
                let clips = vec![0.0; simulation.clip_poses(replica).map_or(0, ClipPoses::unknowns)];
                State { clips, ..start_state(replica, &replica.frames[frame], &curves) }
            })
            .collect();
        simulation
    }

    /// Gives residuals above `limit` times the noise less weight; where the noise is unknown, above `limit` times the
    /// typical residual under the present curve (its median, as a standard deviation).
    pub fn make_robust(&mut self, limit: f64) {
        self.task.robust = None;
        let unit = if self.noise_is_known() { 1.0 } else { self.typical_residual() };
        self.task.robust = (unit > 0.0).then_some(Robust { limit: limit * unit });
    }

    /// Continues with other control points; states are kept.
    pub fn set_unknowns(&mut self, unknowns: Unknowns) {
        self.unknowns = unknowns;
        // Sensitivities belong to the old control values.
        self.states.iter_mut().for_each(|state| state.sensitivity.clear());
    }

    /// The states of all frames, to return to.
    pub fn states(&self) -> States {
        States(self.states.clone())
    }

    /// Continues from earlier states of the same frames.
    pub fn return_to(&mut self, states: &States) {
        self.states.clone_from(&states.0);
    }

    /// The unknowns at the last evaluation.
    pub fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    /// Number of compared measurements, over all frames in use.
    pub fn measurements(&self) -> usize {
        self.settled().map(|s| self.observations(s.frame).len()).sum()
    }

    /// True if the noise of every sequence is known; residuals are then in units of it.
    pub fn noise_is_known(&self) -> bool {
        self.replicas.iter().all(|replica| self.noise(replica).is_some())
    }

    /// The errors of a replica's clip poses, where they are found with the curves: forces tell them, and how far is told by
    /// the noise of both.
    pub(super) fn clip_poses<'r>(&self, replica: &'r Replica) -> Option<&'r ClipPoses> {
        let found = !self.task.exact_clips && self.task.objective == Objective::Forces;
        replica.clip_poses.as_ref().filter(|_| found && self.noise_is_known())
    }

    /// True if shapes help to find the poses of clips.
    pub fn finds_clip_poses(&self) -> bool {
        self.settled()
            .any(|settled| self.clip_poses(settled.replica).is_some() && !settled.frame.points.is_empty())
    }

    /// Converts residuals to newtons or metres: their noise unit (the mean, if sequences differ), or 1.
    pub fn unit(&self) -> f64 {
        let scales = self.replicas.iter().map(|replica| self.scale(replica));
        scales.sum::<f64>() / self.replicas.len() as f64
    }

    /// The compared quantities of a frame.
    pub(super) fn observations(&self, frame: &ReplicaFrame) -> Vec<Observation> {
        self.task.objective.observations(frame, self.task.robust.is_some())
    }

    /// The task of the simulation.
    pub fn task(&self) -> &Task {
        &self.task
    }

    /// Frames without an equilibrium.
    pub fn dropped(&self) -> &[DroppedFrame] {
        &self.dropped
    }

    /// The frames in use, with their replicas and states.
    pub fn settled(&self) -> impl Iterator<Item = Settled<'_>> {
        let replicas = self.replicas;
        self.frames.iter().zip(&self.states).map(move |(&(replica, frame), state)| Settled {
            replica: &replicas[replica],
            frame: &replicas[replica].frames[frame],
            x: &state.x,
            edge: state.edge.as_ref(),
            multi_stable: state.escaped,
            correction: &state.correction.points,
        })
    }

    /// Brings all frames to equilibrium under the curve; returns the simulated forces along the measured components
    /// of each, N, as they are compared: corrected for the grid. Drops frames without an equilibrium.
    pub fn settle(&mut self) -> Vec<Vec<f64>> {
        let results = self.solve_frames(&self.curves(), &[], None);
        let mut forces = Vec::new();
        self.states.clear();
        for ((replica, frame), result) in std::mem::take(&mut self.frames).into_iter().zip(results) {
            if result.status == Status::Converged {
                self.frames.push((replica, frame));
                let of_forces = self.task.objective == Objective::Forces;
                let correction = result
                    .state
                    .correction
                    .values
                    .iter()
                    .filter(|_| of_forces)
                    .chain(std::iter::repeat(&0.0));
                forces.push(
                    result
                        .forces
                        .iter()
                        .zip(correction)
                        .map(|(force, correction)| force + correction)
                        .collect(),
                );
                self.states.push(result.state);
            } else {
                let Replica { name, frames, .. } = &self.replicas[replica];
                let (sequence, frame) = (name.clone(), frames[frame].index);
                self.dropped.push(DroppedFrame { sequence, frame, status: result.status });
            }
        }
        forces
    }

    /// The range of an unknown curve's strains over all states, from the 1st to the 99th percentile; absolute
    /// values where the curve is odd.
    ///
    /// The range starts at rest, where the stress is zero without a measurement, if the gap from there is about as
    /// wide as those between frames.
    pub fn visited(&self, unknown: &Unknown) -> [f64; 2] {
        let mut strains: Vec<f64> = self.strains(unknown).into_iter().map(|[strain, _]| strain).collect();
        strains.sort_by(f64::total_cmp);
        let percentile = |share: f64| {
            let place = share * strains.len().saturating_sub(1) as f64;
            strains.get(place.round() as usize).copied().unwrap_or(0.0)
        };
        let [low, high] = [percentile(0.01), percentile(0.99)];
        [if low > BRIDGED * self.widest_gap(unknown) { low } else { low.min(0.0) }, high.max(0.0)]
    }

    /// The widest gap between mean strains of frames, sorted by mean strain.
    fn widest_gap(&self, unknown: &Unknown) -> f64 {
        let of_frame = |s: Settled<'_>| {
            let strains: Vec<f64> = sized_strains(&s, unknown).map(|[strain, _]| strain).collect();
            strains.iter().sum::<f64>() / strains.len().max(1) as f64
        };
        let mut means: Vec<f64> = self.settled().map(of_frame).collect();
        means.sort_by(f64::total_cmp);
        means.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max)
    }

    /// An unknown curve's strains over all states, each with its area, m²; absolute values where the curve is
    /// odd.
    pub fn strains(&self, unknown: &Unknown) -> Vec<[f64; 2]> {
        self.settled().flat_map(|s| sized_strains(&s, unknown).collect::<Vec<_>>()).collect()
    }

    /// The largest strain that an unknown curve's control points should reach.
    pub fn reach(&self, unknown: &Unknown) -> f64 {
        self.visited(unknown)[1].max(f64::MIN_POSITIVE)
    }

    /// Vertices too far off a table's lines to be used, over all frames.
    pub fn vertices_left_out(&self) -> usize {
        self.replicas.iter().map(|replica| replica.vertices_left_out).sum()
    }

    /// Share of the sheet, over all states, strained beyond the last control point of each component's curve; zero
    /// shares are omitted.
    pub fn extrapolated(&self) -> BTreeMap<Component, f64> {
        let curves = self.curves();
        let share = |component| {
            let (sum, frames) = self.settled().fold((0.0, 0), |(sum, frames), s| {
                (sum + s.replica.cloth(s.frame).extrapolated(&curves, component, s.x), frames + 1)
            });
            (component, sum / f64::from(frames.max(1)))
        };
        curves.components().map(share).filter(|(_, share)| *share > 0.0).collect()
    }

    pub(super) fn curves(&self) -> Curves {
        self.unknowns.beside(&self.task.known)
    }
}

fn sized_strains(settled: &Settled<'_>, unknown: &Unknown) -> impl Iterator<Item = [f64; 2]> {
    let odd = unknown.is_odd();
    let sized = move |[strain, area]: [f64; 2]| [if odd { strain.abs() } else { strain }, area];
    let Settled { replica, frame, x, .. } = *settled;
    unknown.components.iter().flat_map(move |&c| replica.cloth(frame).strains(c, x)).map(sized)
}
