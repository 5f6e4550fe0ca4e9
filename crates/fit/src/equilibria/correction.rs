//! Deferred correction of the grid's error: what a finer grid changes in the simulated values, extrapolated.
//!
//! ```text
//! y_h = y + C hᵖ + …      y − y_h = (y_h' − y_h)/(1 − (h'/h)ᵖ)      y: continuum, h: cell, h' of the finer grid
//! ```
//!
//! p = 2, and 1 where a clip ends within a side: strains grow like r^(−1/2) at its end (Strang and Fix 1973, 8.1).
//!
//! The sum is added to what is simulated on the working grid, and the fit goes on. Between clips a few frames of a
//! sequence are corrected, the others by their extension in between. Source: Fox 1947; Pereyra 1966.
//!
//! Off a table the correction is that of a smooth curve. A zigzag that the shapes hardly show changes the correction as much
//! as them: corrected under itself it would stay (seen with nine points 16 1/m apart: ±5 % of the stiffness).

use super::frames::Equilibria;
use super::observation::{Objective, Observation};
use super::state::{Correction, State};
use crate::twin::replica::{MeasuredPoint, Replica, ReplicaFrame, Term, lagrange};
use cloth_sim::equilibrium::{Solver, Status, Tolerance};
use cloth_sim::material::Curves;
use cloth_sim::mesh::Grid;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::sync::Arc;

/// Frames of a sequence between clips that are corrected.
const SAMPLES: usize = 4;

/// A finer equilibrium is another one if a node lies farther from the coarser one than this share of a cell.
const OTHER_SHAPE: f64 = 0.5;

/// Share of the correction that may be left. An overhang errs by O(h²), and the next order is a small part. At the ends of
/// clips the order is uncertain: 1.3 times what half the cells changed, or 1.6 times where order 1 corrects twice that.
const LEFT_OFF_A_TABLE: f64 = 0.25;
const LEFT_BETWEEN_CLIPS: [f64; 2] = [0.8, 1.0];

/// Tolerance of equilibria whose forces are compared: their difference is a hundredth of these. Shapes need the full one.
const OF_FORCES: Tolerance = Tolerance::Relative(1e-5);

