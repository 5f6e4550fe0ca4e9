//! Observations: the measured quantities of an equilibrium that a fit compares.
//!
//! ```text
//! quantity            simulated            derivative by the unknowns
//! force component     Σ parts · F_c        Σ parts · dF_c/dk,   dF_c/dk = ∂F_c/∂k + (∂F_c/∂x) dx/dk
//! coordinate          x_i                  dx_i/dk
//! ```
//!
//! A new quantity is one more case here; what is minimised asks nothing else of it.

use crate::twin::replica::{Replica, ReplicaFrame};
use cloth_sim::cloth::Cloth;
use cloth_sim::equilibrium::Solver;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The quantities that a stage compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Objective {
    /// The measured components of clip forces, N.
    Forces,
    /// The coordinates of the free nodes that were seen, m.
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
    /// Index among stacked coordinates, and its unknown.
    Coordinate { coordinate: usize, unknown: usize },
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
    pub(super) fn observations(self, replica: &Replica, frame: &ReplicaFrame) -> Vec<Observation> {
        match (self, &frame.observed) {
            (Self::Forces, _) => {
                let component =
                    |(index, force): (usize, &crate::twin::replica::ForceComponent)| Observation {
                        quantity: Quantity::Force { index, clip: force.clip, number: force.number },
                        measured: force.force,
                        spread: 1.0,
                    };
                frame.forces.iter().enumerate().map(component).collect()
            }
            (Self::Positions, Some(observed)) => {
                let coordinate = |(unknown, coordinate): (usize, usize)| Observation {
                    quantity: Quantity::Coordinate { coordinate, unknown },
                    measured: observed[coordinate],
                    spread: replica.spread[coordinate / 3],
                };
                replica.seen_unknowns(frame).map(coordinate).collect()
            }
            (Self::Positions, None) => Vec::new(),
        }
    }
}

/// A frame in equilibrium, with the derivatives of its shape and clip forces.
pub(super) struct Balance<'a> {
    frame: &'a ReplicaFrame,
    x: &'a [f64],
    unknowns: usize,
    /// Of every group of held nodes, N.
    clip_forces: &'a [Vector3<f64>],
    /// dx/dk: one column of unknowns a control value.
    sensitivity: &'a [f64],
    /// dF/dk of every group of held nodes, a list a control value.
    force_slopes: Vec<Vec<Vector3<f64>>>,
}

impl<'a> Balance<'a> {
    /// * `columns` — ∂g/∂k, 3 a node, one a control value
    /// * `sensitivity` — dx/dk
    pub(super) fn new(
        solver: &Solver<'_>,
        cloth: &Cloth,
        frame: &'a ReplicaFrame,
        x: &'a [f64],
        clip_forces: &'a [Vector3<f64>],
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
        Self { frame, x, unknowns, clip_forces, sensitivity, force_slopes }
    }
}

impl Observation {
    /// The quantity in a simulation.
    pub(super) fn simulated(&self, balance: &Balance<'_>) -> f64 {
        match self.quantity {
            Quantity::Force { index, .. } => balance.frame.forces[index].of(balance.clip_forces),
            Quantity::Coordinate { coordinate, .. } => balance.x[coordinate],
        }
    }

    /// Its derivative by one control value.
    pub(super) fn derivative(&self, balance: &Balance<'_>, value: usize) -> f64 {
        match self.quantity {
            Quantity::Force { index, .. } => balance.frame.forces[index].of(&balance.force_slopes[value]),
            Quantity::Coordinate { unknown, .. } => balance.sensitivity[value * balance.unknowns + unknown],
        }
    }

    /// Source: observations of one source follow one another through a sequence's frames.
    pub(super) fn source(&self) -> [usize; 2] {
        match self.quantity {
            Quantity::Force { clip, number, .. } => [clip, number],
            Quantity::Coordinate { coordinate, .. } => [coordinate / 3, coordinate % 3],
        }
    }
}
