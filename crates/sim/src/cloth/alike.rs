//! Identical elements between parallel tied groups: one is computed and represents all.
//!
//! ```text
//! ●───●───●───●     line, moves as a whole       every cell between two parallel lines has the strains of the first:
//! │ ╱ │ ╲ │ ╱ │                                  a sheet that bends as a cylinder costs no more than a strip two cells
//! ●───●───●───●     line                         wide (one, if all cells are split alike)
//! ```

use crate::bending::Bending;
use crate::element::{Change, Element};
use crate::membrane::Membrane;
use crate::mesh::Mesh;
use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};

/// Rest offsets closer than this share of the mean edge count as equal.
const SAME_OFFSET: f64 = 1e-6;

/// Two nodes of an omitted element, and the matching two of its representative.
pub(super) type Twins = [[usize; 2]; 2];

/// Finds identical elements.
pub(super) struct Alike<'a> {
    mesh: &'a Mesh,
    /// The first node of each node's group.
    leader: &'a [usize],
    mean_edge: f64,
    twins: BTreeSet<Twins>,
}

/// Identifies identical elements: the groups of their nodes, and the node offsets from the first node in multiples of
/// the smallest distinguishable offset.
type Key = (Vec<usize>, Vec<i64>);

impl<'a> Alike<'a> {
    pub(super) fn new(mesh: &'a Mesh, leader: &'a [usize], mean_edge: f64) -> Self {
        Self { mesh, leader, mean_edge, twins: BTreeSet::new() }
    }

    /// Keeps one of each set of identical elements; returns the node pairs of the omitted ones.
    pub(super) fn merge(mut self, membrane: &mut Membrane, bending: &mut Option<Bending>) -> Vec<Twins> {
        membrane.change(&mut self);
        if let Some(bending) = bending {
            bending.change(&mut self);
        }
        self.twins.into_iter().collect()
    }

    fn key(&self, nodes: &[usize]) -> Key {
        let unit = SAME_OFFSET * self.mean_edge;
        let offsets = nodes.iter().flat_map(|&node| {
            let offset = self.mesh.positions[node] - self.mesh.positions[nodes[0]];
            let material = self.mesh.material[node] - self.mesh.material[nodes[0]];
            [offset.x, offset.y, offset.z, material.x, material.y].map(|c| (c / unit).round() as i64)
        });
        (nodes.iter().map(|&node| self.leader[node]).collect(), offsets.collect())
    }
}

impl Change for Alike<'_> {
    fn change<const K: usize, const S: usize, E: Element<K, 3, S>>(&mut self, elements: &mut Vec<E>) {
        let mut kept: Vec<E> = Vec::new();
        let mut place_of: HashMap<Key, usize> = HashMap::new();
        for mut element in elements.drain(..) {
            let nodes_of =
                |element: &E| element.coordinates()[..E::TRANSLATED].iter().map(|own| own[0] / 3).collect();
            let own: Vec<usize> = nodes_of(&element);
            let rotations = element.coordinates();
            if rotations[E::TRANSLATED..].iter().flatten().any(|own| own / 3 >= self.mesh.len()) {
                // Edges that rotate do so each on its own.
                kept.push(element);
                continue;
            }
            match place_of.entry(self.key(&own)) {
                Entry::Occupied(place) => {
                    let kept = &mut kept[*place.get()];
                    let stands: Vec<usize> = nodes_of(kept);
                    *kept.extent() += *element.extent();
                    let pairs = own[1..].iter().zip(&stands[1..]);
                    self.twins
                        .extend(pairs.map(|(&left_out, &kept)| [[own[0], left_out], [stands[0], kept]]));
                }
                Entry::Vacant(place) => {
                    place.insert(kept.len());
                    kept.push(element);
                }
            }
        }
        *elements = kept;
    }
}

/// True if omitted elements still have the shape of their representatives in a state.
pub(super) fn are_alike(twins: &[Twins], x: &[f64], mean_edge: f64) -> bool {
    twins.iter().all(|[left_out, kept]| {
        let offset = |[from, to]: &[usize; 2], i: usize| x[3 * to + i] - x[3 * from + i];
        (0..3).all(|i| (offset(left_out, i) - offset(kept, i)).abs() <= SAME_OFFSET * mean_edge)
    })
}
