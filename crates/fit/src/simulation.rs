//! All frames of one stage in equilibrium under trial curves: residuals of clip forces or of positions, and their
//! sensitivities.
//!
//! ```text
//! equilibrium      g(x, k) = 0 at the free nodes                       g = ∇E
//! clip force       F_c = Σ g over the clip's nodes
//! sensitivity      dx/dk = −K⁻¹ ∂g/∂k        dF_c/dk = ∂F_c/∂k + (∂F_c/∂x) dx/dk
//! ```
//!
//! K is the true stiffness matrix at the equilibrium, whose factorisation the equilibrium leaves behind; all control
//! points are solved for at once. Frames are independent: they run in parallel and are collected in order.
//!
//! Source: Miguel et al. 2012, eqs. 7–9; without the μI that they keep in K (docs/model.md).

use crate::boundary::Whitening;
use crate::gauss_newton::{Evaluation, Residuals};
use crate::replica::{Replica, ReplicaFrame};
use crate::robust::Robust;
use cloth_sim::cloth::Cloth;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::equilibrium::{Equilibrium, Settings, Solver, Status};
use cloth_sim::material::{Component, Curves};
use nalgebra::{DMatrix, DVector, Vector3};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

/// What the solves of a stage have cost.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    /// Equilibria sought.
    pub equilibria: usize,
    /// Newton steps.
    pub iterations: usize,
    /// Factorisations.
    pub factorisations: usize,
}

impl Counters {
    /// What was spent since an earlier reading.
    pub fn since(&self, earlier: &Self) -> Self {
        Self {
            equilibria: self.equilibria - earlier.equilibria,
            iterations: self.iterations - earlier.iterations,
            factorisations: self.factorisations - earlier.factorisations,
        }
    }
}

/// Counts the cost of a stage while it runs; other threads may read it.
#[derive(Debug, Default)]
pub struct Meter {
    equilibria: AtomicUsize,
    iterations: AtomicUsize,
    factorisations: AtomicUsize,
}

impl Meter {
    /// What was spent so far.
    pub fn read(&self) -> Counters {
        Counters {
            equilibria: self.equilibria.load(Ordering::Relaxed),
            iterations: self.iterations.load(Ordering::Relaxed),
            factorisations: self.factorisations.load(Ordering::Relaxed),
        }
    }

    fn add(&self, equilibrium: &Equilibrium) {
        self.equilibria.fetch_add(1, Ordering::Relaxed);
        self.iterations.fetch_add(equilibrium.iterations, Ordering::Relaxed);
        self.factorisations.fetch_add(equilibrium.factorisations, Ordering::Relaxed);
    }
}

/// A frame that takes no part because its equilibrium was not found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DroppedFrame {
    /// Name of the sequence.
    pub sequence: String,
    /// Index of the frame in it.
    pub frame: usize,
    /// How the solve ended.
    pub status: Status,
}

/// What a stage compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objective {
    /// The measured components of clip forces, N.
    Forces,
    /// The places of the free nodes that were seen, m.
    Positions,
}

/// The equilibrium of one frame at some control values.
#[derive(Debug, Clone, Default)]
struct State {
    x: Vec<f64>,
    /// dx/dk: one column of unknowns a control value; empty before the first solve.
    sensitivity: Vec<f64>,
    /// An unstable equilibrium was met and left: others may exist.
    escaped: bool,
    /// How errors of what is held enter; taken anew by [`Simulation::set_curve`] and else kept, so that what is minimised
    /// is one function.
    whitening: Option<Whitening>,
}

/// A frame's share of an evaluation.
struct FrameResult {
    state: State,
    status: Status,
    /// Simulated force along each measured component, N.
    forces: Vec<f64>,
    /// What is compared, as simulated.
    simulated: Vec<f64>,
    /// Its derivatives, row by row.
    derivatives: Vec<f64>,
}

/// One frame of a simulation, for those who read it.
#[derive(Debug, Clone, Copy)]
pub struct Settled<'s> {
    /// The sequence's replica.
    pub replica: &'s Replica,
    /// The frame.
    pub frame: &'s ReplicaFrame,
    /// Its equilibrium, 3 stacked coordinates a node, m.
    pub x: &'s [f64],
    /// An unstable equilibrium was met and left on the way: the frame may have several.
    pub multi_stable: bool,
}

/// What is simulated, and how.
#[derive(Debug, Clone)]
pub struct Task {
    /// The components that share the fitted curve.
    pub fitted: Vec<Component>,
    /// What is compared.
    pub objective: Objective,
    /// The curves of the other components.
    pub known: Curves,
    /// How equilibria are found.
    pub settings: Settings,
    /// How far a residual counts in full.
    pub robust: Option<Robust>,
}

