//! Points that a full-field system lost but still recorded: at the origin or at their rest position.

use crate::frame::{Fabric, Sequence, is_seen};
use crate::notice::Notice;
use nalgebra::Vector3;
use std::collections::{BTreeMap, BTreeSet};

/// A vertex that did not move is lost if its neighbours moved by this share of their edge length; cloth does not
/// strain that far.
const LEFT_BEHIND: f64 = 0.25;

/// A vertex is lost if most of its edges are this many times longer, relative to rest, than the other edges of the
/// frame.
const TORN: f64 = 3.0;

/// Number of lost points listed by name.
const NAMED: usize = 5;

/// Marks lost points as unobserved and lists them.
pub(super) fn check(_: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    let surroundings = Surroundings::of(sequence);
    let mut lost = Lost::default();
    let (mut measured, mut followed) = (0, 0);
    for (index, frame) in sequence.frames.iter_mut().enumerate() {
        let Some(positions) = &mut frame.positions else { continue };
        measured += 1;
        let mut found = coincident(positions);
        lost.coincident += found.len();
        let left = surroundings.left_behind(positions, &found);
        lost.left_behind += left.len();
        found.extend(left);
        let torn = surroundings.torn(positions, &found);
        lost.torn += torn.len();
        found.extend(torn);
        found.iter().for_each(|&vertex| positions[vertex] = Vector3::repeat(f64::NAN));
        followed += usize::from(positions.iter().any(is_seen));
        lost.points.extend(found.into_iter().map(|vertex| (index, vertex)));
    }
    if !lost.points.is_empty() {
        notices.push(lost.notice(&sequence.name));
    }
    if !lost.points.is_empty() && followed == 0 {
        notices.push(Notice::doubt(
            &sequence.name,
            "positions.npy",
            format!("no vertex tracked in any of {measured} frames"),
            "shapes, which verify the clip poses of clips.csv; omit positions.npy if there are none",
        ));
    }
}

/// Lost points of all frames.
#[derive(Default)]
struct Lost {
    coincident: usize,
    left_behind: usize,
    torn: usize,
    /// Frame and vertex.
    points: Vec<(usize, usize)>,
}

impl Lost {
    fn notice(&self, sequence: &str) -> Notice {
        let ways = [
            (self.coincident, "at the same place as others"),
            (self.left_behind, "at their rest position, away from their neighbours"),
            (self.torn, "far from their neighbours"),
        ];
        let ways: Vec<String> = ways
            .iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, way)| format!("{count} {way}"))
            .collect();
        let frames: BTreeSet<usize> = self.points.iter().map(|(frame, _)| *frame).collect();
        let first: Vec<String> = self
            .points
            .iter()
            .take(NAMED)
            .map(|(frame, vertex)| format!("vertex {vertex} in frame {frame}"))
            .collect();
        let more = if self.points.len() > NAMED { ", …" } else { "" };
        Notice::remark(
            sequence,
            "positions.npy",
            format!(
                "lost points, in {} frames: {} ({}{more})",
                frames.len(),
                ways.join(", "),
                first.join(", ")
            ),
            "NaN where a vertex was not observed; these points count as unobserved",
        )
    }
}

/// Vertices at exactly the same position as another one, which cloth cannot have.
fn coincident(positions: &[Vector3<f64>]) -> BTreeSet<usize> {
    let mut at: BTreeMap<[u64; 3], Vec<usize>> = BTreeMap::new();
    let seen = positions.iter().enumerate().filter(|(_, place)| is_seen(place));
    for (vertex, place) in seen {
        // −0 equals 0.
        at.entry(<[f64; 3]>::from(*place).map(|c| (c + 0.0).to_bits())).or_default().push(vertex);
    }
    at.into_values().filter(|vertices| vertices.len() > 1).flatten().collect()
}

/// Neighbours of every vertex in the rest mesh.
struct Surroundings {
    rest: Vec<Vector3<f64>>,
    neighbours: Vec<BTreeSet<usize>>,
    /// Held by a clip, whose pose gives its position.
    held: Vec<bool>,
    noise: f64,
}

