//! Observations: the measured quantities of an equilibrium that a fit compares.
//!
//! ```text
//! quantity            simulated                      derivative by the unknowns
//! force component     Σ parts · F_c                  Σ parts · dF_c/dk,   dF_c/dk = ∂F_c/∂k + (∂F_c/∂x) dx/dk
//! coordinate          Σ w x_n, placed by the edge    Σ w dx_n/dk
//! ```
//!
//! A new quantity is one more case here; what is minimised asks nothing else of it.

use crate::twin::replica::{EdgePose, MeasuredPoint, Replica, ReplicaFrame};
use cloth_sim::cloth::Cloth;
use cloth_sim::equilibrium::Solver;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The quantities that a stage compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Objective {
    /// The measured components of clip forces, N.
    Forces,
    /// The coordinates of the measured points, m.
    Positions,
}

/// One measured quantity of a frame.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Observation {
    quantity: Quantity,
    /// Measured, N or m.
    pub(super) measured: f64,
    /// Standard deviation over the instrument's noise.
    pub(super) spread: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Quantity {
    /// Index among the frame's force components, its clip, and which of the clip's it is.
    Force { index: usize, clip: usize, number: usize },
    /// Index among the frame's points or merged points, and an axis.
    Coordinate { point: usize, axis: usize, merged: bool },
}

impl Objective {
    /// Standard deviation of the instrument, N or m, where it is known.
    pub(super) fn noise(self, replica: &Replica) -> Option<f64> {
        match self {
            Self::Forces => replica.force_noise,
            Self::Positions => replica.position_noise,
        }
    }

    /// Observations of one frame.
    ///
    /// * `each` — every point counts by itself, as where some are outliers; else points off a table are merged
    pub(super) fn observations(self, frame: &ReplicaFrame, each: bool) -> Vec<Observation> {
        match self {
            Self::Forces => {
                let component =
                    |(index, force): (usize, &crate::twin::replica::ForceComponent)| Observation {
                        quantity: Quantity::Force { index, clip: force.clip, number: force.number },
                        measured: force.force,
                        spread: 1.0,
                    };
                frame.forces.iter().enumerate().map(component).collect()
            }
            Self::Positions => match &frame.merging {
                Some(merging) if !each => {
                    let points = merging.points.iter().enumerate();
                    points.flat_map(|(index, point)| coordinates_of(frame, point, index, true)).collect()
                }
                _ => coordinates(frame, f64::INFINITY),
            },
        }
    }
}

/// Coordinates of a frame's points up to a distance past the edge of a table, m.
pub(super) fn coordinates(frame: &ReplicaFrame, reach: f64) -> Vec<Observation> {
    let near = |point: &MeasuredPoint| {
        frame.overhang.as_ref().is_none_or(|overhang| overhang.past_edge(point) <= reach)
    };
    let points = frame.points.iter().enumerate().filter(|(_, point)| near(point));
    points.flat_map(|(index, point)| coordinates_of(frame, point, index, false)).collect()
}

fn coordinates_of<'f>(
    frame: &'f ReplicaFrame,
    point: &'f MeasuredPoint,
    index: usize,
    merged: bool,
) -> impl Iterator<Item = Observation> + 'f {
    frame.compared_axes().iter().map(move |&axis| Observation {
        quantity: Quantity::Coordinate { point: index, axis, merged },
        measured: point.position[axis],
        spread: point.spread,
    })
}

/// A frame in equilibrium, with the derivatives of its shape and clip forces.
pub(super) struct Balance<'a> {
    cloth: &'a Cloth,
    frame: &'a ReplicaFrame,
    x: &'a [f64],
    edge: Option<EdgePose>,
    /// Of every group of held nodes, N.
    clip_forces: &'a [Vector3<f64>],
    /// Number of control values.
    values: usize,
    /// dx/dk: one column of unknowns a control value; then dx/dθ of an edge's slope, or dx/dν of the clips' poses.
    sensitivity: &'a [f64],
    /// dF/dk of every group of held nodes, a list a control value; then dF/dν of the clips' poses.
    force_slopes: Vec<Vec<Vector3<f64>>>,
}

