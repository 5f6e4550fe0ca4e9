//! Quasi-static equilibrium: the state in which the gradient of the total energy vanishes at every free node.
//!
//! Newton's method with the geometric stiffness taken at the strains that the last step predicted ("mixed" Newton),
//! which keeps stiff directions from filling the matrix with spurious stress after a rotation. The gradient is exact,
//! so the equilibria are the same. Where the matrix is not positive definite, its geometric part is clamped element by
//! element. Additive Levenberg–Marquardt, the published method, is a setting and the last resort. Where that comes to
//! nothing, a softer or stiffer membrane shows the way. A balance that is not stable is left for the lower of the two states beside it.
//!
//! Source: the problem, Miguel et al. 2012, §5.1; mixed Newton, after Magisano, Leonetti and Garcea 2017.

use crate::cloth::{Cloth, ForceScale};
use crate::element::Curvature;
use crate::increment::Increment;
use crate::linear::Linear;
use crate::linear::cholesky::Factor;
use crate::material::Curves;
use nalgebra::Vector3;

mod continuation;
mod drive;
mod escape;
mod levenberg_marquardt;
mod newton;
mod remedies;
mod time_step;

pub use remedies::Remedies;

/// How equilibria are found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The method; default mixed Newton.
    pub method: Method,
    /// When a state counts as balanced.
    pub tolerance: Tolerance,
    /// Most iterations of one minimisation; default 200. Leaving an unstable state is two more of them, and where they run
    /// out, starting anew from a softer or stiffer membrane is four or more.
    pub max_iterations: usize,
    /// Leave an unstable state for one of lower energy; default true.
    pub escape: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: Method::MixedNewton,
            tolerance: Tolerance::Relative(1e-6),
            max_iterations: 200,
            escape: true,
        }
    }
}

/// The iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Mixed Newton, Levenberg–Marquardt if that comes to nothing.
    MixedNewton,
    /// The full Hessian + μI throughout, for the sensitivities too, as published. Stability is not checked: what is balanced
    /// has converged.
    ///
    /// Source: Miguel et al. 2012, §5.1; how μ is chosen is ours.
    LevenbergMarquardt,
}

/// When a state counts as balanced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// Largest imbalance of a node at most this share of the typical force or weight at a node.
    Relative(f64),
    /// Norm of all imbalances at most this, N; 10 µN as published.
    Absolute(f64),
}

/// How a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Status {
    /// A stable equilibrium; with Levenberg–Marquardt, any equilibrium.
    Converged,
    /// Balanced, but the stiffness matrix is not positive definite: the cloth would leave this state at a touch.
    Unstable,
    /// The iterations ran out.
    IterationLimit,
    /// No step made it better.
    Stalled,
    /// The start, or the curves there, are not finite.
    NotFinite,
    /// Tied groups are not parallel at the start, beyond a millionth of an edge: elements between them that are computed once
    /// for all would not be alike. So it is, by rounding, in a state thrown far away.
    NotParallel,
}

impl std::fmt::Display for Status {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Converged => "converged",
            Self::Unstable => "balanced but unstable",
            Self::IterationLimit => "the iterations ran out",
            Self::Stalled => "no step made the imbalance smaller",
            Self::NotFinite => "the start is not finite",
            Self::NotParallel => "tied groups of nodes are not parallel at the start",
        })
    }
}

/// What decided that a state is balanced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// The tolerance asked for.
    Tolerance,
    /// Rounding: forces cannot be computed more exactly at these coordinates.
    Rounding,
}

/// The outcome of a solve.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equilibrium {
    /// How it ended.
    pub status: Status,
    /// An unstable balance was met and left: the cloth bifurcates near here, so that another shape, and other
    /// sensitivities, are as good.
    pub escaped: bool,
    /// Which limit the imbalance is measured against.
    pub limit: Limit,
    /// Total energy, J.
    pub energy: f64,
    /// Largest imbalance of a free node, N (with an absolute tolerance: the norm over all).
    pub imbalance: f64,
    /// What it had to come below, N.
    pub tolerance: f64,
    /// Newton steps taken, on all sides of states that were left.
    pub iterations: usize,
    /// Factorisations made, those that check stability included.
    pub factorisations: usize,
    /// What was done beside plain Newton steps.
    pub remedies: Remedies,
}

impl Equilibrium {
    /// A stable equilibrium was found.
    pub fn converged(&self) -> bool {
        self.status == Status::Converged
    }
}

/// A stiffness below this share of the mean is one of rounding: the matrix is singular.
const SINGULAR: f64 = 1e-14;

/// So many unstable states in a row are left.
const ESCAPES: usize = 6;

