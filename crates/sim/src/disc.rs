//! A round sheet of nearly equilateral triangles.

mod relax;

use crate::error::{Error, Result};
use crate::mesh::Mesh;
use nalgebra::{Vector2, Vector3};
use relax::relax;
use std::f64::consts::TAU;

/// A disc about the origin: a node at the centre, and 6k nodes around it on the k-th ring.
///
/// Rings are rotated against each other so that rows of similar triangles mark no direction. All nodes except those of
/// the rim and of the kept ring then move until the triangles are nearly equilateral. Hinges then resist bending
/// alike in all directions, and only slightly more than in equilateral triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    /// Radius, m.
    pub radius: f64,
    /// Number of rings around the centre, at least 1.
    pub rings: usize,
    /// Ring whose radius stays at its share of `radius`, for example at the edge of a support.
    pub kept: Option<usize>,
}

/// Relaxation sweeps; more change the mean rigidity by less than 1 %.
const SWEEPS: usize = 60;

impl Disc {
    /// Number of nodes, 1 + 3·rings·(rings + 1).
    pub fn nodes(&self) -> usize {
        first(self.rings + 1)
    }

    /// Nodes of a ring, in the direction of rotation from x to y; ring 0 is the centre.
    pub fn ring(&self, ring: usize) -> std::ops::Range<usize> {
        first(ring)..first(ring + 1)
    }

    /// Builds the disc as a flat mesh in the plane z = 0; material coordinates equal x and y.
    ///
    /// # Errors
    /// No rings, or a radius that is not positive.
    pub fn mesh(&self) -> Result<Mesh> {
        if self.rings == 0 {
            return Err(Error::InvalidValue { field: "rings", value: 0.0, expected: "at least 1" });
        }
        if !(self.radius > 0.0 && self.radius.is_finite()) {
            let expected = "a positive length in metres";
            return Err(Error::InvalidValue { field: "radius", value: self.radius, expected });
        }
        let nodes = (0..=self.rings).flat_map(|ring| {
            let radius = self.radius * ring as f64 / self.rings as f64;
            self.ring(ring).enumerate().map(move |(index, _)| {
                let (sine, cosine) = angle(ring, index).sin_cos();
                radius * Vector2::new(cosine, sine)
            })
        });
        let mut material: Vec<Vector2<f64>> = nodes.collect();
        let mut triangles: Vec<[usize; 3]> = (1..=self.rings).flat_map(band).collect();
        let [rim, kept] = [self.rings, self.kept.unwrap_or(0)].map(|ring| self.ring(ring));
        relax(&mut material, &mut triangles, |node| rim.contains(&node) || kept.contains(&node), SWEEPS);
        let positions = material.iter().map(|p| Vector3::new(p.x, p.y, 0.0)).collect();
        Mesh::new(positions, material, triangles)
    }
}

/// First node of a ring.
fn first(ring: usize) -> usize {
    if ring == 0 { 0 } else { 1 + 3 * ring * (ring - 1) }
}

/// Number of nodes on a ring.
fn count(ring: usize) -> usize {
    if ring == 0 { 1 } else { 6 * ring }
}

/// Angle of a ring's node, rad; indices beyond a full turn continue past 2π.
fn angle(ring: usize, index: usize) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let offset = (ring as f64 * GOLDEN).fract();
    TAU * (index as f64 + offset) / count(ring) as f64
}

