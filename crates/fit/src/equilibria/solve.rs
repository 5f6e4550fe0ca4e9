//! The equilibrium of one frame: start, fallbacks, and sensitivities from the factorisation.

use super::elimination::{Eliminated, Prior, eliminate};
use super::frames::{Equilibria, SolverPool};
use super::observation::{Balance, Objective, coordinates};
use super::state::{FrameResult, State, measured_shape};
use super::task::SolveStart;
use crate::twin::replica::{Replica, ReplicaFrame};
use cloth_sim::cloth::Cloth;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::equilibrium::{Equilibrium, Solver, Status};
use cloth_sim::material::{Component, Curves};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Two equilibria of a frame are the same if no node differs by more than this share of a cell.
const SAME_SHAPE: f64 = 0.01;

/// The pose of an edge, or those of clips, are found where a step removes less than this share of the residual, or after so
/// many steps.
const FOUND: f64 = 1e-4;
const MOST_POSES: usize = 24;

/// Steps to a pose end where one removes little and more than this share of what the last one did: equilibria are not exact.
const LITTLE: f64 = 0.01;
const SLOWEST: f64 = 0.5;

/// Rounding of the pose, as a share of the residual of unit measurements.
const ROUNDING: f64 = 1e-9;

/// Change of a clip's force that no step to its pose is worth, as a share of the noise.
const UNFELT: f64 = 1e-6;

/// Share of an overhang, from the edge on, that places the edge where a shape is predicted.
const NEAR_EDGE: f64 = 1.0 / 3.0;

