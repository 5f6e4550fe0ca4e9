//! The flat rectangle of a specimen at rest, in any position and orientation.

use crate::error::{Error, Result};
use crate::frame::Sequence;
use cloth_sim::mesh::Mesh;
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector2, Vector3};

/// Slope from the plane below which a mesh counts as flat: flattening changes strains by half its square, 1e-5.
pub const FLAT_SLOPE: f64 = 4.5e-3;

/// The rest mesh of a sequence as a rectangle.
pub struct Rectangle {
    /// Maps world coordinates into the frame of the rectangle: corner at 0, x along the side nearer to weft.
    pub frame: Isometry3<f64>,
    /// Extent along x and y, m.
    pub size: [f64; 2],
    /// Rest positions in that frame, m.
    pub flat: Vec<Vector2<f64>>,
}

impl Rectangle {
    /// Smallest rectangle around the rest mesh.
    ///
    /// # Errors
    /// A rest mesh that is not a flat rectangle.
    pub fn of(sequence: &Sequence) -> Result<Self> {
        let mesh = &sequence.mesh;
        let bad = |found: String, expected: &str| Error::Geometry {
            sequence: sequence.name.clone(),
            found,
            expected: expected.into(),
        };
        let normal = rest_normal(mesh);
        let centre = mesh.positions.iter().sum::<Vector3<f64>>() / mesh.len() as f64;
        let off_plane = mesh.positions.iter().fold(0.0f64, |m, p| m.max((p - centre).dot(&normal).abs()));
        let area: f64 = normals(mesh).map(|n| n.norm()).sum::<f64>() / 2.0;
        if off_plane > 0.01 * area.sqrt() {
            return Err(bad(format!("a vertex {off_plane:.2e} m off the plane"), "a flat rest mesh"));
        }
        let weft = weft_direction(mesh, &normal);
        let turned = |x: Vector3<f64>| Matrix3::from_columns(&[x, normal.cross(&x), normal]).transpose();
        let flatten = |axes: &Matrix3<f64>| -> Vec<Vector2<f64>> {
            mesh.positions.iter().map(|p| (axes * (p - centre)).xy()).collect()
        };
        let hull = convex_hull(flatten(&turned(weft)));
        let weft_axes = turned(weft);
        // The hull side with the smallest box; among equal ones the nearest to weft.
        let sides = (0..hull.len()).map(|i| (hull[(i + 1) % hull.len()] - hull[i]).normalize());
        let best = sides
            .map(|side| {
                let turn = quarter_turn(side);
                let [low, high] = bounds(hull.iter().map(|p| Vector2::new(p.dot(&turn), turn.perp(p))));
                let extent = high - low;
                (turn, extent.x * extent.y)
            })
            .min_by(|(a, area_a), (b, area_b)| {
                let close = (area_a - area_b).abs() <= 1e-9 * area_a;
                if close { b.x.total_cmp(&a.x) } else { area_a.total_cmp(area_b) }
            });
        let Some((side, box_area)) = best else {
            return Err(bad("no triangle".into(), "a rest mesh"));
        };
        if (box_area - area).abs() > 0.01 * area {
            return Err(bad(
                format!("a rest mesh of {area:.3e} m² in a rectangle of {box_area:.3e} m²"),
                "a rectangular specimen",
            ));
        }
        let x = weft_axes.transpose() * Vector3::new(side.x, side.y, 0.0);
        let axes = turned(x);
        let [low, high] = bounds(flatten(&axes).into_iter());
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        let shift = -(rotation * centre) - Vector3::new(low.x, low.y, 0.0);
        let frame = Isometry3::from_parts(Translation3::from(shift), rotation);
        let flat = mesh.positions.iter().map(|p| (rotation * p + shift).xy()).collect();
        Ok(Self { frame, size: [high.x - low.x, high.y - low.y], flat })
    }
}

/// Sides of the rest rectangle, m.
///
/// # Errors
/// A rest mesh that is not a flat rectangle.
pub fn rest_size(sequence: &Sequence) -> Result<[f64; 2]> {
    Ok(Rectangle::of(sequence)?.size)
}

/// Twice the rest area of every triangle, along its normal, m².
fn normals(mesh: &Mesh) -> impl Iterator<Item = Vector3<f64>> + '_ {
    let corners = mesh.triangles.iter().map(|triangle| triangle.map(|vertex| mesh.positions[vertex]));
    corners.map(|[a, b, c]| (b - a).cross(&(c - a)))
}

/// Unit normal of a flat mesh at rest, weft × warp. As a sum over triangles it does not depend on mesh density.
pub fn rest_normal(mesh: &Mesh) -> Vector3<f64> {
    normals(mesh).sum::<Vector3<f64>>().normalize()
}

/// Weft direction in space at rest: area-weighted mean of ∂position/∂u.
fn weft_direction(mesh: &Mesh, normal: &Vector3<f64>) -> Vector3<f64> {
    let mut sum = Vector3::zeros();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex]);
        let [p, q, r] = triangle.map(|vertex| mesh.material[vertex]);
        // area × ∂x/∂u, from x = a + (b − a)s + (c − a)t.
        sum += (b - a) * (r - p).y - (c - a) * (q - p).y;
    }
    (sum - normal * sum.dot(normal)).normalize()
}

/// Rotates a direction by quarter turns to within 45° of the x axis; of two at 45° the one with y < 0.
fn quarter_turn(side: Vector2<f64>) -> Vector2<f64> {
    let turns = [side, Vector2::new(-side.y, side.x), -side, Vector2::new(side.y, -side.x)];
    let better = |a: &Vector2<f64>, b: &Vector2<f64>| {
        if (a.x - b.x).abs() < 1e-6 { b.y.total_cmp(&a.y) } else { a.x.total_cmp(&b.x) }
    };
    turns.into_iter().max_by(better).unwrap_or(side)
}

/// Lowest and highest corner of the bounding box of points.
pub fn bounds(points: impl Iterator<Item = Vector2<f64>>) -> [Vector2<f64>; 2] {
    points.fold([Vector2::repeat(f64::MAX), Vector2::repeat(f64::MIN)], |[low, high], p| {
        [low.inf(&p), high.sup(&p)]
    })
}

/// Convex hull by Andrew's monotone chain.
fn convex_hull(mut points: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let scale = points.iter().fold(0.0f64, |m, p| m.max(p.norm_squared()));
    let chain = |points: &mut dyn Iterator<Item = &Vector2<f64>>| {
        let mut chain: Vec<Vector2<f64>> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..] {
                // Points on a side, up to rounding, are not corners.
                if (b - a).perp(&(p - a)) > 1e-9 * scale {
                    break;
                }
                chain.pop();
            }
            chain.push(*p);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter());
    hull.extend(chain(&mut points.iter().rev()));
    hull
}
