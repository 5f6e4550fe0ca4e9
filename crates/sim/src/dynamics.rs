//! Cloth in motion: time steps of implicit Euler or Runge–Kutta, with an account of energy and work.
//!
//! ```text
//! M ẍ = −∇E(x) − C(x) ẋ + B (w − ẋ)        M lumped masses, C damping, B drag of the air, w the wind
//! ```
//!
//! An implicit step is solved to a tolerance, or linearised once as published; by factorisation or by conjugate gradients.
//! Held nodes stay where they are; guided ones keep to their directions.
//!
//! ```text
//! kinetic + elastic + weight  =  their sum at the start + work of the wind − damping − numerical loss
//! ```
//!
//! Source: Baraff and Witkin 1998; Strohkorb 2019, §3.3. The damping law is ours: see [`Damping`].

mod implicit_euler;
mod runge_kutta;
mod wind;

pub use wind::Wind;

use crate::cloth::Cloth;
use crate::equilibrium::Remedies;
use crate::error::{Error, Result};
use crate::material::Curves;
use implicit_euler::ImplicitEuler;
use runge_kutta::RungeKutta;
pub use runge_kutta::stable_step;

/// How a cloth is moved on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Length of a step, s; default 0.01.
    pub step: f64,
    /// Default implicit Euler.
    pub integrator: Integrator,
    /// Default none.
    pub damping: Damping,
    /// The air; default none.
    pub wind: Option<Wind>,
}

impl Default for Settings {
    fn default() -> Self {
        let integrator =
            Integrator::ImplicitEuler { newton: Newton::default(), linear: LinearSolver::Direct };
        Self { step: 0.01, integrator, damping: Damping::default(), wind: None }
    }
}

/// The way from one time to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// First order, stable at any step, and lossy: motion faster than some steps dies.
    ImplicitEuler {
        /// How the step's equation is solved.
        newton: Newton,
        /// How its linear systems are.
        linear: LinearSolver,
    },
    /// Fourth order, explicit: stable up to [`stable_step`].
    RungeKutta,
}

/// How an implicit step's equation is solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Newton {
    /// Until the largest imbalance of a node is at most this share of the typical force or weight at a node; default 1e-6.
    Converged {
        /// That share.
        tolerance: f64,
    },
    /// Linearised once, as published: faster, and neither exact nor always stable.
    Single,
}

impl Default for Newton {
    fn default() -> Self {
        Self::Converged { tolerance: 1e-6 }
    }
}

/// How linear systems are solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LinearSolver {
    /// Sparse Cholesky factorisation.
    Direct,
    /// Conjugate gradients with a diagonal preconditioner.
    ConjugateGradient {
        /// γ: stop at rᵀP⁻¹r ≤ γ² bᵀP⁻¹b; 1e-5 as published.
        tolerance: f64,
        /// Most iterations of one system.
        max_iterations: usize,
    },
}

/// Damping in proportion to mass and to stiffness, known as Rayleigh damping.
///
/// ```text
/// C(x) = α M + β K(x)      K(x) = Σ A σ′(ε) ∇ε ∇εᵀ, the stiffness without its geometric part
/// ```
///
/// A mode of angular frequency ω is damped by the share ζ = (α/ω + β ω)/2 of the critical damping. K does not resist rigid
/// motion, and C never feeds energy in. A step takes it where it starts. The law that Strohkorb 2019 takes over from Kang
/// and Cho 2002 adds a force to a mass, in whatever units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Damping {
    /// α, 1/s.
    pub mass: f64,
    /// β, s.
    pub stiffness: f64,
}

/// Energies of a state, and the account since the start; J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energies {
    /// ½ Σ m |v|².
    pub kinetic: f64,
    /// Of all strains.
    pub elastic: f64,
    /// −Σ m g·x.
    pub weight: f64,
    /// What damping has taken since the start.
    pub damping: f64,
    /// What the air has done since the start; drag in still air takes.
    pub wind: f64,
    /// What the integrator has lost since the start; negative if it has gained.
    pub numerical: f64,
}

impl Energies {
    /// Kinetic, elastic and weight.
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.weight
    }
}

/// A share of the energy that no stable integrator makes.
const MADE: f64 = 0.1;

/// How a step ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// As it should.
    Done,
    /// Its equation is not solved to the tolerance, and the best state is taken; or an explicit integrator has made energy
    /// out of nothing, as it does where the cloth has become too stiff for its step.
    NotConverged,
    /// It led to numbers that are not finite: nothing has moved.
    NotFinite,
}

/// The outcome of one step.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// How it ended.
    pub status: Status,
    /// Newton steps; 0 of an explicit integrator.
    pub newton_iterations: usize,
    /// Iterations of conjugate gradients.
    pub linear_iterations: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// Largest imbalance of a node in the step's equation, N; 0 of an explicit integrator and of a linearised step.
    pub imbalance: f64,
    /// What was done beside plain Newton steps.
    pub remedies: Remedies,
}

/// The memory of an integrator.
enum Method<'a> {
    Implicit(Box<ImplicitEuler<'a>>),
    Explicit(Box<RungeKutta>),
}

