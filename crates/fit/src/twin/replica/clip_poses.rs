//! Errors of the clips' poses: every body of clips is off by a small rigid motion.
//!
//! ```text
//! x = x_measured + σ (t + ω × (x_measured − c)/L)      σ: noise of a clip's place, c: centre, L: length of the body
//! ```
//!
//! t and ω are unknowns of a frame, in standard deviations: 0 ± 1. Clips that hold a node together, as the bars of a
//! picture frame do, move as one body, and one body alone cannot be off: a rigid motion strains nothing.

use super::clips::Grip;
use cloth_sim::mesh::Mesh;
use nalgebra::Vector3;

/// The bodies of clips in a replica.
#[derive(Debug)]
pub struct ClipPoses {
    bodies: Vec<Body>,
    /// σ, m.
    noise: f64,
    planar: bool,
}

#[derive(Debug)]
struct Body {
    nodes: Vec<usize>,
    /// L, m.
    length: f64,
}

impl ClipPoses {
    /// `None` if the poses are exact, or nothing moves against anything else.
    pub(super) fn new(grip: &Grip, mesh: &Mesh, noise: f64, planar: bool) -> Option<Self> {
        if noise <= 0.0 {
            return None;
        }
        // Every clip under the name of the first clip of its body.
        let mut body_of: Vec<usize> = (0..grip.groups.len()).collect();
        for &[a, b] in &grip.groups {
            let [kept, other] = [body_of[a].min(body_of[b]), body_of[a].max(body_of[b])];
            body_of.iter_mut().filter(|body| **body == other).for_each(|body| *body = kept);
        }
        let body = |first: usize| {
            let of = |node: &usize| grip.group_of[*node].map(|group| body_of[grip.groups[group][0]]);
            let nodes: Vec<usize> = (0..mesh.len()).filter(|node| of(node) == Some(first)).collect();
            let at = |&node: &usize| mesh.positions[node];
            let apart = |a: &usize| nodes.iter().map(|b| (at(a) - at(b)).norm()).fold(0.0, f64::max);
            let length = nodes.iter().map(apart).fold(0.0, f64::max);
            (!nodes.is_empty()).then_some(Body { nodes, length })
        };
        let bodies: Vec<Body> = (0..grip.groups.len()).filter_map(body).collect();
        (bodies.len() > 1).then_some(Self { bodies, noise, planar })
    }

    /// Noise of a clip's place, m.
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.bodies.len() * if self.planar { 3 } else { 6 }
    }

    /// Displacement of all nodes by one standard deviation of each unknown, 3 stacked coordinates per node, m.
    ///
    /// * `start` — the measured state
    pub fn moves(&self, start: &[f64]) -> Vec<Vec<f64>> {
        let at = |node: usize| Vector3::from_column_slice(&start[3 * node..3 * node + 3]);
        let [shifts, turns] = if self.planar { [0..2, 2..3] } else { [0..3, 0..3] };
        let axis = |i: usize| Vector3::ith(i, 1.0);
        let mut moves = Vec::with_capacity(self.unknowns());
        for Body { nodes, length } in &self.bodies {
            let centre = nodes.iter().map(|&node| at(node)).sum::<Vector3<f64>>() / nodes.len() as f64;
            let mut add = |shift: &dyn Fn(Vector3<f64>) -> Vector3<f64>| {
                let mut moved = vec![0.0; start.len()];
                for &node in nodes {
                    let own = self.noise * shift(at(node) - centre);
                    moved[3 * node..3 * node + 3].copy_from_slice(own.as_slice());
                }
                moves.push(moved);
            };
            shifts.clone().for_each(|i| add(&|_| axis(i)));
            // A clip at one node has no direction.
            let length = if *length > 0.0 { *length } else { f64::INFINITY };
            turns.clone().for_each(|i| add(&|arm| axis(i).cross(&arm) / length));
        }
        moves
    }

    /// Puts the held nodes of a state where the measured one has them, but for errors in standard deviations.
    pub fn hold(&self, start: &[f64], errors: &[f64], x: &mut [f64]) {
        for node in self.bodies.iter().flat_map(|body| &body.nodes) {
            let own = 3 * node..3 * node + 3;
            x[own.clone()].copy_from_slice(&start[own]);
        }
        for (moved, error) in self.moves(start).iter().zip(errors) {
            x.iter_mut().zip(moved).for_each(|(x, moved)| *x += error * moved);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_sim::mesh::{Diagonals, Grid};

    /// Clips on the columns of a grid of 4 × 3 nodes, 1 m apart, some with groups of two.
    fn poses(groups: &[[usize; 2]], of_column: [Option<usize>; 4], planar: bool) -> Option<ClipPoses> {
        let grid = Grid { columns: 4, rows: 3, width: 3.0, height: 2.0, diagonals: Diagonals::Forward };
        let mesh = grid.mesh().unwrap();
        let group_of = mesh.positions.iter().map(|p| of_column[p.x.round() as usize]).collect();
        ClipPoses::new(&Grip { group_of, groups: groups.to_vec() }, &mesh, 1e-3, planar)
    }

    #[test]
    fn what_holds_a_node_together_moves_as_one() {
        let own = [[0, 0], [1, 1], [2, 2]];
        let apart = poses(&own, [Some(0), None, Some(1), Some(2)], true).unwrap();
        assert_eq!(apart.unknowns(), 9);
        let paired = [own[0], own[1], own[2], [1, 2]];
        let pair = poses(&paired, [Some(0), Some(1), Some(3), Some(2)], false).unwrap();
        assert_eq!(pair.unknowns(), 12);
        let all = [own[0], own[1], own[2], [1, 2], [0, 1]];
        assert!(poses(&all, [Some(0), Some(4), Some(3), Some(2)], true).is_none());
    }

    #[test]
    fn clips_shift_and_turn_about_their_centres() {
        let poses = poses(&[[0, 0], [1, 1]], [Some(0), None, None, Some(1)], true).unwrap();
        let grid = Grid { columns: 4, rows: 3, width: 3.0, height: 2.0, diagonals: Diagonals::Forward };
        let start = grid.mesh().unwrap().coordinates();
        let mut x = vec![7.0; start.len()];
        // The second clip up by one deviation, and turned by two: 1e-3 over its length of 2 m.
        poses.hold(&start, &[0.0, 0.0, 0.0, 0.0, 1.0, 2.0], &mut x);
        for (node, (at, x)) in start.chunks(3).zip(x.chunks(3)).enumerate() {
            let expected = match at[0].round() as usize {
                0 => [at[0], at[1], 0.0],
                3 => [at[0] - 1e-3 * (at[1] - 1.0), at[1] + 1e-3, 0.0],
                _ => [7.0; 3],
            };
            assert!(x.iter().zip(expected).all(|(x, e)| (x - e).abs() < 1e-15), "{node}: {x:?}");
        }
    }
}
