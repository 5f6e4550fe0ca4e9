//! A fit with a fixed number of control points.

use crate::optimise::gauss_newton::Iteration;
use serde::{Deserialize, Serialize};

/// A fit with a fixed number of control points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// Control points.
    pub points: usize,
    /// Root mean square residual, N or m.
    pub rms: f64,
    /// Status at the end.
    pub status: String,
    /// Its iterations.
    pub iterations: Vec<Iteration>,
    /// Starts that violated a constraint of the curve and were moved to the nearest feasible point.
    pub projected: usize,
}

impl Level {
    /// The residual after every step tried, N or m, from the sums of squares relative to the final one.
    pub fn course(&self) -> impl Iterator<Item = f64> + '_ {
        let last = self.iterations.last().map_or(1.0, |step| step.sum_of_squares);
        let share = move |squares: f64| if last > 0.0 { (squares / last).sqrt() } else { 1.0 };
        self.iterations.iter().map(move |step| self.rms * share(step.sum_of_squares))
    }

    /// Adds a later fit with the same number of control points.
    pub(crate) fn go_on(&mut self, later: &Self) {
        let done = self.iterations.len();
        let numbered = |step: &Iteration| Iteration { iteration: done + step.iteration, ..step.clone() };
        self.iterations.extend(later.iterations.iter().map(numbered));
        self.projected += later.projected;
        self.rms = later.rms;
        self.status.clone_from(&later.status);
    }
}