type SolverPool<'a> = Mutex<Vec<Solver<'a>>>;

/// A stage's replicas under one unknown curve.
pub struct Simulation<'a> {
    replicas: &'a [Replica],
    /// Per replica, per cloth.
    solvers: Vec<Vec<SolverPool<'a>>>,
    task: Task,
    curve: StiffnessCurve,
    /// (replica, frame) of every frame in use.
    frames: Vec<(usize, usize)>,
    states: Vec<State>,
    dropped: Vec<DroppedFrame>,
    meter: Arc<Meter>,
}

impl<'a> Simulation<'a> {
    /// Finds the first equilibria, and drops the frames that have none.
    ///
    /// * `curve` — the curve to start from; its strains are the control points that are fitted
    pub fn new(replicas: &'a [Replica], task: Task, curve: StiffnessCurve, meter: Arc<Meter>) -> Self {
        let frames: Vec<(usize, usize)> = replicas
            .iter()
            .enumerate()
            .flat_map(|(replica, r)| (0..r.frames.len()).map(move |frame| (replica, frame)))
            .collect();
        let pools = |replica: &Replica| replica.cloths.iter().map(|_| Mutex::default()).collect();
        let mut simulation = Self {
            replicas,
            solvers: replicas.iter().map(pools).collect(),
            task,
            curve,
            states: Vec::new(),
            frames,
            dropped: Vec::new(),
            meter,
        };
        let curves = simulation.curves(&simulation.curve);
        simulation.states = simulation
            .frames
            .par_iter()
            .map(|&(replica, frame)| {
                start_state(&replicas[replica], &replicas[replica].frames[frame], &curves)
            })
            .collect();
        simulation.settle();
        simulation
    }

    /// Lets residuals above so many times the noise count less; where the noise is not known, above so many times the
    /// typical residual under the curve as it is (its median, as a standard deviation).
    pub fn make_robust(&mut self, limit: f64) {
        let unit = if self.noise_is_known() { 1.0 } else { self.typical_residual() };
        self.task.robust = (unit > 0.0).then_some(Robust { limit: limit * unit });
    }

    fn typical_residual(&self) -> f64 {
        let results = self.solve_frames(&self.curves(&self.curve), &[], None);
        let mut sizes: Vec<f64> = Vec::new();
        for (&(replica, frame), result) in self.frames.iter().zip(&results) {
            let replica = &self.replicas[replica];
            let rows = self.residual_rows(replica, &replica.frames[frame], result, 0);
            sizes.extend(rows.iter().map(|residual| residual.abs()));
        }
        sizes.sort_by(f64::total_cmp);
        sizes.get(sizes.len() / 2).map_or(0.0, |median| 1.4826 * median)
    }

    /// Goes on with other control points; states stay.
    pub fn set_curve(&mut self, curve: StiffnessCurve) {
        self.curve = curve;
        // Sensitivities belong to the old control values.
        self.states.iter_mut().for_each(|state| state.sensitivity.clear());
        self.states.iter_mut().for_each(|state| state.whitening = None);
    }

    /// True if errors of what is held enter the residuals.
    pub fn is_whitened(&self) -> bool {
        self.states.iter().any(|state| state.whitening.is_some())
    }

    /// The curve of the last evaluation.
    pub fn curve(&self) -> &StiffnessCurve {
        &self.curve
    }

    /// Number of measurements that are compared, over all frames in use.
    pub fn measurements(&self) -> usize {
        self.settled().map(|s| self.scales(s.replica, s.frame).count()).sum()
    }

    /// True if the noise of every sequence is known: residuals then are in units of it.
    pub fn noise_is_known(&self) -> bool {
        self.replicas.iter().all(|replica| self.noise(replica).is_some())
    }

    /// What turns residuals into newtons or metres: the noise they are in units of (the mean, if sequences differ), or 1.
    pub fn unit(&self) -> f64 {
        let scales = self.replicas.iter().map(|replica| self.scale(replica));
        scales.sum::<f64>() / self.replicas.len() as f64
    }

    /// What is simulated, and how.
    pub fn task(&self) -> &Task {
        &self.task
    }

    fn noise(&self, replica: &Replica) -> Option<f64> {
        match self.task.objective {
            Objective::Forces => replica.force_noise,
            Objective::Positions => replica.position_noise,
        }
    }

    /// What the residuals of a replica are divided by.
    fn scale(&self, replica: &Replica) -> f64 {
        self.noise(replica).filter(|_| self.noise_is_known()).unwrap_or(1.0)
    }

