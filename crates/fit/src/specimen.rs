//! The specimen as the simulation sees it: a regular grid over the measured rest rectangle, in a frame of its own.
//!
//! ```text
//! measured mesh (any triangulation, any place in space)        specimen frame
//!        ______                                             y │
//!       /\ /| /                                               │▒▒▒▒▒▒▒▒   rest rectangle at z = 0, corner at 0,
//!      /  \/|/           ── isometry ──▶                      │▒▒▒▒▒▒▒▒   x along its side nearer to weft
//!      ‾‾‾‾‾‾                                                 └────────x
//! ```

use crate::error::{Error, Result};
use crate::frame::{MeshPoint, Sequence};
use crate::locator::Locator;
use cloth_sim::mesh::{Diagonals, Grid, Mesh};
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector2, Vector3};

/// Cells along the two sides of a square specimen unless told otherwise: 25×25 nodes.
const DEFAULT_CELLS: usize = 24;

/// What leaves a plane by no more than this slope counts as in it: flattening changes strains by half its square, 1e-5.
pub(crate) const FLAT_SLOPE: f64 = 4.5e-3;

/// The simulation's grid over a measured specimen.
#[derive(Debug, Clone)]
pub struct Specimen {
    /// Maps world coordinates into the specimen's frame.
    pub frame: Isometry3<f64>,
    /// The grid as a mesh, in the specimen's frame; material coordinates are the measured ones.
    pub mesh: Mesh,
    /// The grid.
    pub grid: Grid,
    /// Where each grid node lies in the measured mesh.
    pub samples: Vec<MeshPoint>,
    /// Cloth inside each clip that was cut off, m².
    pub gripped: Vec<f64>,
}

impl Specimen {
    /// Lays a grid over a sequence's rest mesh, less what lies inside bars that grip a whole side: that cloth moves rigidly,
    /// and the grid's border falls on the bar's edge, wherever that is.
    ///
    /// * `nodes` — columns and rows; `None` = as many cells as 25×25 nodes have, near square
    ///
    /// # Errors
    /// A rest mesh that is not a flat rectangle; too few nodes.
    pub fn new(sequence: &Sequence, nodes: Option<[usize; 2]>, diagonals: Diagonals) -> Result<Self> {
        let mechanics = |source| Error::Mechanics { context: sequence.name.clone(), source };
        let rectangle = Rectangle::of(sequence)?;
        let (free, gripped) = free_region(sequence, &rectangle);
        let [corner, opposite] = free;
        let [width, height] = [opposite.x - corner.x, opposite.y - corner.y];
        let [columns, rows] = nodes.unwrap_or_else(|| near_square(width, height, diagonals));
        let grid = Grid { columns, rows, width, height, diagonals };
        let mut mesh = grid.mesh().map_err(mechanics)?;
        let locator = Locator::new(&sequence.mesh, &rectangle.flat, rectangle.size);
        let samples: Vec<MeshPoint> = mesh.positions.iter().map(|p| locator.find(p.xy() + corner)).collect();
        for (material, sample) in mesh.material.iter_mut().zip(&samples) {
            *material = sample.interpolate(&sequence.mesh, &sequence.mesh.material);
        }
        let checked = Mesh::new(mesh.positions, mesh.material, mesh.triangles).map_err(mechanics)?;
        let mut frame = rectangle.frame;
        frame.translation.vector -= Vector3::new(corner.x, corner.y, 0.0);
        Ok(Self { frame, mesh: Mesh { grid: Some(grid), ..checked }, grid, samples, gripped })
    }

    /// The grid's nodes at rest, in world coordinates, m.
    pub fn rest_in_world(&self, node: usize) -> Vector3<f64> {
        let inverse = self.frame.inverse();
        inverse.rotation * self.mesh.positions[node] + inverse.translation.vector
    }

    /// A world position in the specimen's frame.
    pub fn place(&self, world: &Vector3<f64>) -> Vector3<f64> {
        self.frame.rotation * world + self.frame.translation.vector
    }

