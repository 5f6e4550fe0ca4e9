//! Cloth in motion: implicit Euler or Runge–Kutta time steps, with a balance of energy and work.
//!
//! ```text
//! M ẍ = −∇E(x) − C(x) ẋ + B (w − ẋ)        M lumped masses, C damping, B drag of the air, w the wind
//! ```
//!
//! An implicit step is solved to a tolerance, or linearised once as published, by factorisation or conjugate gradients.
//! Held nodes keep their positions, guided nodes their directions.
//!
//! ```text
//! kinetic + elastic + weight  =  their sum at the start + work of the wind − damping − numerical loss
//! ```
//!
//! Source: Baraff and Witkin 1998; Strohkorb 2019, §3.3. The damping law is specific to this project: see [`Damping`].

mod damping;
mod energy;
mod implicit_euler;
mod runge_kutta;
mod settings;
mod state;
mod step;
mod wind;

pub use damping::Damping;
pub use energy::Energies;
pub use runge_kutta::stable_step;
pub use settings::{Integrator, LinearSolver, Newton, Settings};
pub use step::{Status, Step};
pub use wind::Wind;

use crate::cloth::Cloth;
use crate::error::{Error, Result};
use crate::material::Curves;
use energy::Work;
use implicit_euler::ImplicitEuler;
use runge_kutta::RungeKutta;
use state::State;

/// Energy gain, as a share, that marks an integrator as unstable.
const MADE: f64 = 0.1;

/// State of an integrator.
enum Method<'a> {
    Implicit(Box<ImplicitEuler<'a>>),
    Explicit(Box<RungeKutta>),
}

/// A cloth in motion.
pub struct Motion<'a> {
    cloth: &'a Cloth,
    curves: &'a Curves,
    settings: Settings,
    method: Method<'a>,
    state: State,
    /// State before the last step.
    before: State,
    /// Total energy at the start, J.
    start: f64,
    steps: usize,
    energies: Energies,
}

impl<'a> Motion<'a> {
    /// Starts from rest at a state.
    ///
    /// * `positions` — a state ([`Cloth::state`]), m; held nodes at their fixed positions
    ///
    /// # Errors
    /// A setting or a position that is not finite or out of range; cloth without mass; a Runge–Kutta step beyond
    /// [`stable_step`], which the error reports; Runge–Kutta for a sheet whose edges rotate.
    pub fn new(
        cloth: &'a Cloth,
        curves: &'a Curves,
        positions: Vec<f64>,
        settings: &Settings,
    ) -> Result<Self> {
        let velocities = vec![0.0; positions.len()];
        Self::with_velocities(cloth, curves, positions, velocities, settings)
    }

    /// Starts with velocities.
    ///
    /// * `velocities` — 3 per point, m/s; ignored for held nodes, and across the free directions of guided ones
    ///
    /// # Errors
    /// Those of [`Motion::new`].
    pub fn with_velocities(
        cloth: &'a Cloth,
        curves: &'a Curves,
        positions: Vec<f64>,
        velocities: Vec<f64>,
        settings: &Settings,
    ) -> Result<Self> {
        settings.check()?;
        for (what, values) in [("positions", &positions), ("velocities", &velocities)] {
            if values.len() != 3 * cloth.points() {
                return Err(Error::ShapeMismatch { what, expected: 3 * cloth.points(), found: values.len() });
            }
            if let Some(index) = values.iter().position(|value| !value.is_finite()) {
                return Err(Error::NotFinite { what, vertex: index / 3 });
            }
        }
        if let Some(&mass) = cloth.masses().iter().find(|&&mass| !(mass > 0.0)) {
            let expected = "more than 0, in kg/m²: motion needs mass";
            return Err(Error::InvalidValue { field: "areal_density", value: mass, expected });
        }
        let mut free = vec![0.0; cloth.unknowns()];
        let mut state = State { velocities: vec![0.0; positions.len()], positions };
        // Tied nodes take the velocity of the first one.
        for (value, &coordinate) in free.iter_mut().zip(cloth.unknown_coordinates()) {
            *value = velocities[coordinate];
        }
        cloth.project(&mut free);
        cloth.spread(&free, &mut state.velocities);
        let method = match settings.integrator {
            Integrator::ImplicitEuler { newton, linear } => {
                Method::Implicit(Box::new(ImplicitEuler::new(cloth, newton, linear)))
            }
            Integrator::RungeKutta if cloth.points() > cloth.nodes() => {
                let expected = "implicit-euler, as edges of a sheet rotate without mass";
                return Err(Error::InvalidValue { field: "runge_kutta", value: settings.step, expected });
            }
            Integrator::RungeKutta => {
                let limit = stable_step(cloth, curves, &state.positions, &settings.damping);
                if settings.step > limit {
                    return Err(Error::UnstableStep { step: settings.step, limit });
                }
                Method::Explicit(Box::new(RungeKutta::new(cloth)))
            }
        };
        let before = state.clone();
        let mut motion = Self {
            cloth,
            curves,
            settings: *settings,
            method,
            state,
            before,
            start: 0.0,
            steps: 0,
            energies: Energies::default(),
        };
        motion.account(Work::default());
        motion.start = motion.energies.total();
        motion.energies.numerical = 0.0;
        Ok(motion)
    }