/// A cloth on its way.
pub struct Motion<'a> {
    cloth: &'a Cloth,
    curves: &'a Curves,
    settings: Settings,
    method: Method<'a>,
    state: State,
    /// The state before the last step.
    before: State,
    /// Total energy at the start, J.
    start: f64,
    steps: usize,
    energies: Energies,
}

/// Where a cloth is and how it moves.
#[derive(Debug, Clone)]
struct State {
    /// 3 a node, m.
    positions: Vec<f64>,
    /// 3 a node, m/s; zero where the cloth is held.
    velocities: Vec<f64>,
}

/// What air and damping did in a step, J.
#[derive(Debug, Clone, Copy, Default)]
struct Work {
    damping: f64,
    wind: f64,
}

impl<'a> Motion<'a> {
    /// A cloth at rest in some state.
    ///
    /// * `positions` — 3 a node, m; held nodes where they shall stay
    ///
    /// # Errors
    /// A setting or a position that is not finite or out of its range; cloth without mass; a step of Runge–Kutta beyond
    /// [`stable_step`], which is named.
    pub fn new(
        cloth: &'a Cloth,
        curves: &'a Curves,
        positions: Vec<f64>,
        settings: &Settings,
    ) -> Result<Self> {
        let velocities = vec![0.0; positions.len()];
        Self::with_velocities(cloth, curves, positions, velocities, settings)
    }

    /// The same, moving at the start.
    ///
    /// * `velocities` — 3 a node, m/s; those of held nodes, and of guided ones across their directions, are ignored
    ///
    /// # Errors
    /// As [`Motion::new`].
    pub fn with_velocities(
        cloth: &'a Cloth,
        curves: &'a Curves,
        positions: Vec<f64>,
        velocities: Vec<f64>,
        settings: &Settings,
    ) -> Result<Self> {
        settings.check()?;
        for (what, values) in [("positions", &positions), ("velocities", &velocities)] {
            if values.len() != 3 * cloth.nodes() {
                return Err(Error::ShapeMismatch { what, expected: 3 * cloth.nodes(), found: values.len() });
            }
            if let Some(index) = values.iter().position(|value| !value.is_finite()) {
                return Err(Error::NotFinite { what, vertex: index / 3 });
            }
        }
        if let Some(&mass) = cloth.masses().iter().find(|&&mass| !(mass > 0.0)) {
            let expected = "more than 0, in kg/m²: what has no mass has no motion";
            return Err(Error::InvalidValue { field: "areal_density", value: mass, expected });
        }
        let mut free = vec![0.0; cloth.unknowns()];
        let mut state = State { velocities: vec![0.0; positions.len()], positions };
        // Of nodes that move alike the first one's velocity is that of all.
        for (value, &coordinate) in free.iter_mut().zip(cloth.unknown_coordinates()) {
            *value = velocities[coordinate];
        }
        cloth.project(&mut free);
        cloth.spread(&free, &mut state.velocities);
        let method = match settings.integrator {
            Integrator::ImplicitEuler { newton, linear } => {
                Method::Implicit(Box::new(ImplicitEuler::new(cloth, newton, linear)))
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

    /// Moves on by one step. One that ends in numbers that are not finite changes nothing.
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

    /// Where the nodes are, 3 a node, m.
    pub fn positions(&self) -> &[f64] {
        &self.state.positions
    }

    /// How they move, 3 a node, m/s.
    pub fn velocities(&self) -> &[f64] {
        &self.state.velocities
    }

    /// Time since the start, s.
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.settings.step
    }

    /// Energies, and the account since the start.
    pub fn energies(&self) -> Energies {
        self.energies
    }

    /// Greatest speed of a node, m/s.
    pub fn greatest_speed(&self) -> f64 {
        let squares = self.state.velocities.chunks_exact(3).map(|v| v.iter().map(|c| c * c).sum::<f64>());
        squares.fold(0.0, f64::max).sqrt()
    }

    /// True if there is more energy than at the start and from the air, by a tenth of what moves or is strained. Damping, which
    /// only takes, does not count: it is known to first order in the step.
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

impl Settings {
    fn check(&self) -> Result<()> {
        let positive = |field, value: f64| match value > 0.0 && value.is_finite() {
            true => Ok(()),
            false => Err(Error::InvalidValue { field, value, expected: "a number above 0" }),
        };
        let not_negative = |field, value: f64| match value >= 0.0 && value.is_finite() {
            true => Ok(()),
            false => Err(Error::InvalidValue { field, value, expected: "0 or more" }),
        };
        positive("step", self.step)?;
        not_negative("damping.mass", self.damping.mass)?;
        not_negative("damping.stiffness", self.damping.stiffness)?;
        if let Integrator::ImplicitEuler { newton, linear } = self.integrator {
            if let Newton::Converged { tolerance } = newton {
                positive("newton.tolerance", tolerance)?;
            }
            if let LinearSolver::ConjugateGradient { tolerance, max_iterations } = linear {
                positive("linear.tolerance", tolerance)?;
                positive("linear.max_iterations", max_iterations as f64)?;
            }
        }
        self.wind.map_or(Ok(()), |wind| wind.check())
    }
}