/// A step to the best pose of an edge, or to the likeliest ones of clips.
struct PoseStep {
    step: DVector<f64>,
    /// The part of the residual that it removes.
    removed: f64,
    /// The residual before it.
    residual: f64,
}

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

    /// The equilibrium of a frame: off a table at the pose of the edge that meets its points best; between clips at their
    /// likeliest poses.
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
        let state = match self.task.start {
            SolveStart::LastEquilibrium => predicted(state, replica, frame, change),
            SolveStart::Measured => {
                let mut x = measured_shape(replica, frame);
                replica.hold(frame, None, &state.clips, &mut x);
                State { x, edge: frame.edge(), ..state.clone() }
            }
        };
        let mut result = FrameResult {
            state: State { sensitivity: Vec::new(), ..state },
            status: Status::NotFinite,
            forces: Vec::new(),
            rows: DMatrix::zeros(0, 0),
            simulated: Vec::new(),
        };
        let mut last: Option<(State, PoseStep)> = None;
        for poses in 1.. {
            let found = self.balance(solver, replica, frame, curves, &mut result.state);
            result.status = found.status;
            // Only an equilibrium has sensitivities.
            if !found.converged() {
                break;
            }
            let slowest = last.as_ref().map_or(f64::INFINITY, |(_, step)| SLOWEST * step.removed);
            let ends = |removed: f64, size: f64| {
                poses >= MOST_POSES || removed <= LITTLE * size && removed >= slowest
            };
            let next = self.differentiate(solver, replica, frame, curves, groups, &ends, &mut result);
            let Some(next) = next else { break };
            match &mut last {
                // Too long: half the step, from where it started.
                Some((from, step)) if next.residual > step.residual => {
                    step.step *= 0.5;
                    // What half a step leaves tells nothing of how slow it is.
                    step.removed = f64::INFINITY;
                    result.state.clone_from(from);
                }
                _ => last = Some((result.state.clone(), next)),
            }
            if let Some((_, step)) = last.as_ref().filter(|_| poses + 1 < MOST_POSES) {
                take_own_step(replica, frame, &step.step, &mut result.state);
            }
        }
        result
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
        let own_start = own_start(replica, frame, state);
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
            x.copy_from_slice(&own_start);
            found = solver.solve(curves, x, settings);
            self.meter.add(&found);
            escaped = found.escaped;
        }
        if (!found.converged() || crumpled(x)) && falls_back && !replica.is_on_table() {
            // Then in load steps, from the flat sheet.
            self.meter.takes_load_steps();
            x.copy_from_slice(&rest);
            found = solver.load_steps(curves, x, &own_start, settings);
            self.meter.add(&found);
            escaped = found.escaped;
        }
        state.escaped |= escaped || crumpled(x);
        found
    }

    /// Residuals, their derivatives with respect to the groups' curves, and dx/dk. Returns a step to the best pose of
    /// the edge, or to the likeliest ones of the clips, unless these are found; then the frame's own unknowns are eliminated.
    ///
    /// * `ends` — true if a step that removes so much of a residual, and leaves so much, is not taken
    #[expect(clippy::too_many_arguments, reason = "the parts of solve_with")]
    fn differentiate(
        &self,
        solver: &mut Solver<'_>,
        replica: &Replica,
        frame: &ReplicaFrame,
        curves: &Curves,
        groups: &[Vec<Component>],
        ends: &dyn Fn(f64, f64) -> bool,
        result: &mut FrameResult,
    ) -> Option<PoseStep> {
        let cloth = replica.cloth(frame);
        let state = &mut result.state;
        let clip_forces = solver.clip_forces();
        result.forces = frame.forces.iter().map(|component| component.of(&clip_forces)).collect();
        let mut columns = parameter_columns(cloth, curves, groups, &state.x);
        let values = columns.len();
        if let Some(poses) = self.clip_poses(replica) {
            let moves = poses.moves(&frame.start);
            columns.extend(moves.iter().map(|moved| cloth.stiffness_times(curves, &state.x, moved)));
        }
        let unknowns = cloth.unknowns();
        let mut sensitivity = vec![0.0; columns.len() * unknowns];
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
        let (x, edge) = (&state.x, state.edge);
        let balance =
            Balance::new(solver, cloth, frame, x, edge, &clip_forces, values, &columns, &sensitivity);
        let observations = self.observations(frame);
        result.simulated = observations.iter().map(|observation| observation.simulated(&balance)).collect();
        let unit = self.scale(replica);
        let (mut rows, own) = self.rows(unit, &observations, &balance, values, &state.correction.values);
        let Some(overhang) = &frame.overhang else {
            if own.ncols() > 0 {
                let at = DVector::from_column_slice(&state.clips);
                let prior = self.pose_prior(replica, &balance, values, &at, &state.correction.points);
                // As if the poses were the likeliest before the forces.
                let eliminated = |mut rows: DMatrix<f64>, own: &DMatrix<f64>| {
                    rows.set_column(0, &(rows.column(0) + own * (&at - &prior.mean)));
                    let values = rows.columns(1, values) + own * &prior.by_value;
                    rows.columns_mut(1, values.ncols()).copy_from(&values);
                    eliminate(rows, &(own * &prior.spread), Prior::Unit)
                };
                let (way, by_own) = self.weighted(&rows, &own);
                let residual = rows.column(0).norm().hypot(prior.deviations(&at).norm());
                let found = eliminated(way, &by_own);
                let step = prior.errors(&found.step) - &at;
                let removed = (by_own * &step).norm().hypot((&found.step - prior.deviations(&at)).norm());
                let unfelt = UNFELT * (rows.nrows() as f64).sqrt();
                let size = found.rows.column(0).norm();
                if removed > FOUND * size + unfelt && !ends(removed, size) {
                    state.sensitivity = sensitivity;
                    return Some(PoseStep { step, removed, residual });
                }
                let bent = self.task.robust.map(|_| eliminated(rows, &own));
                let Eliminated { rows: left, by_value, .. } = bent.unwrap_or(found);
                let by_value = &prior.by_value + &prior.spread * by_value;
                add_own(&mut sensitivity, values, unknowns, &by_value);
                state.grid_through_poses = Some(&own * &prior.of_grid);
                let own = own * &prior.spread;
                (state.own_sensitivity, state.by_clips, rows) = (by_value, own, left);
            }
            state.sensitivity = sensitivity;
            result.rows = rows;
            return None;
        };
        // A prediction may see no more of the shape than what places the edge.
        let near = match self.task.objective {
            Objective::Positions => None,
            Objective::Forces => {
                let near = coordinates(frame, NEAR_EDGE * overhang.length);
                Some(self.rows(unit, &near, &balance, values, &[]))
            }
        };
        let measurements = near.as_ref().map_or(rows.nrows(), |(rows, _)| rows.nrows());
        let (of_pose, mut own) = near.unwrap_or_else(|| (rows.clone(), own));
        let way = |own: &DMatrix<f64>| {
            let (rows, own) = self.weighted(&of_pose, own);
            eliminate(rows, &own, Prior::Flat)
        };
        let mut found = way(&own);
        if state.edge.is_some_and(|edge| overhang.is_pinned(&edge, found.step.as_slice())) {
            own.column_mut(4).fill(0.0);
            found = way(&own);
        }
        let size = found.rows.column(0).norm();
        let rounding = ROUNDING * (measurements as f64).sqrt() * overhang.length / self.scale(replica);
        if found.removed > FOUND * size + rounding && !ends(found.removed, size) {
            state.sensitivity = sensitivity;
            let residual = of_pose.column(0).norm();
            return Some(PoseStep { step: found.step, removed: found.removed, residual });
        }
        let bent = self.task.robust.map(|_| eliminate(of_pose, &own, Prior::Flat));
        let Eliminated { rows: left, by_value, rank, .. } = bent.unwrap_or(found);
        add_own(&mut sensitivity, values, unknowns, &by_value.rows(4, 1).into_owned());
        state.own_sensitivity = by_value;
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
fn predicted(state: &State, replica: &Replica, frame: &ReplicaFrame, change: Option<&DVector<f64>>) -> State {
    let mut next = state.clone();
    let cloth = replica.cloth(frame);
    let unknowns = cloth.unknowns();
    let Some(change) = change.filter(|change| state.sensitivity.len() == change.len() * unknowns) else {
        return next;
    };
    shift(cloth, &state.sensitivity, change.as_slice(), &mut next.x);
    if state.own_sensitivity.ncols() == change.len() {
        let step = &state.own_sensitivity * change;
        match (&mut next.edge, &frame.overhang) {
            (Some(edge), Some(overhang)) => *edge = overhang.pose_after(edge, step.as_slice()),
            _ => next.clips.iter_mut().zip(step.iter()).for_each(|(error, step)| *error += step),
        }
        replica.hold(frame, next.edge.as_ref(), &next.clips, &mut next.x);
    }
    next
}

/// Moves the free coordinates by Σ change · dx.
fn shift(cloth: &Cloth, columns: &[f64], changes: &[f64], x: &mut [f64]) {
    for (column, change) in columns.chunks_exact(cloth.unknowns().max(1)).zip(changes) {
        for &(coordinate, unknown) in cloth.free_coordinates() {
            x[coordinate] += column[unknown] * change;
        }
    }
}

/// Takes a step of the frame's own unknowns: the free nodes follow to first order.
fn take_own_step(replica: &Replica, frame: &ReplicaFrame, step: &DVector<f64>, state: &mut State) {
    let cloth = replica.cloth(frame);
    let changes = match (&frame.overhang, &mut state.edge) {
        (Some(overhang), Some(edge)) => {
            let turned = overhang.pose_after(edge, step.as_slice());
            let change = turned.slope - edge.slope;
            *edge = turned;
            vec![change]
        }
        _ => {
            state.clips.iter_mut().zip(step.iter()).for_each(|(error, step)| *error += step);
            step.as_slice().to_vec()
        }
    };
    let first = state.sensitivity.len() - changes.len() * cloth.unknowns();
    shift(cloth, &state.sensitivity[first..], &changes, &mut state.x);
    replica.hold(frame, state.edge.as_ref(), &state.clips, &mut state.x);
}

/// dx/dk with the frame's own unknowns at their best, from dx/dk and dx/dν, which follows it and is dropped.
///
/// * `by_value` — dν/dk
fn add_own(sensitivity: &mut Vec<f64>, values: usize, unknowns: usize, by_value: &DMatrix<f64>) {
    let by_own = sensitivity.split_off(values * unknowns);
    for (column, slopes) in sensitivity.chunks_exact_mut(unknowns.max(1)).zip(by_value.column_iter()) {
        for (own, slope) in by_own.chunks_exact(unknowns.max(1)).zip(slopes.iter()) {
            column.iter_mut().zip(own).for_each(|(dx, own)| *dx += own * slope);
        }
    }
}

/// Where a frame starts by itself, at the present pose of its edge or clips.
fn own_start(replica: &Replica, frame: &ReplicaFrame, state: &State) -> Vec<f64> {
    match (&frame.overhang, &state.edge) {
        (Some(overhang), Some(edge)) => overhang.start(edge.slope),
        _ => {
            let mut x = frame.start.clone();
            replica.hold(frame, None, &state.clips, &mut x);
            x
        }
    }
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
