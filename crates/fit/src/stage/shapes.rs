//! The shapes of a sequence, simulated beside seen: for those who look at them.

use crate::equilibria::Settled;
use crate::twin::replica::Replica;
use cloth_sim::mesh::Grid;
use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

/// Single precision: what is looked at needs no more.
pub type Place = [f32; 3];

/// All frames of a sequence that were used, on the simulation's grid, in the world's axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shapes {
    /// The simulation's grid.
    pub grid: Grid,
    /// Three nodes each.
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
    /// How far the test went: see [`ReplicaFrame`](crate::twin::replica::ReplicaFrame::extension).
    pub extension: f64,
    /// Where the nodes are in equilibrium, m.
    pub simulated: Vec<Place>,
    /// Where they were seen, m, NaN where not; empty where no shape was measured.
    pub measured: Vec<Place>,
}

impl Shapes {
    /// A replica's mesh, without a frame yet.
    pub(crate) fn of(replica: &Replica) -> Self {
        let mesh = &replica.specimen.mesh;
        Self {
            grid: replica.specimen.grid,
            triangles: mesh.triangles.clone(),
            material: mesh.material.clone(),
            frames: Vec::new(),
        }
    }

    /// One more frame.
    pub(crate) fn push(&mut self, settled: &Settled<'_>) {
        let Settled { replica, frame, x, .. } = *settled;
        let back = replica.specimen.frame.inverse();
        let place = |node: &[f64]| -> Place {
            let at = back.rotation * Vector3::from_column_slice(node) + back.translation.vector;
            [0, 1, 2].map(|i| at[i] as f32)
        };
        let places = |x: &[f64]| x.chunks_exact(3).map(place).collect();
        self.frames.push(FrameShape {
            frame: frame.index,
            extension: frame.extension,
            simulated: places(x),
            measured: frame.observed.as_deref().map(places).unwrap_or_default(),
        });
    }
}
