//! The residuals of a stage, in units of independent noise, and their derivatives.

use super::frames::Equilibria;
use super::observation::{Balance, Objective, Observation};
use crate::optimise::gauss_newton::{Evaluation, Residuals};
use crate::optimise::robust::Robust;
use crate::optimise::uncertainty::{CONTRADICTED, Covariance, NoiseSource, Scatter};
use crate::twin::replica::Replica;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::equilibrium::Status;
use cloth_sim::material::Component;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;
use std::convert::Infallible;

impl Equilibria<'_> {
    /// Indices of consecutive residuals: one force component of one clip through a sequence, or one coordinate of one
    /// node.
    fn tracks(&self) -> Vec<Vec<usize>> {
        let mut tracks: BTreeMap<(usize, usize, usize), Vec<usize>> = BTreeMap::new();
        let mut index = 0;
        for &(replica, frame) in &self.frames {
            let own = &self.replicas[replica];
            for observation in self.observations(&own.frames[frame]) {
                let [of, number] = observation.source(&own.frames[frame]);
                tracks.entry((replica, of, number)).or_default().push(index);
                index += 1;
            }
        }
        tracks.into_values().collect()
    }

    /// Derivative of all simulated values with respect to the control values of other curves, in the order of
    /// `groups`; rows and units as in an evaluation.
    ///
    /// * `groups` — components that share a curve, one group each
    pub fn sensitivity_to(&self, groups: &[Vec<Component>]) -> DMatrix<f64> {
        let curves = self.curves();
        let results = self.solve_frames(&curves, groups, None);
        let columns: usize =
            groups.iter().map(|group| curves.get(group[0]).map_or(0, StiffnessCurve::len)).sum();
        let mut values = Vec::new();
        for result in &results {
            values.extend(result.rows.columns(1, columns).transpose().iter());
        }
        DMatrix::from_row_slice(values.len() / columns.max(1), columns, &values)
    }

    pub(super) fn noise(&self, replica: &Replica) -> Option<f64> {
        self.task.objective.noise(replica)
    }

    /// The unit that divides a replica's residuals.
    pub(super) fn scale(&self, replica: &Replica) -> f64 {
        self.noise(replica).filter(|_| self.noise_is_known()).unwrap_or(1.0)
    }

    pub(super) fn typical_residual(&self) -> f64 {
        let results = self.solve_frames(&self.curves(), &[], None);
        let mut sizes: Vec<f64> = Vec::new();
        // A frame without an equilibrium has no residuals.
        for result in results.iter().filter(|result| result.status == Status::Converged) {
            sizes.extend(result.rows.iter().map(|residual| residual.abs()));
        }
        sizes.sort_by(f64::total_cmp);
        sizes.get(sizes.len() / 2).map_or(0.0, |median| 1.4826 * median)
    }

    /// Residuals of some observations, in units of independent noise, with their derivatives by the control values in
    /// further columns; and their derivatives by the frame's own unknowns.
    ///
    /// * `unit` — divides the residuals: the instrument's noise, or 1
    /// * `correction` — error of the grid in each simulated value, or empty
    pub(super) fn rows(
        &self,
        unit: f64,
        observations: &[Observation],
        balance: &Balance<'_>,
        values: usize,
        correction: &[f64],
    ) -> (DMatrix<f64>, DMatrix<f64>) {
        let owned = balance.owned();
        let mut rows = DMatrix::zeros(observations.len(), values + 1);
        let mut own = DMatrix::zeros(observations.len(), owned);
        let mut derivatives = vec![0.0; values + owned];
        for (i, observation) in observations.iter().enumerate() {
            let scale = observation.spread * unit;
            let simulated = observation.simulated(balance) + correction.get(i).unwrap_or(&0.0);
            let residual = (observation.measured - simulated) / scale;
            let (bent, slope) = self.task.robust.map_or((residual, 1.0), |robust| robust.bend(residual));
            rows[(i, 0)] = bent;
            let (by_value, by_own) = derivatives.split_at_mut(values);
            observation.differentiate(balance, by_value, by_own);
            by_value.iter().enumerate().for_each(|(j, d)| rows[(i, j + 1)] = slope * d / scale);
            by_own.iter().enumerate().for_each(|(j, d)| own[(i, j)] = slope * d / scale);
        }
        (rows, own)
    }

    /// The same residuals as weighted ones, with the slopes of weighted least squares. On bent residuals Gauss–Newton steps
    /// to a pose would be twice too long where all points are far off, and never end.
    pub(super) fn weighted(&self, rows: &DMatrix<f64>, own: &DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
        let (mut rows, mut own) = (rows.clone(), own.clone());
        let Some(robust) = self.task.robust else { return (rows, own) };
        for i in 0..rows.nrows() {
            let share = robust.weighted(rows[(i, 0)]);
            let values = rows.ncols() - 1;
            rows.row_mut(i).columns_mut(1, values).scale_mut(share);
            own.row_mut(i).scale_mut(share);
            rows[(i, 0)] /= share;
        }
        (rows, own)
    }

    /// Sum of squares, in the units of the residuals, that no cylinder off a table meets, and its degrees of freedom; `None`
    /// without merged points.
    fn repeats(&self) -> Option<(f64, usize)> {
        if self.task.robust.is_some() || self.task.objective != Objective::Positions {
            return None;
        }
        let (mut squares, mut freedom) = (0.0, 0);
        for &(replica, frame) in &self.frames {
            let replica = &self.replicas[replica];
            let merging = replica.frames[frame].merging.as_ref()?;
            squares += merging.left / self.scale(replica).powi(2);
            freedom += merging.freedom;
        }
        (freedom > 0).then_some((squares, freedom))
    }

    /// Errors of all residuals by one standard deviation of each unknown of the clips' poses, beside what these poses
    /// were found to be.
    pub fn by_clip_poses(&self) -> Vec<DVector<f64>> {
        let all = self.measurements();
        let (mut first, mut errors) = (0, Vec::new());
        for (settled, state) in self.settled().zip(&self.states) {
            for column in state.without_clips(state.by_clips.clone()).column_iter() {
                let mut error = DVector::zeros(all);
                error.rows_mut(first, column.len()).copy_from(&column);
                errors.push(error);
            }
            first += self.observations(settled.frame).len();
        }
        errors
    }

    /// Noise and misfit of an evaluation. A given noise stands unless the measurements contradict it: all that is left is far
    /// below it, or points that no curve tells apart differ by far more.
    pub fn scatter(&self, residual: &DVector<f64>, jacobian: &DMatrix<f64>) -> Scatter {
        let rank = Covariance::rank_of(jacobian) + self.eliminated();
        let expected = self.task.robust.map_or(1.0, |robust| robust.mean_of_noise());
        let by =
            |source: NoiseSource<'_>| Scatter { expected, ..Scatter::new(residual, jacobian, rank, source) };
        let repeats = self.repeats();
        let estimated = || match repeats {
            Some((squares, freedom)) => by(NoiseSource::Repeats { squares, freedom }),
            None => by(NoiseSource::Neighbours(&self.tracks())),
        };
        if !self.noise_is_known() {
            return estimated();
        }
        let given = by(NoiseSource::Declared(1.0));
        let too_large = given.noise_is_overstated() && CONTRADICTED * given.residual < given.noise;
        let far = |(squares, freedom): (f64, usize)| squares > CONTRADICTED.powi(2) * freedom as f64;
        match too_large || repeats.is_some_and(far) {
            true => Scatter { contradicted: Some(given.noise), ..estimated() },
            false => given,
        }
    }

    /// Number of the frames' own unknowns that their measurements determine.
    fn eliminated(&self) -> usize {
        self.states.iter().map(|state| state.eliminated).sum()
    }
}

