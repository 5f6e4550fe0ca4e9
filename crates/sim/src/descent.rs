//! Descent from any shape to a shape at rest: the cloth sinks without momentum and ends in an equilibrium.
//!
//! ```text
//! minimise over x′    E(x′) + Σ m |x′ − x|² / (2 h²)        h grows from step to step, x′ is the next x
//! ```
//!
//! Every step is one of implicit Euler from rest. The mass keeps it well posed where the cloth is slack, flat or
//! folding, and the energy falls in every step. The path hardly depends on the mesh, whereas Newton's method from a
//! flat sheet ends in one of many folded equilibria.
//!
//! Source: proximal point method, Rockafellar 1976, in the mass metric.

use crate::cloth::Cloth;
use crate::dynamics::{self, Integrator, LinearSolver, Motion, Newton};
use crate::equilibrium::{self, Equilibrium, Remedies, Solver};
use crate::error::{Error, Result};
use crate::material::Curves;

/// Settings of a descent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// First step, s; the cloth falls by about g h²/2 in it. Default 0.01.
    pub step: f64,
    /// Growth factor of the step after an easy one; default 1.25.
    pub growth: f64,
    /// Maximum number of steps; default 200.
    pub max_steps: usize,
    /// Settings of the final solve for the equilibrium.
    pub equilibrium: equilibrium::Settings,
}

impl Default for Settings {
    fn default() -> Self {
        let equilibrium = equilibrium::Settings::default();
        Self { step: 0.01, growth: 1.25, max_steps: 200, equilibrium }
    }
}

/// Outcome of a descent.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Descent {
    /// The final equilibrium, or the reason for its absence.
    pub equilibrium: Equilibrium,
    /// Steps taken.
    pub steps: usize,
    /// Largest displacement of a node in the solve after the last step, m.
    pub last_way: f64,
    /// Numerical interventions in all steps and solves; steps that could not be solved count as halved.
    pub remedies: Remedies,
}

/// A step with fewer iterations is easy.
const EASY: usize = 12;

/// Steps are solved to this share of the typical nodal force: only their end matters.
const TOLERANCE: f64 = 1e-3;

/// The final solve follows a step that moves every node by less than this share of the mean edge and whose driving
/// acceleration has fallen to the share `WEAK` of the strongest one.
const NEAR: f64 = 1e-3;
const WEAK: f64 = 1e-2;

/// A step that moves every node by less than this share of the mean edge counts as no motion.
const NOTHING: f64 = 1e-9;

/// Shortest step, as a share of the first.
const SHORTEST: f64 = 1e-4;

/// Lets a cloth descend from a shape, which is replaced by the shape at rest.
///
/// A step that cannot be solved is halved. When the steps hardly move the cloth, a solve for the equilibrium follows;
/// if it fails, more steps are taken.
///
/// * `x` — 3 stacked coordinates per node, m; held nodes at their positions
/// * `watch` — receives the number of each step and the largest displacement of a node in it, m
///
/// # Errors
/// A setting or a position that is not finite or out of range; cloth without mass.
pub fn descend(
    cloth: &Cloth,
    curves: &Curves,
    x: &mut [f64],
    settings: &Settings,
    watch: &mut dyn FnMut(usize, f64),
) -> Result<Descent> {
    for (field, value, least) in
        [("step", settings.step, f64::MIN_POSITIVE), ("growth", settings.growth, 1.0)]
    {
        if !(value >= least && value.is_finite()) {
            let expected = "a step above 0 and a growth of 1 or more";
            return Err(Error::InvalidValue { field, value, expected });
        }
    }
    let (mut solver, nodes) = (Solver::new(cloth), cloth.nodes());
    let (mut length, mut near) = (settings.step, NEAR * cloth.mean_edge());
    let (mut steps, mut strongest) = (0, 0.0f64);
    let mut remedies = Remedies::default();
    loop {
        let mut going = true;
        while steps < settings.max_steps && going && length > SHORTEST * settings.step {
            let mut motion = Motion::new(cloth, curves, x.to_vec(), &still(length))?;
            let step = motion.step();
            steps += 1;
            remedies += step.remedies;
            remedies.halved += usize::from(step.status != dynamics::Status::Done);
            if step.status == dynamics::Status::NotFinite {
                length *= 0.5;
                continue;
            }
            let way = greatest_way(nodes, x, motion.positions());
            // Driving acceleration, m/s².
            let pull = way / (length * length);
            strongest = strongest.max(pull);
            x.copy_from_slice(motion.positions());
            watch(steps, way);
            if step.status == dynamics::Status::NotConverged {
                length *= 0.5;
                continue;
            }
            going = !(way <= near && pull <= WEAK * strongest || way <= NOTHING * cloth.mean_edge());
            if step.newton_iterations < EASY {
                length *= settings.growth;
            }
        }
        let before = x.to_vec();
        let equilibrium = solver.solve(curves, x, &settings.equilibrium);
        remedies += equilibrium.remedies;
        let last_way = greatest_way(nodes, &before, x);
        if equilibrium.converged() || steps >= settings.max_steps || length <= SHORTEST * settings.step {
            return Ok(Descent { equilibrium, steps, last_way, remedies });
        }
        // The state after a failed solve is no better start than the end of the steps.
        x.copy_from_slice(&before);
        near *= 0.1;
    }
}

/// Settings of one step from rest.
fn still(step: f64) -> dynamics::Settings {
    let newton = Newton::Converged { tolerance: TOLERANCE };
    let integrator = Integrator::ImplicitEuler { newton, linear: LinearSolver::Direct };
    dynamics::Settings { step, integrator, ..dynamics::Settings::default() }
}

fn greatest_way(nodes: usize, from: &[f64], to: &[f64]) -> f64 {
    let squares = from
        .chunks_exact(3)
        .zip(to.chunks_exact(3))
        .take(nodes)
        .map(|(from, to)| from.iter().zip(to).map(|(from, to)| (to - from).powi(2)).sum::<f64>());
    squares.fold(0.0, f64::max).sqrt()
}