/// The memory that finding equilibria of one cloth needs. One a thread.
pub struct Solver<'a> {
    cloth: &'a Cloth,
    linear: Linear,
    /// What a time step adds to the energy.
    pub(crate) increment: Option<Increment>,
    values: Vec<f64>,
    gradient: Vec<f64>,
    scale: ForceScale,
    step: Vec<f64>,
    trial: Vec<f64>,
    trial_gradient: Vec<f64>,
    trial_scale: ForceScale,
    reduced: Vec<f64>,
    /// The gradient, summed over each unknown.
    forces: Vec<f64>,
    mixed: Vec<f64>,
    /// Imbalance after the last accepted step over that before.
    contraction: f64,
    /// μ of the factor, N/m: it is that of the matrix + μI.
    shift: f64,
    /// μ of the next Newton matrix, as a share of the mean of its diagonal.
    damping: f64,
    /// Newton matrices that were not positive definite, in this minimisation.
    clamped: usize,
    /// Downhill in every step, with the full Hessian or the clamped one.
    careful: bool,
    /// Where a time step starts.
    before: Vec<f64>,
    /// All that was done beside plain Newton steps, in every solve so far.
    remedies: Remedies,
}

impl<'a> Solver<'a> {
    /// Memory for one cloth.
    pub fn new(cloth: &'a Cloth) -> Self {
        Self::with(cloth, Linear::Direct(Factor::new(cloth.pattern())))
    }