/// Triangles between a ring and the one inside it. The nearer of the two rings' next nodes completes the next triangle.
fn band(ring: usize) -> Vec<[usize; 3]> {
    let node = |ring: usize, index: usize| first(ring) + index % count(ring);
    if ring == 1 {
        return (0..6).map(|index| [0, node(1, index), node(1, index + 1)]).collect();
    }
    let [inner, outer] = [count(ring - 1), count(ring)];
    let mut triangles = Vec::with_capacity(inner + outer);
    let (mut i, mut o) = (0, 0);
    while i < inner || o < outer {
        let [from, to] = [node(ring - 1, i), node(ring, o)];
        let out = angle(ring, o + 1) - angle(ring - 1, i);
        let inside = angle(ring - 1, i + 1) - angle(ring, o);
        if i == inner || o < outer && out.abs() <= inside.abs() {
            triangles.push([from, to, node(ring, o + 1)]);
            o += 1;
        } else {
            triangles.push([from, to, node(ring - 1, i + 1)]);
            i += 1;
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bending::Hinge;
    use crate::element::{Element, gather, stacked};
    use crate::samples::rolled;
    use crate::strain_measure::HINGE_STRAIN_PER_CURVATURE;

    #[test]
    fn a_disc_has_its_rings_and_nearly_its_area() {
        let disc = Disc { radius: 0.15, rings: 10, kept: Some(6) };
        let mesh = disc.mesh().unwrap();
        assert_eq!((mesh.len(), mesh.triangles.len()), (disc.nodes(), 6 * 10 * 10));
        for ring in [6, 10] {
            let on = |node: usize| (mesh.material[node].norm() - 0.015 * ring as f64).abs() < 1e-15;
            assert!(disc.ring(ring).all(on));
        }
        let area: f64 = (0..mesh.triangles.len()).map(|t| 0.5 * mesh.double_area(t)).sum();
        // A polygon with 60 corners.
        let polygon = 0.5 * 60.0 * (TAU / 60.0).sin() * 0.15 * 0.15;
        assert!((area - polygon).abs() < 1e-12, "{area} {polygon}");
        assert!(matches!(Disc { radius: 0.1, rings: 0, kept: None }.mesh(), Err(Error::InvalidValue { .. })));
        assert!(matches!(
            Disc { radius: f64::NAN, rings: 3, kept: None }.mesh(),
            Err(Error::InvalidValue { .. })
        ));
    }

    #[test]
    fn triangles_are_nearly_equilateral() {
        let mesh = Disc { radius: 1.0, rings: 20, kept: Some(12) }.mesh().unwrap();
        let shares = (0..mesh.triangles.len()).map(|triangle| {
            let [a, b, c] = mesh.triangles[triangle].map(|node| mesh.material[node]);
            let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
            // 1 for an equilateral triangle, 0.58 for half a square.
            mesh.double_area(triangle) / (longest * longest) / 0.75f64.sqrt()
        });
        let shares: Vec<f64> = shares.collect();
        let mean = shares.iter().sum::<f64>() / shares.len() as f64;
        assert!(mean > 0.8 && shares.iter().all(|&share| share > 0.4), "{mean} {shares:.2?}");
    }

    /// Effective rigidity within a circle over the hinge stiffness, for a mesh rolled along a direction.
    fn rigidity(mesh: &Mesh, degrees: f64, within: f64) -> f64 {
        let radius = 1e3;
        let place = |m: &Vector2<f64>| <[f64; 3]>::from(rolled(*m, f64::to_radians(degrees), radius));
        let x: Vec<f64> = mesh.material.iter().flat_map(place).collect();
        let energy = |hinge: &Hinge| {
            let [a, b] = [0, 1].map(|end| mesh.material[hinge.nodes[end]].norm());
            // Half of an edge on the circle belongs to it.
            let share = [a, b].map(|r| if (r - within).abs() < 1e-9 { 0.5 } else { f64::from(r < within) });
            let [strain] = hinge.strains(&gather(stacked(hinge.nodes), &x));
            share[0].min(share[1]) * 0.5 * strain * strain * Element::<4, 3, 1>::area(hinge)
        };
        let hinges = Hinge::all(mesh).unwrap();
        let area = |t: usize| {
            let inside = mesh.triangles[t].iter().all(|&node| mesh.material[node].norm() < within + 1e-9);
            if inside { 0.5 * mesh.double_area(t) } else { 0.0 }
        };
        let area: f64 = (0..mesh.triangles.len()).map(area).sum();
        2.0 * hinges.iter().map(energy).sum::<f64>() * radius * radius / area
    }

    #[test]
    fn hinges_resist_bending_nearly_as_in_equilateral_triangles_and_alike_in_all_directions() {
        // The rigidity of an infinite sheet of equilateral triangles is exactly three times the hinge stiffness, in all
        // directions.
        let expected = HINGE_STRAIN_PER_CURVATURE;
        for rings in [20, 40] {
            let kept = rings * 3 / 5;
            let mesh = Disc { radius: 0.15, rings, kept: Some(kept) }.mesh().unwrap();
            for within in [kept, rings].map(|ring| 0.15 * ring as f64 / rings as f64) {
                let found = [0.0, 40.0, 80.0, 120.0].map(|degrees| rigidity(&mesh, degrees, within));
                assert!(found.iter().all(|k| (k / expected - 1.0).abs() < 0.05), "{rings}: {found:?}");
                assert!(found.iter().all(|k| (k / found[0] - 1.0).abs() < 1e-6), "{rings}: {found:?}");
            }
        }
    }
}
