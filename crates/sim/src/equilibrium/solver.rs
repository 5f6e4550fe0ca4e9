//! State of a solve: energy derivatives, the factor, and the steps shared by all methods.

use super::outcome::{Equilibrium, Limit, Status};
use super::remedies::Remedies;
use super::settings::{Settings, Tolerance};
use crate::cloth::{Cloth, ForceScale};
use crate::element::HessianKind;
use crate::increment::Increment;
use crate::linear::Linear;
use crate::linear::cholesky::Factor;
use crate::material::Curves;
use nalgebra::Vector3;

/// Below this share of the mean, a stiffness is rounding and the matrix is singular.
pub(super) const SINGULAR: f64 = 1e-14;

/// Memory for finding equilibria of one cloth. One per thread.
pub struct Solver<'a> {
    pub(super) cloth: &'a Cloth,
    pub(super) linear: Linear,
    /// Terms that a time step adds to the energy.
    pub(crate) increment: Option<Increment>,
    values: Vec<f64>,
    pub(super) gradient: Vec<f64>,
    scale: ForceScale,
    pub(super) step: Vec<f64>,
    pub(super) trial: Vec<f64>,
    pub(super) trial_gradient: Vec<f64>,
    trial_scale: ForceScale,
    pub(super) reduced: Vec<f64>,
    /// Gradient summed over each unknown.
    forces: Vec<f64>,
    pub(super) mixed: Vec<f64>,
    /// Imbalance after the last accepted step over that before it.
    pub(super) contraction: f64,
    /// μ of the factor, N/m: the matrix + μI was factorised.
    pub(super) shift: f64,
    /// μ of the next Newton matrix, as a share of its mean diagonal.
    pub(super) damping: f64,
    /// Newton matrices of this minimisation that were not positive definite.
    pub(super) clamped: usize,
    /// The energy must fall in every step, with the full or the clamped Hessian.
    pub(super) careful: bool,
    /// Start of a time step.
    pub(super) before: Vec<f64>,
    /// Numerical interventions of all solves so far.
    pub(super) remedies: Remedies,
}

impl<'a> Solver<'a> {
    /// Allocates for one cloth.
    pub fn new(cloth: &'a Cloth) -> Self {
        Self::with(cloth, Linear::Direct(Factor::new(cloth.pattern())))
    }

    /// Allocates with a given linear solver.
    pub(crate) fn with(cloth: &'a Cloth, linear: Linear) -> Self {
        let coordinates = 3 * cloth.points();
        Self {
            cloth,
            linear,
            increment: None,
            values: Vec::new(),
            gradient: vec![0.0; coordinates],
            scale: ForceScale::new(cloth.points()),
            step: vec![0.0; coordinates],
            trial: vec![0.0; coordinates],
            trial_gradient: vec![0.0; coordinates],
            trial_scale: ForceScale::new(cloth.points()),
            reduced: vec![0.0; cloth.unknowns()],
            forces: vec![0.0; cloth.unknowns()],
            mixed: Vec::new(),
            contraction: 1.0,
            shift: 0.0,
            damping: 0.0,
            clamped: 0,
            careful: false,
            before: Vec::new(),
            remedies: Remedies::default(),
        }
    }

    /// Solves K y = b in place for all stacked right-hand sides, with the stiffness matrix K of the last solve, over
    /// the cloth's unknowns.
    pub fn solve_linear(&mut self, columns: &mut [f64]) {
        // Conjugate gradients serve time steps only, which need no sensitivities.
        let _ = self.linear.solve(self.cloth.pattern(), columns);
    }

    /// Derivative of the clip forces ([`Solver::clip_forces`]) with respect to the unknowns, N/m: 3 × clips rows. Empty
    /// before the first solve.
    pub fn border(&self) -> &[f64] {
        let start = self.cloth.entries();
        self.values.get(start..self.values.len().saturating_sub(1)).unwrap_or_default()
    }

    /// Force that holds each clip at the last solve's state, N, excluding the clip's own weight.
    pub fn clip_forces(&self) -> Vec<Vector3<f64>> {
        self.cloth.clip_forces(&self.gradient)
    }

    /// Gradient at the last solve's state, N, 3 per node.
    pub fn gradient(&self) -> &[f64] {
        &self.gradient
    }

