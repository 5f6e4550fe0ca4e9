//! Faces and lines in the order of their distance.

use super::super::chart::Drawn;
use super::view::View;
use cloth_sim::mesh::Mesh;
use nalgebra::Vector3;
use plotters::coord::Shift;
use plotters::prelude::*;
use std::f64::consts::TAU;

/// The two sides of the cloth, in full light.
const FRONT: [f64; 3] = [126.0, 164.0, 210.0];
const BACK: [f64; 3] = [222.0, 184.0, 150.0];
/// The support, and the sheet laid flat.
const SUPPORT: [f64; 3] = [200.0, 200.0, 200.0];
const FLAT: RGBColor = RGBColor(228, 228, 228);
const OUTLINE: RGBColor = RGBColor(70, 70, 70);
/// Least share of light on a face.
const DARK: f64 = 0.42;
/// Faces reach beyond their edges by so much, in pixels: no paper shines through between neighbours.
const OVERLAP: f64 = 2.2;
/// A circle's corners.
const CORNERS: usize = 48;

/// Where a panel shows what.
#[derive(Debug, Clone, Copy)]
pub(super) struct Panel {
    /// Pixels a metre.
    pub(super) scale: f64,
    /// Its middle, in pixels.
    pub(super) middle: [f64; 2],
    /// What is seen there, right and up, m.
    pub(super) centre: [f64; 2],
}

enum Item {
    Face(Vec<(i32, i32)>, RGBColor),
    Line(Vec<(i32, i32)>, u32),
    Pin((i32, i32)),
}

/// What is to be drawn, with how near it is.
pub(super) struct Painter<'v> {
    view: &'v View,
    panel: Panel,
    items: Vec<(f64, Item)>,
}

impl<'v> Painter<'v> {
    pub(super) fn new(view: &'v View, panel: Panel) -> Self {
        Self { view, panel, items: Vec::new() }
    }

    /// The sheet, its two sides in two colours, and its border.
    pub(super) fn cloth(&mut self, mesh: &Mesh, positions: &[Vector3<f64>]) {
        // Light falls on the mean normals of corners, so that facets show less.
        let mut normals = vec![Vector3::zeros(); mesh.len()];
        for triangle in &mesh.triangles {
            let normal = cross(&triangle.map(|node| positions[node]));
            triangle.iter().for_each(|&node| normals[node] += normal);
        }
        for triangle in &mesh.triangles {
            let corners = triangle.map(|node| positions[node]);
            let colour = if cross(&corners).dot(&self.view.towards) >= 0.0 { FRONT } else { BACK };
            let smooth: Vector3<f64> = triangle.iter().map(|&node| normals[node]).sum();
            self.face(&corners, smooth, colour);
        }
        // An edge lies as near as its triangle and before it.
        let nearer =
            2e-2 * self.view.extent(positions).iter().flatten().fold(0.0, |m: f64, c| m.max(c.abs()));
        for edge in mesh.edges().unwrap_or_default().iter().filter(|edge| edge.right.is_none()) {
            let ends = edge.ends.map(|node| positions[node]);
            let inner = positions[edge.left];
            let depth = self.depth(&[ends[0], ends[1], inner]) + nearer;
            let points = ends.iter().map(|&end| self.pixel(end)).collect();
            self.items.push((depth, Item::Line(points, 2)));
        }
    }

    /// A node that is held.
    pub(super) fn pin(&mut self, at: Vector3<f64>) {
        let [.., depth] = self.view.see(at);
        let item = Item::Pin(self.pixel(at));
        self.items.push((depth + self.panel.scale.recip() * 20.0, item));
    }

    /// A level disc below everything.
    pub(super) fn disc(&mut self, centre: Vector3<f64>, radius: f64) {
        let points = self.circle(centre, radius);
        self.items.push((f64::MIN, Item::Face(points.iter().map(|&p| self.pixel(p)).collect(), FLAT)));
    }

    /// A level circle above everything.
    pub(super) fn ring(&mut self, centre: Vector3<f64>, radius: f64) {
        let mut points = self.circle(centre, radius);
        points.push(points[0]);
        self.items.push((f64::MAX, Item::Line(points.iter().map(|&p| self.pixel(p)).collect(), 2)));
    }