    /// What each measurement of a frame is divided by.
    fn scales<'s>(&'s self, replica: &'s Replica, frame: &'s ReplicaFrame) -> impl Iterator<Item = f64> + 's {
        let scale = self.scale(replica);
        let forces = frame.forces.iter().map(|_| 1.0);
        let positions = seen_unknowns(replica, frame).map(|(_, coordinate)| replica.spread[coordinate / 3]);
        let by_forces = self.task.objective == Objective::Forces;
        forces
            .filter(move |_| by_forces)
            .chain(positions.filter(move |_| !by_forces))
            .map(move |share| share * scale)
    }

    /// Indices of residuals that follow one another: one force component of one clip through a sequence, or one coordinate
    /// of one node.
    pub fn tracks(&self) -> Vec<Vec<usize>> {
        let mut tracks: BTreeMap<(usize, usize, usize), Vec<usize>> = BTreeMap::new();
        let mut index = 0;
        for &(replica, frame) in &self.frames {
            let frame = &self.replicas[replica].frames[frame];
            let forces = &frame.forces;
            match self.task.objective {
                Objective::Forces => {
                    for (place, force) in forces.iter().enumerate() {
                        let first = forces.iter().position(|other| other.clip == force.clip).unwrap_or(0);
                        tracks.entry((replica, force.clip, place - first)).or_default().push(index);
                        index += 1;
                    }
                }
                Objective::Positions => {
                    for (_, coordinate) in seen_unknowns(&self.replicas[replica], frame) {
                        tracks.entry((replica, coordinate / 3, coordinate % 3)).or_default().push(index);
                        index += 1;
                    }
                }
            }
        }
        tracks.into_values().collect()
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
            multi_stable: state.escaped,
        })
    }

    /// Brings all frames to equilibrium under the curve, and returns the simulated forces along the measured components of
    /// each, N. Frames that have none are dropped.
    pub fn settle(&mut self) -> Vec<Vec<f64>> {
        let results = self.solve_frames(&self.curves(&self.curve), &[], None);
        let mut forces = Vec::new();
        self.states.clear();
        for ((replica, frame), result) in std::mem::take(&mut self.frames).into_iter().zip(results) {
            if result.status == Status::Converged {
                self.frames.push((replica, frame));
                self.states.push(result.state);
                forces.push(result.forces);
            } else {
                let Replica { name, frames, .. } = &self.replicas[replica];
                let (sequence, frame) = (name.clone(), frames[frame].index);
                self.dropped.push(DroppedFrame { sequence, frame, status: result.status });
            }
        }
        forces
    }

    /// The derivative of everything that is compared with respect to the control values of other curves, in the order of
    /// their groups; rows and units as those of an evaluation.
    ///
    /// * `groups` — components that share a curve, a group each
    pub fn sensitivity_to(&self, groups: &[Vec<Component>]) -> DMatrix<f64> {
        let curves = self.curves(&self.curve);
        let results = self.solve_frames(&curves, groups, None);
        let columns: usize =
            groups.iter().map(|group| curves.get(group[0]).map_or(0, StiffnessCurve::len)).sum();
        let mut values = Vec::new();
        for (&(replica, frame), result) in self.frames.iter().zip(&results) {
            let replica = &self.replicas[replica];
            let rows = self.residual_rows(replica, &replica.frames[frame], result, columns);
            values.extend(rows.columns(1, columns).transpose().iter());
        }
        DMatrix::from_row_slice(values.len() / columns.max(1), columns, &values)
    }

    /// The 1st and 99th percentile of the fitted components' strains over all states; of their size where the curve is odd
    /// and bends either way alike.
    pub fn visited(&self) -> [f64; 2] {
        let bends = self.task.fitted.iter().any(|component| component.is_bending());
        let mut strains: Vec<f64> = self
            .settled()
            .flat_map(|s| {
                self.task.fitted.iter().flat_map(move |&c| s.replica.cloth(s.frame).strains(c, s.x))
            })
            .map(|[strain, _]| if bends { strain.abs() } else { strain })
            .collect();
        strains.sort_by(f64::total_cmp);
        let percentile = |share: f64| {
            let place = share * strains.len().saturating_sub(1) as f64;
            strains.get(place.round() as usize).copied().unwrap_or(0.0)
        };
        [if bends { 0.0 } else { percentile(0.01) }, percentile(0.99)]
    }

    /// The largest strain that control points should reach.
    pub fn reach(&self) -> f64 {
        let [low, high] = self.visited();
        let odd = self.task.fitted.iter().all(|component| !component.is_stretch());
        (if odd { high.max(-low) } else { high }).max(f64::MIN_POSITIVE)
    }

    fn curves(&self, curve: &StiffnessCurve) -> Curves {
        let mut curves = self.task.known.clone();
        self.task.fitted.iter().for_each(|&component| curves.set(component, curve.clone()));
        curves
    }

    /// Equilibria of all frames; `change` of the control values since the states were found moves them ahead.
    ///
    /// * `groups` — derivatives are taken with respect to their curves
    fn solve_frames(
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
        let mut x = predicted(state, cloth, change);
        let settings = &self.task.settings;
        let mut found = solver.solve(curves, &mut x, settings);
        self.meter.add(&found);
        let mut escaped = found.escaped;
        if !found.converged() {
            // A measured shape or a prediction that was too far off: from the replica's own start instead.
            x.copy_from_slice(&frame.start);
            found = solver.solve(curves, &mut x, settings);
            self.meter.add(&found);
            escaped = found.escaped;
        }
        if !found.converged() && !replica.is_on_table() {
            // In load steps, from the flat sheet.
            x = replica.rest();
            found = solver.drive(curves, &mut x, &frame.start, settings);
            self.meter.add(&found);
            escaped = found.escaped;
        }
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
        // What is no equilibrium has no sensitivities.
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
        match self.task.objective {
            Objective::Forces => {
                result.simulated = result.forces.clone();
                result.derivatives = force_derivatives(solver, cloth, frame, &columns, &sensitivity);
            }
            Objective::Positions => {
                result.simulated = seen_unknowns(replica, frame).map(|(_, c)| x[c]).collect();
                let seen = seen_unknowns(replica, frame).map(|(unknown, _)| unknown);
                let row = |unknown| (0..columns.len()).map(move |k| k * unknowns + unknown);
                result.derivatives = seen.flat_map(row).map(|place| sensitivity[place]).collect();
                if result.state.whitening.is_none() && replica.held_spread > 0.0 {
                    result.state.whitening = Some(whitening(solver, replica, frame));
                }
            }
        }
        result.state.sensitivity = sensitivity;
    }
}