    /// Advances by one step. A step that ends in non-finite numbers changes nothing.
    pub fn step(&mut self) -> Step {
        let time = self.time();
        self.before.positions.copy_from_slice(&self.state.positions);
        self.before.velocities.copy_from_slice(&self.state.velocities);
        let (mut step, work) = match &mut self.method {
            Method::Implicit(euler) => {
                euler.step(self.cloth, self.curves, &self.settings, time, &mut self.state)
            }
            Method::Explicit(runge_kutta) => {
                runge_kutta.step(self.cloth, self.curves, &self.settings, time, &mut self.state)
            }
        };
        let energies = self.energies;
        if step.status != Status::NotFinite {
            self.account(work);
        }
        let finite = self.state.positions.iter().chain(&self.state.velocities).all(|value| value.is_finite());
        if step.status == Status::NotFinite || !finite || !self.energies.total().is_finite() {
            std::mem::swap(&mut self.state, &mut self.before);
            self.energies = energies;
            step.status = Status::NotFinite;
            return step;
        }
        if matches!(self.method, Method::Explicit(_)) && self.has_made_energy() {
            step.status = Status::NotConverged;
        }
        self.steps += 1;
        step
    }

    /// The state: positions of the nodes, 3 per node, m, and rotations.
    pub fn positions(&self) -> &[f64] {
        &self.state.positions
    }

    /// Velocities of the state, 3 per point, m/s.
    pub fn velocities(&self) -> &[f64] {
        &self.state.velocities
    }

    /// Time since the start, s.
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.settings.step
    }

    /// Energies, and their balance since the start.
    pub fn energies(&self) -> Energies {
        self.energies
    }

    /// Greatest speed of a node, m/s.
    pub fn greatest_speed(&self) -> f64 {
        let squares = self
            .state
            .velocities
            .chunks_exact(3)
            .take(self.cloth.nodes())
            .map(|v| v.iter().map(|c| c * c).sum::<f64>());
        squares.fold(0.0, f64::max).sqrt()
    }

    /// True if the energy exceeds the initial energy plus the work of the air by more than a tenth of the larger of
    /// kinetic and elastic energy. Damping, which only dissipates, is ignored: it is known only to first order in the
    /// step.
    fn has_made_energy(&self) -> bool {
        let Energies { kinetic, elastic, wind, .. } = self.energies;
        let made = self.energies.total() - self.start - wind;
        made > MADE * kinetic.max(elastic) + 1e-9 * self.start.abs()
    }

    fn account(&mut self, work: Work) {
        let State { positions, velocities } = &self.state;
        let square = |v: &[f64]| v.iter().map(|c| c * c).sum::<f64>();
        let kinetic = self.cloth.masses().iter().zip(velocities.chunks_exact(3));
        let weight = self.cloth.weight_energy(positions);
        self.energies = Energies {
            kinetic: kinetic.map(|(mass, v)| 0.5 * mass * square(v)).sum(),
            elastic: self.cloth.elastic_energy(self.curves, positions),
            weight,
            damping: self.energies.damping + work.damping,
            wind: self.energies.wind + work.wind,
            numerical: 0.0,
        };
        let Energies { damping, wind, .. } = self.energies;
        self.energies.numerical = self.start + wind - damping - self.energies.total();
    }
}