    /// A world direction (force, gravity) in the specimen's frame.
    pub fn turn(&self, world: &Vector3<f64>) -> Vector3<f64> {
        self.frame.rotation * world
    }
}

/// The rectangle between the bars that grip whole sides, as two corners, and the area inside each bar.
fn free_region(sequence: &Sequence, rectangle: &Rectangle) -> ([Vector2<f64>; 2], Vec<f64>) {
    let [width, height] = rectangle.size;
    let size = Vector2::new(width, height);
    let (mut low, mut high) = (Vector2::zeros(), size);
    let boxes = sequence.clips.iter().map(|clip| bounds(clip.vertices.iter().map(|&v| rectangle.flat[v])));
    let mut gripped = Vec::new();
    for [from, to] in boxes {
        let mut area = 0.0;
        for (along, across) in [(0, 1), (1, 0)] {
            let near = 1e-3 * size[along];
            let whole_side = to[across] - from[across] > 0.98 * size[across];
            let deep = to[along] - from[along];
            // A bar deeper than half the specimen is none.
            if !whole_side || deep > 0.5 * size[along] {
                continue;
            }
            if from[along] < near {
                low[along] = f64::max(low[along], to[along]);
            } else if to[along] > size[along] - near {
                high[along] = f64::min(high[along], from[along]);
            } else {
                continue;
            }
            area += deep * size[across];
        }
        gripped.push(area);
    }
    ([low, high], gripped)
}

/// Columns and rows that make cells near square, with about as many nodes as 25×25: crossed cells have one more each.
pub(crate) fn near_square(width: f64, height: f64, diagonals: Diagonals) -> [usize; 2] {
    let cells =
        (DEFAULT_CELLS * DEFAULT_CELLS) as f64 / if diagonals == Diagonals::Crossed { 2.0 } else { 1.0 };
    let count = |length: f64, side: f64| (length / side).round().max(2.0);
    // The shorter side first, since it takes fewer cells: the longer one then meets their size better.
    let shorter = width.min(height);
    let side = shorter / count(shorter, (width * height / cells).sqrt());
    [width, height].map(|length| count(length, side) as usize + 1)
}

/// The rest rectangle.
pub(crate) struct Rectangle {
    frame: Isometry3<f64>,
    /// Extent along x and y of the specimen's frame, m.
    pub(crate) size: [f64; 2],
    /// Rest positions in the specimen's frame.
    pub(crate) flat: Vec<Vector2<f64>>,
}

