//! Relaxation of a planar triangulation towards equilateral triangles.

use nalgebra::Vector2;
use std::collections::HashMap;

/// Alternately moves free nodes to the area-weighted mean of their triangles' circumcentres and flips edges until the
/// triangulation is Delaunay.
///
/// Source: Chen and Holst 2011, centroidal patch triangulations by circumcentres; Lawson 1977, flips.
pub(super) fn relax(
    nodes: &mut [Vector2<f64>],
    triangles: &mut [[usize; 3]],
    fixed: impl Fn(usize) -> bool,
    sweeps: usize,
) {
    for _ in 0..sweeps {
        turn_edges(nodes, triangles);
        let mut sums = vec![(Vector2::zeros(), 0.0); nodes.len()];
        for triangle in &*triangles {
            let [a, b, c] = triangle.map(|node| nodes[node]);
            let (centre, area) = circumcentre(a, b, c);
            for &node in triangle {
                sums[node].0 += area * centre;
                sums[node].1 += area;
            }
        }
        for (node, (sum, area)) in sums.into_iter().enumerate() {
            if !fixed(node) {
                nodes[node] = sum / area;
            }
        }
    }
    turn_edges(nodes, triangles);
}

/// Circumcentre of three points, and twice the area of their triangle.
fn circumcentre(a: Vector2<f64>, b: Vector2<f64>, c: Vector2<f64>) -> (Vector2<f64>, f64) {
    let [b, c] = [b - a, c - a];
    let area = b.perp(&c);
    let [bb, cc] = [b.norm_squared(), c.norm_squared()];
    (a + Vector2::new(c.y * bb - b.y * cc, b.x * cc - c.x * bb) / (2.0 * area), area)
}

/// Flips every edge whose opposite angles sum to more than π, until none is left.
fn turn_edges(nodes: &[Vector2<f64>], triangles: &mut [[usize; 3]]) {
    // Flipping terminates by itself; the limit guards against rounding with four nodes on one circle.
    for _ in 0..50 {
        let mut sides: HashMap<[usize; 2], usize> = HashMap::with_capacity(3 * triangles.len());
        for (triangle, &[a, b, c]) in triangles.iter().enumerate() {
            sides.extend([([a, b], triangle), ([b, c], triangle), ([c, a], triangle)]);
        }
        let mut turned = vec![false; triangles.len()];
        for first in 0..triangles.len() {
            for corner in 0..3 {
                let [a, b, c] = [0, 1, 2].map(|i| triangles[first][(corner + i) % 3]);
                let Some(&second) = sides.get(&[b, a]) else { continue };
                if turned[first] || turned[second] {
                    continue;
                }
                let Some(&d) = triangles[second].iter().find(|&&node| node != a && node != b) else {
                    continue;
                };
                if opposite_angles(nodes, [a, b, c, d]) > 1e-9 {
                    (triangles[first], triangles[second]) = ([c, a, d], [d, b, c]);
                    (turned[first], turned[second]) = (true, true);
                }
            }
        }
        if !turned.contains(&true) {
            return;
        }
    }
}

/// Minus the sine of the sum of the angles at c and d, opposite the edge a–b: positive for sums above π.
fn opposite_angles(nodes: &[Vector2<f64>], quad: [usize; 4]) -> f64 {
    let [a, b, c, d] = quad.map(|node| nodes[node]);
    let angle = |p: Vector2<f64>, q: Vector2<f64>| {
        (p.perp(&q).abs() / (p.norm() * q.norm()), p.dot(&q) / (p.norm() * q.norm()))
    };
    let [(sine_c, cosine_c), (sine_d, cosine_d)] = [angle(a - c, b - c), angle(a - d, b - d)];
    -(sine_c * cosine_d + cosine_c * sine_d)
}