/// The correction of one frame between clips.
struct Corrected {
    /// Index among all frames.
    place: usize,
    /// Of the forces, N.
    forces: Vec<f64>,
    /// Of the points' coordinates, m.
    points: Vec<f64>,
    /// The finer equilibrium, and what of it was interpolated.
    finer: [Vec<f64>; 2],
}

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
        let corrections: Vec<Option<Correction>> = match self.task.objective {
            Objective::Positions => {
                let smooth = self.unknowns.smooth().beside(&self.task.known);
                let frames = self.frames.par_iter().zip(&self.states);
                frames
                    .map(|(&(index, place), state)| self.of_overhang(&smooth, index, place, state))
                    .collect()
            }
            Objective::Forces => {
                let samples = self.samples().into_par_iter();
                let corrected: Vec<Corrected> =
                    samples.filter_map(|place| self.of_clips(&curves, place)).collect();
                let places = 0..self.frames.len();
                let corrections = places.map(|place| self.between(&corrected, place)).collect();
                for Corrected { place, finer, .. } in corrected {
                    self.states[place].finer = Some(Arc::new(finer));
                }
                corrections
            }
        };
        for (state, correction) in self.states.iter_mut().zip(corrections) {
            correction.into_iter().for_each(|correction| state.correction = Arc::new(correction));
        }
    }

    /// The error of the grid that may be left in all residuals, in their units, without the errors of the clips' poses; zero
    /// where nothing was corrected.
    pub fn left_of_grid(&self) -> DVector<f64> {
        let mut all = Vec::new();
        for (&(index, place), state) in self.frames.iter().zip(&self.states) {
            let replica = &self.replicas[index];
            let observations = self.observations(&replica.frames[place]);
            let value = |(row, observation): (usize, &Observation)| {
                state.correction.values.get(row).unwrap_or(&0.0) / (observation.spread * self.scale(replica))
            };
            let values = observations.iter().enumerate().map(value);
            let mut own = DMatrix::from_iterator(observations.len(), 1, values);
            if let Some(through_poses) = &state.grid_through_poses {
                own += through_poses;
            }
            let left = match self.task.objective {
                Objective::Positions => LEFT_OFF_A_TABLE,
                Objective::Forces => LEFT_BETWEEN_CLIPS[usize::from(replica.grid_order == 2)],
            };
            all.extend_from_slice(state.without_clips(left * own).as_slice());
        }
        DVector::from_vec(all)
    }

    /// The same frame on the finer grid.
    fn finer(&self, replica: &Replica, frame: &ReplicaFrame) -> Option<(&'a Replica, &'a ReplicaFrame)> {
        let finer = self.finer.iter().find(|finer| finer.name == replica.name)?;
        Some((finer, finer.frames.iter().find(|fine| fine.index == frame.index)?))
    }

    /// Correction of the positions in a frame off a table.
    fn of_overhang(&self, curves: &Curves, index: usize, place: usize, state: &State) -> Option<Correction> {
        let replica = &self.replicas[index];
        let frame = &replica.frames[place];
        let (finer, fine) = self.finer(replica, frame)?;
        let [coarse_overhang, fine_overhang] = [frame.overhang.as_ref()?, fine.overhang.as_ref()?];
        let edge = state.edge?;
        let mut x = state.x.clone();
        coarse_overhang.hold(edge.slope, &mut x);
        let mut fine_x = fine_overhang.of(coarse_overhang, &x);
        fine_overhang.hold(edge.slope, &mut fine_x);
        self.balanced(curves, replica, frame, &mut x)?;
        self.balanced(curves, finer, fine, &mut fine_x)?;
        // The pose moves both grids alike.
        let [coarse, fine] = [(frame, &x), (fine, &fine_x)].map(|(frame, x)| -> Vec<f64> {
            let shape = |point: &MeasuredPoint| {
                frame.compared_axes().iter().map(|&axis| point.coordinate(x, axis)).collect::<Vec<_>>()
            };
            frame.points.iter().flat_map(shape).collect()
        });
        let ratio = fine_overhang.grid.cell()[0] / coarse_overhang.grid.cell()[0];
        let axes = frame.compared_axes().len();
        let points = extrapolated(&coarse, &fine, ratio, replica.grid_order);
        let values = match (&frame.merging, self.task.robust) {
            (Some(merging), None) => {
                let value = |point: usize, axis: usize| points[axes * point + axis / 2];
                merging.of(value).0.into_flattened()
            }
            _ => points.clone(),
        };
        Some(Correction { values, points })
    }

    /// Brings a frame to a stable equilibrium; returns its forces along the measured components, N.
    fn balanced(
        &self,
        curves: &Curves,
        replica: &Replica,
        frame: &ReplicaFrame,
        x: &mut [f64],
    ) -> Option<Vec<f64>> {
        let mut solver = Solver::new(replica.cloth(frame));
        let mut settings = self.task.settings;
        if self.task.objective == Objective::Forces {
            settings.tolerance = OF_FORCES;
        }
        let found = solver.solve(curves, x, &settings);
        self.meter.add(&found);
        let clip_forces = solver.clip_forces();
        let stable = found.status == Status::Converged && !found.escaped;
        stable.then(|| frame.forces.iter().map(|component| component.of(&clip_forces)).collect())
    }

    /// Number of frames that no finer grid has corrected, if any should be.
    pub fn uncorrected(&self) -> usize {
        let refined = |index: usize| self.finer.iter().any(|finer| finer.name == self.replicas[index].name);
        let frames = self.frames.iter().zip(&self.states);
        frames.filter(|((index, _), state)| refined(*index) && state.correction.values.is_empty()).count()
    }

    fn extension(&self, place: usize) -> f64 {
        let (index, frame) = self.frames[place];
        self.replicas[index].frames[frame].extension
    }

    /// Sum of squares of a frame's measured forces, N².
    fn load(&self, place: usize) -> f64 {
        let (index, frame) = self.frames[place];
        self.replicas[index].frames[frame].forces.iter().map(|component| component.force.powi(2)).sum()
    }

    /// The frames between clips that are corrected: a few of every sequence, from the smallest extension to the largest.
    fn samples(&self) -> Vec<usize> {
        let mut of_replica: Vec<Vec<usize>> = vec![Vec::new(); self.replicas.len()];
        self.frames.iter().enumerate().for_each(|(place, &(index, _))| of_replica[index].push(place));
        for places in &mut of_replica {
            // Loaded and unloaded again, two frames have one extension: of these the less loaded first, in any order of frames.
            places.sort_by(|&a, &b| {
                let by_extension = self.extension(a).total_cmp(&self.extension(b));
                by_extension.then_with(|| self.load(a).total_cmp(&self.load(b)))
            });
        }
        of_replica.iter().flat_map(|places| spread(places, SAMPLES)).collect()
    }

    /// Correction of a frame from those of its sequence.
    fn between(&self, corrected: &[Corrected], place: usize) -> Option<Correction> {
        let own = corrected.iter().filter(|other| self.frames[other.place].0 == self.frames[place].0);
        let known = |of: fn(&Corrected) -> &Vec<f64>| -> Vec<(f64, &Vec<f64>)> {
            own.clone().map(|other| (self.extension(other.place), of(other))).collect()
        };
        let values = between(&known(|corrected| &corrected.forces), self.extension(place))?;
        let points = between(&known(|corrected| &corrected.points), self.extension(place));
        Some(Correction { values, points: points.unwrap_or_default() })
    }

    /// Correction of one frame between clips.
    fn of_clips(&self, curves: &Curves, place: usize) -> Option<Corrected> {
        let (index, frame) = self.frames[place];
        let replica = &self.replicas[index];
        let frame = &replica.frames[frame];
        let (finer, fine) = self.finer(replica, frame)?;
        let mut x = self.states[place].x.clone();
        let coarse = self.balanced(curves, replica, frame, &mut x)?;
        let mut started = interpolated(replica, finer, fine, &x);
        finer.hold(fine, None, &self.states[place].clips, &mut started);
        // From the last finer shape, moved as the coarse one has moved since.
        let mut fine_x = match self.states[place].finer.as_deref() {
            Some([last, from]) => {
                last.iter().zip(from).zip(&started).map(|((last, from), now)| last + (now - from)).collect()
            }
            None => started.clone(),
        };
        let fine_forces = self.balanced(curves, finer, fine, &mut fine_x)?;
        let [dx, dy] = replica.specimen.grid.cell();
        let apart = fine_x.iter().zip(&started).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        if apart > OTHER_SHAPE * dx.min(dy) || fine_forces.len() != coarse.len() {
            return None;
        }
        let [ratio_x, ratio_y] = [0, 1].map(|axis| finer.specimen.grid.cell()[axis] / [dx, dy][axis]);
        let ratio = ratio_x.max(ratio_y);
        let order = replica.grid_order;
        let forces = extrapolated(&coarse, &fine_forces, ratio, order);
        let of_points = |shape: &dyn Fn(&Term, usize) -> f64| -> Vec<f64> {
            let coordinate = |point: &MeasuredPoint, axis: usize| {
                point.terms.iter().map(|term| term.weight * shape(term, axis)).sum()
            };
            let axes = frame.compared_axes();
            frame
                .points
                .iter()
                .flat_map(|point| axes.iter().map(move |&axis| coordinate(point, axis)))
                .collect()
        };
        let coarse = of_points(&|term, axis| x[3 * term.node + axis]);
        let [grid, fine_grid] = [&replica.specimen.grid, &finer.specimen.grid];
        let fine =
            of_points(&|term, axis| surface(fine_grid, &fine_x, place_of(grid, term.node, fine_grid), axis));
        Some(Corrected {
            place,
            forces,
            points: extrapolated(&coarse, &fine, ratio, order),
            finer: [fine_x, started],
        })
    }
}

