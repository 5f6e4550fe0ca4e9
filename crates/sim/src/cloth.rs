//! The assembled cloth: all elements of one problem, with total energy, gradient and sparse Hessian.
//!
//! A problem lists only the parts it has, and absent parts cost nothing: a stretch problem has no hinges in its matrix,
//! planar motion has two unknowns per node, and a held node has none.

mod alike;
mod guide;
mod numbering;
mod problem;

pub use problem::{Problem, Rest};

use crate::bending::Bending;
use crate::curve::NegativeStrain;
use crate::element::{
    EnergyPass, GradientPass, HessianKind, HessianPass, ParameterPass, Pass, PredictedStrainPass,
    StiffnessPass, StrainPass, gather, stacked,
};
use crate::error::{Error, Result};
use crate::linear::matrix::Pattern;
use crate::load::{Held, lumped_masses};
use crate::material::{Component, Curves};
use crate::membrane::Membrane;
use crate::mesh::{Edge, Mesh};
use alike::{Alike, Twins, are_alike};
use guide::Guide;
use nalgebra::{Matrix3, Vector3};
use numbering::{GraphPass, HELD, ScatterPass, columns, leaders, number};
use problem::{check, check_pinned};
use std::collections::BTreeSet;

/// A prepared problem: elements, masses, numbering, matrix pattern and symbolic factorisation. Shared by all frames and
/// threads; all mutable state is in a [`Solver`](crate::equilibrium::Solver).
#[derive(Debug)]
pub struct Cloth {
    membrane: Membrane,
    bending: Option<Bending>,
    /// Mass of every point, kg; rotations have none.
    masses: Vec<f64>,
    /// Gravity, m/s².
    gravity: Vector3<f64>,
    nodes: usize,
    /// Rotations of edges, which follow the nodes' coordinates in a state.
    rotations: usize,
    clips: usize,
    clip_of: Vec<Option<usize>>,
    planar: bool,
    /// Triangles of the rest mesh, for every model.
    triangles: Vec<[usize; 3]>,
    /// Mean length of the rest mesh's edges, m.
    mean_edge: f64,
    /// Node pairs of omitted elements and of the elements that represent them.
    twins: Vec<Twins>,
    /// Index of every unknown in the stacked coordinates; for a tied group, the index of its first node.
    unknowns: Vec<usize>,
    /// Every coordinate that is not held, with its unknown.
    free: Vec<(usize, usize)>,
    pattern: Pattern,
    guides: Vec<Guide>,
    /// Per part: destination of each lower entry of each element. See [`Cloth::hessian`].
    targets: [Vec<u32>; 2],
    /// Positions of the diagonal among the entries.
    diagonal: Vec<usize>,
    /// True if entries of an element beside its diagonal fall on the matrix's: points that are tied, or one node twice.
    doubles: bool,
}

impl Cloth {
    /// Prepares an equilibrium problem.
    ///
    /// # Errors
    /// Those of [`Cloth::in_motion`]; a part of the cloth that nothing holds.
    pub fn new(problem: &Problem<'_>) -> Result<Self> {
        check_pinned(problem)?;
        Self::in_motion(problem)
    }

