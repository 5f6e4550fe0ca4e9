//! One run: what was tried, how far off it was, and what it has cost.

use crate::solver::Solver;
use crate::spent::Spent;
use cloth_sim::equilibrium::Tolerance;
use cloth_sim::material::Model;

/// What a run belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// One equilibrium of a scene.
    Equilibrium,
    /// A fit of all curves.
    Fit,
    /// One stage of a fit.
    Stage,
    /// A stage fitted to data with a known amount of noise.
    Noise,
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Equilibrium => "equilibrium",
            Self::Fit => "fit",
            Self::Stage => "stage",
            Self::Noise => "noise",
        })
    }
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Ending {
    /// As it should.
    Converged,
    /// As it should, but an unstable state was met and left: another shape may be as good.
    SeveralEquilibria,
    /// Otherwise; why.
    Failed(String),
}

impl std::fmt::Display for Ending {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Converged => "converged",
            Self::SeveralEquilibria => "several equilibria",
            Self::Failed(why) => why,
        })
    }
}

/// One row of `study.csv`. Errors are `None` where there is nothing to compare.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// What it belongs to.
    pub part: Part,
    /// The scene; or the stage of a fit, `all` for the whole.
    pub test: String,
    /// The cloth model.
    pub model: Model,
    /// How it was solved.
    pub solver: Solver,
    /// Nodes a side.
    pub nodes: usize,
    /// Most control points of a curve; `None` where nothing was fitted.
    pub points: Option<usize>,
    /// Frames that were simulated or fitted.
    pub frames: usize,
    /// Noise, as a multiple of the instruments'; `None` if there is none, or that of the set.
    pub noise: Option<f64>,
    /// When an equilibrium counted as found.
    pub tolerance: Tolerance,
    /// Seed of the noise.
    pub seed: Option<u64>,
    /// Largest error of a clip force (fits: root mean square residual), over the largest force.
    pub error_force: Option<f64>,
    /// Root mean square error of the nodes' places (fits: residual), mm.
    pub error_position_mm: Option<f64>,
    /// Root mean square error of the stress or moment over the visited range, over the largest there.
    pub error_curve: Option<f64>,
    /// The least that error can be with this noise, as the Cramér–Rao bound has it.
    pub floor: Option<f64>,
    /// What it has cost.
    pub spent: Spent,
    /// Order of convergence in the mesh size, of the places, from this mesh and the two before it.
    pub order: Option<f64>,
    /// How it ended.
    pub ending: Ending,
}

impl Run {
    /// A run that has cost nothing yet.
    pub(crate) fn new(part: Part, test: &str, model: Model, solver: Solver, nodes: usize) -> Self {
        Self {
            part,
            test: test.into(),
            model,
            solver,
            nodes,
            points: None,
            frames: 0,
            noise: None,
            tolerance: solver.equilibrium().tolerance,
            seed: None,
            error_force: None,
            error_position_mm: None,
            error_curve: None,
            floor: None,
            spent: Spent::default(),
            order: None,
            ending: Ending::Converged,
        }
    }

    /// It came to nothing, or not to its end.
    pub fn failed(&self) -> bool {
        matches!(self.ending, Ending::Failed(_))
    }
}