/// (y_h' − y_h)/(1 − (h'/h)ᵖ).
fn extrapolated(coarse: &[f64], fine: &[f64], ratio: f64, order: i32) -> Vec<f64> {
    let share = 1.0 / (1.0 - ratio.powi(order));
    coarse.iter().zip(fine).map(|(coarse, fine)| share * (fine - coarse)).collect()
}

/// A few of a list, evenly, with its ends.
fn spread(list: &[usize], few: usize) -> Vec<usize> {
    let last = list.len().saturating_sub(1);
    if list.len() <= few {
        return list.to_vec();
    }
    (0..few).map(|i| list[(i * last + (few - 1) / 2) / (few - 1)]).collect()
}

/// Values at an extension, linearly between those at the known ones, which ascend; constant beyond.
fn between(known: &[(f64, &Vec<f64>)], extension: f64) -> Option<Vec<f64>> {
    let after = known.partition_point(|(at, _)| *at < extension);
    let high = known.get(after).or(known.last())?;
    let low = known[..after].last().unwrap_or(high);
    let share = if high.0 > low.0 { ((extension - low.0) / (high.0 - low.0)).clamp(0.0, 1.0) } else { 0.0 };
    (low.1.len() == high.1.len())
        .then(|| low.1.iter().zip(high.1).map(|(low, high)| low + share * (high - low)).collect())
}

