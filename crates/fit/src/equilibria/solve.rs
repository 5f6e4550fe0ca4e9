//! The equilibrium of one frame: start, fallbacks, and sensitivities from the factorisation.

use super::frames::{Equilibria, SolverPool};
use super::observation::{Balance, Objective, Observation};
use super::state::{FrameResult, State, measured_shape};
use super::task::SolveStart;
use super::whitening::Whitening;
use crate::twin::replica::{Replica, ReplicaFrame};
use cloth_sim::cloth::Cloth;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::equilibrium::Solver;
use cloth_sim::material::{Component, Curves};
use nalgebra::DVector;
use rayon::prelude::*;
use std::sync::Arc;

/// Two equilibria of a frame are the same if no node differs by more than this share of a cell.
const SAME_SHAPE: f64 = 0.01;

impl<'a> Equilibria<'a> {
    /// Equilibria of all frames. `change`, of the control values since the states were found, extrapolates the states
    /// first.
    ///
    /// * `groups` — differentiates with respect to their curves
    pub(super) fn solve_frames(
        &self,
        curves: &Curves,
        groups: &[Vec<Component>],
        change: Option<&DVector<f64>>,
    ) -> Vec<FrameResult> {
        self.frames
            .par_iter()
            .zip(&self.states)
            .map(|(&(replica, frame), state)| {
                let pool = &self.solvers[replica][self.replicas[replica].frames[frame].cloth];
                let replica = &self.replicas[replica];
                self.solve_frame(pool, replica, &replica.frames[frame], state, curves, groups, change)
            })
            .collect()
    }

