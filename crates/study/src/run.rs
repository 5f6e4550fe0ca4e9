//! One run: its parameters, error and cost.

use crate::solver::Solver;
use crate::spent::Spent;
use cloth_sim::equilibrium::Tolerance;
use cloth_sim::material::Model;

/// Kind of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// One equilibrium of a scene.
    Equilibrium,
    /// A fit of all curves.
    Fit,
    /// One stage of a fit.
    Stage,
    /// A stage fitted to data with known noise.
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

/// Ending of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Ending {
    /// Converged.
    Converged,
    /// Converged, but an unstable state was met and left: another shape may be equally valid.
    SeveralEquilibria,
    /// Failed, with the reason.
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

/// One row of `study.csv`. Errors are `None` if there is no reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Kind of the run.
    pub part: Part,
    /// Scene, or stage of a fit; `all` for the whole fit.
    pub test: String,
    /// The cloth model.
    pub model: Model,
    /// Solver.
    pub solver: Solver,
    /// Nodes per side.
    pub nodes: usize,
    /// Maximum number of control points of a curve; `None` if nothing was fitted.
    pub points: Option<usize>,
    /// Number of frames simulated or fitted.
    pub frames: usize,
    /// Noise, as a multiple of the instruments'; `None` without noise, or with that of the set.
    pub noise: Option<f64>,
    /// Criterion for equilibrium.
    pub tolerance: Tolerance,
    /// Seed of the noise.
    pub seed: Option<u64>,
    /// Largest error of a clip force (fits: root mean square residual), over the largest force.
    pub error_force: Option<f64>,
    /// Root mean square error of the nodal positions (fits: residual), mm.
    pub error_position_mm: Option<f64>,
    /// Root mean square error of stress or moment over the visited range, over the largest value there.
    pub error_curve: Option<f64>,
    /// Cramér–Rao bound: the least value of `error_curve` with this noise.
    pub floor: Option<f64>,
    /// Cost of the run.
    pub spent: Spent,
    /// Order of convergence of the positions in the mesh size, from this mesh and the two before it.
    pub order: Option<f64>,
    /// Ending of the run.
    pub ending: Ending,
}

impl Run {
    /// A run without cost yet.
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

    /// True if the run failed.
    pub fn failed(&self) -> bool {
        matches!(self.ending, Ending::Failed(_))
    }
}