    /// Prepares a dynamic problem. The cloth may be free.
    ///
    /// # Errors
    /// Springs on a mesh that is not a grid; a collapsed hinge; a negative density; a held, tied or guided node that
    /// does not exist or is in two of these roles; bending, guides or out-of-plane weight in a planar problem.
    pub fn in_motion(problem: &Problem<'_>) -> Result<Self> {
        let Problem { mesh, model, components, planar, .. } = *problem;
        check(problem)?;
        let mut held = vec![false; mesh.len()];
        let mut clip_of = vec![None; mesh.len()];
        for &Held { node, clip } in problem.held {
            held[node] = true;
            clip_of[node] = clip;
        }
        let mut membrane = Membrane::new(model, mesh, components)?;
        // As a cylinder, if every node is on a line that moves as a whole.
        let rolls = problem.tied.iter().map(Vec::len).sum::<usize>() == mesh.len();
        let mut bending = Bending::new(model, mesh, components, &held, rolls)?;
        if let (Some(bending), Rest::Flat) = (&mut bending, problem.rest) {
            bending.flatten();
        }
        let mut places = mesh.positions.clone();
        let rotating = bending.as_ref().map_or(&[][..], |bending| bending.rotating());
        let rotations = rotating.len();
        // Of three rotations the mean of their edges.
        places.extend(rotating.chunks(3).map(|own| own.iter().sum::<Vector3<f64>>() / own.len() as f64));
        let points = places.len();
        let mean_edge = mean_edge(mesh)?;
        let leader = leaders(points, problem.tied);
        let alike = Alike::new(mesh, &leader, mean_edge);
        let twins =
            if problem.tied.is_empty() { Vec::new() } else { alike.merge(&mut membrane, &mut bending) };
        held.resize(points, false);
        clip_of.resize(points, None);
        let mut graph = GraphPass { neighbours: vec![BTreeSet::new(); points], used: BTreeSet::new() };
        visit(&membrane, bending.as_ref(), planar, &mut graph);
        let used = std::mem::take(&mut graph.used);
        let neighbours = graph.led(&leader);
        let moves: Vec<bool> = (0..points).map(|point| !held[point] && leader[point] == point).collect();
        let dimensions = if planar { 2 } else { 3 };
        let mut unknowns = number(&moves, &neighbours, &places, dimensions);
        // A node without elements is an unknown, too; a rotation without is none.
        unknowns.retain(|coordinate| *coordinate < 3 * mesh.len() || used.contains(coordinate));
        let mut unknown_of = vec![HELD; 3 * points];
        unknowns.iter().enumerate().for_each(|(unknown, &coordinate)| unknown_of[coordinate] = unknown);
        let columns = columns(&unknowns, &unknown_of, &neighbours);
        for node in (0..points).filter(|&node| leader[node] != node) {
            (0..3).for_each(|i| unknown_of[3 * node + i] = unknown_of[3 * leader[node] + i]);
        }
        let coordinates = unknown_of.iter().copied().enumerate();
        let free = coordinates.filter(|&(_, unknown)| unknown != HELD).collect();
        let too_large = Error::InvalidValue {
            field: "nodes",
            value: mesh.len() as f64,
            expected: "a mesh whose factorisation fits into memory",
        };
        let pattern = Pattern::new(&columns).ok_or(too_large)?;
        let guides = guide::guides(problem.guided, &unknown_of, &neighbours, &pattern)?;
        let diagonal = (0..unknowns.len()).filter_map(|unknown| pattern.position(unknown, unknown)).collect();
        let clips = clip_of.iter().flatten().max().map_or(0, |&last| last + 1);
        let mut scatter = ScatterPass {
            unknown_of: &unknown_of,
            clip_of: &clip_of,
            pattern: &pattern,
            clips,
            targets: Default::default(),
        };
        visit(&membrane, bending.as_ref(), planar, &mut scatter);
        let targets = scatter.targets;
        let nowhere = pattern.entries() + 3 * clips * pattern.size();
        let doubles = targets.iter().flatten().any(|&target| target as usize > nowhere);
        let mut masses = lumped_masses(mesh, problem.areal_density);
        masses.resize(points, 0.0);
        Ok(Self {
            membrane,
            bending,
            masses,
            gravity: problem.gravity,
            nodes: mesh.len(),
            rotations,
            clips,
            clip_of,
            planar,
            triangles: mesh.triangles.clone(),
            mean_edge,
            twins,
            unknowns,
            free,
            pattern,
            guides,
            targets,
            diagonal,
            doubles,
        })
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Number of points: nodes, and one for every three rotations of edges. A state has three coordinates of each.
    pub fn points(&self) -> usize {
        self.nodes + self.rotations.div_ceil(3)
    }

    /// A state of given nodes, with every edge's normal between those of its triangles.
    ///
    /// * `nodes` — 3 stacked coordinates per node, m
    pub fn state(&self, nodes: &[f64]) -> Vec<f64> {
        let mut state = nodes.to_vec();
        state.resize(3 * self.points(), 0.0);
        state
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.unknowns.len()
    }

    /// Number of entries in the Hessian's lower triangle.
    pub fn entries(&self) -> usize {
        self.pattern.entries()
    }

    /// Number of clips.
    pub fn clips(&self) -> usize {
        self.clips
    }

    /// Membrane elements.
    pub fn membrane(&self) -> &Membrane {
        &self.membrane
    }

    /// Bending elements, if the problem has any.
    pub fn bending(&self) -> Option<&Bending> {
        self.bending.as_ref()
    }

    /// Index of every unknown in the stacked coordinates, in matrix order.
    pub fn unknown_coordinates(&self) -> &[usize] {
        &self.unknowns
    }

    /// Every coordinate that is not held, with the index of its unknown. Tied nodes share unknowns.
    pub fn free_coordinates(&self) -> &[(usize, usize)] {
        &self.free
    }

    /// Unknown of a coordinate; `None` if it is held.
    pub fn unknown(&self, coordinate: usize) -> Option<usize> {
        let place = self.free.binary_search_by_key(&coordinate, |&(coordinate, _)| coordinate);
        place.ok().map(|place| self.free[place].1)
    }

    /// Sums a coordinate quantity, such as a gradient, over each unknown. For a guided node only the part along its
    /// free directions remains.
    pub fn collect(&self, coordinates: &[f64], unknowns: &mut [f64]) {
        unknowns.fill(0.0);
        self.free.iter().for_each(|&(coordinate, unknown)| unknowns[unknown] += coordinates[coordinate]);
        self.project(unknowns);
    }

    /// Sets every free coordinate to the value of its unknown, for example of a step.
    pub fn spread(&self, unknowns: &[f64], coordinates: &mut [f64]) {
        self.free.iter().for_each(|&(coordinate, unknown)| coordinates[coordinate] = unknowns[unknown]);
    }

    /// Total energy, J: elastic energy plus that of the weight.
    ///
    /// * `x` — 3 stacked coordinates per point, m: nodes, then of every rotating edge its angle times its length
    pub fn energy(&self, curves: &Curves, x: &[f64]) -> f64 {
        self.elastic_energy(curves, x) + self.weight_energy(x)
    }

    /// Computes the gradient of the total energy, N, 3 per node, held nodes included. Returns the energy, J.
    ///
    /// `scale` receives the magnitudes of forces and rounding errors; see [`ForceScale`].
    pub fn gradient(&self, curves: &Curves, x: &[f64], gradient: &mut [f64], scale: &mut ForceScale) -> f64 {
        gradient.fill(0.0);
        scale.magnitude.fill(0.0);
        scale.stiffness.fill(0.0);
        let mut pass = GradientPass {
            law: curves,
            x,
            gradient: &mut *gradient,
            magnitude: &mut scale.magnitude,
            stiffness: &mut scale.stiffness,
            energy: 0.0,
        };
        self.visit(&mut pass);
        let energy = pass.energy;
        if self.gravity != Vector3::zeros() {
            for (mass, gradient) in self.masses.iter().zip(gradient.chunks_exact_mut(3)) {
                (0..3).for_each(|i| gradient[i] -= mass * self.gravity[i]);
            }
        }
        energy + self.weight_energy(x)
    }

    /// Computes the Hessian over the unknowns, and its border. A guided node's rows and columns contain its free
    /// directions only; the blocked directions get a positive diagonal, on which no force acts.
    ///
    /// `values` holds, in this order: the lower triangle by columns ([`Cloth::entries`]); the derivative of each clip's
    /// summed gradient with respect to the unknowns, as 3 × clips rows of [`Cloth::unknowns`] entries; one entry to
    /// ignore.
    pub fn hessian(&self, curves: &Curves, x: &[f64], kind: HessianKind<'_>, values: &mut Vec<f64>) {
        let len = self.entries() + self.border_len() + 1;
        let twice = if self.doubles { self.entries() } else { 0 };
        values.clear();
        values.resize(len + twice, 0.0);
        let targets = [&self.targets[0][..], &self.targets[1][..]];
        self.visit(&mut HessianPass { law: curves, x, kind, targets, values });
        // Elements list an entry and its mirror image once; it counts twice if both fall on one diagonal entry.
        (0..twice).for_each(|place| values[place] += 2.0 * values[len + place]);
        values.truncate(len);
        let (lower, border) = values.split_at_mut(self.entries());
        self.filter(lower);
        for row in border.chunks_exact_mut(self.unknowns.len().max(1)) {
            self.guides.iter().for_each(|guide| guide.project(row));
        }
    }

    /// Projects the lower entries of a matrix onto the free directions of guided nodes.
    pub(crate) fn filter(&self, lower: &mut [f64]) {
        self.guides.iter().for_each(|guide| guide.filter(lower));
    }

    /// Position of an entry among the Hessian's values; `None` if it is zero in every state.
    pub fn entry(&self, first: usize, second: usize) -> Option<usize> {
        self.pattern.position(first.max(second), first.min(second))
    }

    /// ∂(gradient)/∂kᵢ for every control value of a component's curve, N per unit of stiffness: one column of 3 × nodes
    /// entries each.
    pub fn parameter_gradient(
        &self,
        curves: &Curves,
        component: Component,
        x: &[f64],
        columns: &mut Vec<f64>,
    ) {
        let points = curves.get(component).map_or(0, |curve| curve.len());
        columns.clear();
        columns.resize(points * 3 * self.points(), 0.0);
        let mut derivative = vec![0.0; points];
        self.visit(&mut ParameterPass {
            law: curves,
            x,
            parameters: component,
            derivative: &mut derivative,
            columns,
        });
    }

    /// K d, N, 3 per node, held nodes included: change of the gradient by a displacement of any nodes.
    ///
    /// * `displacement` — d, 3 stacked coordinates per node, m
    pub fn stiffness_times(&self, curves: &Curves, x: &[f64], displacement: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; x.len()];
        self.visit(&mut StiffnessPass { law: curves, x, displacement, force: &mut force });
        force
    }