    #[expect(clippy::too_many_arguments, reason = "one frame of solve_frames")]
    fn solve_frame(
        &self,
        pool: &SolverPool<'a>,
        replica: &'a Replica,
        frame: &'a ReplicaFrame,
        state: &State,
        curves: &Curves,
        groups: &[Vec<Component>],
        change: Option<&DVector<f64>>,
    ) -> FrameResult {
        let cloth = replica.cloth(frame);
        // A poisoned pool only means that another frame panicked; its solvers hold no state that matters.
        let take = || pool.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).pop();
        let mut solver = take().unwrap_or_else(|| Solver::new(cloth));
        let mut x = match self.task.start {
            SolveStart::LastEquilibrium => predicted(state, cloth, change),
            SolveStart::Measured => measured_shape(replica, frame),
        };
        let falls_back = self.task.start == SolveStart::LastEquilibrium;
        let settings = &self.task.settings;
        let mut found = solver.solve(curves, &mut x, settings);
        self.meter.add(&found);
        let mut escaped = found.escaped;
        // In the plane, a triangle cannot turn over without passing through itself: such an equilibrium stems from a
        // crumpled start.
        let rest = replica.rest();
        let crumpled = |x: &[f64]| cloth.turns_over(&rest, x);
        if (!found.converged() || crumpled(&x)) && falls_back {
            // The measured shape or the prediction was too far off: restart from the replica's own start.
            self.meter.begins_anew();
            x.copy_from_slice(&frame.start);
            found = solver.solve(curves, &mut x, settings);
            self.meter.add(&found);
            escaped = found.escaped;
        }
        if (!found.converged() || crumpled(&x)) && falls_back && !replica.is_on_table() {
            // Then in load steps, from the flat sheet.
            self.meter.takes_load_steps();
            x.copy_from_slice(&rest);
            found = solver.load_steps(curves, &mut x, &frame.start, settings);
            self.meter.add(&found);
            escaped = found.escaped;
        }
        let escaped = escaped || crumpled(&x);
        let mut result = FrameResult {
            state: State {
                x,
                sensitivity: Vec::new(),
                escaped: state.escaped || escaped,
                whitening: state.whitening.clone(),
            },
            status: found.status,
            forces: Vec::new(),
            simulated: Vec::new(),
            derivatives: Vec::new(),
        };
        // Only an equilibrium has sensitivities.
        if found.converged() {
            self.differentiate(&mut solver, replica, frame, curves, groups, &mut result);
        }
        pool.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push(solver);
        result
    }

    /// Simulated values, their derivatives with respect to the groups' curves, and dx/dk.
    fn differentiate(
        &self,
        solver: &mut Solver<'_>,
        replica: &Replica,
        frame: &ReplicaFrame,
        curves: &Curves,
        groups: &[Vec<Component>],
        result: &mut FrameResult,
    ) {
        let cloth = replica.cloth(frame);
        let x = &result.state.x;
        let clip_forces = solver.clip_forces();
        result.forces = frame.forces.iter().map(|component| component.of(&clip_forces)).collect();
        let columns = parameter_columns(cloth, curves, groups, x);
        let unknowns = cloth.unknowns();
        let mut sensitivity = vec![0.0; columns.len() * unknowns];
        for (column, slopes) in columns.iter().zip(sensitivity.chunks_exact_mut(unknowns.max(1))) {
            cloth.collect(column, slopes);
            slopes.iter_mut().for_each(|force| *force = -*force);
        }
        solver.solve_linear(&mut sensitivity);
        let balance = Balance::new(solver, cloth, frame, x, &clip_forces, &columns, &sensitivity);
        let observations = self.task.objective.observations(replica, frame);
        result.simulated = observations.iter().map(|observation| observation.simulated(&balance)).collect();
        let row = |observation: &Observation| -> Vec<f64> {
            (0..columns.len()).map(|value| observation.derivative(&balance, value)).collect()
        };
        result.derivatives = observations.iter().flat_map(row).collect();
        // Only shapes feel where a table holds the sheet.
        let errs = self.task.objective == Objective::Positions && replica.held_spread > 0.0;
        if errs && result.state.whitening.is_none() {
            result.state.whitening = Some(Arc::new(Whitening::of_table(solver, replica, frame)));
        }
        result.state.sensitivity = sensitivity;
    }

    /// Follows every sheet between clips that moves in space through its frames, from rest, each frame from the
    /// previous equilibrium. A frame that thereby reaches another shape than from its measured one has several
    /// equilibria and is flagged; a frame that continuation does not reach starts from its measured shape.
    pub fn follow(&mut self) {
        let curves = self.curves();
        let followed: Vec<Vec<(usize, State)>> =
            (0..self.replicas.len()).into_par_iter().map(|replica| self.followed(replica, &curves)).collect();
        for (place, state) in followed.into_iter().flatten() {
            self.states[place] = state;
        }
    }

    /// The states of one replica's frames by continuation, with their indices among all frames.
    fn followed(&self, index: usize, curves: &Curves) -> Vec<(usize, State)> {
        let replica = &self.replicas[index];
        if replica.planar || replica.is_on_table() {
            return Vec::new();
        }
        let mut solver = Solver::new(&replica.cloths[0]);
        let mut x = replica.rest();
        let mut states = Vec::new();
        for (place, &(_, frame)) in self.frames.iter().enumerate().filter(|(_, (of, _))| *of == index) {
            let settings = &self.task.settings;
            let mut measured = self.states[place].clone();
            let seen = solver.solve(curves, &mut measured.x, settings);
            measured.escaped |= seen.escaped;
            let along = solver.load_steps(curves, &mut x, &replica.frames[frame].start, settings);
            [seen, along].iter().for_each(|found| self.meter.add(found));
            if !along.converged() {
                self.meter.does_not_follow();
                x.copy_from_slice(&measured.x);
                states.push((place, measured));
                continue;
            }
            let apart = x.iter().zip(&measured.x).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
            let [dx, dy] = replica.specimen.grid.cell();
            let other = seen.converged() && apart > SAME_SHAPE * dx.min(dy);
            let escaped = measured.escaped || along.escaped || other;
            states.push((place, State { x: x.clone(), escaped, ..State::default() }));
        }
        states
    }
}

/// A state extrapolated by a change of the control values.
fn predicted(state: &State, cloth: &Cloth, change: Option<&DVector<f64>>) -> Vec<f64> {
    let mut x = state.x.clone();
    let unknowns = cloth.unknowns();
    if let Some(change) = change.filter(|change| state.sensitivity.len() == change.len() * unknowns) {
        for (column, step) in state.sensitivity.chunks_exact(unknowns.max(1)).zip(change.iter()) {
            for &(coordinate, unknown) in cloth.free_coordinates() {
                x[coordinate] += column[unknown] * step;
            }
        }
    }
    x
}

/// ∂g/∂k for every control value of every group, N per unit of stiffness, 3 entries per node.
pub(crate) fn parameter_columns(
    cloth: &Cloth,
    curves: &Curves,
    groups: &[Vec<Component>],
    x: &[f64],
) -> Vec<Vec<f64>> {
    let mut columns = Vec::new();
    let mut part = Vec::new();
    for group in groups {
        let first = columns.len();
        let points =
            group.first().and_then(|&component| curves.get(component)).map_or(0, StiffnessCurve::len);
        columns.resize(first + points, vec![0.0; x.len()]);
        for &component in group {
            cloth.parameter_gradient(curves, component, x, &mut part);
            for (sum, column) in columns[first..].iter_mut().zip(part.chunks_exact(x.len())) {
                sum.iter_mut().zip(column).for_each(|(sum, value)| *sum += value);
            }
        }
    }
    columns
}
