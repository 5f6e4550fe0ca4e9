//! Deferred correction of the grid's error: what a finer grid changes in the simulated values, extrapolated.
//!
//! ```text
//! y_h = y + C h² + …      y − y_h = (y_h' − y_h)/(1 − (h'/h)²)      y: continuum, h: cell, h' of the finer grid
//! ```
//!
//! The sum is added to what is simulated on the working grid, and the fit goes on. Source: Fox 1947; Pereyra 1966.

use super::frames::Equilibria;
use super::state::State;
use crate::twin::replica::{MeasuredPoint, Replica, ReplicaFrame};
use cloth_sim::equilibrium::{Solver, Status};
use rayon::prelude::*;
use std::sync::Arc;

impl<'a> Equilibria<'a> {
    /// Corrects by replicas of the same sequences on finer grids.
    pub fn corrected_by(mut self, finer: &'a [Replica]) -> Self {
        self.finer = finer;
        self
    }

    /// True if simulated values are corrected for the grid's error.
    pub fn is_corrected(&self) -> bool {
        !self.finer.is_empty()
    }

    /// Renews the correction under the present curves. A frame without an equilibrium on the finer grid keeps what it
    /// has.
    pub fn correct(&mut self) {
        if !self.is_corrected() {
            return;
        }
        let curves = self.curves();
        let correction = |(&(index, place), state): (&(usize, usize), &State)| -> Option<Vec<f64>> {
            let replica = &self.replicas[index];
            let frame = &replica.frames[place];
            let finer = self.finer.iter().find(|finer| finer.name == replica.name)?;
            let fine = finer.frames.iter().find(|fine| fine.index == frame.index)?;
            let [coarse_overhang, fine_overhang] = [frame.overhang.as_ref()?, fine.overhang.as_ref()?];
            let simulate = |replica: &Replica, frame: &ReplicaFrame, mut x: Vec<f64>| {
                let mut solver = Solver::new(replica.cloth(frame));
                let found = solver.solve(&curves, &mut x, &self.task.settings);
                self.meter.add(&found);
                // The pose moves both grids alike.
                let shape = |point: &MeasuredPoint| -> Vec<f64> {
                    frame.compared_axes().iter().map(|&axis| point.coordinate(&x, axis)).collect()
                };
                (found.status == Status::Converged)
                    .then(|| frame.points.iter().flat_map(shape).collect::<Vec<_>>())
            };
            let edge = state.edge?;
            let mut x = state.x.clone();
            coarse_overhang.hold(edge.slope, &mut x);
            let mut fine_x = fine_overhang.of(coarse_overhang, &x);
            fine_overhang.hold(edge.slope, &mut fine_x);
            let coarse = simulate(replica, frame, x)?;
            let fine = simulate(finer, fine, fine_x)?;
            let ratio = fine_overhang.grid.cell()[0] / coarse_overhang.grid.cell()[0];
            let extrapolated = 1.0 / (1.0 - ratio * ratio);
            let axes = frame.compared_axes().len();
            let of_point: Vec<f64> =
                coarse.iter().zip(&fine).map(|(coarse, fine)| extrapolated * (fine - coarse)).collect();
            Some(match (&frame.merging, self.task.robust) {
                (Some(merging), None) => {
                    let value = |point: usize, axis: usize| of_point[axes * point + axis / 2];
                    merging.of(&frame.points, value).0.into_flattened()
                }
                _ => of_point,
            })
        };
        let corrections: Vec<Option<Vec<f64>>> =
            self.frames.par_iter().zip(&self.states).map(correction).collect();
        for (state, correction) in self.states.iter_mut().zip(corrections) {
            correction.into_iter().for_each(|correction| state.correction = Arc::new(correction));
        }
    }
}
