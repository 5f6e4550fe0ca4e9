//! All frames of one stage in equilibrium under trial curves: residuals of clip forces, and their sensitivities.
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

use crate::gauss_newton::{Evaluation, Residuals};
use crate::replica::{Replica, ReplicaFrame};
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

/// The equilibrium of one frame at some control values.
#[derive(Debug, Clone)]
struct State {
    x: Vec<f64>,
    /// dx/dk: one column of unknowns a control value; empty before the first solve.
    sensitivity: Vec<f64>,
}

/// A frame's share of an evaluation.
struct FrameResult {
    state: State,
    status: Status,
    /// Simulated force along each measured component, N.
    forces: Vec<f64>,
    /// Its derivatives, component-major.
    derivatives: Vec<f64>,
}

/// A stage's replicas under one unknown curve.
pub struct Simulation<'a> {
    replicas: &'a [Replica],
    solvers: Vec<Mutex<Vec<Solver<'a>>>>,
    component: Component,
    curve: StiffnessCurve,
    known: Curves,
    settings: Settings,
    /// (replica, frame) of every frame in use.
    frames: Vec<(usize, usize)>,
    states: Vec<State>,
    dropped: Vec<DroppedFrame>,
    meter: Arc<Meter>,
}

impl<'a> Simulation<'a> {
    /// Finds the first equilibria, and drops the frames that have none.
    ///
    /// * `curve` — the component's curve to start from; its strains are the control points that are fitted
    /// * `known` — the curves of the other components
    pub fn new(
        replicas: &'a [Replica],
        component: Component,
        curve: StiffnessCurve,
        known: Curves,
        settings: Settings,
        meter: Arc<Meter>,
    ) -> Self {
        let frames: Vec<(usize, usize)> = replicas
            .iter()
            .enumerate()
            .flat_map(|(replica, r)| (0..r.frames.len()).map(move |frame| (replica, frame)))
            .collect();
        let mut simulation = Self {
            replicas,
            solvers: replicas.iter().map(|_| Mutex::new(Vec::new())).collect(),
            component,
            curve,
            known,
            settings,
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

    /// Goes on with other control points; states stay.
    pub fn set_curve(&mut self, curve: StiffnessCurve) {
        self.curve = curve;
        // Sensitivities belong to the old control values.
        self.states.iter_mut().for_each(|state| state.sensitivity.clear());
    }

    /// The curve of the last evaluation.
    pub fn curve(&self) -> &StiffnessCurve {
        &self.curve
    }

    /// Number of measured force components of all frames in use.
    pub fn measurements(&self) -> usize {
        self.frames().map(|(_, frame, _)| frame.forces.len()).sum()
    }

    /// True if the noise of every sequence is known: residuals then are in units of it.
    pub fn noise_is_known(&self) -> bool {
        self.replicas.iter().all(|replica| replica.force_noise.is_some())
    }

    /// What turns residuals into newtons: the noise they are in units of (the mean, if sequences differ), or 1.
    pub fn unit(&self) -> f64 {
        let scales = self.scales();
        scales.iter().sum::<f64>() / scales.len() as f64
    }

    /// The component that is fitted.
    pub fn component(&self) -> Component {
        self.component
    }

    /// What the residuals of each replica are divided by, N.
    fn scales(&self) -> Vec<f64> {
        let known = self.noise_is_known();
        let scale = |replica: &Replica| replica.force_noise.filter(|_| known).unwrap_or(1.0);
        self.replicas.iter().map(scale).collect()
    }

    /// Indices of residuals that follow one another: one force component of one clip through a sequence.
    pub fn tracks(&self) -> Vec<Vec<usize>> {
        let mut tracks: BTreeMap<(usize, usize, usize), Vec<usize>> = BTreeMap::new();
        let mut index = 0;
        for &(replica, frame) in &self.frames {
            let forces = &self.replicas[replica].frames[frame].forces;
            for (place, force) in forces.iter().enumerate() {
                let first = forces.iter().position(|other| other.clip == force.clip).unwrap_or(0);
                tracks.entry((replica, force.clip, place - first)).or_default().push(index);
                index += 1;
            }
        }
        tracks.into_values().collect()
    }

    /// Frames without an equilibrium.
    pub fn dropped(&self) -> &[DroppedFrame] {
        &self.dropped
    }

    /// The frames in use, with their replicas and states.
    pub fn frames(&self) -> impl Iterator<Item = (&'a Replica, &'a ReplicaFrame, &[f64])> {
        let replicas = self.replicas;
        self.frames.iter().zip(&self.states).map(move |(&(replica, frame), state)| {
            (&replicas[replica], &replicas[replica].frames[frame], &state.x[..])
        })
    }

    /// Brings all frames to equilibrium under the curve, and returns the simulated forces along the measured components of
    /// each, N. Frames that have none are dropped.
    pub fn settle(&mut self) -> Vec<Vec<f64>> {
        let results = self.solve_frames(&self.curves(&self.curve), None);
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

    /// The 1st and 99th percentile of the component's strains over all states.
    pub fn visited(&self) -> [f64; 2] {
        let mut strains: Vec<f64> = self
            .frames()
            .flat_map(|(replica, _, x)| replica.cloth.strains(self.component, x))
            .map(|[strain, _]| strain)
            .collect();
        strains.sort_by(f64::total_cmp);
        let percentile = |share: f64| {
            let place = share * strains.len().saturating_sub(1) as f64;
            strains.get(place.round() as usize).copied().unwrap_or(0.0)
        };
        [percentile(0.01), percentile(0.99)]
    }

    fn curves(&self, curve: &StiffnessCurve) -> Curves {
        let mut curves = self.known.clone();
        curves.set(self.component, curve.clone());
        curves
    }

    /// Equilibria of all frames; `change` of the control values since the states were found moves them ahead.
    fn solve_frames(&self, curves: &Curves, change: Option<&DVector<f64>>) -> Vec<FrameResult> {
        self.frames
            .par_iter()
            .zip(&self.states)
            .map(|(&(replica, frame), state)| self.solve_frame(replica, frame, state, curves, change))
            .collect()
    }

    fn solve_frame(
        &self,
        replica: usize,
        frame: usize,
        state: &State,
        curves: &Curves,
        change: Option<&DVector<f64>>,
    ) -> FrameResult {
        let Replica { cloth, frames, .. } = &self.replicas[replica];
        let pool = &self.solvers[replica];
        // A poisoned pool only means that another frame panicked; its solvers hold no state that matters.
        let take = || pool.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).pop();
        let mut solver = take().unwrap_or_else(|| Solver::new(cloth));
        let mut x = state.x.clone();
        if let Some(change) =
            change.filter(|change| state.sensitivity.len() == change.len() * cloth.unknowns())
        {
            for (column, step) in state.sensitivity.chunks_exact(cloth.unknowns().max(1)).zip(change.iter()) {
                for (&coordinate, slope) in cloth.unknown_coordinates().iter().zip(column) {
                    x[coordinate] += slope * step;
                }
            }
        }
        let mut solve = |x: &mut Vec<f64>| {
            let equilibrium = solver.solve(curves, x, &self.settings);
            self.meter.add(&equilibrium);
            equilibrium.status
        };
        let first = x.clone();
        let mut status = solve(&mut x);
        if status != Status::Converged && first != frames[frame].start {
            // A measured shape or a prediction that was too far off: from the blended shape instead.
            x.copy_from_slice(&frames[frame].start);
            status = solve(&mut x);
        }
        let (forces, derivatives, sensitivity) = match status {
            Status::Converged => self.sensitivities(&mut solver, replica, frame, curves, &x),
            // What is no equilibrium has no sensitivities.
            _ => Default::default(),
        };
        pool.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push(solver);
        FrameResult { state: State { x, sensitivity }, status, forces, derivatives }
    }

    /// Simulated force components, their derivatives, and dx/dk.
    fn sensitivities(
        &self,
        solver: &mut Solver<'_>,
        replica: usize,
        frame: usize,
        curves: &Curves,
        x: &[f64],
    ) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let Replica { cloth, frames, .. } = &self.replicas[replica];
        let unknowns = cloth.unknowns();
        let mut columns = Vec::new();
        cloth.parameter_gradient(curves, self.component, x, &mut columns);
        let mut sensitivity: Vec<f64> = columns
            .chunks_exact(x.len())
            .flat_map(|column| cloth.unknown_coordinates().iter().map(|&coordinate| -column[coordinate]))
            .collect();
        solver.solve_linear(&mut sensitivity);
        let direct: Vec<Vec<Vector3<f64>>> =
            columns.chunks_exact(x.len()).map(|column| cloth.clip_forces(column)).collect();
        let border = solver.border();
        let through_shape = |clip: usize, point: usize| -> Vector3<f64> {
            let slopes = &sensitivity[point * unknowns..(point + 1) * unknowns];
            Vector3::from_fn(|i, _| {
                let row = &border[(3 * clip + i) * unknowns..(3 * clip + i + 1) * unknowns];
                row.iter().zip(slopes).map(|(a, b)| a * b).sum()
            })
        };
        let forces = solver.clip_forces();
        let components = &frames[frame].forces;
        let simulated = components.iter().map(|c| forces[c.clip].dot(&c.direction)).collect();
        let derivatives = components
            .iter()
            .flat_map(|c| {
                (0..direct.len())
                    .map(|point| (direct[point][c.clip] + through_shape(c.clip, point)).dot(&c.direction))
                    .collect::<Vec<_>>()
            })
            .collect();
        (simulated, derivatives, sensitivity)
    }
}

impl Residuals for Simulation<'_> {
    type Error = Infallible;

