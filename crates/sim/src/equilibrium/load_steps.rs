//! Load steps: held nodes move far, and the cloth follows in as few steps as possible.

use super::outcome::{Equilibrium, Status};
use super::settings::Settings;
use super::solver::Solver;
use crate::cloth::Cloth;
use crate::material::Curves;
use crate::rigid::nearest_rotation;
use nalgebra::{Rotation3, Vector3};
use std::collections::BTreeMap;

/// A step that is not balanced after this many iterations was too long.
const ITERATIONS: usize = 40;

/// Shortest step, as a share of the whole motion.
const SHORTEST: f64 = 1.0 / 256.0;

/// Displacement of the held nodes, as a share of the mean edge, that probes the resulting forces.
const PROBE: f64 = 1e-6;

impl Solver<'_> {
    /// Follows an equilibrium while the held nodes move.
    ///
    /// The first step is the whole motion. A step is halved if it is not balanced within 40 iterations, if a hinge
    /// jumps across half a turn or, in planar problems, if a triangle flips; after a success the step doubles. Every
    /// step starts from −K⁻¹ K_h Δx_h, the first-order response of the free nodes to the motion Δx_h of the held ones.
    /// Every clip moves as rigidly as possible, with proportional rotation and translation.
    ///
    /// * `x` — as for [`Solver::solve`]; near an equilibrium for the present positions of its held nodes
    /// * `target` — target positions of the held nodes, 3 stacked coordinates per node, m; entries of free nodes are
    ///   ignored
    ///
    /// If a step of 1/256 of the motion fails too, `x` is the last balanced state on the way and the status that of the
    /// failed step; the other figures are those of `x`. The counters include all steps. The steps leave unstable states
    /// as a solve does.
    ///
    /// # Panics
    /// If the length of `x` or `target` differs from the cloth's number of coordinates.
    pub fn load_steps(
        &mut self,
        curves: &Curves,
        x: &mut [f64],
        target: &[f64],
        settings: &Settings,
    ) -> Equilibrium {
        assert_eq!([x.len(), target.len()], [3 * self.cloth.points(); 2], "three coordinates per node");
        if let Some(refused) = self.refused(x) {
            return refused;
        }
        let (before, remedies) = (self.linear.factorisations(), self.remedies);
        let clips = motions(self.cloth, x, target);
        let limited = Settings { max_iterations: settings.max_iterations.min(ITERATIONS), ..*settings };
        let (mut done, mut length) = (0.0, 1.0);
        let (mut status, mut iterations, mut escaped) = (Status::Stalled, 0, false);
        self.refresh(curves, x);
        while done < 1.0 && length >= SHORTEST {
            let mut trial = x.to_vec();
            clips.iter().for_each(|clip| clip.place(done + length, &mut trial));
            self.predict(curves, x, &mut trial);
            let found = self.settle(curves, &mut trial, &limited);
            iterations += found.iterations;
            status = found.status;
            let balanced = matches!(status, Status::Converged | Status::Unstable);
            if balanced && !self.cloth.hinge_jumps(x, &trial) && !self.cloth.turns_over(x, &trial) {
                x.copy_from_slice(&trial);
                escaped |= found.escaped;
                done += length;
                length = (2.0 * length).min(1.0 - done);
            } else {
                status = if balanced { Status::Stalled } else { status };
                self.refresh(curves, x);
                self.remedies.halved += 1;
                length *= 0.5;
            }
        }
        let energy = self.cloth.energy(curves, x);
        let (imbalance, tolerance, limit) = self.balance(x, settings);
        let factorisations = self.linear.factorisations() - before;
        let remedies = self.remedies - remedies;
        Equilibrium {
            status,
            escaped,
            limit,
            energy,
            imbalance,
            tolerance,
            iterations,
            factorisations,
            remedies,
        }
    }

    /// Moves the free nodes of a state, whose held nodes have moved away from `x`, to first order. Gradient and factor
    /// are those of `x`. The strains predicted by this step are kept for the first matrix.
    fn predict(&mut self, curves: &Curves, x: &[f64], state: &mut [f64]) {
        self.step.iter_mut().zip(state.iter().zip(x)).for_each(|(d, (to, from))| *d = to - from);
        let farthest = self.step.iter().fold(0.0, |largest: f64, d| largest.max(d.abs()));
        let probe = PROBE * self.cloth.mean_edge() / farthest.max(f64::MIN_POSITIVE);
        self.try_step(curves, x, probe);
        let change =
            self.gradient.iter().zip(&self.trial_gradient).map(|(here, there)| (here - there) / probe);
        let change: Vec<f64> = change.collect();
        self.cloth.collect(&change, &mut self.reduced);
        self.solve_reduced();
        self.cloth.spread(&self.reduced, &mut self.step);
        let free = self.cloth.free_coordinates().iter();
        free.for_each(|&(coordinate, unknown)| state[coordinate] += self.reduced[unknown]);
        self.cloth.predicted_strains(x, &self.step, &mut self.mixed);
    }
}

