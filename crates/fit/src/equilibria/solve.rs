//! The equilibrium of one frame: start, fallbacks, and sensitivities from the factorisation.

use super::elimination::{Eliminated, eliminate};
use super::frames::{Equilibria, SolverPool};
use super::observation::{Balance, Objective, coordinates};
use super::state::{FrameResult, State, measured_shape};
use super::task::SolveStart;
use crate::twin::replica::{EdgePose, Replica, ReplicaFrame};
use cloth_sim::cloth::Cloth;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::equilibrium::{Equilibrium, Solver, Status};
use cloth_sim::material::{Component, Curves};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Two equilibria of a frame are the same if no node differs by more than this share of a cell.
const SAME_SHAPE: f64 = 0.01;

/// The pose of an edge is found where a step removes less than this share of the residual, or after so many steps.
const FOUND: f64 = 1e-4;
const MOST_POSES: usize = 12;

/// Steps to the pose of an edge end where one removes more than this share of what the last one did: equilibria are not
/// exact.
const SLOWEST: f64 = 0.5;

/// Rounding of the pose, as a share of the residual of unit measurements.
const ROUNDING: f64 = 1e-9;

/// Share of an overhang, from the edge on, that places the edge where a shape is predicted.
const NEAR_EDGE: f64 = 1.0 / 3.0;

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
        // A poisoned pool only means that another frame panicked; its solvers hold no state that matters.
        let take = || pool.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).pop();
        let mut solver = take().unwrap_or_else(|| Solver::new(replica.cloth(frame)));
        let result = self.solve_with(&mut solver, replica, frame, state, curves, groups, change);
        pool.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push(solver);
        result
    }

    /// The equilibrium of a frame; off a table at the pose of the edge that meets its points best.
    #[expect(clippy::too_many_arguments, reason = "one frame of solve_frames")]
    pub(super) fn solve_with(
        &self,
        solver: &mut Solver<'_>,
        replica: &Replica,
        frame: &ReplicaFrame,
        state: &State,
        curves: &Curves,
        groups: &[Vec<Component>],
        change: Option<&DVector<f64>>,
    ) -> FrameResult {
        let (x, edge) = match self.task.start {
            SolveStart::LastEquilibrium => predicted(state, frame, replica.cloth(frame), change),
            SolveStart::Measured => (measured_shape(replica, frame), frame.edge()),
        };
        let mut result = FrameResult {
            state: State { x, edge, sensitivity: Vec::new(), ..state.clone() },
            status: Status::NotFinite,
            forces: Vec::new(),
            rows: DMatrix::zeros(0, 0),
            simulated: Vec::new(),
        };
        let (mut poses, mut last) = (0, f64::INFINITY);
        loop {
            let found = self.balance(solver, replica, frame, curves, &mut result.state);
            result.status = found.status;
            // Only an equilibrium has sensitivities.
            if !found.converged() {
                return result;
            }
            poses += 1;
            let least = if poses < MOST_POSES { last } else { 0.0 };
            let step = self.differentiate(solver, replica, frame, curves, groups, least, &mut result);
            match (step, &frame.overhang, &mut result.state.edge) {
                (Some((step, removed)), Some(overhang), Some(edge)) => {
                    last = SLOWEST * removed;
                    let turned = overhang.pose_after(edge, step.as_slice());
                    let by_slope = &result.state.sensitivity
                        [result.state.sensitivity.len() - replica.cloth(frame).unknowns()..];
                    for &(coordinate, unknown) in replica.cloth(frame).free_coordinates() {
                        result.state.x[coordinate] += by_slope[unknown] * (turned.slope - edge.slope);
                    }
                    *edge = turned;
                    overhang.hold(edge.slope, &mut result.state.x);
                }
                _ => return result,
            }
        }
    }

    /// Brings a frame to equilibrium from its state, or else from its replica's own start.
    fn balance(
        &self,
        solver: &mut Solver<'_>,
        replica: &Replica,
        frame: &ReplicaFrame,
        curves: &Curves,
        state: &mut State,
    ) -> Equilibrium {
        let cloth = replica.cloth(frame);
        let falls_back = self.task.start == SolveStart::LastEquilibrium;
        let settings = &self.task.settings;
        let x = &mut state.x;
        let mut found = solver.solve(curves, x, settings);
        self.meter.add(&found);
        let mut escaped = found.escaped;
        // In the plane, a triangle cannot turn over without passing through itself: such an equilibrium stems from a
        // crumpled start.
        let rest = replica.rest(frame);
        let crumpled = |x: &[f64]| cloth.turns_over(&rest, x);
        if (!found.converged() || crumpled(x)) && falls_back {
            // The measured shape or the prediction was too far off: restart from the replica's own start.
            self.meter.begins_anew();
            match (&frame.overhang, &state.edge) {
                (Some(overhang), Some(edge)) => x.copy_from_slice(&overhang.start(edge.slope)),
                _ => x.copy_from_slice(&frame.start),
            }
            found = solver.solve(curves, x, settings);
            self.meter.add(&found);
            escaped = found.escaped;
        }
        if (!found.converged() || crumpled(x)) && falls_back && !replica.is_on_table() {
            // Then in load steps, from the flat sheet.
            self.meter.takes_load_steps();
            x.copy_from_slice(&rest);
            found = solver.load_steps(curves, x, &frame.start, settings);
            self.meter.add(&found);
            escaped = found.escaped;
        }
        state.escaped |= escaped || crumpled(x);
        found
    }

    /// Residuals, their derivatives with respect to the groups' curves, and dx/dk. Returns a step to the best pose of
    /// the edge, and the residual that it removes, unless the pose is found; then the frame's own unknowns are
    /// eliminated.
    ///
    /// * `least` — a step that removes more does not get nearer
    #[expect(clippy::too_many_arguments, reason = "the parts of solve_with")]
    fn differentiate(
        &self,
        solver: &mut Solver<'_>,
        replica: &Replica,
        frame: &ReplicaFrame,
        curves: &Curves,
        groups: &[Vec<Component>],
        least: f64,
        result: &mut FrameResult,
    ) -> Option<(DVector<f64>, f64)> {
        let cloth = replica.cloth(frame);
        let state = &mut result.state;
        let clip_forces = solver.clip_forces();
        result.forces = frame.forces.iter().map(|component| component.of(&clip_forces)).collect();
        let columns = parameter_columns(cloth, curves, groups, &state.x);
        let values = columns.len();
        let unknowns = cloth.unknowns();
        let mut sensitivity = vec![0.0; values * unknowns];
        for (column, slopes) in columns.iter().zip(sensitivity.chunks_exact_mut(unknowns.max(1))) {
            cloth.collect(column, slopes);
            slopes.iter_mut().for_each(|force| *force = -*force);
        }
        // The response of the free lines to a turn of the first segment: −K_h ∂x_h/∂θ on the right.
        if let (Some(overhang), Some(edge)) = (&frame.overhang, &state.edge) {
            let turning = overhang.turning(edge.slope).map(|line| [line.x, 0.0, line.y]);
            let mut response = vec![0.0; unknowns];
            for (row, moved) in solver.border().chunks_exact(unknowns.max(1)).zip(turning.as_flattened()) {
                response.iter_mut().zip(row).for_each(|(sum, k)| *sum -= k * moved);
            }
            sensitivity.extend(response);
        }
        solver.solve_linear(&mut sensitivity);
        let balance =
            Balance::new(solver, cloth, frame, &state.x, state.edge, &clip_forces, &columns, &sensitivity);
        let observations = self.observations(frame);
        result.simulated = observations.iter().map(|observation| observation.simulated(&balance)).collect();
        let (rows, own) = self.rows(replica, &observations, &balance, values, &state.correction);
        let Some(overhang) = &frame.overhang else {
            result.rows = rows;
            state.sensitivity = sensitivity;
            return None;
        };
        // A prediction may see no more of the shape than what places the edge.
        let near = match self.task.objective {
            Objective::Positions => None,
            Objective::Forces => {
                let near = coordinates(frame, NEAR_EDGE * overhang.length);
                Some(self.rows(replica, &near, &balance, values, &[]))
            }
        };
        let measurements = near.as_ref().map_or(rows.nrows(), |(rows, _)| rows.nrows());
        let (of_pose, mut own) = near.unwrap_or_else(|| (rows.clone(), own));
        let mut eliminated = eliminate(of_pose.clone(), &own);
        if state.edge.is_some_and(|edge| overhang.is_pinned(&edge, eliminated.step.as_slice())) {
            own.column_mut(4).fill(0.0);
            eliminated = eliminate(of_pose, &own);
        }
        let Eliminated { rows: left, step, by_value, rank, removed } = eliminated;
        let size = left.column(0).norm();
        let rounding = ROUNDING * (measurements as f64).sqrt() * overhang.length / self.scale(replica);
        if removed > FOUND * size + rounding && removed < least {
            state.sensitivity = sensitivity;
            return Some((step, removed));
        }
        // dx/dk at the best pose.
        let by_slope = sensitivity.split_off(values * unknowns);
        for (column, slope) in sensitivity.chunks_exact_mut(unknowns.max(1)).zip(by_value.row(4).iter()) {
            column.iter_mut().zip(&by_slope).for_each(|(dx, turn)| *dx += turn * slope);
        }
        state.edge_sensitivity = by_value;
        state.eliminated = rank;
        state.sensitivity = sensitivity;
        result.rows = if self.task.objective == Objective::Positions { left } else { rows };
        None
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
        let Some(first) = replica.frames.first() else { return Vec::new() };
        let mut x = replica.rest(first);
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
fn predicted(
    state: &State,
    frame: &ReplicaFrame,
    cloth: &Cloth,
    change: Option<&DVector<f64>>,
) -> (Vec<f64>, Option<EdgePose>) {
    let (mut x, mut edge) = (state.x.clone(), state.edge);
    let unknowns = cloth.unknowns();
    let Some(change) = change.filter(|change| state.sensitivity.len() == change.len() * unknowns) else {
        return (x, edge);
    };
    for (column, step) in state.sensitivity.chunks_exact(unknowns.max(1)).zip(change.iter()) {
        for &(coordinate, unknown) in cloth.free_coordinates() {
            x[coordinate] += column[unknown] * step;
        }
    }
    if let (Some(edge), Some(overhang)) = (&mut edge, &frame.overhang)
        && state.edge_sensitivity.ncols() == change.len()
    {
        *edge = overhang.pose_after(edge, (&state.edge_sensitivity * change).as_slice());
        overhang.hold(edge.slope, &mut x);
    }
    (x, edge)
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
