//! Locates points in a flat mesh.

use crate::frame::MeshPoint;
use crate::rectangle::bounds;
use cloth_sim::mesh::Mesh;
use nalgebra::Vector2;

/// Finds the triangle of a flat mesh that contains a point, by means of buckets.
pub struct Locator<'a> {
    mesh: &'a Mesh,
    /// In-plane vertex positions, from 0 to `size`, m.
    flat: &'a [Vector2<f64>],
    size: [f64; 2],
    buckets: Vec<Vec<usize>>,
    side: usize,
}

impl<'a> Locator<'a> {
    /// Sorts the triangles of a mesh into buckets.
    ///
    /// * `flat` — in-plane vertex positions, between 0 and `size`, m
    pub fn new(mesh: &'a Mesh, flat: &'a [Vector2<f64>], size: [f64; 2]) -> Self {
        let side = ((mesh.triangles.len() as f64).sqrt() as usize / 2).max(1);
        let mut locator = Self { mesh, flat, size, buckets: vec![Vec::new(); side * side], side };
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            let [low, high] = bounds(triangle.iter().map(|&vertex| flat[vertex]));
            let ([i0, j0], [i1, j1]) = (locator.bucket(low), locator.bucket(high));
            for j in j0..=j1 {
                (i0..=i1).for_each(|i| locator.buckets[j * side + i].push(index));
            }
        }
        locator
    }

    fn bucket(&self, p: Vector2<f64>) -> [usize; 2] {
        let place = |p: f64, size: f64| ((p / size * self.side as f64).max(0.0) as usize).min(self.side - 1);
        [place(p.x, self.size[0]), place(p.y, self.size[1])]
    }

    /// The triangle that contains a point, or is nearest to it in case of rounding at the border.
    pub fn find(&self, p: Vector2<f64>) -> MeshPoint {
        let [i, j] = self.bucket(p);
        let here = &self.buckets[j * self.side + i];
        let depth = |point: &MeshPoint| point.weights.into_iter().fold(f64::MAX, f64::min);
        let best = |triangles: &mut dyn Iterator<Item = usize>| {
            triangles
                .map(|triangle| self.barycentric(triangle, p))
                .max_by(|a, b| depth(a).total_cmp(&depth(b)))
        };
        match best(&mut here.iter().copied()) {
            Some(point) if depth(&point) > -1e-9 => point,
            // In a coarse mesh the border of a bucket may belong to a neighbour.
            _ => best(&mut (0..self.mesh.triangles.len()))
                .unwrap_or(MeshPoint { triangle: 0, weights: [1.0, 0.0, 0.0] }),
        }
    }

    fn barycentric(&self, triangle: usize, p: Vector2<f64>) -> MeshPoint {
        let [a, b, c] = self.mesh.triangles[triangle].map(|vertex| self.flat[vertex]);
        let area = (b - a).perp(&(c - a));
        let [u, v] = [(p - a).perp(&(c - a)) / area, (b - a).perp(&(p - a)) / area];
        MeshPoint { triangle, weights: [1.0 - u - v, u, v] }
    }
}
