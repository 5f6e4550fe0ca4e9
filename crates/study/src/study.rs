//! A whole study: execution and results.

use crate::ablation::{self, Ablated};
use crate::extent::{Extent, Topic};
use crate::progress::Progress;
use crate::run::{Part, Run};
use crate::solver::Solver;
use crate::subject::Subject;
use crate::{equilibria, fits, noise};
use cloth_data::error::Result;

/// Results of a study.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// The fabric whose set was fitted.
    pub fabric: String,
    /// Description of the reference for curve errors.
    pub reference: String,
    /// One row per run.
    pub runs: Vec<Run>,
    /// One row per part and scene.
    pub ablation: Vec<Ablated>,
}

impl Study {
    /// Nodes per side of the finest grid on which both solvers ran fits, or else the default solver.
    pub fn finest_fit(&self) -> Option<usize> {
        let of = |solver| self.part(Part::Fit).filter(move |run| run.solver == solver).map(|run| run.nodes);
        let both = of(Solver::AsPublished).filter(|nodes| of(Solver::Default).any(|other| other == *nodes));
        both.max().or(of(Solver::Default).max())
    }

    /// Rows of one kind.
    pub fn part(&self, part: Part) -> impl Iterator<Item = &Run> {
        self.runs.iter().filter(move |run| run.part == part)
    }
}

/// Runs a whole study.
///
/// # Errors
/// A set for which even the reference fit fails; scenes that the rig cannot build.
pub fn run(subject: &Subject, extent: &Extent, progress: &dyn Progress) -> Result<Study> {
    let fabric = &subject.fabric;
    let (mut runs, mut ablation, mut told) = (Vec::new(), Vec::new(), String::new());
    if extent.has(Topic::Equilibria) {
        runs.extend(equilibria::runs(fabric, extent, progress)?);
    }
    if extent.has(Topic::Noise) {
        runs.extend(noise::runs(fabric, extent, progress)?);
    }
    if extent.has(Topic::Ablation) {
        ablation.extend(ablation::of_scenes(fabric, extent, progress)?);
    }
    if extent.has(Topic::Fits) {
        let reference;
        (reference, told) = fits::reference(subject, extent, progress)?;
        let fits = fits::runs(subject, &reference, extent, progress);
        runs.extend(fits.iter().flat_map(|fit| fit.rows.iter().cloned()));
        if extent.has(Topic::Ablation) {
            ablation.extend(ablation::of_fits(subject, &reference, &fits, extent, progress));
        }
    }
    Ok(Study { fabric: subject.set.fabric.name.clone(), reference: told, runs, ablation })
}
