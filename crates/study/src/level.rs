//! Fits at one noise level, averaged over their seeds.

use crate::mean::root_mean_square;
use crate::run::{Part, Run};
use crate::study::Study;

/// All seeds of one noise level.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Curve and mesh.
    pub test: String,
    /// Multiple of the instruments' noise.
    pub noise: f64,
    /// Number of seeds with converged fits.
    pub seeds: usize,
    /// Number of seeds whose fits did not converge.
    pub failed: usize,
    /// Root mean square of their curve errors.
    pub error: f64,
    /// The Cramér–Rao bound.
    pub floor: Option<f64>,
}

/// Averages the fits to noise over their seeds.
pub fn levels(study: &Study) -> Vec<Level> {
    let mut levels: Vec<Level> = Vec::new();
    let runs: Vec<&Run> = study.part(Part::Noise).collect();
    for group in runs.chunk_by(|a, b| a.test == b.test && a.noise == b.noise) {
        let done = group.iter().filter(|run| !run.failed() && run.error_curve.is_some());
        let seeds = done.clone().count();
        levels.extend(root_mean_square(done.filter_map(|run| run.error_curve)).map(|error| Level {
            test: group[0].test.clone(),
            noise: group[0].noise.unwrap_or(0.0),
            seeds,
            failed: group.len() - seeds,
            error,
            floor: group[0].floor,
        }));
    }
    levels
}
