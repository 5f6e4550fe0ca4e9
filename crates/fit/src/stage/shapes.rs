//! Simulated and measured shapes of a sequence, for display.

use crate::equilibria::Settled;
use crate::twin::replica::Replica;
use cloth_sim::mesh::Grid;
use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

/// Single precision: sufficient for display.
pub type Place = [f32; 3];

/// All used frames of a sequence, on the simulation's grid, in world axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shapes {
    /// The simulation's grid.
    pub grid: Grid,
    /// Three nodes per triangle.
    pub triangles: Vec<[usize; 3]>,
    /// Material coordinates of every node, m: u along weft, v along warp.
    pub material: Vec<Vector2<f64>>,
    /// In the order of the sequence.
    pub frames: Vec<FrameShape>,
}

/// One frame's shapes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrameShape {
    /// Index of the frame in its sequence.
    pub frame: usize,
    /// Extension of the test: see [`ReplicaFrame`](crate::twin::replica::ReplicaFrame::extension).
    pub extension: f64,
    /// Positions of the nodes in equilibrium, m.
    pub simulated: Vec<Place>,
    /// Measured positions of the nodes, m; NaN if a node was not observed, empty if no shape was measured.
    pub measured: Vec<Place>,
}

impl Shapes {
    /// The mesh of a replica, without frames.
    pub(crate) fn of(replica: &Replica) -> Self {
        let mesh = &replica.specimen.mesh;
        Self {
            grid: replica.specimen.grid,
            triangles: mesh.triangles.clone(),
            material: mesh.material.clone(),
            frames: Vec::new(),
        }
    }

    /// Adds a frame.
    pub(crate) fn push(&mut self, settled: &Settled<'_>) {
        let Settled { replica, frame, x, edge, .. } = *settled;
        let back = replica.specimen.frame.inverse();
        let place = |node: &[f64]| -> Place {
            let at = back.rotation * Vector3::from_column_slice(node) + back.translation.vector;
            [0, 1, 2].map(|i| at[i] as f32)
        };
        let places = |x: &[f64]| x.chunks_exact(3).map(place).collect();
        self.frames.push(FrameShape {
            frame: frame.index,
            extension: frame.extension,
            simulated: places(&replica.displayed(frame, x, edge)),
            measured: frame.observed.as_deref().map(places).unwrap_or_default(),
        });
    }
}