    /// All strains of a component, each with the area (m²) it represents.
    pub fn strains(&self, component: Component, x: &[f64]) -> Vec<[f64; 2]> {
        let mut pass = StrainPass { x, component, strains: Vec::new() };
        self.visit(&mut pass);
        pass.strains
    }

    /// Share of the sheet in which a component's strain exceeds the last control point of its curve, where the stress
    /// is extrapolated linearly; 0 for a constant stiffness.
    pub fn extrapolated(&self, curves: &Curves, component: Component, x: &[f64]) -> f64 {
        let Some(curve) = curves.get(component).filter(|curve| curve.len() > 1) else { return 0.0 };
        let last = curve.strains()[curve.len() - 1];
        let is_odd = curve.negative() == NegativeStrain::Odd;
        let (beyond, all) =
            self.strains(component, x).into_iter().fold((0.0, 0.0), |sums, [strain, area]| {
                let reaches = if is_odd { strain.abs() } else { strain };
                (sums.0 + if reaches > last { area } else { 0.0 }, sums.1 + area)
            });
        if all > 0.0 { beyond / all } else { 0.0 }
    }

    /// Gradient summed over the nodes of each clip, N: the force that holds the clip, excluding the clip's own weight.
    pub fn clip_forces(&self, gradient: &[f64]) -> Vec<Vector3<f64>> {
        let mut forces = vec![Vector3::zeros(); self.clips];
        for (node, clip) in self.clip_of.iter().enumerate() {
            if let Some(clip) = *clip {
                forces[clip] += Vector3::from_column_slice(&gradient[3 * node..3 * node + 3]);
            }
        }
        forces
    }

