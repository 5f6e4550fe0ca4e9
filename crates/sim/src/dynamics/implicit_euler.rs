//! Implicit Euler.
//!
//! ```text
//! M (v₁ − v₀)/h = −∇E(x₁) − C(x₀) v₁ + B(x₀) (w − v₁)      x₁ = x₀ + h v₁
//! ```
//!
//! The solution minimises the incremental potential: see [`Increment`].

use super::energy::Work;
use super::settings::{LinearSolver, Newton, Settings};
use super::state::State;
use super::step::{Status, Step};
use crate::cloth::Cloth;
use crate::element::HessianKind;
use crate::equilibrium::{self, Solver, Tolerance};
use crate::increment::Increment;
use crate::linear::Linear;
use crate::linear::cholesky::Factor;
use crate::linear::conjugate_gradient::ConjugateGradient;
use crate::material::Curves;
use nalgebra::{Matrix3, Vector3};

/// Maximum number of Newton steps in a time step.
const MAX_ITERATIONS: usize = 100;

pub(super) struct ImplicitEuler<'a> {
    solver: Solver<'a>,
    /// Terms of the step, while the solver does not own them.
    increment: Increment,
    newton: Newton,
    /// Mass of every unknown, kg.
    masses: Vec<f64>,
    predicted: Vec<f64>,
    /// B at every node.
    drag: Vec<Matrix3<f64>>,
    values: Vec<f64>,
    /// Scratch space, one entry per coordinate.
    coordinates: Vec<f64>,
    /// Scratch space, one entry per unknown.
    unknowns: Vec<f64>,
}

impl<'a> ImplicitEuler<'a> {
    pub(super) fn new(cloth: &'a Cloth, newton: Newton, linear: LinearSolver) -> Self {
        let linear = match linear {
            LinearSolver::Direct => Linear::Direct(Factor::new(cloth.pattern())),
            LinearSolver::ConjugateGradient { tolerance, max_iterations } => {
                Linear::Iterative(ConjugateGradient::new(cloth.pattern(), tolerance, max_iterations))
            }
        };
        Self {
            solver: Solver::with(cloth, linear),
            increment: Increment::new(cloth),
            newton,
            masses: cloth.unknown_masses(),
            predicted: vec![0.0; 3 * cloth.points()],
            drag: Vec::new(),
            values: Vec::new(),
            coordinates: vec![0.0; 3 * cloth.points()],
            unknowns: vec![0.0; cloth.unknowns()],
        }
    }

    pub(super) fn step(
        &mut self,
        cloth: &Cloth,
        curves: &Curves,
        settings: &Settings,
        time: f64,
        state: &mut State,
    ) -> (Step, Work) {
        let h = settings.step;
        let air = settings.wind.map(|wind| wind.at(time + h));
        self.prepare(cloth, curves, settings, air, state);
        let linear_before = self.solver.linear_iterations();
        for ((to, x), v) in self.predicted.iter_mut().zip(&state.positions).zip(&state.velocities) {
            *to = x + h * v;
        }
        self.solver.increment = Some(std::mem::take(&mut self.increment));
        let mut step = self.solve(curves, state);
        step.linear_iterations = self.solver.linear_iterations() - linear_before;
        self.increment = self.solver.increment.take().unwrap_or_default();
        for ((v, x), before) in state.velocities.iter_mut().zip(&state.positions).zip(&self.increment.origin)
        {
            *v = (x - before) / h;
        }
        let work = self.work(cloth, settings, air, state);
        (step, work)
    }

    /// Prepares the terms of a step from a state.
    fn prepare(
        &mut self,
        cloth: &Cloth,
        curves: &Curves,
        settings: &Settings,
        air: Option<Vector3<f64>>,
        state: &State,
    ) {
        let (h, alpha, beta) = (settings.step, settings.damping.mass, settings.damping.stiffness);
        let increment = &mut self.increment;
        increment.origin.copy_from_slice(&state.positions);
        increment.matrix.clear();
        for (unknown, &coordinate) in cloth.unknown_coordinates().iter().enumerate() {
            let mass = self.masses[unknown];
            increment.diagonal[unknown] = mass / (h * h) + alpha * mass / h;
            increment.push[unknown] = mass * state.velocities[coordinate] / h;
        }
        if beta > 0.0 {
            cloth.hessian(curves, &state.positions, HessianKind::Material, &mut self.values);
            increment.matrix.extend(self.values[..cloth.entries()].iter().map(|value| value * beta / h));
        }
        if let (Some(wind), Some(air)) = (settings.wind, air) {
            wind.drag(cloth, state, air, &mut self.drag);
            increment.matrix.resize(cloth.entries(), 0.0);
            cloth.add_blocks(&self.drag, 1.0 / h, &mut increment.matrix);
            cloth.filter(&mut increment.matrix);
            for (force, drag) in self.coordinates.chunks_exact_mut(3).zip(&self.drag) {
                force.copy_from_slice((drag * air).as_slice());
            }
            cloth.collect(&self.coordinates, &mut self.unknowns);
            increment.push.iter_mut().zip(&self.unknowns).for_each(|(push, force)| *push += force);
        }
    }

    fn solve(&mut self, curves: &Curves, state: &mut State) -> Step {
        match self.newton {
            Newton::Converged { tolerance } => {
                let settings = equilibrium::Settings {
                    tolerance: Tolerance::Relative(tolerance),
                    max_iterations: MAX_ITERATIONS,
                    escape: false,
                    ..Default::default()
                };
                let found = self.solver.time_step(curves, &mut state.positions, &self.predicted, &settings);
                let status = match found.status {
                    equilibrium::Status::Converged | equilibrium::Status::Unstable => Status::Done,
                    equilibrium::Status::IterationLimit
                    | equilibrium::Status::Stalled
                    | equilibrium::Status::NotParallel => Status::NotConverged,
                    equilibrium::Status::NotFinite => Status::NotFinite,
                };
                Step {
                    status,
                    newton_iterations: found.iterations,
                    linear_iterations: 0,
                    factorisations: found.factorisations,
                    imbalance: found.imbalance,
                    remedies: found.remedies,
                }
            }
            Newton::Single => {
                let before = self.solver.factorisations();
                let solved = self.solver.linearised_step(curves, &mut state.positions);
                Step {
                    status: if solved.is_some() { Status::Done } else { Status::NotFinite },
                    newton_iterations: 1,
                    linear_iterations: 0,
                    factorisations: self.solver.factorisations() - before,
                    imbalance: 0.0,
                    remedies: solved.unwrap_or_default(),
                }
            }
        }
    }

    /// Work in a step: damping takes h vᵀCv, the air does h vᵀB(w − v).
    fn work(&mut self, cloth: &Cloth, settings: &Settings, air: Option<Vector3<f64>>, state: &State) -> Work {
        let h = settings.step;
        let mut work = Work::default();
        if !self.increment.matrix.is_empty() {
            work.damping = h * h * self.increment.quadratic(cloth, &state.velocities);
        }
        if let Some(air) = air {
            for (v, drag) in state.velocities.chunks_exact(3).zip(&self.drag) {
                let v = Vector3::from_column_slice(v);
                // The matrix contains the drag, which is not damping.
                work.damping -= h * v.dot(&(drag * v));
                work.wind += h * v.dot(&(drag * (air - v)));
            }
        }
        if settings.damping.mass > 0.0 {
            let squares = self.masses.iter().zip(cloth.unknown_coordinates());
            let squares = squares.map(|(mass, &coordinate)| mass * state.velocities[coordinate].powi(2));
            work.damping += h * settings.damping.mass * squares.sum::<f64>();
        }
        work
    }
}
