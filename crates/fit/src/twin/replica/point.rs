//! Measured points and their interpolation in the simulated sheet.

use super::edge_pose::EdgePose;
use cloth_sim::cloth::Cloth;
use nalgebra::Vector3;

/// A measured point of the sheet: where it was seen, and the nodes that interpolate it in the simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredPoint {
    /// Vertex of the measured mesh; where the shape was interpolated to the grid, the node.
    pub source: usize,
    /// Nodes that interpolate it; their weights sum to 1.
    pub terms: Vec<Term>,
    /// Share of the place of a table's edge in its coordinates: 1, or that of a merged point; 0 between clips.
    pub place: f64,
    /// Share of the edge's tilt, m: distance from the middle of the sheet along the edge.
    pub across: f64,
    /// Measured position, m: specimen axes, off a table the axes of its edge.
    pub position: Vector3<f64>,
    /// Standard deviation of a coordinate over a vertex's: an interpolated point averages several.
    pub spread: f64,
}

/// A node's share of an interpolated point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// Index of the node.
    pub node: usize,
    /// Its weight.
    pub weight: f64,
    /// Unknowns of its coordinates; `None` where it is held.
    pub unknowns: [Option<usize>; 3],
}

impl Term {
    /// A node of a cloth.
    pub fn new(node: usize, weight: f64, cloth: &Cloth) -> Self {
        Self { node, weight, unknowns: [0, 1, 2].map(|axis| cloth.unknown(3 * node + axis)) }
    }
}

impl MeasuredPoint {
    /// Interpolates a coordinate.
    ///
    /// * `x` — 3 stacked coordinates per node
    pub fn coordinate(&self, x: &[f64], axis: usize) -> f64 {
        self.terms.iter().map(|term| term.weight * x[3 * term.node + axis]).sum()
    }

    /// Interpolates a coordinate of a sheet placed by a table's edge.
    pub fn placed(&self, x: &[f64], edge: Option<&EdgePose>, axis: usize) -> f64 {
        let shape = self.coordinate(x, axis);
        edge.map_or(shape, |edge| edge.coordinate(shape, axis / 2, [self.place, self.across]))
    }

    /// Interpolates a coordinate of a vector over the unknowns, which is 0 at held nodes.
    pub fn of_unknowns(&self, unknowns: &[f64], axis: usize) -> f64 {
        let share = |term: &Term| term.unknowns[axis].map_or(0.0, |unknown| term.weight * unknowns[unknown]);
        self.terms.iter().map(share).sum()
    }
}

/// Weights of a polynomial through equidistant values, at a place in units of their distance: the four nearest values,
/// or as many as there are (Lagrange).
pub(crate) fn lagrange(place: f64, values: usize) -> Vec<(usize, f64)> {
    let order = values.min(4);
    let first = (place.floor() - 1.0).clamp(0.0, (values - order) as f64) as usize;
    let weight = |i: usize| -> f64 {
        let others = (first..first + order).filter(|&j| j != i);
        others.map(|j| (place - j as f64) / (i as f64 - j as f64)).product()
    };
    (first..first + order).map(|i| (i, weight(i))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_interpolated_exactly() {
        let cubic = |t: f64| 1.0 - 2.0 * t + 0.3 * t * t - 0.1 * t * t * t;
        for place in [-0.5, 0.0, 0.4, 3.7, 8.0, 8.5] {
            let found: f64 = lagrange(place, 9).into_iter().map(|(i, weight)| weight * cubic(i as f64)).sum();
            assert!((found - cubic(place)).abs() < 1e-12, "{place}");
        }
        assert_eq!(lagrange(0.3, 1), [(0, 1.0)]);
        assert_eq!(lagrange(0.25, 2), [(0, 0.75), (1, 0.25)]);
    }
}
