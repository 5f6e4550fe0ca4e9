//! A start from the equilibrium gap: one linear least-squares problem, no simulation.
//!
//! Stress is linear in the control values, and between clips the cloth is close to their blended motion x̃. So is the
//! virtual work of the stresses there in each clip's field φ, which balances that clip's force alone:
//!
//! ```text
//! minimise over k   Σ_frames Σ_clips | Σ_n φ_c(n) g_n(x̃, k) − F̃_c |²     subject to the curve's constraints
//! ```
//!
//! Measured shapes would do as well, but their noise biases the result. Either way it is a start, not a result.
//! Source: virtual fields and equilibrium gap, Grédiac et al. 2006; Claire et al. 2004.

use crate::equilibria::{parameter_columns, without_rounding};
use crate::optimise::gauss_newton::LinearConstraints;
use crate::optimise::least_squares::{LeastSquares, Smoothing};
use crate::twin::replica::Replica;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::material::{Component, Curves};
use nalgebra::{DMatrix, DVector, Vector3};

/// Control values at the curve's strains that best balance the measured forces on the blended shapes, as if the curve
/// carried all the load. Known yarn curves are left out: nearly inextensible yarns would be overstretched on those
/// shapes.
pub fn start(
    replicas: &[Replica],
    fitted: &[Component],
    curve: &StiffnessCurve,
    domain: &LinearConstraints,
) -> DVector<f64> {
    let points = curve.len();
    let mut curves = Curves::default();
    fitted.iter().for_each(|&component| curves.set(component, curve.clone()));
    let (mut rows, mut target): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    for replica in replicas {
        for frame in &replica.frames {
            let cloth = replica.cloth(frame);
            let columns = parameter_columns(cloth, &curves, &[fitted.to_vec()], &frame.start);
            for force in &frame.forces {
                let work = |column: &[f64]| -> f64 {
                    let of_group = |(group, vector): &(usize, Vector3<f64>)| -> f64 {
                        let nodes = column.chunks_exact(3).zip(&replica.fields[*group]);
                        nodes.map(|(g, weight)| weight * Vector3::from_column_slice(g).dot(vector)).sum()
                    };
                    force.parts.iter().map(of_group).sum()
                };
                rows.extend(columns.iter().map(|column| work(column)));
                target.push(force.force);
            }
        }
    }
    let problem = LeastSquares {
        rows: domain.rows.clone(),
        bounds: domain.bounds.clone(),
        smoothing: domain
            .roughness
            .clone()
            .map(|roughness| Smoothing { roughness, point: DVector::zeros(points) }),
        ..LeastSquares::new(
            without_rounding(DMatrix::from_row_slice(target.len(), points, &rows)),
            DVector::from_vec(target),
        )
    };
    problem.solve().point
}