/// A state on the finer grid, 3 stacked coordinates per node, m: held nodes in place, the others on a smooth surface
/// through the coarse ones, so that few steps lead to their balance.
fn interpolated(coarse: &Replica, finer: &Replica, fine: &ReplicaFrame, x: &[f64]) -> Vec<f64> {
    let [grid, fine_grid] = [&coarse.specimen.grid, &finer.specimen.grid];
    let cloth = finer.cloth(fine);
    let mut own = fine.start.clone();
    for node in 0..finer.specimen.mesh.positions.len() {
        let place = place_of(fine_grid, node, grid);
        for axis in (0..3).filter(|&axis| cloth.unknown(3 * node + axis).is_some()) {
            own[3 * node + axis] = surface(grid, x, place, axis);
        }
    }
    own
}

/// Place of a node on another grid of the same sheet, in its cells.
fn place_of(grid: &Grid, node: usize, other: &Grid) -> [f64; 2] {
    // After the corners come the centres of crossed cells.
    let columns = grid.columns;
    let [column, row] = match node.checked_sub(columns * grid.rows) {
        None => [(node % columns) as f64, (node / columns) as f64],
        Some(cell) => [(cell % (columns - 1)) as f64 + 0.5, (cell / (columns - 1)) as f64 + 0.5],
    };
    let cells = |nodes: usize| (nodes - 1) as f64;
    [column * cells(other.columns) / cells(columns), row * cells(other.rows) / cells(grid.rows)]
}

/// A coordinate of the smooth surface through a grid's corners, at a place in its cells.
fn surface(grid: &Grid, x: &[f64], [column, row]: [f64; 2], axis: usize) -> f64 {
    let of_columns = lagrange(column, grid.columns);
    let along = |row: usize| -> f64 {
        of_columns.iter().map(|&(column, weight)| weight * x[3 * grid.node(column, row) + axis]).sum()
    };
    lagrange(row, grid.rows).iter().map(|&(row, weight)| weight * along(row)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_frames_stand_for_all() {
        assert_eq!(spread(&[3, 1, 4, 1, 5, 9, 2, 6, 7], 5), [3, 4, 5, 2, 7]);
        assert_eq!(spread(&[3, 1], 5), [3, 1]);
        assert_eq!(spread(&[], 5), [0; 0]);
        let [a, b] = [vec![1.0, 0.0], vec![3.0, 4.0]];
        let known = [(1.0, &a), (2.0, &b)];
        for (extension, expected) in
            [(0.5, [1.0, 0.0]), (1.25, [1.5, 1.0]), (2.0, [3.0, 4.0]), (9.0, [3.0, 4.0])]
        {
            assert_eq!(between(&known, extension), Some(expected.to_vec()));
        }
        assert_eq!(between(&[], 1.0), None);
    }
}