    /// First-order prediction of the membrane's strains after a step, for [`HessianKind::Mixed`].
    pub(crate) fn predicted_strains(&self, x: &[f64], step: &[f64], strains: &mut Vec<f64>) {
        self.visit(&mut PredictedStrainPass { x, step, strains });
    }

    /// True if an angle across an edge changes by more than half a turn between two states, that is, jumps across ±π.
    pub(crate) fn hinge_jumps(&self, x: &[f64], to: &[f64]) -> bool {
        self.bending.as_ref().is_some_and(|bending| bending.jumps(x, to))
    }

    /// True if a triangle flips between two states of a planar problem (3 stacked coordinates per node).
    pub fn turns_over(&self, x: &[f64], to: &[f64]) -> bool {
        let faces_up = |x: &[f64], nodes: [usize; 3]| {
            let [a, b, c] = gather::<3, 2>(stacked(nodes), x);
            (b - a).perp(&(c - a)) > 0.0
        };
        self.planar && self.triangles.iter().any(|&nodes| faces_up(x, nodes) != faces_up(to, nodes))
    }

    pub(crate) fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    pub(crate) fn diagonal(&self) -> &[usize] {
        &self.diagonal
    }

    /// The clip that holds a node, if any.
    pub(crate) fn clip_of(&self, node: usize) -> Option<usize> {
        self.clip_of[node]
    }

    /// True if the tied groups are parallel in a state.
    pub(crate) fn is_parallel(&self, x: &[f64]) -> bool {
        are_alike(&self.twins, x, self.mean_edge)
    }

    pub(crate) fn mean_edge(&self) -> f64 {
        self.mean_edge
    }

    /// Weight of a node, N.
    pub(crate) fn weight(&self, node: usize) -> f64 {
        self.masses[node] * self.gravity.norm()
    }