impl Simulation<'_> {
    /// A frame's residuals, and in further columns their derivatives, all in units of independent noise.
    fn residual_rows(
        &self,
        replica: &Replica,
        frame: &ReplicaFrame,
        result: &FrameResult,
        points: usize,
    ) -> DMatrix<f64> {
        let scales: Vec<f64> = self.scales(replica, frame).collect();
        let mut rows = DMatrix::zeros(scales.len(), points + 1);
        let measured = measured(replica, frame, self.task.objective);
        for (i, ((measured, simulated), scale)) in measured.zip(&result.simulated).zip(&scales).enumerate() {
            rows[(i, 0)] = (measured - simulated) / scale;
            (0..points).for_each(|k| rows[(i, k + 1)] = result.derivatives[i * points + k] / scale);
        }
        if let Some(whitening) = &result.state.whitening {
            whitening.apply(&mut rows);
        }
        rows
    }
}

/// How the places of the last held lines enter the positions that are compared.
fn whitening(solver: &mut Solver<'_>, replica: &Replica, frame: &ReplicaFrame) -> Whitening {
    let unknowns = replica.cloth(frame).unknowns();
    let mut modes: Vec<f64> = solver.border().iter().map(|k| -k).collect();
    solver.solve_linear(&mut modes);
    let seen: Vec<(usize, usize)> = seen_unknowns(replica, frame).collect();
    let columns = modes.len() / unknowns.max(1);
    Whitening::new(DMatrix::from_fn(seen.len(), columns, |i, j| {
        let (unknown, coordinate) = seen[i];
        modes[j * unknowns + unknown] * replica.held_spread / replica.spread[coordinate / 3]
    }))
}

