//! Blends the motion of the clips over the cloth between them: a harmonic extension.

use cloth_data::measure::moved;
use cloth_sim::mesh::Mesh;
use cloth_sim::rigid::nearest_motion;
use nalgebra::Vector3;

/// Extends values from held nodes over the mesh by Laplace's equation, with zero flux at the border. Linear fields
/// are reproduced exactly; a blended shape is smooth and stays between the clips.
#[derive(Debug, Clone)]
pub(super) struct Blend {
    /// Conductance of every edge: half the cotangents of the angles opposite it (Pinkall and Polthier 1993).
    conductances: Vec<(usize, usize, f64)>,
    held: Vec<bool>,
}

impl Blend {
    /// For a flat mesh; `held` marks the nodes with given values.
    pub(super) fn new(mesh: &Mesh, held: Vec<bool>) -> Self {
        let mut conductances = Vec::with_capacity(3 * mesh.triangles.len());
        for triangle in &mesh.triangles {
            for corner in 0..3 {
                let [apex, a, b] = [0, 1, 2].map(|i| triangle[(corner + i) % 3]);
                let [left, right] = [a, b].map(|node| mesh.positions[node] - mesh.positions[apex]);
                let cotangent = left.dot(&right) / left.cross(&right).norm();
                conductances.push((a, b, 0.5 * cotangent));
            }
        }
        Self { conductances, held }
    }

    /// Computes the values of all free nodes, by conjugate gradients.
    pub(super) fn extend(&self, values: &mut [f64]) {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        values.iter_mut().zip(&self.held).filter(|(_, held)| !**held).for_each(|(value, _)| *value = 0.0);
        let mut residual: Vec<f64> = self.outflow(values).iter().map(|flow| -flow).collect();
        let mut direction = residual.clone();
        let mut square = dot(&residual, &residual);
        let enough = 1e-28 * square;
        // Exact arithmetic needs as many steps as unknowns; rounding may need a few more.
        for _ in 0..4 * values.len() {
            if square <= enough {
                break;
            }
            let image = self.outflow(&direction);
            let length = square / dot(&direction, &image);
            values.iter_mut().zip(&direction).for_each(|(value, d)| *value += length * d);
            residual.iter_mut().zip(&image).for_each(|(r, i)| *r -= length * i);
            let before = std::mem::replace(&mut square, dot(&residual, &residual));
            direction.iter_mut().zip(&residual).for_each(|(d, r)| *d = r + square / before * *d);
        }
    }

    /// The shape with the held nodes at given positions, 3 stacked coordinates per node, m: the sheet follows their
    /// rigid motion, and the remainder is blended.
    ///
    /// * `place` — position of a held node, given its index
    pub(super) fn shape(&self, mesh: &Mesh, place: impl Fn(usize) -> Vector3<f64>) -> Vec<f64> {
        let rest = &mesh.positions;
        let held = || (0..mesh.len()).filter(|&node| self.held[node]);
        let motion = nearest_motion(&held().map(|node| [rest[node], place(node)]).collect::<Vec<_>>());
        let mut x: Vec<f64> = rest.iter().flat_map(|&p| <[f64; 3]>::from(moved(&motion, &p))).collect();
        for i in 0..3 {
            let mut left = vec![0.0; mesh.len()];
            held().for_each(|node| left[node] = place(node)[i] - x[3 * node + i]);
            self.extend(&mut left);
            x.iter_mut().skip(i).step_by(3).zip(&left).for_each(|(x, left)| *x += left);
            held().for_each(|node| x[3 * node + i] = place(node)[i]);
        }
        x
    }

    /// Flux out of every free node.
    fn outflow(&self, values: &[f64]) -> Vec<f64> {
        let mut flow = vec![0.0; values.len()];
        for &(a, b, conductance) in &self.conductances {
            let current = conductance * (values[a] - values[b]);
            flow[a] += current;
            flow[b] -= current;
        }
        flow.iter_mut().zip(&self.held).filter(|(_, held)| **held).for_each(|(f, _)| *f = 0.0);
        flow
    }
}