    fn is_tied(&self) -> bool {
        self.free.len() > self.unknowns.len()
    }

    /// Norm of a gradient over the unknowns, N.
    pub(crate) fn norm(&self, gradient: &[f64]) -> f64 {
        let square = |forces: &mut dyn Iterator<Item = f64>| forces.map(|f| f * f).sum::<f64>().sqrt();
        if !self.is_tied() && self.guides.is_empty() {
            return square(&mut self.unknowns.iter().map(|&coordinate| gradient[coordinate]));
        }
        let mut forces = vec![0.0; self.unknowns.len()];
        self.collect(gradient, &mut forces);
        square(&mut forces.into_iter())
    }

    fn border_len(&self) -> usize {
        3 * self.clips * self.unknowns.len()
    }

    /// Energy of the weight, J: −Σ m g·x; zero without gravity.
    pub fn weight_energy(&self, x: &[f64]) -> f64 {
        if self.gravity == Vector3::zeros() {
            return 0.0;
        }
        let node = |(mass, x): (&f64, &[f64])| -mass * self.gravity.dot(&Vector3::from_column_slice(x));
        self.masses.iter().zip(x.chunks_exact(3)).map(node).sum()
    }

    /// Elastic energy, J: total energy without that of the weight.
    pub fn elastic_energy(&self, curves: &Curves, x: &[f64]) -> f64 {
        let mut pass = EnergyPass { law: curves, x, energy: 0.0 };
        self.visit(&mut pass);
        pass.energy
    }

    /// Mass of every unknown, kg: the whole group's mass for tied nodes.
    pub(crate) fn unknown_masses(&self) -> Vec<f64> {
        let mut masses = vec![0.0; self.unknowns.len()];
        self.free.iter().for_each(|&(coordinate, unknown)| masses[unknown] += self.masses[coordinate / 3]);
        masses
    }

    /// Projects a vector over the unknowns onto the free directions of guided nodes.
    pub(crate) fn project(&self, unknowns: &mut [f64]) {
        self.guides.iter().for_each(|guide| guide.project(unknowns));
    }

    /// Adds a multiple of every node's block to the lower entries of a matrix.
    pub(crate) fn add_blocks(&self, blocks: &[Matrix3<f64>], factor: f64, lower: &mut [f64]) {
        // The unknowns of a node are consecutive.
        for pair in self.free.chunk_by(|a, b| a.0 / 3 == b.0 / 3) {
            for &(row_coordinate, row) in pair {
                for &(column_coordinate, column) in pair.iter().filter(|&&(_, column)| column <= row) {
                    if let Some(place) = self.pattern.position(row, column) {
                        let block = &blocks[row_coordinate / 3];
                        lower[place] += factor * block[(row_coordinate % 3, column_coordinate % 3)];
                    }
                }
            }
        }
    }

    /// Lumped mass of every node, kg.
    pub fn masses(&self) -> &[f64] {
        &self.masses[..self.nodes]
    }

    /// Triangles of the rest mesh.
    pub(crate) fn triangles(&self) -> &[[usize; 3]] {
        &self.triangles
    }

    fn visit(&self, pass: &mut impl Pass) {
        visit(&self.membrane, self.bending.as_ref(), self.planar, pass);
    }
}

/// Magnitudes of the forces at every node, against which an imbalance is judged.
#[derive(Debug, Clone, Default)]
pub struct ForceScale {
    /// Σ over a node's elements of their force on it, N.
    pub magnitude: Vec<f64>,
    /// Stiffness that converts a position error to a force error, N/m.
    pub stiffness: Vec<f64>,
}

impl ForceScale {
    /// Allocates for a cloth's nodes.
    pub fn new(nodes: usize) -> Self {
        Self { magnitude: vec![0.0; nodes], stiffness: vec![0.0; nodes] }
    }
}

/// Runs a pass over the membrane and bending elements of a problem. Every loop over elements goes through here.
fn visit(membrane: &Membrane, bending: Option<&Bending>, planar: bool, pass: &mut impl Pass) {
    membrane.visit(planar, pass);
    if let Some(bending) = bending {
        bending.visit(pass);
    }
}

fn mean_edge(mesh: &Mesh) -> Result<f64> {
    let edges = mesh.edges()?;
    let length = |edge: &Edge| (mesh.positions[edge.ends[1]] - mesh.positions[edge.ends[0]]).norm();
    Ok(edges.iter().map(length).sum::<f64>() / edges.len().max(1) as f64)
}
