//! Painter's algorithm: faces and lines sorted by depth.

use super::drawing::{Area, Drawn};
use super::view::View;
use cloth_sim::mesh::Mesh;
use nalgebra::Vector3;
use plotters::prelude::*;
use std::f64::consts::TAU;

/// Colours of the two sides of the cloth, fully lit.
const FRONT: [f64; 3] = [126.0, 164.0, 210.0];
const BACK: [f64; 3] = [222.0, 184.0, 150.0];
/// Colours of the support and of the sheet laid flat.
const SUPPORT: [f64; 3] = [200.0, 200.0, 200.0];
const FLAT: RGBColor = RGBColor(228, 228, 228);
const OUTLINE: RGBColor = RGBColor(70, 70, 70);
/// Minimum brightness of a face, as a share of full light.
const DARK: f64 = 0.42;
/// Faces are enlarged by this beyond their edges, and at most by this beyond their corners, in pixels, so that no gaps
/// show between neighbours whose corners are rounded to pixels.
const OVERLAP: f64 = 1.2;
const CORNER: f64 = 4.0;
/// Maximum length of an arrow head, in pixels.
const HEAD: f64 = 18.0;
/// Corners of a circle.
const CORNERS: usize = 48;

/// Mapping from view coordinates to a panel's pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Panel {
    /// Pixels per metre.
    pub(super) scale: f64,
    /// Centre of the panel, in pixels.
    pub(super) middle: [f64; 2],
    /// View coordinates at the centre, right and up, m.
    pub(super) centre: [f64; 2],
}

enum Item {
    Face(Vec<(i32, i32)>, RGBColor),
    Line(Vec<(i32, i32)>, ShapeStyle),
    Pin((i32, i32)),
    Arrow([[f64; 2]; 2], ShapeStyle),
}

/// Items to draw, with their depth.
pub(super) struct Painter<'v> {
    view: &'v View,
    panel: Panel,
    items: Vec<(f64, Item)>,
}

impl<'v> Painter<'v> {
    pub(super) fn new(view: &'v View, panel: Panel) -> Self {
        Self { view, panel, items: Vec::new() }
    }

    /// Adds the sheet, its sides in two colours, and its border.
    pub(super) fn cloth(&mut self, mesh: &Mesh, positions: &[Vector3<f64>]) {
        // Shading by the mean normals at nodes, so that facets are less visible.
        let mut normals = vec![Vector3::zeros(); mesh.len()];
        // Nodes that were not observed leave a hole.
        let is_seen = |nodes: &[usize]| {
            nodes.iter().all(|&node| positions[node].iter().all(|coordinate| coordinate.is_finite()))
        };
        let triangles: Vec<_> = mesh.triangles.iter().filter(|triangle| is_seen(&triangle[..])).collect();
        for triangle in &triangles {
            let normal = cross(&triangle.map(|node| positions[node]));
            triangle.iter().for_each(|&node| normals[node] += normal);
        }
        for triangle in triangles {
            let corners = triangle.map(|node| positions[node]);
            let colour = if cross(&corners).dot(&self.view.towards) >= 0.0 { FRONT } else { BACK };
            let smooth: Vector3<f64> = triangle.iter().map(|&node| normals[node]).sum();
            self.face(&corners, smooth, colour);
        }
        // An edge has the depth of its triangle, slightly nearer.
        let nearer =
            2e-2 * self.view.extent(positions).iter().flatten().fold(0.0, |m: f64, c| m.max(c.abs()));
        let edges = mesh.edges().unwrap_or_default();
        let border = edges.iter().filter(|edge| edge.right.is_none());
        for edge in border.filter(|edge| is_seen(&[edge.ends[0], edge.ends[1], edge.left])) {
            let ends = edge.ends.map(|node| positions[node]);
            let inner = positions[edge.left];
            let depth = self.depth(&[ends[0], ends[1], inner]) + nearer;
            let points = ends.iter().map(|&end| self.pixel(end)).collect();
            self.items.push((depth, Item::Line(points, OUTLINE.stroke_width(2))));
        }
    }

    /// Adds a held node.
    pub(super) fn pin(&mut self, at: Vector3<f64>) {
        let [.., depth] = self.view.see(at);
        let item = Item::Pin(self.pixel(at));
        self.items.push((depth + self.panel.scale.recip() * 20.0, item));
    }

    /// Adds a flat polygon below everything.
    pub(super) fn floor(&mut self, outline: &[Vector3<f64>]) {
        self.items.push((f64::MIN, Item::Face(outline.iter().map(|&p| self.pixel(p)).collect(), FLAT)));
    }

    /// Adds a horizontal disc below everything.
    pub(super) fn disc(&mut self, centre: Vector3<f64>, radius: f64) {
        self.floor(&self.circle(centre, radius));
    }

    /// Adds a horizontal circle above everything.
    pub(super) fn ring(&mut self, centre: Vector3<f64>, radius: f64) {
        let mut points = self.circle(centre, radius);
        points.push(points[0]);
        self.line(&points, OUTLINE.stroke_width(2));
    }

    /// Adds a line above everything but arrows.
    pub(super) fn line(&mut self, points: &[Vector3<f64>], style: ShapeStyle) {
        let points = points.iter().map(|&point| self.pixel(point)).collect();
        self.items.push((0.5 * f64::MAX, Item::Line(points, style)));
    }

