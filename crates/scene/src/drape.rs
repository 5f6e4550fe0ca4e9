//! Drape of a round sheet over a support: shadow and folds.
//!
//! ```text
//! drape coefficient = (A_shadow − A_support)/(A_flat − A_support)        1 for a board, 0 for a hanging tube
//! ```
//!
//! The shadow is the union of all triangles seen along gravity. The integration is exact along scan lines and uses the
//! midpoint rule across them.
//!
//! Source: Cusick 1968; ISO 9073-9.

use cloth_sim::mesh::Mesh;
use nalgebra::{Vector2, Vector3};

/// Number of scan lines over the shadow.
const LINES: usize = 2000;

/// A wave of the rim counts as a fold if it rises and falls by this share of the rim's total height range.
const FOLD: f64 = 0.1;

/// A rim is level if its heights differ by less than this share of the sheet's size.
const LEVEL: f64 = 1e-6;

/// Drape of a sheet.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Drape {
    /// The drape coefficient, 0 … 1.
    pub coefficient: f64,
    /// Difference from the coefficient with half as many scan lines.
    pub coefficient_error: f64,
    /// Area of the shadow, m².
    pub shadow_m2: f64,
    /// Area of the held part, m².
    pub support_m2: f64,
    /// Area of the flat sheet, m².
    pub flat_m2: f64,
    /// Number of folds: waves of the rim.
    pub folds: usize,
    /// Least and greatest depth of the rim below the support, m.
    pub rim_depth_m: [f64; 2],
}

/// Measures the drape of a shape.
///
/// * `held` — the nodes on the support
/// * `centre` — of the support, in material coordinates, m
/// * `down` — unit vector
pub fn drape(
    mesh: &Mesh,
    positions: &[Vector3<f64>],
    held: &[usize],
    centre: Vector2<f64>,
    down: Vector3<f64>,
) -> Drape {
    let mut is_held = vec![false; mesh.len()];
    held.iter().for_each(|&node| is_held[node] = true);
    let area = |triangle: usize| 0.5 * mesh.double_area(triangle);
    let on_support = |&triangle: &usize| mesh.triangles[triangle].iter().all(|&node| is_held[node]);
    let flat_m2: f64 = (0..mesh.triangles.len()).map(area).sum();
    let support_m2: f64 = (0..mesh.triangles.len()).filter(on_support).map(area).sum();
    let flattened = seen_along(positions, down);
    let [shadow_m2, coarse] = [LINES, LINES / 2].map(|lines| shadow(&flattened, &mesh.triangles, lines));
    let coefficient = |shadow: f64| (shadow - support_m2) / (flat_m2 - support_m2);
    let level = held.iter().map(|&node| positions[node].dot(&down)).sum::<f64>() / held.len().max(1) as f64;
    let depths: Vec<f64> = rim(mesh, centre).iter().map(|&node| positions[node].dot(&down) - level).collect();
    let fold = |start: f64, of: fn(f64, f64) -> f64| depths.iter().fold(start, |m, &depth| of(m, depth));
    Drape {
        coefficient: coefficient(shadow_m2),
        coefficient_error: (coefficient(shadow_m2) - coefficient(coarse)).abs(),
        shadow_m2,
        support_m2,
        flat_m2,
        folds: waves(&depths, LEVEL * flat_m2.sqrt()),
        rim_depth_m: [fold(f64::MAX, f64::min), fold(f64::MIN, f64::max)],
    }
}

/// Points projected along a direction.
fn seen_along(positions: &[Vector3<f64>], down: Vector3<f64>) -> Vec<Vector2<f64>> {
    let aside = if down.x.abs() < 0.5 { Vector3::x() } else { Vector3::y() };
    let first = (aside - down * aside.dot(&down)).normalize();
    let second = first.cross(&down);
    positions.iter().map(|p| Vector2::new(p.dot(&first), p.dot(&second))).collect()
}

/// Area of the union of triangles, m².
fn shadow(points: &[Vector2<f64>], triangles: &[[usize; 3]], lines: usize) -> f64 {
    let [low, high] =
        points.iter().fold([f64::MAX, f64::MIN], |[low, high], p| [low.min(p.y), high.max(p.y)]);
    let width = (high - low) / lines as f64;
    let mut spans: Vec<Vec<[f64; 2]>> = vec![Vec::new(); lines];
    for triangle in triangles {
        let corners = triangle.map(|node| points[node]);
        let ys = corners.map(|p| (p.y - low) / width - 0.5);
        let [first, last] =
            [ys.iter().fold(f64::MAX, |m, y| m.min(*y)), ys.iter().fold(f64::MIN, |m, y| m.max(*y))];
        for line in (first.ceil().max(0.0) as usize)..lines.min((last.floor() + 1.0).max(0.0) as usize) {
            if let Some(span) = crossing(&corners, low + (line as f64 + 0.5) * width) {
                spans[line].push(span);
            }
        }
    }
    spans.into_iter().map(|spans| width * covered(spans)).sum()
}