    /// What stands below a support, down to some point.
    pub(super) fn cylinder(&mut self, centre: Vector3<f64>, radius: f64, foot: Vector3<f64>) {
        let down = foot - centre;
        // A little smaller than what lies on it, so that it never comes through.
        let top = self.circle(centre + 0.05 * down, 0.97 * radius);
        for corner in 0..CORNERS {
            let [a, b] = [top[corner], top[(corner + 1) % CORNERS]];
            let outwards = (0.5 * (a + b) - centre).dot(&self.view.towards);
            if outwards > 0.0 {
                // Drawn in pieces, as the painter sorts by middles.
                for piece in 0..8 {
                    let [from, to] = [piece, piece + 1].map(|i| f64::from(i) / 8.0);
                    let at = |point: Vector3<f64>, share: f64| point + share * down;
                    let corners = [at(a, from), at(b, from), at(b, to), at(a, to)];
                    self.face(&corners, cross(&corners), SUPPORT);
                }
            }
        }
    }

    /// Draws all, the farthest first.
    pub(super) fn draw<B: DrawingBackend>(mut self, area: &DrawingArea<B, Shift>) -> Drawn<()>
    where
        B::ErrorType: 'static,
    {
        self.items.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, item) in self.items {
            match item {
                Item::Face(points, colour) => area.draw(&Polygon::new(points, colour.filled()))?,
                Item::Line(points, width) => {
                    area.draw(&PathElement::new(points, OUTLINE.stroke_width(width)))?
                }
                Item::Pin(at) => area.draw(&Circle::new(at, 5, OUTLINE.filled()))?,
            }
        }
        Ok(())
    }

    /// A flat face, lit by a normal on the side that is seen.
    fn face(&mut self, corners: &[Vector3<f64>], normal: Vector3<f64>, colour: [f64; 3]) {
        let facing = normal.dot(&self.view.towards).signum();
        let light = normal.try_normalize(0.0).map_or(0.0, |n| facing * n.dot(&self.view.light()));
        let share = DARK + (1.0 - DARK) * light.max(0.0);
        let [r, g, b] = colour.map(|part| (part * share).round().clamp(0.0, 255.0) as u8);
        let seen: Vec<[f64; 2]> = corners.iter().map(|&corner| self.place(corner)).collect();
        let middle = [0, 1].map(|axis| seen.iter().map(|p| p[axis]).sum::<f64>() / seen.len() as f64);
        let spread = |p: &[f64; 2]| {
            let [x, y] = [p[0] - middle[0], p[1] - middle[1]];
            let grown = 1.0 + OVERLAP / x.hypot(y).max(1.0);
            ((middle[0] + grown * x).round() as i32, (middle[1] + grown * y).round() as i32)
        };
        let item = Item::Face(seen.iter().map(spread).collect(), RGBColor(r, g, b));
        self.items.push((self.depth(corners), item));
    }

    /// The corners of a level circle.
    fn circle(&self, centre: Vector3<f64>, radius: f64) -> Vec<Vector3<f64>> {
        let [first, second] = self.view.level();
        let corner = |index: usize| {
            let (sine, cosine) = (TAU * index as f64 / CORNERS as f64).sin_cos();
            centre + radius * (cosine * first + sine * second)
        };
        (0..CORNERS).map(corner).collect()
    }

    fn depth(&self, points: &[Vector3<f64>]) -> f64 {
        points.iter().map(|&point| self.view.see(point)[2]).sum::<f64>() / points.len() as f64
    }

    fn place(&self, point: Vector3<f64>) -> [f64; 2] {
        let Panel { scale, middle, centre } = self.panel;
        let [x, y, _] = self.view.see(point);
        // Pixels count downwards.
        [middle[0] + scale * (x - centre[0]), middle[1] - scale * (y - centre[1])]
    }

    fn pixel(&self, point: Vector3<f64>) -> (i32, i32) {
        let [x, y] = self.place(point);
        (x.round() as i32, y.round() as i32)
    }
}

/// Across a face, as long as twice the area of its first three corners.
fn cross(corners: &[Vector3<f64>]) -> Vector3<f64> {
    (corners[1] - corners[0]).cross(&(corners[2] - corners[0]))
}