    /// Residuals of all measured force components, frame by frame, in units of the noise where that is known, else N.
    fn evaluate(&mut self, point: &DVector<f64>, _jacobian: bool) -> Result<Evaluation, Infallible> {
        let failed = |reason: String| Ok(Evaluation::Failed { reason });
        let curve = match self.curve.with_stiffnesses(point.iter().copied().collect()) {
            Ok(curve) => curve,
            Err(error) => return failed(error.to_string()),
        };
        let change = point - DVector::from_column_slice(self.curve.stiffnesses());
        let results = self.solve_frames(&self.curves(&curve), Some(&change));
        if let Some(index) = results.iter().position(|result| result.status != Status::Converged) {
            let (replica, frame) = self.frames[index];
            let replica = &self.replicas[replica];
            return failed(format!(
                "no equilibrium of {} frame {}: {}",
                replica.name, replica.frames[frame].index, results[index].status
            ));
        }
        let points = point.len();
        let scales = self.scales();
        let (mut residual, mut derivatives) = (Vec::new(), Vec::new());
        for (&(replica, frame), result) in self.frames.iter().zip(&results) {
            let measured = &self.replicas[replica].frames[frame].forces;
            let scale = scales[replica];
            residual.extend(
                measured.iter().zip(&result.forces).map(|(m, simulated)| (m.force - simulated) / scale),
            );
            derivatives.extend(result.derivatives.iter().map(|derivative| derivative / scale));
        }
        let rows = residual.len();
        self.states = results.into_iter().map(|result| result.state).collect();
        self.curve = curve;
        Ok(Evaluation::Values {
            residual: DVector::from_vec(residual),
            jacobian: Some(DMatrix::from_row_slice(rows, points, &derivatives)),
        })
    }
}

/// The blended shape or, where it is nearer to balance, the measured one with the clips in place.
fn start_state(replica: &Replica, frame: &ReplicaFrame, curves: &Curves) -> State {
    let cloth = &replica.cloth;
    let blended = frame.start.clone();
    let Some(observed) = frame.observed.as_ref().filter(|x| x.iter().all(|c| c.is_finite())) else {
        return State { x: blended, sensitivity: Vec::new() };
    };
    let mut measured = blended.clone();
    cloth.unknown_coordinates().iter().for_each(|&c| measured[c] = observed[c]);
    let imbalance = |x: &[f64]| {
        let mut gradient = vec![0.0; x.len()];
        cloth.gradient(curves, x, &mut gradient, &mut cloth_sim::cloth::ForceScale::new(cloth.nodes()));
        cloth.unknown_coordinates().iter().map(|&c| gradient[c] * gradient[c]).sum::<f64>()
    };
    let x = if imbalance(&measured) < imbalance(&blended) { measured } else { blended };
    State { x, sensitivity: Vec::new() }
}