    /// The same with another way to solve linear systems.
    pub(crate) fn with(cloth: &'a Cloth, linear: Linear) -> Self {
        let coordinates = 3 * cloth.nodes();
        Self {
            cloth,
            linear,
            increment: None,
            values: Vec::new(),
            gradient: vec![0.0; coordinates],
            scale: ForceScale::new(cloth.nodes()),
            step: vec![0.0; coordinates],
            trial: vec![0.0; coordinates],
            trial_gradient: vec![0.0; coordinates],
            trial_scale: ForceScale::new(cloth.nodes()),
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

    /// Finds an equilibrium near a state, which it replaces.
    ///
    /// * `x` — 3 stacked coordinates a node, m; held nodes at their prescribed places, where they stay
    ///
    /// On return [`Solver::solve_linear`] works with the true stiffness matrix there (where that is not positive
    /// definite: shifted until it is); with Levenberg–Marquardt as the method, with that + μI, μ of the last step.
    ///
    /// # Panics
    /// If `x` has another length than the cloth has coordinates.
    pub fn solve(&mut self, curves: &Curves, x: &mut [f64], settings: &Settings) -> Equilibrium {
        assert_eq!(x.len(), 3 * self.cloth.nodes(), "three coordinates a node");
        if let Some(refused) = self.refused(x) {
            return refused;
        }
        self.mixed.clear();
        let start = x.to_vec();
        let (before, remedies) = (self.linear.factorisations(), self.remedies);
        let mut found = self.settle(curves, x, settings);
        // Fewer iterations than that were asked for to see how far they lead.
        if matches!(found.status, Status::IterationLimit | Status::Stalled)
            && settings.method == Method::MixedNewton
            && settings.max_iterations > newton::NONMONOTONE_STEPS
        {
            self.remedies.continued += 1;
            self.continue_from_others(curves, x, &start, settings, &mut found);
        }
        let (factorisations, remedies) = (self.linear.factorisations() - before, self.remedies - remedies);
        Equilibrium { factorisations, remedies, ..found }
    }

    /// The outcome at a state that no solve can start from; it stays, and so does the factor.
    fn refused(&self, x: &[f64]) -> Option<Equilibrium> {
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

    /// Solves K y = b in place for as many right-hand sides as are stacked, with the stiffness matrix K of the last
    /// solve, over the cloth's unknowns.
    pub fn solve_linear(&mut self, columns: &mut [f64]) {
        // Conjugate gradients belong to time steps, which need no sensitivities.
        let _ = self.linear.solve(self.cloth.pattern(), columns);
    }

    /// Derivative of the clips' forces ([`Solver::clip_forces`]) with respect to the unknowns, N/m: 3 × clips rows.
    /// Empty before the first solve.
    pub fn border(&self) -> &[f64] {
        let start = self.cloth.entries();
        self.values.get(start..self.values.len().saturating_sub(1)).unwrap_or_default()
    }

    /// The force that holds each clip at the last solve's state, N, apart from the clip's own weight.
    pub fn clip_forces(&self) -> Vec<Vector3<f64>> {
        self.cloth.clip_forces(&self.gradient)
    }

    /// The gradient at the last solve's state, N, 3 a node.
    pub fn gradient(&self) -> &[f64] {
        &self.gradient
    }

    /// A solve whose first matrix uses the strains in `mixed`, if there are any.
    fn settle(&mut self, curves: &Curves, x: &mut [f64], settings: &Settings) -> Equilibrium {
        let (before, remedies) = (self.linear.factorisations(), self.remedies);
        let mut found = self.minimise(curves, x, settings);
        for _ in 0..ESCAPES {
            let unstable = found.status == Status::Unstable;
            if !(settings.escape && unstable && self.leave(curves, x, settings, &mut found)) {
                break;
            }
            self.remedies.escapes += 1;
        }
        let (factorisations, remedies) = (self.linear.factorisations() - before, self.remedies - remedies);
        Equilibrium { factorisations, remedies, ..found }
    }

    /// A balanced state downhill, stable or not.
    fn minimise(&mut self, curves: &Curves, x: &mut [f64], settings: &Settings) -> Equilibrium {
        let (before, remedies) = (self.linear.factorisations(), self.remedies);
        let mut iterations = 0;
        self.damping = 0.0;
        self.clamped = 0;
        let mut energy = self.evaluate(curves, x);
        // An angle at a collapsed wing has a finite energy and forces that are not, on held nodes only if all are held.
        let finite = energy.is_finite()
            && self.gradient.iter().all(|force| force.is_finite())
            && self.cloth.norm(&self.gradient).is_finite();
        let mut status = if finite { Status::Stalled } else { Status::NotFinite };
        if status == Status::Stalled && settings.method == Method::MixedNewton {
            status = self.mixed_newton(curves, x, settings, &mut energy, &mut iterations);
        }
        if status == Status::Stalled {
            self.remedies.levenberg_marquardt += usize::from(settings.method == Method::MixedNewton);
            status = self.levenberg_marquardt(curves, x, settings, &mut energy, &mut iterations);
        }
        match settings.method {
            _ if status == Status::NotFinite => (),
            // A time step is no place to rest in: whether it is stable does not matter.
            _ if self.increment.is_some() => (),
            Method::LevenbergMarquardt => self.factorise_damped(curves, x),
            Method::MixedNewton => {
                let stable = self.factorise_true_hessian(curves, x);
                if status == Status::Converged && !stable {
                    status = Status::Unstable;
                }
            }
        }
        let (imbalance, tolerance, limit) = self.balance(x, settings);
        let factorisations = self.linear.factorisations() - before;
        let remedies = self.remedies - remedies;
        let escaped = false;
        Equilibrium {
            status,
            escaped,
            limit,
            energy,
            imbalance,
            tolerance,
            iterations,
            factorisations,
            remedies,
        }
    }

    /// Gradient and factor at a state that the last minimisation did not end in.
    fn refresh(&mut self, curves: &Curves, x: &[f64]) {
        self.evaluate(curves, x);
        self.factorise_true_hessian(curves, x);
    }

    /// The imbalance, what it must come below, and by which limit.
    ///
    /// Rounding: coordinates are known to an ulp, and an error δ of position is an error K δ of force; forces sum with
    /// errors of an ulp of their own. A hundred of both are allowed for.
    fn balance(&mut self, x: &[f64], settings: &Settings) -> (f64, f64, Limit) {
        let cloth = self.cloth;
        let size = x.iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
        let (mut typical, mut last) = (0.0, usize::MAX);
        // Nodes that move alike balance as one, whose errors are those of all.
        self.forces.fill(0.0);
        for &(coordinate, unknown) in cloth.free_coordinates() {
            let node = coordinate / 3;
            self.forces[unknown] += self.scale.stiffness[node] * size + self.scale.magnitude[node];
            if node != last {
                typical += self.scale.magnitude[node].max(cloth.weight(node));
                last = node;
            }
        }
        let mut rounding = 100.0 * f64::EPSILON * self.forces.iter().fold(0.0, |a: f64, &b| a.max(b));
        cloth.collect(&self.gradient, &mut self.forces);
        let moving = self.forces.chunks_exact(if cloth.is_planar() { 2 } else { 3 });
        let nodes = moving.len() as f64;
        let squares = moving.map(|force| force.iter().map(|f| f * f).sum::<f64>());
        let (largest, total) = squares.fold((0.0f64, 0.0), |(largest, total), s| (largest.max(s), total + s));
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

    fn is_balanced(&mut self, x: &[f64], settings: &Settings) -> bool {
        let (imbalance, tolerance, _) = self.balance(x, settings);
        imbalance <= tolerance
    }

    /// True if the state is stable: no stiffness is negative, or zero up to rounding.
    fn factorise_true_hessian(&mut self, curves: &Curves, x: &[f64]) -> bool {
        self.assemble(curves, x, Curvature::Full);
        let stable = self.factorise(-SINGULAR * self.mean_diagonal());
        if !stable {
            self.factorise_shifted();
        }
        stable
    }

    /// Adds μ to the diagonal, ten times more each time, until the matrix is positive definite.
    fn factorise_shifted(&mut self) -> bool {
        shifts(self.mean_diagonal()).any(|shift| self.factorise(shift))
    }

    /// Never zero: a cloth without any stiffness still gets a factor.
    fn mean_diagonal(&self) -> f64 {
        let diagonal = self.cloth.diagonal();
        let sum: f64 = diagonal.iter().map(|&place| self.values[place].abs()).sum();
        (sum / diagonal.len().max(1) as f64).max(f64::MIN_POSITIVE.sqrt())
    }

    /// Factorises the assembled matrix + μI.
    fn factorise(&mut self, shift: f64) -> bool {
        let diagonal = self.cloth.diagonal();
        diagonal.iter().for_each(|&place| self.values[place] += shift);
        let made = self.linear.prepare(self.cloth.pattern(), &self.values[..self.cloth.entries()]);
        diagonal.iter().for_each(|&place| self.values[place] -= shift);
        self.shift = shift;
        made.is_ok()
    }

    /// d = −(K + μI)⁻¹ g of the assembled matrix; `None` where that is not positive definite.
    fn direction_of(&mut self, shift: f64) -> Option<f64> {
        if self.factorise(shift) { self.direction() } else { None }
    }

    /// d = −K⁻¹ g into `step`; returns g·d. `None` where conjugate gradients find K not positive definite.
    fn direction(&mut self) -> Option<f64> {
        self.cloth.collect(&self.gradient, &mut self.reduced);
        self.reduced.iter_mut().for_each(|force| *force = -*force);
        if !self.solve_reduced() {
            return None;
        }
        self.step.fill(0.0);
        self.cloth.spread(&self.reduced, &mut self.step);
        Some(self.gradient.iter().zip(&self.step).map(|(g, d)| g * d).sum())
    }

    fn solve_reduced(&mut self) -> bool {
        self.linear.solve(self.cloth.pattern(), &mut self.reduced).is_ok()
    }

    fn is_direct(&self) -> bool {
        matches!(self.linear, Linear::Direct(_))
    }

    /// Total energy, with what a time step adds.
    fn energy(&mut self, curves: &Curves, x: &[f64]) -> f64 {
        let added = self.increment.as_mut().map_or(0.0, |increment| increment.energy(self.cloth, x));
        self.cloth.energy(curves, x) + added
    }

    /// The same and its gradient.
    fn evaluate(&mut self, curves: &Curves, x: &[f64]) -> f64 {
        let energy = self.cloth.gradient(curves, x, &mut self.gradient, &mut self.scale);
        let (gradient, scale) = (&mut self.gradient, &mut self.scale);
        energy
            + self.increment.as_mut().map_or(0.0, |added| added.add_gradient(self.cloth, x, gradient, scale))
    }

    /// The Hessian, with what a time step adds.
    fn assemble(&mut self, curves: &Curves, x: &[f64], curvature: Curvature<'_>) {
        self.cloth.hessian(curves, x, curvature, &mut self.values);
        if let Some(increment) = &self.increment {
            increment.add_hessian(self.cloth, &mut self.values);
        }
    }

    /// The same with the geometric part at the strains that the last step predicted, if there was one.
    fn assemble_mixed(&mut self, curves: &Curves, x: &[f64]) {
        let mixed = std::mem::take(&mut self.mixed);
        let curvature =
            if mixed.is_empty() || self.careful { Curvature::Full } else { Curvature::Mixed(&mixed) };
        self.assemble(curves, x, curvature);
        self.mixed = mixed;
    }

    /// Energy after a share of the step; the state and its gradient stay in `trial`.
    fn try_step(&mut self, curves: &Curves, x: &[f64], length: f64) -> f64 {
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

    /// Takes the trial; the strains that the step predicted are kept for the next matrix.
    fn accept(&mut self, x: &mut [f64], energy: f64) -> f64 {
        self.cloth.predicted_strains(x, &self.step, &mut self.mixed);
        x.copy_from_slice(&self.trial);
        std::mem::swap(&mut self.gradient, &mut self.trial_gradient);
        std::mem::swap(&mut self.scale, &mut self.trial_scale);
        energy
    }
}

/// Shifts μ from a billionth of the mean of a diagonal up, ten times more each.
fn shifts(mean: f64) -> impl Iterator<Item = f64> {
    (0..16).map(move |power| mean * 1e-9 * 10f64.powi(power))
}
