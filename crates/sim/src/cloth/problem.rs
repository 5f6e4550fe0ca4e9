//! A cloth problem and its validation.

use crate::error::{Error, Part, Result};
use crate::load::{Guided, Held};
use crate::material::{Component, Model};
use crate::mesh::Mesh;
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// A cloth problem.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    /// The sheet at rest.
    pub mesh: &'a Mesh,
    /// Membrane and bending model.
    pub model: Model,
    /// Components that store energy; the others are omitted.
    pub components: &'a [Component],
    /// Areal density, kg/m².
    pub areal_density: f64,
    /// Gravity, m/s²; zero for weightless cloth.
    pub gravity: Vector3<f64>,
    /// Nodes at prescribed positions.
    pub held: &'a [Held],
    /// Groups of nodes that share one displacement, such as the lines of a sheet that bends as a cylinder. The groups
    /// are parallel at rest and stay so in every state, so one element represents all identical elements between the
    /// same groups. A group is free as a whole, or held as a whole by one clip.
    pub tied: &'a [Vec<usize>],
    /// Nodes that may move in some directions only; neither held nor tied.
    pub guided: &'a [Guided],
    /// Planar motion, z = const: two unknowns per node.
    pub planar: bool,
    /// Shape without bending moments.
    pub rest: Rest,
}

/// Shape in which a sheet has no bending moments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rest {
    /// Flat, as woven.
    #[default]
    Flat,
    /// The shape of the mesh, as for pleats that were set.
    AsLaidOut,
}

impl<'a> Problem<'a> {
    /// A free sheet in space without mass or weight; a starting point for struct update syntax.
    ///
    /// * `components` — components that store energy; [`Component::ALL`] is valid even if some have no curve
    pub fn new(mesh: &'a Mesh, model: Model, components: &'a [Component]) -> Self {
        Self {
            mesh,
            model,
            components,
            areal_density: 0.0,
            gravity: Vector3::zeros(),
            held: &[],
            tied: &[],
            guided: &[],
            planar: false,
            rest: Rest::Flat,
        }
    }
}

/// Rejects an invalid problem.
pub(super) fn check(problem: &Problem<'_>) -> Result<()> {
    let density = problem.areal_density;
    if !(density >= 0.0 && density.is_finite()) {
        return Err(Error::InvalidValue {
            field: "areal_density",
            value: density,
            expected: "0 or more, in kg/m²",
        });
    }
    let bends = problem.components.iter().any(|component| component.is_bending());
    if problem.planar && (bends || !problem.guided.is_empty() || problem.gravity.z != 0.0) {
        return Err(Error::InvalidValue {
            field: "planar",
            value: 1.0,
            expected: "a problem without bending, guides or out-of-plane weight",
        });
    }
    let mesh = problem.mesh;
    if let Some(held) = problem.held.iter().find(|held| held.node >= mesh.len()) {
        return Err(Error::ShapeMismatch { what: "held node", expected: mesh.len(), found: held.node });
    }
    let held: BTreeMap<usize, Option<usize>> =
        problem.held.iter().map(|held| (held.node, held.clip)).collect();
    let mut seen = BTreeSet::new();
    let mut unfit = |group: &[usize], node: usize| {
        node >= mesh.len() || held.get(&node) != held.get(&group[0]) || !seen.insert(node)
    };
    let nodes = problem.tied.iter().flat_map(|group| group.iter().map(move |&node| (group, node)));
    if let Some((_, node)) = nodes.into_iter().find(|&(group, node)| unfit(group, node)) {
        return Err(Error::InvalidValue {
            field: "tied",
            value: node as f64,
            expected: "nodes of the mesh, each in one group, which is free or held by one clip",
        });
    }
    let tied: BTreeSet<usize> = problem.tied.iter().flatten().copied().collect();
    let mut seen = BTreeSet::new();
    let mut unfit = |&&Guided { node, .. }: &&Guided| {
        node >= mesh.len() || held.contains_key(&node) || tied.contains(&node) || !seen.insert(node)
    };
    if let Some(guided) = problem.guided.iter().find(|guided| unfit(guided)) {
        let expected = "nodes of the mesh, each once, and neither held nor tied";
        return Err(Error::InvalidValue { field: "guided", value: guided.node as f64, expected });
    }
    Ok(())
}

/// Checks that every part of the cloth is held by a node, or by guides that block all translations.
pub(super) fn check_pinned(problem: &Problem<'_>) -> Result<()> {
    let mesh = problem.mesh;
    if problem.held.iter().any(|held| held.node >= mesh.len()) {
        // Other errors are reported later.
        return Ok(());
    }
    let parts = mesh.parts();
    let mut pinned: BTreeSet<usize> = problem.held.iter().map(|held| parts[held.node]).collect();
    let mut blocked: BTreeMap<usize, Matrix3<f64>> = BTreeMap::new();
    for guided in problem.guided.iter().filter(|guided| guided.node < mesh.len()) {
        *blocked.entry(parts[guided.node]).or_default() += Matrix3::identity() - guided.free.projection()?;
    }
    let holds = |blocked: &Matrix3<f64>| blocked.symmetric_eigenvalues().min() > 1e-9;
    pinned.extend(blocked.iter().filter(|(_, blocked)| holds(blocked)).map(|(&part, _)| part));
    let mut sizes: BTreeMap<usize, usize> = BTreeMap::new();
    parts.iter().filter(|part| !pinned.contains(part)).for_each(|&part| *sizes.entry(part).or_default() += 1);
    if sizes.is_empty() {
        return Ok(());
    }
    let parts = sizes.into_iter().map(|(vertex, vertices)| Part { vertex, vertices }).collect();
    Err(Error::Unpinned { parts, free: if problem.planar { 3 } else { 6 } })
}
