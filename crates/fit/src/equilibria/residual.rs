//! The residuals of a stage, in units of independent noise, and their derivatives.

use super::frames::Equilibria;
use super::state::FrameResult;
use crate::optimise::gauss_newton::{Evaluation, Residuals};
use crate::optimise::robust::Robust;
use crate::twin::replica::{Replica, ReplicaFrame};
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::equilibrium::Status;
use cloth_sim::material::Component;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;
use std::convert::Infallible;

impl Equilibria<'_> {
    /// Indices of consecutive residuals: one force component of one clip through a sequence, or one coordinate of one
    /// node.
    pub fn tracks(&self) -> Vec<Vec<usize>> {
        let mut tracks: BTreeMap<(usize, usize, usize), Vec<usize>> = BTreeMap::new();
        let mut index = 0;
        for &(replica, frame) in &self.frames {
            let own = &self.replicas[replica];
            for observation in self.task.objective.observations(own, &own.frames[frame]) {
                let [of, number] = observation.source();
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
        for (&(replica, frame), result) in self.frames.iter().zip(&results) {
            let replica = &self.replicas[replica];
            let rows = self.residual_rows(replica, &replica.frames[frame], result, columns);
            values.extend(rows.columns(1, columns).transpose().iter());
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
        let balanced =
            self.frames.iter().zip(&results).filter(|(_, result)| result.status == Status::Converged);
        for (&(replica, frame), result) in balanced {
            let replica = &self.replicas[replica];
            let rows = self.residual_rows(replica, &replica.frames[frame], result, 0);
            sizes.extend(rows.iter().map(|residual| residual.abs()));
        }
        sizes.sort_by(f64::total_cmp);
        sizes.get(sizes.len() / 2).map_or(0.0, |median| 1.4826 * median)
    }

    /// A frame's residuals, with their derivatives in further columns, all in units of independent noise.
    fn residual_rows(
        &self,
        replica: &Replica,
        frame: &ReplicaFrame,
        result: &FrameResult,
        points: usize,
    ) -> DMatrix<f64> {
        let observations = self.task.objective.observations(replica, frame);
        let mut rows = DMatrix::zeros(observations.len(), points + 1);
        for (i, observation) in observations.iter().enumerate() {
            let scale = observation.spread * self.scale(replica);
            rows[(i, 0)] = (observation.measured - result.simulated[i]) / scale;
            (0..points).for_each(|k| rows[(i, k + 1)] = result.derivatives[i * points + k] / scale);
        }
        if let Some(whitening) = &result.state.whitening {
            whitening.apply(&mut rows);
        }
        if let Some(robust) = self.task.robust {
            for mut row in rows.row_iter_mut() {
                let (value, slope) = robust.bend(row[0]);
                row *= slope;
                row[0] = value;
            }
        }
        rows
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
        for (&(replica, frame), result) in self.frames.iter().zip(&results) {
            let replica = &self.replicas[replica];
            let rows = self.residual_rows(replica, &replica.frames[frame], result, point.len());
            for row in rows.row_iter() {
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