impl Rectangle {
    pub(crate) fn of(sequence: &Sequence) -> Result<Self> {
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
        // The side of the hull whose box is smallest; among equal ones the nearest to weft.
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

/// The two sides of the rest rectangle, m.
///
/// # Errors
/// A rest mesh that is not a flat rectangle.
pub(crate) fn rest_size(sequence: &Sequence) -> Result<[f64; 2]> {
    Ok(Rectangle::of(sequence)?.size)
}

/// Twice the area of every triangle at rest, along its normal, m².
fn normals(mesh: &Mesh) -> impl Iterator<Item = Vector3<f64>> + '_ {
    let corners = mesh.triangles.iter().map(|triangle| triangle.map(|vertex| mesh.positions[vertex]));
    corners.map(|[a, b, c]| (b - a).cross(&(c - a)))
}

/// Unit normal of a flat mesh at rest, weft × warp. Summed over triangles it does not care how fine the mesh is.
pub(crate) fn rest_normal(mesh: &Mesh) -> Vector3<f64> {
    normals(mesh).sum::<Vector3<f64>>().normalize()
}

/// The weft direction in space at rest: area-weighted mean of ∂position/∂u.
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

/// Turns a direction by quarter turns until it lies within 45° of the x axis; of two at 45° the one with y < 0.
fn quarter_turn(side: Vector2<f64>) -> Vector2<f64> {
    let turns = [side, Vector2::new(-side.y, side.x), -side, Vector2::new(side.y, -side.x)];
    let better = |a: &Vector2<f64>, b: &Vector2<f64>| {
        if (a.x - b.x).abs() < 1e-6 { b.y.total_cmp(&a.y) } else { a.x.total_cmp(&b.x) }
    };
    turns.into_iter().max_by(better).unwrap_or(side)
}

/// The lowest and the highest corner of the box around points.
pub(crate) fn bounds(points: impl Iterator<Item = Vector2<f64>>) -> [Vector2<f64>; 2] {
    points.fold([Vector2::repeat(f64::MAX), Vector2::repeat(f64::MIN)], |[low, high], p| {
        [low.inf(&p), high.sup(&p)]
    })
}

/// Andrew's monotone chain.
fn convex_hull(mut points: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let scale = points.iter().fold(0.0f64, |m, p| m.max(p.norm_squared()));
    let chain = |points: &mut dyn Iterator<Item = &Vector2<f64>>| {
        let mut chain: Vec<Vector2<f64>> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..] {
                // Points on a side, give or take rounding, are no corners.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Kind;

    fn sequence(mesh: Mesh) -> Sequence {
        Sequence {
            name: "test".into(),
            kind: Kind::StretchWeft,
            gravity: Vector3::zeros(),
            noise: None,
            force_direction: None,
            table: None,
            mesh,
            clips: Vec::new(),
            frames: Vec::new(),
        }
    }

    fn rectangle(width: f64, height: f64) -> Mesh {
        Grid { columns: 14, rows: 9, width, height, diagonals: Diagonals::Alternating }.mesh().unwrap()
    }

    #[test]
    fn a_grid_is_laid_over_a_specimen_wherever_it_is() {
        let mut mesh = rectangle(0.08, 0.04);
        let motion = Isometry3::new(Vector3::new(0.3, -0.2, 0.9), Vector3::new(0.4, 1.2, -0.7));
        mesh.positions.iter_mut().for_each(|p| *p = motion.rotation * *p + motion.translation.vector);
        let specimen = Specimen::new(&sequence(mesh), None, Diagonals::Forward).unwrap();
        let [dx, dy] = specimen.grid.cell();
        assert!((dx / dy - 1.0).abs() < 0.05, "{dx} {dy}");
        assert!((specimen.grid.width - 0.08).abs() < 1e-12 && (specimen.grid.height - 0.04).abs() < 1e-12);
        for (node, material) in specimen.mesh.material.iter().enumerate() {
            assert!((material - specimen.mesh.positions[node].xy()).norm() < 1e-12);
            assert!(
                (specimen.place(&specimen.rest_in_world(node)) - specimen.mesh.positions[node]).norm()
                    < 1e-12
            );
        }
    }

    #[test]
    fn a_strip_cut_on_the_bias_keeps_its_yarns() {
        let mut mesh = rectangle(0.03, 0.1);
        let turn = nalgebra::Rotation2::new(std::f64::consts::FRAC_PI_4);
        mesh.material.iter_mut().for_each(|m| *m = turn * *m);
        let specimen = Specimen::new(&sequence(mesh), Some([5, 13]), Diagonals::Forward).unwrap();
        assert_eq!(specimen.grid.columns * specimen.grid.rows, 65);
        let along = specimen.mesh.material[1] - specimen.mesh.material[0];
        assert!((along.x.abs() - along.y.abs()).abs() < 1e-9 * along.norm());
    }

    #[test]
    fn what_is_no_rectangle_is_refused() {
        let mut mesh = rectangle(0.1, 0.1);
        let shear = |p: f64, q: f64| p + 0.3 * q;
        mesh.positions.iter_mut().for_each(|p| p.x = shear(p.x, p.y));
        assert!(Specimen::new(&sequence(mesh), None, Diagonals::Forward).is_err());
    }
}