    /// Outcome for a state from which no solve can start; `x` and the factor are unchanged.
    pub(super) fn refused(&self, x: &[f64]) -> Option<Equilibrium> {
        let status = if x.iter().all(|c| c.is_finite()) { Status::NotParallel } else { Status::NotFinite };
        (!self.cloth.is_parallel(x)).then_some(Equilibrium {
            status,
            escaped: false,
            limit: Limit::Tolerance,
            energy: f64::NAN,
            imbalance: f64::NAN,
            tolerance: f64::NAN,
            iterations: 0,
            factorisations: 0,
            remedies: Remedies::default(),
        })
    }

    /// Recomputes gradient and factor at a state that is not the end of the last minimisation.
    pub(super) fn refresh(&mut self, curves: &Curves, x: &[f64]) {
        self.evaluate(curves, x);
        self.factorise_true_hessian(curves, x);
    }

    /// The imbalance, its limit, and the kind of limit.
    ///
    /// Rounding: coordinates are accurate to an ulp, and a position error δ causes a force error K δ; summed forces add
    /// errors of an ulp each. The limit allows a hundred times both.
    pub(super) fn balance(&mut self, x: &[f64], settings: &Settings) -> (f64, f64, Limit) {
        let cloth = self.cloth;
        let size = x.iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
        let (mut typical, mut last) = (0.0, usize::MAX);
        // Tied nodes balance as one, with the errors of all.
        self.forces.fill(0.0);
        for &(coordinate, unknown) in cloth.free_coordinates() {
            let node = coordinate / 3;
            self.forces[unknown] += self.scale.stiffness[node] * size + self.scale.magnitude[node];
            // Rotations are no nodes.
            if node != last && node < cloth.nodes() {
                typical += self.scale.magnitude[node].max(cloth.weight(node));
                last = node;
            }
        }
        let mut rounding = 100.0 * f64::EPSILON * self.forces.iter().fold(0.0, |a: f64, &b| a.max(b));
        cloth.collect(&self.gradient, &mut self.forces);
        let (mut largest, mut total, mut nodes, mut first) = (0.0f64, 0.0, 0.0, 0);
        for point in cloth.unknown_coordinates().chunk_by(|a, b| a / 3 == b / 3) {
            let force = &self.forces[first..first + point.len()];
            let square = force.iter().map(|f| f * f).sum::<f64>();
            (largest, total, first) = (largest.max(square), total + square, first + point.len());
            nodes += f64::from(u8::from(point[0] / 3 < cloth.nodes()));
        }
        let (imbalance, asked) = match settings.tolerance {
            Tolerance::Relative(share) => (largest.sqrt(), share * typical / nodes.max(1.0)),
            Tolerance::Absolute(limit) => {
                rounding *= nodes.sqrt();
                (total.sqrt(), limit)
            }
        };
        if asked >= rounding {
            (imbalance, asked, Limit::Tolerance)
        } else {
            (imbalance, rounding, Limit::Rounding)
        }
    }

    pub(super) fn is_balanced(&mut self, x: &[f64], settings: &Settings) -> bool {
        let (imbalance, tolerance, _) = self.balance(x, settings);
        imbalance <= tolerance
    }

    /// Factorises the true Hessian. True if the state is stable: no stiffness is negative, or zero up to rounding.
    pub(super) fn factorise_true_hessian(&mut self, curves: &Curves, x: &[f64]) -> bool {
        self.assemble(curves, x, HessianKind::Full);
        let stable = self.factorise(-SINGULAR * self.mean_diagonal());
        if !stable {
            self.factorise_shifted();
        }
        stable
    }

    /// Adds μ to the diagonal, increased tenfold until the matrix is positive definite.
    fn factorise_shifted(&mut self) -> bool {
        shifts(self.mean_diagonal()).any(|shift| self.factorise(shift))
    }

    /// Mean of the diagonal. Never zero, so that a cloth without any stiffness still gets a factor.
    pub(super) fn mean_diagonal(&self) -> f64 {
        let diagonal = self.cloth.diagonal();
        let sum: f64 = diagonal.iter().map(|&place| self.values[place].abs()).sum();
        (sum / diagonal.len().max(1) as f64).max(f64::MIN_POSITIVE.sqrt())
    }