/// Motion of the nodes held by one clip: a rigid part and a remainder.
struct Motion {
    /// Centre at the start, m.
    middle: Vector3<f64>,
    /// Displacement of the centre, m.
    travel: Vector3<f64>,
    /// Rotation, axis times angle, rad.
    turn: Vector3<f64>,
    nodes: Vec<Follower>,
}

/// A node held by a clip, m.
struct Follower {
    node: usize,
    /// Vector from the clip's centre to the node at the start.
    arm: Vector3<f64>,
    /// Displacement from the rigidly moved position to the target.
    rest: Vector3<f64>,
    target: Vector3<f64>,
}

/// Motions of all clips, and one for the nodes held without a clip.
fn motions(cloth: &Cloth, x: &[f64], target: &[f64]) -> Vec<Motion> {
    let mut free = vec![false; cloth.points()];
    cloth.free_coordinates().iter().for_each(|(coordinate, _)| free[coordinate / 3] = true);
    let mut clips: BTreeMap<Option<usize>, Vec<usize>> = BTreeMap::new();
    for node in (0..cloth.points()).filter(|&node| !free[node]) {
        clips.entry(cloth.clip_of(node)).or_default().push(node);
    }
    clips.values().map(|nodes| Motion::new(nodes, x, target)).collect()
}

impl Motion {
    fn new(nodes: &[usize], x: &[f64], target: &[f64]) -> Self {
        let at = |x: &[f64], node: usize| Vector3::from_column_slice(&x[3 * node..3 * node + 3]);
        let mean =
            |x: &[f64]| nodes.iter().map(|&node| at(x, node)).sum::<Vector3<f64>>() / nodes.len() as f64;
        let [middle, end] = [mean(x), mean(target)];
        let arms = nodes.iter().map(|&node| [at(x, node) - middle, at(target, node) - end]);
        let turn = nearest_rotation(arms).scaled_axis();
        let follower = |&node: &usize| {
            let (arm, target) = (at(x, node) - middle, at(target, node));
            Follower { node, arm, rest: target - end - Rotation3::new(turn) * arm, target }
        };
        let nodes = nodes.iter().map(follower).collect();
        Self { middle, travel: end - middle, turn, nodes }
    }

    /// Places the nodes at a share of the motion.
    fn place(&self, share: f64, x: &mut [f64]) {
        let rotation = Rotation3::new(self.turn * share);
        for &Follower { node, arm, rest, target } in &self.nodes {
            let place = self.middle + rotation * arm + (self.travel + rest) * share;
            let place = if share < 1.0 { place } else { target };
            x[3 * node..3 * node + 3].copy_from_slice(place.as_slice());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks the distances between nodes at several shares of the motion against those at rest.
    fn keeps_its_size(start: &[f64], turn: Vector3<f64>) {
        let nodes: Vec<usize> = (0..start.len() / 3).collect();
        let at = |x: &[f64], node: usize| Vector3::from_column_slice(&x[3 * node..3 * node + 3]);
        let to = |&node: &usize| Rotation3::new(turn) * at(start, node) + Vector3::new(1.0, 2.0, 3.0);
        let target: Vec<f64> = nodes.iter().flat_map(|node| <[f64; 3]>::from(to(node))).collect();
        let motion = Motion::new(&nodes, start, &target);
        for share in [0.25, 0.5, 0.75, 1.0] {
            let mut x = start.to_vec();
            motion.place(share, &mut x);
            for node in &nodes {
                let [length, rest] = [&x[..], start].map(|x| (at(x, *node) - at(x, 0)).norm());
                assert!((length - rest).abs() < 1e-5, "{share}, {node}: {length} {rest}");
            }
            assert!(share < 1.0 || x == target);
        }
    }

    #[test]
    fn clips_turn_and_keep_their_size() {
        let square = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
        for angle in [0.0, 1.0, 2.5, std::f64::consts::PI] {
            for axis in [Vector3::x(), Vector3::z(), Vector3::new(0.6, 0.0, 0.8)] {
                // Four nodes, two, and one.
                for count in [12, 6, 3] {
                    keeps_its_size(&square[..count], axis * angle);
                }
            }
        }
    }
}