/// Interval in which a line y = const crosses a triangle.
fn crossing(corners: &[Vector2<f64>; 3], y: f64) -> Option<[f64; 2]> {
    let mut span = [f64::MAX, f64::MIN];
    for side in 0..3 {
        let [a, b] = [corners[side], corners[(side + 1) % 3]];
        if (a.y <= y) != (b.y <= y) {
            let x = a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y);
            span = [span[0].min(x), span[1].max(x)];
        }
    }
    (span[0] < span[1]).then_some(span)
}

/// Length of the union of intervals.
fn covered(mut spans: Vec<[f64; 2]>) -> f64 {
    spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut sum, mut end) = (0.0, f64::MIN);
    for [from, to] in spans {
        sum += (to - from.max(end)).max(0.0);
        end = end.max(to);
    }
    sum
}

/// Border nodes, in order around a point of the sheet.
fn rim(mesh: &Mesh, centre: Vector2<f64>) -> Vec<usize> {
    let edges = mesh.edges().unwrap_or_default();
    let border = edges.iter().filter(|edge| edge.right.is_none());
    let mut nodes: Vec<usize> = border.flat_map(|edge| edge.ends).collect();
    let angle = |node: usize| {
        let from = mesh.material[node] - centre;
        from.y.atan2(from.x)
    };
    nodes.sort_by(|&a, &b| angle(a).total_cmp(&angle(b)).then(a.cmp(&b)));
    nodes.dedup();
    nodes
}

/// Number of times a closed line rises and falls by more than a share of its range.
///
/// * `level` — a line with a smaller range is level
fn waves(heights: &[f64], level: f64) -> usize {
    let top = (0..heights.len()).max_by(|&a, &b| heights[a].total_cmp(&heights[b]));
    let Some(top) = top else { return 0 };
    let lowest = heights.iter().fold(f64::MAX, |m, &h| m.min(h));
    let least = FOLD * (heights[top] - lowest);
    if !(heights[top] - lowest > level) {
        return 0;
    }
    // From the top down, then alternately up and down.
    let (mut count, mut falling, mut extreme) = (0, true, heights[top]);
    for step in 1..=heights.len() {
        let height = heights[(top + step) % heights.len()];
        if falling {
            extreme = extreme.min(height);
            if height - extreme >= least {
                (count, falling, extreme) = (count + 1, false, height);
            }
        } else {
            extreme = extreme.max(height);
            if extreme - height >= least {
                (falling, extreme) = (true, height);
            }
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_sim::disc::Disc;
    use std::f64::consts::{PI, TAU};

    #[test]
    fn a_shadow_is_the_union_of_what_overlaps() {
        // Two unit squares that share a quarter, and a triangle in the shadow of the first.
        let points =
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5], [1.5, 0.5], [1.5, 1.5], [0.5, 1.5]];
        let points: Vec<Vector2<f64>> = points.into_iter().map(Vector2::from).collect();
        let triangles = [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 6, 7], [0, 1, 3]];
        assert!((shadow(&points, &triangles, 1500) - 1.75).abs() < 1e-12);
    }

    #[test]
    fn a_cone_casts_the_shadow_of_its_circle_and_a_wave_is_counted() {
        let disc = Disc { radius: 0.15, rings: 20, kept: Some(12) };
        let mesh = disc.mesh().unwrap();
        let held: Vec<usize> = (0..mesh.len()).filter(|&node| mesh.material[node].norm() < 0.0901).collect();
        let shape = |slope: f64, waves: f64| -> Vec<Vector3<f64>> {
            let place = |m: &Vector2<f64>| {
                let beyond = (m.norm() - 0.09).max(0.0);
                let (inside, angle) = (m.norm() - beyond, m.y.atan2(m.x));
                let radius = inside + beyond * slope.cos();
                let depth = beyond * (slope.sin() + 0.2 * (waves * angle).cos());
                Vector3::new(radius * angle.cos(), radius * angle.sin(), -depth)
            };
            mesh.material.iter().map(place).collect()
        };
        let down = -Vector3::z();
        let flat = drape(&mesh, &shape(0.0, 0.0), &held, Vector2::zeros(), down);
        assert!((flat.coefficient - 1.0).abs() < 1e-4 && flat.coefficient_error < 1e-5, "{flat:?}");
        let steep = drape(&mesh, &shape(0.5 * PI, 7.0), &held, Vector2::zeros(), down);
        assert!(steep.coefficient.abs() < 1e-3, "{steep:?}");
        let cone = drape(&mesh, &shape(PI / 3.0, 7.0), &held, Vector2::zeros(), down);
        let ring = |radius: f64| 0.5 * TAU * radius * radius;
        let expected = (ring(0.12) - ring(0.09)) / (ring(0.15) - ring(0.09));
        assert!((cone.coefficient - expected).abs() < 2e-3, "{} {expected}", cone.coefficient);
        assert_eq!((flat.folds, cone.folds), (0, 7));
        assert!((cone.rim_depth_m[1] - cone.rim_depth_m[0] - 0.06 * 0.4).abs() < 1e-4);
    }
}