impl Surroundings {
    fn of(sequence: &Sequence) -> Self {
        let rest = sequence.mesh.positions.clone();
        let mut neighbours = vec![BTreeSet::new(); rest.len()];
        for triangle in &sequence.mesh.triangles {
            for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (triangle[a], triangle[b])) {
                neighbours[a].insert(b);
                neighbours[b].insert(a);
            }
        }
        let mut held = vec![false; rest.len()];
        sequence.clips.iter().flat_map(|clip| &clip.vertices).for_each(|&vertex| held[vertex] = true);
        Self { rest, neighbours, held, noise: sequence.position_noise() }
    }

    /// Neighbours that were observed and are not lost.
    fn seen<'a>(
        &'a self,
        vertex: usize,
        positions: &'a [Vector3<f64>],
        lost: &'a BTreeSet<usize>,
    ) -> impl Iterator<Item = usize> + 'a {
        let neighbours = self.neighbours[vertex].iter().copied();
        neighbours.filter(|other| is_seen(&positions[*other]) && !lost.contains(other))
    }

    /// Vertices exactly at their rest position, in single or double precision, although their neighbours moved away.
    fn left_behind(&self, positions: &[Vector3<f64>], lost: &BTreeSet<usize>) -> BTreeSet<usize> {
        let stays = |vertex: usize| {
            let (now, rest) = (positions[vertex], self.rest[vertex]);
            now == rest || now == rest.map(|c| f64::from(c as f32))
        };
        let resting: BTreeSet<usize> = (0..positions.len()).filter(|&vertex| stays(vertex)).collect();
        let moved_away = |&vertex: &usize| {
            let others: Vec<usize> =
                self.seen(vertex, positions, lost).filter(|other| !resting.contains(other)).collect();
            // A connected region at its rest position, as on a table, is at rest.
            let alone = 2 * others.len() > self.neighbours[vertex].len();
            let mean = |of: &dyn Fn(usize) -> Vector3<f64>| {
                others.iter().map(|&other| of(other)).sum::<Vector3<f64>>() / others.len() as f64
            };
            let edges = others.iter().map(|&other| (self.rest[other] - self.rest[vertex]).norm());
            let edge = edges.sum::<f64>() / others.len() as f64;
            let away = mean(&|other| positions[other] - self.rest[other]).norm();
            alone && away > f64::max(LEFT_BEHIND * edge, 6.0 * self.noise)
        };
        resting.iter().copied().filter(|&v| !self.held[v] && !lost.contains(&v)).filter(moved_away).collect()
    }

    /// Vertices torn from most of their neighbours.
    fn torn(&self, positions: &[Vector3<f64>], lost: &BTreeSet<usize>) -> BTreeSet<usize> {
        let stretch = |vertex: usize, other: usize| {
            let rest = (self.rest[other] - self.rest[vertex]).norm();
            // Noise lengthens short edges.
            let now = ((positions[other] - positions[vertex]).norm() - 6.0 * self.noise).max(0.0);
            now / rest
        };
        let stretches = |vertex: usize| -> Vec<f64> {
            self.seen(vertex, positions, lost).map(|other| stretch(vertex, other)).collect()
        };
        let candidates = || {
            (0..positions.len()).filter(|&v| !self.held[v] && is_seen(&positions[v]) && !lost.contains(&v))
        };
        let mut all: Vec<f64> = candidates().flat_map(stretches).collect();
        all.sort_by(f64::total_cmp);
        let Some(&typical) = all.get(all.len() / 2) else { return BTreeSet::new() };
        let limit = TORN * f64::max(typical, 1.0);
        let is_torn = |vertex: &usize| {
            let own = stretches(*vertex);
            2 * own.iter().filter(|stretch| **stretch > limit).count() > own.len()
        };
        candidates().filter(is_torn).collect()
    }
}
