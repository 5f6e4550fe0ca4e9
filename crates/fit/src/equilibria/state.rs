//! The equilibrium of one frame, and the start of its first solve.

use super::elimination::{Prior, eliminate};
use crate::twin::replica::{EdgePose, Replica, ReplicaFrame};
use cloth_sim::equilibrium::Status;
use cloth_sim::material::Curves;
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Error of the grid in one frame, added to what is simulated.
#[derive(Debug, Clone, Default)]
pub(super) struct Correction {
    /// Of each compared value; empty if not known.
    pub(super) values: Vec<f64>,
    /// Of each point's compared coordinates, m; empty if not known.
    pub(super) points: Vec<f64>,
}

/// The equilibrium of one frame at given control values.
#[derive(Debug, Clone, Default)]
pub(super) struct State {
    pub(super) x: Vec<f64>,
    /// dx/dk, one column of unknowns per control value, with the frame's own unknowns at their best; empty before the
    /// first solve.
    pub(super) sensitivity: Vec<f64>,
    /// The solve met an unstable equilibrium and left it: others may exist.
    pub(super) escaped: bool,
    /// Pose of the sheet at a table's edge.
    pub(super) edge: Option<EdgePose>,
    /// Errors of the clips' poses in standard deviations; empty if the poses are exact.
    pub(super) clips: Vec<f64>,
    /// Derivative of the simulated values, in units of the noise, by deviations of these from what else is known of them.
    pub(super) by_clips: DMatrix<f64>,
    /// Change of the simulated values, in units of the noise, by clip poses that took the grid's error for their own.
    pub(super) grid_through_poses: Option<DVector<f64>>,
    /// dν/dk of the frame's own unknowns: one column per control value.
    pub(super) own_sensitivity: DMatrix<f64>,
    /// Number of the frame's own unknowns that its measurements determine.
    pub(super) eliminated: usize,
    /// Renewed by [`Equilibria::correct`] and constant in between, so that the objective stays one function.
    pub(super) correction: Arc<Correction>,
    /// The equilibrium on the finer grid, and what of it was interpolated, where it was corrected by one.
    pub(super) finer: Option<Arc<[Vec<f64>; 2]>>,
}

impl State {
    /// Rows of residuals, or of what changes them, without the errors of the clips' poses.
    pub(super) fn without_clips(&self, rows: DMatrix<f64>) -> DMatrix<f64> {
        match self.by_clips.ncols() {
            0 => rows,
            _ => eliminate(rows, &self.by_clips, Prior::Unit).rows,
        }
    }
}

/// A frame's share of an evaluation.
pub(super) struct FrameResult {
    pub(super) state: State,
    pub(super) status: Status,
    /// Simulated force along each measured component, N.
    pub(super) forces: Vec<f64>,
    /// Residuals of the compared quantities in units of independent noise, then their derivatives by the control
    /// values: one row each.
    pub(super) rows: DMatrix<f64>,
    /// Simulated values of the compared quantities, without correction.
    pub(super) simulated: Vec<f64>,
}

/// The replica's own start, with every observed free node moved to its measured place. On a table the start already
/// consists of the observed shape.
pub(super) fn measured_shape(replica: &Replica, frame: &ReplicaFrame) -> Vec<f64> {
    let mut x = frame.start.clone();
    if !replica.is_on_table() {
        let cloth = replica.cloth(frame);
        for (point, axis) in frame.points.iter().flat_map(|point| (0..3).map(move |axis| (point, axis))) {
            let coordinate = 3 * point.source + axis;
            if cloth.unknown(coordinate).is_some() {
                x[coordinate] = point.position[axis];
            }
        }
    }
    x
}

/// Start of the first solve: the measured shape if it leaves the plane; else the replica's own start or the measured
/// shape, whichever is nearer to equilibrium.
pub(super) fn start_state(replica: &Replica, frame: &ReplicaFrame, curves: &Curves) -> State {
    let cloth = replica.cloth(frame);
    let own = frame.start.clone();
    if frame.observed.is_none() || replica.is_on_table() {
        return State { x: own, edge: frame.edge(), ..State::default() };
    }
    let measured = measured_shape(replica, frame);
    let imbalance = |x: &[f64]| {
        let mut gradient = vec![0.0; x.len()];
        cloth.gradient(curves, x, &mut gradient, &mut cloth_sim::cloth::ForceScale::new(cloth.points()));
        cloth.free_coordinates().iter().map(|&(c, _)| gradient[c] * gradient[c]).sum::<f64>()
    };
    let x = if replica.is_buckled(frame) || imbalance(&measured) < imbalance(&own) { measured } else { own };
    State { x, ..State::default() }
}
