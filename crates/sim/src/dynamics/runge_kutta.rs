//! The classical Runge–Kutta method and its stability limit.

use super::damping::Damping;
use super::energy::Work;
use super::settings::Settings;
use super::state::State;
use super::step::{Status, Step};
use crate::cloth::{Cloth, ForceScale};
use crate::curve::{NegativeStrain, StiffnessCurve};
use crate::element::HessianKind;
use crate::equilibrium::Remedies;
use crate::material::Curves;
use crate::sequence::irregular;
use nalgebra::{Matrix3, Vector3};

/// Time of each of the four slopes within a step, and its weight.
const STAGES: [(f64, f64); 4] = [(0.0, 1.0 / 6.0), (0.5, 1.0 / 3.0), (0.5, 1.0 / 3.0), (1.0, 1.0 / 6.0)];

/// Maximum iterations of the power method on M⁻¹K, and the relative change at which it stops.
const POWER_ITERATIONS: usize = 2000;
const POWER_CHANGE: f64 = 1e-7;

/// The power method approaches the greatest frequency from below.
const MARGIN: f64 = 0.99;

pub(super) struct RungeKutta {
    /// Mass of every unknown, kg.
    masses: Vec<f64>,
    gradient: Vec<f64>,
    scale: ForceScale,
    values: Vec<f64>,
    drag: Vec<Matrix3<f64>>,
    unknowns: Vec<f64>,
    free: Vec<f64>,
    product: Vec<f64>,
    /// Slopes of position and velocity at the current stage.
    slope: State,
    /// Weighted sum of the slopes.
    sum: State,
    stage: State,
}