impl<'a> Balance<'a> {
    /// * `values` — number of control values
    /// * `columns` — ∂g/∂k, 3 a node, one a control value; then ∂g/∂ν of the clips' poses
    /// * `sensitivity` — dx/dk; then dx/dθ of an edge's slope, or dx/dν of the clips' poses
    #[expect(clippy::too_many_arguments, reason = "the parts of a frame in equilibrium")]
    pub(super) fn new(
        solver: &Solver<'_>,
        cloth: &'a Cloth,
        frame: &'a ReplicaFrame,
        x: &'a [f64],
        edge: Option<EdgePose>,
        clip_forces: &'a [Vector3<f64>],
        values: usize,
        columns: &[Vec<f64>],
        sensitivity: &'a [f64],
    ) -> Self {
        let unknowns = cloth.unknowns();
        let border = solver.border();
        let slopes = columns.iter().zip(sensitivity.chunks_exact(unknowns.max(1))).map(|(column, dx)| {
            let through_shape = |row: usize| -> f64 {
                border[row * unknowns..(row + 1) * unknowns].iter().zip(dx).map(|(a, b)| a * b).sum()
            };
            let direct = cloth.clip_forces(column).into_iter().enumerate();
            direct
                .map(|(group, direct)| direct + Vector3::from_fn(|i, _| through_shape(3 * group + i)))
                .collect()
        });
        let force_slopes = slopes.collect();
        Self { cloth, frame, x, edge, clip_forces, values, sensitivity, force_slopes }
    }

    /// The frame.
    pub(super) fn frame(&self) -> &'a ReplicaFrame {
        self.frame
    }

    /// Number of the frame's own unknowns.
    pub(super) fn owned(&self) -> usize {
        self.edge.map_or(self.force_slopes.len() - self.values, |_| EdgePose::UNKNOWNS)
    }
}

impl Observation {
    /// The quantity in a simulation.
    pub(super) fn simulated(&self, balance: &Balance<'_>) -> f64 {
        match self.quantity {
            Quantity::Force { index, .. } => balance.frame.forces[index].of(balance.clip_forces),
            Quantity::Coordinate { point, axis, merged } => {
                point_of(balance.frame, point, merged).placed(balance.x, balance.edge.as_ref(), axis)
            }
        }
    }

    /// Fills in its derivatives by the control values, then by the frame's own unknowns.
    pub(super) fn differentiate(&self, balance: &Balance<'_>, by_value: &mut [f64], own: &mut [f64]) {
        match self.quantity {
            Quantity::Force { index, .. } => {
                let force = &balance.frame.forces[index];
                let derivatives = by_value.iter_mut().chain(own);
                derivatives.zip(&balance.force_slopes).for_each(|(d, slopes)| *d = force.of(slopes));
            }
            Quantity::Coordinate { point, axis, merged } => {
                let point = point_of(balance.frame, point, merged);
                let mut columns = balance.sensitivity.chunks_exact(balance.cloth.unknowns().max(1));
                by_value.iter_mut().zip(&mut columns).for_each(|(d, dx)| *d = point.of_unknowns(dx, axis));
                let Some((edge, overhang)) = balance.edge.zip(balance.frame.overhang.as_ref()) else {
                    own.iter_mut().zip(columns).for_each(|(d, dx)| *d = point.of_unknowns(dx, axis));
                    return;
                };
                own.fill(0.0);
                own[axis / 2] = point.place;
                own[2 + axis / 2] = point.across;
                // The held lines turn with the slope.
                let by_slope = columns.next().map_or(0.0, |dx| point.of_unknowns(dx, axis));
                own[4] = by_slope + overhang.turned(point, edge.slope)[axis / 2];
            }
        }
    }

    /// The axis of a coordinate.
    pub(super) fn axis(&self) -> Option<usize> {
        match self.quantity {
            Quantity::Force { .. } => None,
            Quantity::Coordinate { axis, .. } => Some(axis),
        }
    }

    /// Source: observations of one source follow one another through a sequence's frames.
    pub(super) fn source(&self, frame: &ReplicaFrame) -> [usize; 2] {
        match self.quantity {
            Quantity::Force { clip, number, .. } => [clip, number],
            Quantity::Coordinate { point, axis, merged } => [point_of(frame, point, merged).source, axis],
        }
    }
}

fn point_of(frame: &ReplicaFrame, index: usize, merged: bool) -> &MeasuredPoint {
    match &frame.merging {
        Some(merging) if merged => &merging.points[index],
        _ => &frame.points[index],
    }
}