impl Residuals for Equilibria<'_> {
    type Error = Infallible;

    fn robust(&self) -> Option<Robust> {
        self.task.robust
    }

    /// Residuals of all measurements, frame by frame, in units of the noise where known, else N or m.
    fn evaluate(&mut self, point: &DVector<f64>, _jacobian: bool) -> Result<Evaluation, Infallible> {
        let failed = |reason: String| Ok(Evaluation::Failed { reason });
        let unknowns = match self.unknowns.with_values(point) {
            Ok(unknowns) => unknowns,
            Err(error) => return failed(error.to_string()),
        };
        let change = point - self.unknowns.values();
        let curves = unknowns.beside(&self.task.known);
        let results = self.solve_frames(&curves, &unknowns.groups(), Some(&change));
        if let Some(index) = results.iter().position(|result| result.status != Status::Converged) {
            let (replica, frame) = self.frames[index];
            let replica = &self.replicas[replica];
            return failed(format!(
                "no equilibrium of {} frame {}: {}",
                replica.name, replica.frames[frame].index, results[index].status
            ));
        }
        let (mut residual, mut derivatives) = (Vec::new(), Vec::new());
        for result in &results {
            for row in result.rows.row_iter() {
                residual.push(row[0]);
                derivatives.extend(row.iter().skip(1));
            }
        }
        let rows = residual.len();
        self.states = results.into_iter().map(|result| result.state).collect();
        self.unknowns = unknowns;
        Ok(Evaluation::Values {
            residual: DVector::from_vec(residual),
            jacobian: Some(without_rounding(DMatrix::from_row_slice(rows, point.len(), &derivatives))),
        })
    }
}

/// Columns, and rows, up to this share of the longest are rounding.
const ROUNDING: f64 = 1e-12;
const UNMOVED: f64 = 1e-9;

/// The Jacobian with zero columns for control values that no frame sees. Rounding leaves such columns slightly
/// nonzero, and the solver, which scales columns to unit length, would count them as seen. Control values share one
/// unit and act through the same equilibrium, so column lengths can be compared.
pub(crate) fn without_rounding(mut jacobian: DMatrix<f64>) -> DMatrix<f64> {
    let longest = jacobian.column_iter().map(|column| column.norm()).fold(0.0, f64::max);
    let rounding = jacobian.column_iter_mut().filter(|column| column.norm() <= ROUNDING * longest);
    rounding.for_each(|mut column| column.fill(0.0));
    // Likewise rows: bending does not move a coordinate along a table's edge, which carries no information on any
    // curve.
    let longest = jacobian.row_iter().map(|row| row.norm()).fold(0.0, f64::max);
    let rounding = jacobian.row_iter_mut().filter(|row| row.norm() <= UNMOVED * longest);
    rounding.for_each(|mut row| row.fill(0.0));
    jacobian
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_of_a_column_by_rounding_is_nothing() {
        let jacobian = DMatrix::from_row_slice(2, 3, &[1.0, 1e-16, 1e-9, 2.0, -2e-16, 0.0]);
        let expected = DMatrix::from_row_slice(2, 3, &[1.0, 0.0, 1e-9, 2.0, 0.0, 0.0]);
        assert_eq!(without_rounding(jacobian), expected);
        assert_eq!(without_rounding(DMatrix::zeros(0, 2)), DMatrix::zeros(0, 2));
    }
}