impl Residuals for Simulation<'_> {
    type Error = Infallible;

    /// Residuals of all measurements, frame by frame, in units of the noise where that is known, else N or m.
    fn evaluate(&mut self, point: &DVector<f64>, _jacobian: bool) -> Result<Evaluation, Infallible> {
        let failed = |reason: String| Ok(Evaluation::Failed { reason });
        let curve = match self.curve.with_stiffnesses(point.iter().copied().collect()) {
            Ok(curve) => curve,
            Err(error) => return failed(error.to_string()),
        };
        let change = point - DVector::from_column_slice(self.curve.stiffnesses());
        let groups = [self.task.fitted.clone()];
        let results = self.solve_frames(&self.curves(&curve), &groups, Some(&change));
        if let Some(index) = results.iter().position(|result| result.status != Status::Converged) {
            let (replica, frame) = self.frames[index];
            let replica = &self.replicas[replica];
            return failed(format!(
                "no equilibrium of {} frame {}: {}",
                replica.name, replica.frames[frame].index, results[index].status
            ));
        }
        let (mut residual, mut derivatives) = (Vec::new(), Vec::new());
        for (&(replica, frame), result) in self.frames.iter().zip(&results) {
            let replica = &self.replicas[replica];
            let rows = self.residual_rows(replica, &replica.frames[frame], result, point.len());
            for row in rows.row_iter() {
                let (value, slope) = self.task.robust.map_or((row[0], 1.0), |robust| robust.bend(row[0]));
                residual.push(value);
                derivatives.extend(row.iter().skip(1).map(|d| d * slope));
            }
        }
        let rows = residual.len();
        self.states = results.into_iter().map(|result| result.state).collect();
        self.curve = curve;
        Ok(Evaluation::Values {
            residual: DVector::from_vec(residual),
            jacobian: Some(DMatrix::from_row_slice(rows, point.len(), &derivatives)),
        })
    }
}

/// The free coordinates of a frame that were seen: their unknown, and their index.
fn seen_unknowns<'r>(
    replica: &'r Replica,
    frame: &'r ReplicaFrame,
) -> impl Iterator<Item = (usize, usize)> + 'r {
    let free = replica.cloth(frame).free_coordinates();
    frame.observed.iter().flat_map(move |observed| {
        let seen = free.iter().filter(|(coordinate, _)| observed[*coordinate].is_finite());
        seen.map(|&(coordinate, unknown)| (unknown, coordinate))
    })
}

/// What was measured of what is compared.
fn measured<'r>(
    replica: &'r Replica,
    frame: &'r ReplicaFrame,
    objective: Objective,
) -> Box<dyn Iterator<Item = f64> + 'r> {
    match objective {
        Objective::Forces => Box::new(frame.forces.iter().map(|component| component.force)),
        Objective::Positions => Box::new(
            seen_unknowns(replica, frame)
                .filter_map(|(_, coordinate)| frame.observed.as_ref().map(|observed| observed[coordinate])),
        ),
    }
}

/// A state, moved ahead by a change of the control values.
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

/// ∂g/∂k for every control value of every group, N per unit of stiffness, 3 a node.
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

/// Derivatives of the measured force components, component by component: direct, and through the shape.
fn force_derivatives(
    solver: &Solver<'_>,
    cloth: &Cloth,
    frame: &ReplicaFrame,
    columns: &[Vec<f64>],
    sensitivity: &[f64],
) -> Vec<f64> {
    let unknowns = cloth.unknowns();
    let border = solver.border();
    let slopes: Vec<Vec<Vector3<f64>>> = columns
        .iter()
        .zip(sensitivity.chunks_exact(unknowns.max(1)))
        .map(|(column, dx)| {
            let through_shape = |row: usize| -> f64 {
                border[row * unknowns..(row + 1) * unknowns].iter().zip(dx).map(|(a, b)| a * b).sum()
            };
            let direct = cloth.clip_forces(column).into_iter().enumerate();
            direct
                .map(|(group, direct)| direct + Vector3::from_fn(|i, _| through_shape(3 * group + i)))
                .collect()
        })
        .collect();
    frame.forces.iter().flat_map(|component| slopes.iter().map(|groups| component.of(groups))).collect()
}

/// Where the first solve starts: at the measured shape where that leaves the plane, else at the replica's own start or,
/// where it is nearer to balance, at the measured shape.
fn start_state(replica: &Replica, frame: &ReplicaFrame, curves: &Curves) -> State {
    let cloth = replica.cloth(frame);
    let own = frame.start.clone();
    let Some(observed) = frame.observed.as_ref().filter(|x| x.iter().all(|c| c.is_finite())) else {
        return State { x: own, ..State::default() };
    };
    let mut measured = own.clone();
    cloth.free_coordinates().iter().for_each(|&(c, _)| measured[c] = observed[c]);
    let imbalance = |x: &[f64]| {
        let mut gradient = vec![0.0; x.len()];
        cloth.gradient(curves, x, &mut gradient, &mut cloth_sim::cloth::ForceScale::new(cloth.nodes()));
        cloth.free_coordinates().iter().map(|&(c, _)| gradient[c] * gradient[c]).sum::<f64>()
    };
    let x = if replica.is_on_table() {
        own
    } else if replica.is_buckled(frame) || imbalance(&measured) < imbalance(&own) {
        measured
    } else {
        own
    };
    State { x, ..State::default() }
}