    /// Factorises the assembled matrix + μI.
    pub(super) fn factorise(&mut self, shift: f64) -> bool {
        let diagonal = self.cloth.diagonal();
        diagonal.iter().for_each(|&place| self.values[place] += shift);
        let made = self.linear.prepare(self.cloth.pattern(), &self.values[..self.cloth.entries()]);
        diagonal.iter().for_each(|&place| self.values[place] -= shift);
        self.shift = shift;
        made.is_ok()
    }

    /// d = −(K + μI)⁻¹ g of the assembled matrix; `None` if it is not positive definite.
    pub(super) fn direction_of(&mut self, shift: f64) -> Option<f64> {
        if self.factorise(shift) { self.direction() } else { None }
    }

    /// Writes d = −K⁻¹ g to `step`; returns g·d. `None` if conjugate gradients find K not positive definite.
    pub(super) fn direction(&mut self) -> Option<f64> {
        self.cloth.collect(&self.gradient, &mut self.reduced);
        self.reduced.iter_mut().for_each(|force| *force = -*force);
        if !self.solve_reduced() {
            return None;
        }
        self.step.fill(0.0);
        self.cloth.spread(&self.reduced, &mut self.step);
        Some(self.gradient.iter().zip(&self.step).map(|(g, d)| g * d).sum())
    }

    pub(super) fn solve_reduced(&mut self) -> bool {
        self.linear.solve(self.cloth.pattern(), &mut self.reduced).is_ok()
    }

    pub(super) fn is_direct(&self) -> bool {
        matches!(self.linear, Linear::Direct(_))
    }

    /// Total energy, including the terms of a time step.
    pub(super) fn energy(&mut self, curves: &Curves, x: &[f64]) -> f64 {
        let added = self.increment.as_mut().map_or(0.0, |increment| increment.energy(self.cloth, x));
        self.cloth.energy(curves, x) + added
    }

    /// Total energy and its gradient.
    pub(super) fn evaluate(&mut self, curves: &Curves, x: &[f64]) -> f64 {
        let energy = self.cloth.gradient(curves, x, &mut self.gradient, &mut self.scale);
        let (gradient, scale) = (&mut self.gradient, &mut self.scale);
        energy
            + self.increment.as_mut().map_or(0.0, |added| added.add_gradient(self.cloth, x, gradient, scale))
    }

    /// Assembles the Hessian, including the terms of a time step.
    pub(super) fn assemble(&mut self, curves: &Curves, x: &[f64], curvature: HessianKind<'_>) {
        self.cloth.hessian(curves, x, curvature, &mut self.values);
        if let Some(increment) = &self.increment {
            increment.add_hessian(self.cloth, &mut self.values);
        }
    }

    /// Assembles it with the geometric part at the strains predicted by the last step, if there was one.
    pub(super) fn assemble_mixed(&mut self, curves: &Curves, x: &[f64]) {
        let mixed = std::mem::take(&mut self.mixed);
        let curvature =
            if mixed.is_empty() || self.careful { HessianKind::Full } else { HessianKind::Mixed(&mixed) };
        self.assemble(curves, x, curvature);
        self.mixed = mixed;
    }

    /// Energy after a share of the step; state and gradient are left in the trial buffers.
    pub(super) fn try_step(&mut self, curves: &Curves, x: &[f64], length: f64) -> f64 {
        for ((trial, x), d) in self.trial.iter_mut().zip(x).zip(&self.step) {
            *trial = x + length * d;
        }
        let (gradient, scale) = (&mut self.trial_gradient, &mut self.trial_scale);
        let energy = self.cloth.gradient(curves, &self.trial, gradient, scale);
        let trial = &self.trial;
        energy
            + self
                .increment
                .as_mut()
                .map_or(0.0, |added| added.add_gradient(self.cloth, trial, gradient, scale))
    }

    /// Accepts the trial; the strains predicted by the step are kept for the next matrix.
    pub(super) fn accept(&mut self, x: &mut [f64], energy: f64) -> f64 {
        self.cloth.predicted_strains(x, &self.step, &mut self.mixed);
        x.copy_from_slice(&self.trial);
        std::mem::swap(&mut self.gradient, &mut self.trial_gradient);
        std::mem::swap(&mut self.scale, &mut self.trial_scale);
        energy
    }
}

/// Shifts μ, from a billionth of the mean diagonal up, each ten times the previous.
pub(super) fn shifts(mean: f64) -> impl Iterator<Item = f64> {
    (0..16).map(move |power| mean * 1e-9 * 10f64.powi(power))
}