impl RungeKutta {
    pub(super) fn new(cloth: &Cloth) -> Self {
        let zeros = vec![0.0; 3 * cloth.points()];
        let state = State { positions: zeros.clone(), velocities: zeros.clone() };
        Self {
            masses: cloth.unknown_masses(),
            gradient: zeros,
            scale: ForceScale::new(cloth.points()),
            values: Vec::new(),
            drag: Vec::new(),
            unknowns: vec![0.0; cloth.unknowns()],
            free: vec![0.0; cloth.unknowns()],
            product: vec![0.0; cloth.unknowns()],
            slope: state.clone(),
            sum: state.clone(),
            stage: state,
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
        let mut work = Work::default();
        self.sum.positions.fill(0.0);
        self.sum.velocities.fill(0.0);
        for (part, weight) in STAGES {
            advance(&mut self.stage, state, part * h, &self.slope);
            let power = self.slope_at(cloth, curves, settings, time + part * h);
            work.damping += h * weight * power.damping;
            work.wind += h * weight * power.wind;
            for (sum, slope) in [
                (&mut self.sum.positions, &self.slope.positions),
                (&mut self.sum.velocities, &self.slope.velocities),
            ] {
                sum.iter_mut().zip(slope).for_each(|(sum, slope)| *sum += weight * slope);
            }
        }
        advance(&mut self.stage, state, h, &self.sum);
        std::mem::swap(state, &mut self.stage);
        let step = Step {
            status: Status::Done,
            newton_iterations: 0,
            linear_iterations: 0,
            factorisations: 0,
            imbalance: 0.0,
            remedies: Remedies::default(),
        };
        (step, work)
    }

    /// Computes velocity and acceleration at the stage; returns the power of damping and wind, W.
    fn slope_at(&mut self, cloth: &Cloth, curves: &Curves, settings: &Settings, time: f64) -> Work {
        let mut power = Work::default();
        let State { positions, velocities } = &self.stage;
        cloth.gradient(curves, positions, &mut self.gradient, &mut self.scale);
        if let Some(wind) = settings.wind {
            let air = wind.at(time);
            wind.drag(cloth, &self.stage, air, &mut self.drag);
            let nodes = self.gradient.chunks_exact_mut(3).zip(velocities.chunks_exact(3)).zip(&self.drag);
            for ((gradient, v), drag) in nodes {
                let v = Vector3::from_column_slice(v);
                let force = drag * (air - v);
                power.wind += v.dot(&force);
                (0..3).for_each(|i| gradient[i] -= force[i]);
            }
        }
        cloth.collect(&self.gradient, &mut self.unknowns);
        let Damping { mass: alpha, stiffness: beta } = settings.damping;
        if alpha > 0.0 || beta > 0.0 {
            let v = |unknown: usize| velocities[cloth.unknown_coordinates()[unknown]];
            self.product.fill(0.0);
            if beta > 0.0 {
                cloth.hessian(curves, positions, HessianKind::Material, &mut self.values);
                self.free.iter_mut().enumerate().for_each(|(unknown, free)| *free = v(unknown));
                cloth.pattern().multiply(&self.values[..cloth.entries()], &self.free, &mut self.product);
            }
            for unknown in 0..cloth.unknowns() {
                let force = beta * self.product[unknown] + alpha * self.masses[unknown] * v(unknown);
                power.damping += force * v(unknown);
                self.unknowns[unknown] += force;
            }
        }
        self.unknowns.iter_mut().zip(&self.masses).for_each(|(force, mass)| *force /= -mass);
        self.slope.positions.copy_from_slice(velocities);
        cloth.spread(&self.unknowns, &mut self.slope.velocities);
        power
    }
}

/// `to` = `from` + h · `slope`.
fn advance(to: &mut State, from: &State, h: f64, slope: &State) {
    for (to, from, slope) in [
        (&mut to.positions, &from.positions, &slope.positions),
        (&mut to.velocities, &from.velocities, &slope.velocities),
    ] {
        to.iter_mut().zip(from).zip(slope).for_each(|((to, from), slope)| *to = from + h * slope);
    }
}

/// Longest step, s, at which Runge–Kutta is stable, with every curve at its stiffest; infinite without stiffness and
/// damping.
///
/// ```text
/// ω² = greatest eigenvalue of M⁻¹K        λ = −ω (ζ ± √(ζ² − 1)),  ζ = (α/ω + βω)/2
/// |1 + z + z²/2 + z³/6 + z⁴/24| ≤ 1,  z = hλ        undamped: h ≤ 2√2/ω
/// ```
///
/// K is evaluated at the given state with the greatest tangent of every curve. Drag, or much more stretch or
/// compression during the motion, requires shorter steps. The frequency of StVK grows with stretch: a step of 0.9 times
/// the limit allows 11 % of it.
///
/// * `positions` — 3 per node, m
pub fn stable_step(cloth: &Cloth, curves: &Curves, positions: &[f64], damping: &Damping) -> f64 {
    let frequency = greatest_frequency(cloth, &stiffest(curves), positions) / MARGIN;
    let limit = |frequency: f64| match frequency > 0.0 {
        true => longest(frequency, damping),
        false if damping.mass > 0.0 => real_limit() / damping.mass,
        false => f64::INFINITY,
    };
    // A slow mode is damped by the mass term alone.
    limit(frequency).min(limit(0.0))
}

/// Every curve replaced by its greatest tangent, for both signs of strain.
fn stiffest(curves: &Curves) -> Curves {
    let constant = |component| {
        let tangent = curves.get(component)?.greatest_tangent();
        Some((component, StiffnessCurve::constant(tangent, NegativeStrain::Odd).ok()?))
    };
    curves.components().filter_map(constant).collect()
}

/// Greatest ω, 1/s, by the power method.
fn greatest_frequency(cloth: &Cloth, curves: &Curves, positions: &[f64]) -> f64 {
    let mut values = Vec::new();
    cloth.hessian(curves, positions, HessianKind::Full, &mut values);
    let masses = cloth.unknown_masses();
    let mut mode: Vec<f64> = (0..cloth.unknowns()).map(irregular).collect();
    cloth.project(&mut mode);
    let mut product = vec![0.0; mode.len()];
    let mut square = 0.0;
    for _ in 0..POWER_ITERATIONS {
        let length = mode.iter().zip(&masses).map(|(d, mass)| d * d * mass).sum::<f64>().sqrt();
        if !(length > 0.0) {
            return 0.0;
        }
        mode.iter_mut().for_each(|d| *d /= length);
        cloth.pattern().multiply(&values[..cloth.entries()], &mode, &mut product);
        product.iter_mut().zip(&masses).for_each(|(force, mass)| *force /= mass);
        cloth.project(&mut product);
        std::mem::swap(&mut mode, &mut product);
        // ‖M⁻¹K d‖ in the mass norm equals the eigenvalue once d is the eigenvector.
        let found = mode.iter().zip(&masses).map(|(d, mass)| d * d * mass).sum::<f64>().sqrt();
        if (found - square).abs() <= POWER_CHANGE * found {
            return found.sqrt();
        }
        square = found;
    }
    square.sqrt()
}

/// Longest stable step of a mode, s.
fn longest(frequency: f64, damping: &Damping) -> f64 {
    let share = 0.5 * (damping.mass / frequency + damping.stiffness * frequency);
    let undamped = 8f64.sqrt() / frequency;
    if share == 0.0 {
        return undamped;
    }
    let stable = |h: f64| eigenvalues(frequency, share).iter().all(|&[re, im]| growth(h * re, h * im) <= 1.0);
    // Damping first lengthens the stable step slightly, then shortens it.
    let (mut low, mut high) = (0.0, 1.5 * undamped);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if stable(middle) { low = middle } else { high = middle }
    }
    low
}

fn eigenvalues(frequency: f64, share: f64) -> [[f64; 2]; 2] {
    if share < 1.0 {
        let im = frequency * (1.0 - share * share).sqrt();
        [[-frequency * share, im], [-frequency * share, -im]]
    } else {
        let root = (share * share - 1.0).sqrt();
        [[-frequency * (share + root), 0.0], [-frequency / (share + root), 0.0]]
    }
}

/// |1 + z + z²/2 + z³/6 + z⁴/24|².
fn growth(re: f64, im: f64) -> f64 {
    // Horner's scheme: 1 + z (1 + z/2 (1 + z/3 (1 + z/4))).
    let (mut a, mut b) = (1.0, 0.0);
    for divisor in [4.0, 3.0, 2.0, 1.0] {
        (a, b) = (1.0 + (a * re - b * im) / divisor, (a * im + b * re) / divisor);
    }
    a * a + b * b
}

/// End of the stability region on the negative real axis: −z of R(z) = 1.
fn real_limit() -> f64 {
    let (mut low, mut high) = (2.0, 3.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if growth(-middle, 0.0) <= 1.0 { low = middle } else { high = middle }
    }
    low
}