    /// Adds an arrow above everything.
    pub(super) fn arrow(&mut self, from: Vector3<f64>, to: Vector3<f64>, style: ShapeStyle) {
        self.items.push((f64::MAX, Item::Arrow([self.place(from), self.place(to)], style)));
    }

    /// Adds a cylindrical support, from its top down to the height of `foot`.
    pub(super) fn cylinder(&mut self, centre: Vector3<f64>, radius: f64, foot: Vector3<f64>) {
        let down = foot - centre;
        // Slightly smaller than the area that the sheet lies on, so that it never shows through.
        let top = self.circle(centre + 0.05 * down, 0.97 * radius);
        for corner in 0..CORNERS {
            let [a, b] = [top[corner], top[(corner + 1) % CORNERS]];
            let outwards = (0.5 * (a + b) - centre).dot(&self.view.towards);
            if outwards > 0.0 {
                // Drawn in pieces, since items are sorted by their centres.
                for piece in 0..8 {
                    let [from, to] = [piece, piece + 1].map(|i| f64::from(i) / 8.0);
                    let at = |point: Vector3<f64>, share: f64| point + share * down;
                    let corners = [at(a, from), at(b, from), at(b, to), at(a, to)];
                    self.face(&corners, cross(&corners), SUPPORT);
                }
            }
        }
    }

    /// Draws all items, the farthest first.
    pub(super) fn draw(mut self, area: &Area<'_>) -> Drawn<()> {
        self.items.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, item) in self.items {
            match item {
                Item::Face(points, colour) => area.draw(&Polygon::new(points, colour.filled()))?,
                Item::Line(points, style) => area.draw(&PathElement::new(points, style))?,
                Item::Pin(at) => area.draw(&Circle::new(at, 5, OUTLINE.filled()))?,
                Item::Arrow(ends, style) => draw_arrow(area, ends, style)?,
            }
        }
        Ok(())
    }

    /// Adds a flat face, shaded by its normal on the visible side.
    fn face(&mut self, corners: &[Vector3<f64>], normal: Vector3<f64>, colour: [f64; 3]) {
        let facing = normal.dot(&self.view.towards).signum();
        let light = normal.try_normalize(0.0).map_or(0.0, |n| facing * n.dot(&self.view.light()));
        let share = DARK + (1.0 - DARK) * light.max(0.0);
        let [r, g, b] = colour.map(|part| (part * share).round().clamp(0.0, 255.0) as u8);
        let seen: Vec<[f64; 2]> = corners.iter().map(|&corner| self.place(corner)).collect();
        let middle = [0, 1].map(|axis| seen.iter().map(|p| p[axis]).sum::<f64>() / seen.len() as f64);
        let from_middle: Vec<[f64; 2]> = seen.iter().map(|p| [p[0] - middle[0], p[1] - middle[1]]).collect();
        let farthest = from_middle.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
        // An edge lies at about the radius of the inscribed circle.
        let grown = 1.0 + (OVERLAP / inner_radius(&from_middle)).min(CORNER / farthest.max(1.0));
        let spread = |[x, y]: &[f64; 2]| {
            ((middle[0] + grown * x).round() as i32, (middle[1] + grown * y).round() as i32)
        };
        let item = Item::Face(from_middle.iter().map(spread).collect(), RGBColor(r, g, b));
        self.items.push((self.depth(corners), item));
    }

    /// Corners of a horizontal circle.
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
        // Pixel rows count downwards.
        [middle[0] + scale * (x - centre[0]), middle[1] - scale * (y - centre[1])]
    }

    fn pixel(&self, point: Vector3<f64>) -> (i32, i32) {
        let [x, y] = self.place(point);
        (x.round() as i32, y.round() as i32)
    }
}

/// Twice the area of a polygon over its perimeter: the radius of the inscribed circle, if there is one.
fn inner_radius(corners: &[[f64; 2]]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let (area, length) = corners.iter().zip(next).fold((0.0, 0.0), |(area, length), ([x, y], [u, v])| {
        (area + x * v - y * u, length + (u - x).hypot(v - y))
    });
    area.abs() / length.max(1.0)
}

/// Normal of a face, as long as twice the area of its first three corners.
fn cross(corners: &[Vector3<f64>]) -> Vector3<f64> {
    (corners[1] - corners[0]).cross(&(corners[2] - corners[0]))
}

/// Draws an arrow in one stroke, its head at most a third of its length; a dot if it is too short to be visible.
pub(super) fn draw_arrow(area: &Area<'_>, [from, to]: [[f64; 2]; 2], style: ShapeStyle) -> Drawn<()> {
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = along[0].hypot(along[1]);
    let pixel = |[x, y]: [f64; 2]| (x.round() as i32, y.round() as i32);
    if length < 1.5 {
        return Ok(area.draw(&Circle::new(pixel(from), 1, style.filled()))?);
    }
    let [x, y] = along.map(|part| part / length);
    let head = HEAD.min(length / 3.0);
    let barb = |side: f64| pixel([to[0] - head * (x + side * y), to[1] - head * (y - side * x)]);
    let points = vec![pixel(from), pixel(to), barb(0.5), pixel(to), barb(-0.5)];
    Ok(area.draw(&PathElement::new(points, style))?)
}
