//! Numbering of the unknowns, and the destination of every entry of every element's Hessian.

use crate::element::{Element, Pass, lower_entries};
use crate::linear::matrix::Pattern;
use crate::linear::ordering::order;
use nalgebra::Vector3;
use std::collections::BTreeSet;

/// Marks a coordinate that is not an unknown.
pub(super) const HELD: usize = usize::MAX;

/// Numbers the unknowns in a node order that keeps the factor sparse. The coordinates of a node are consecutive.
///
/// * `places` — rest positions of all nodes, m
pub(super) fn number(
    moves: &[bool],
    neighbours: &[BTreeSet<usize>],
    places: &[Vector3<f64>],
    coordinates: usize,
) -> Vec<usize> {
    let free: Vec<usize> = (0..moves.len()).filter(|&node| moves[node]).collect();
    let mut place = vec![HELD; moves.len()];
    free.iter().enumerate().for_each(|(index, &node)| place[node] = index);
    let graph: Vec<Vec<usize>> = free
        .iter()
        .map(|&node| {
            neighbours[node].iter().map(|&other| place[other]).filter(|&other| other != HELD).collect()
        })
        .collect();
    let places: Vec<Vector3<f64>> = free.iter().map(|&node| places[node]).collect();
    order(&graph, &places)
        .into_iter()
        .flat_map(|index| (0..coordinates).map(move |i| (index, i)))
        .map(|(index, i)| 3 * free[index] + i)
        .collect()
}

/// Row indices of the lower triangle, column by column.
pub(super) fn columns(
    unknowns: &[usize],
    unknown_of: &[usize],
    neighbours: &[BTreeSet<usize>],
) -> Vec<Vec<usize>> {
    unknowns
        .iter()
        .enumerate()
        .map(|(column, &coordinate)| {
            let node = coordinate / 3;
            let around = neighbours[node].iter().copied().chain([node]);
            let mut rows: Vec<usize> = around
                .flat_map(|other| (0..3).map(move |i| 3 * other + i))
                .map(|coordinate| unknown_of[coordinate])
                .filter(|&row| row != HELD && row >= column)
                .collect();
            rows.sort_unstable();
            rows
        })
        .collect()
}

/// The node whose displacement each node shares: itself, or the first of its group.
pub(super) fn leaders(nodes: usize, tied: &[Vec<usize>]) -> Vec<usize> {
    let mut leader: Vec<usize> = (0..nodes).collect();
    for group in tied {
        group.iter().for_each(|&node| leader[node] = group[0]);
    }
    leader
}

/// Collects the pairs of nodes that share an element.
pub(super) struct GraphPass {
    pub(super) neighbours: Vec<BTreeSet<usize>>,
    /// Coordinates that an element has.
    pub(super) used: BTreeSet<usize>,
}

impl GraphPass {
    /// Graph between tied groups.
    pub(super) fn led(self, leader: &[usize]) -> Vec<BTreeSet<usize>> {
        let mut led = vec![BTreeSet::new(); leader.len()];
        for (node, neighbours) in self.neighbours.into_iter().enumerate() {
            let own = leader[node];
            led[own].extend(neighbours.into_iter().map(|other| leader[other]).filter(|&other| other != own));
        }
        led
    }
}

impl Pass for GraphPass {
    fn visit<const K: usize, const N: usize, const S: usize, E: Element<K, N, S>>(
        &mut self,
        _part: usize,
        elements: &[E],
    ) {
        for element in elements {
            let coordinates = element.coordinates();
            let points: BTreeSet<usize> = coordinates.iter().flatten().map(|own| own / 3).collect();
            self.used.extend(coordinates.as_flattened());
            for &from in &points {
                self.neighbours[from].extend(points.iter().filter(|&&to| to != from));
            }
        }
    }
}

/// Records the destination of every entry of every element's Hessian.
pub(super) struct ScatterPass<'a> {
    pub(super) unknown_of: &'a [usize],
    pub(super) clip_of: &'a [Option<usize>],
    pub(super) pattern: &'a Pattern,
    pub(super) clips: usize,
    pub(super) targets: [Vec<u32>; 2],
}

impl ScatterPass<'_> {
    /// * `mirrored` — the element lists the entry once, and it is no diagonal one of its own
    fn target(&self, [first, second]: [usize; 2], mirrored: bool) -> usize {
        let unknown = |coordinate: usize| self.unknown_of[coordinate];
        let border = |coordinate: usize, column: usize| {
            self.clip_of[coordinate / 3].map(|clip| {
                self.pattern.entries() + (3 * clip + coordinate % 3) * self.pattern.size() + column
            })
        };
        let nowhere = self.pattern.entries() + 3 * self.clips * self.pattern.size();
        let place = match (unknown(first), unknown(second)) {
            (HELD, HELD) => None,
            (HELD, column) => border(first, column),
            (column, HELD) => border(second, column),
            (a, b) if a == b && mirrored => {
                self.pattern.position(a, a).map(|diagonal| nowhere + 1 + diagonal)
            }
            (a, b) => self.pattern.position(a.max(b), a.min(b)),
        };
        // Unused entries go to the last place.
        place.unwrap_or(nowhere)
    }
}

impl Pass for ScatterPass<'_> {
    fn visit<const K: usize, const N: usize, const S: usize, E: Element<K, N, S>>(
        &mut self,
        part: usize,
        elements: &[E],
    ) {
        let entries = lower_entries(K, N);
        let mut targets = Vec::with_capacity(entries.len() * elements.len());
        for element in elements {
            let coordinates = element.coordinates();
            let of_entry = |entry: &[(usize, usize); 2]| {
                self.target(entry.map(|(a, i)| coordinates[a][i]), entry[0] != entry[1])
            };
            targets.extend(entries.iter().map(|entry| of_entry(entry) as u32));
        }
        self.targets[part] = targets;
    }
}
