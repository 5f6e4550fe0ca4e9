//! How a sheet lies on a table: which side of its rest rectangle runs outward.
//!
//! ```text
//!  rest rectangle                           axes of the edge
//!   ┌─────────────┐    outward              y (along the edge)   z = x × y
//!   │  s ──▶      │    ──────▶               │
//!   └─────────────┘                          └── x: outward, horizontal as the table tells
//!  0 back end    length
//! ```

use crate::twin::specimen::Specimen;
use cloth_data::error::{Error, Result};
use cloth_data::frame::{Frame, Sequence, is_seen};
use nalgebra::{Isometry3, Matrix2, Matrix3, Rotation3, UnitQuaternion, Vector2, Vector3};

/// Minimum ratio of a sheet's reach outward to its reach across: its sides are then along the edge within about 4°.
const STRAIGHT: f64 = 12.0;

/// How a rest rectangle lies on a table: outward and along the edge, in the plane of the specimen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sheet {
    pub(super) outward: Vector2<f64>,
    pub(super) centre: Vector2<f64>,
    /// Extent outward, m.
    pub(super) length: f64,
    /// Distance of the edge from the sheet's back end, m.
    pub(super) edge: f64,
}

impl Sheet {
    /// Distance past the edge along the sheet, and from its middle line, m.
    pub(super) fn unrolled(&self, at: Vector2<f64>) -> [f64; 2] {
        let from = at - self.centre;
        let along = Vector2::new(-self.outward.y, self.outward.x);
        [from.dot(&self.outward) + 0.5 * self.length - self.edge, from.dot(&along)]
    }

    /// The inverse of [`Sheet::unrolled`].
    pub(super) fn at(&self, s: f64, across: f64) -> Vector2<f64> {
        let along = Vector2::new(-self.outward.y, self.outward.x);
        self.centre + self.outward * (s + self.edge - 0.5 * self.length) + along * across
    }
}

/// A sheet on a table: axes of the edge, and how the sheet lies in them in all frames.
pub(super) struct Layout {
    /// From the specimen's axes to those of the edge: x outward, y along the edge, z = x × y; origin on the edge.
    pub(super) axes: Isometry3<f64>,
    /// The rest rectangle; its edge is still at its back end.
    pub(super) sheet: Sheet,
}

/// A seen vertex of a sheet on a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seen {
    /// Index of the vertex.
    pub(super) vertex: usize,
    /// Distance along the sheet from its back end, m.
    pub(super) s: f64,
    /// Distance from its middle line, m.
    pub(super) across: f64,
    /// Position in the axes of the edge, m.
    pub(super) position: Vector3<f64>,
}

impl Layout {
    /// Finds how the sheet lies on the table from the observed shapes.
    ///
    /// # Errors
    /// No table, no shape, or an edge that is not along a side of the specimen.
    pub(super) fn new(sequence: &Sequence, specimen: &Specimen) -> Result<Self> {
        let Some(table) = sequence.table else {
            return Err(Error::geometry(&sequence.name, "no table", "a [table] in test.toml, with its edge"));
        };
        let turn = |direction: [f64; 3]| specimen.turn(&Vector3::from(direction));
        let edge = turn(table.edge_direction).normalize();
        let outward = turn(table.outward);
        let outward = (outward - edge * outward.dot(&edge)).normalize();
        let origin = specimen.place(&Vector3::from(table.edge_point_m));
        // How far outward the sheet reaches along the two sides of its rest rectangle, by least squares over all
        // points: every frame about its own mean.
        let (mut square, mut product) = (Matrix2::zeros(), [Vector2::zeros(); 2]);
        for frame in &sequence.frames {
            let points: Vec<_> = seen_vertices(sequence, specimen, frame).collect();
            let count = points.len().max(1) as f64;
            let flat = points.iter().map(|(_, at, _)| at).sum::<Vector2<f64>>() / count;
            let place = points.iter().map(|(.., place)| place).sum::<Vector3<f64>>() / count;
            for (_, at, now) in &points {
                let from = at - flat;
                square += from * from.transpose();
                product[0] += from * (now - place).dot(&outward);
                product[1] += from * (now - place).dot(&edge);
            }
        }
        let inverse = square.try_inverse().unwrap_or_else(Matrix2::zeros);
        let [reach, along] = product.map(|product| inverse * product);
        let axis = reach.iamax();
        if !(reach[axis].abs() > STRAIGHT * reach[1 - axis].abs()) {
            return Err(Error::geometry(
                &sequence.name,
                "a sheet whose sides are not along the table's edge, or no shape at all",
                "shapes (positions.npy) of a sheet pushed straight over the edge, and the true outward and \
                 edge_direction",
            ));
        }
        let mut direction = Vector2::zeros();
        direction[axis] = reach[axis].signum();
        let size = Vector2::new(specimen.grid.width, specimen.grid.height);
        let sheet = Sheet { outward: direction, centre: 0.5 * size, length: size[axis], edge: 0.0 };
        // The sheet may lie face down.
        let edge = edge * along.dot(&Vector2::new(-direction.y, direction.x)).signum();
        let rotation = Matrix3::from_columns(&[outward, edge, outward.cross(&edge)]).transpose();
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
        Ok(Self { axes: Isometry3::from_parts((-(rotation * origin)).into(), rotation), sheet })
    }

    /// The seen vertices of a frame.
    pub(super) fn seen(&self, sequence: &Sequence, specimen: &Specimen, frame: &Frame) -> Vec<Seen> {
        let seen = |(vertex, at, now): (usize, Vector2<f64>, Vector3<f64>)| {
            let [s, across] = self.sheet.unrolled(at);
            Seen { vertex, s, across, position: self.placed(&now) }
        };
        seen_vertices(sequence, specimen, frame).map(seen).collect()
    }

    /// A position of the specimen's axes in those of the edge.
    pub(super) fn placed(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.axes.rotation * p + self.axes.translation.vector
    }
}

/// Seen vertices: index, place in the rest rectangle, and position in the specimen's axes.
fn seen_vertices<'s>(
    sequence: &'s Sequence,
    specimen: &'s Specimen,
    frame: &'s Frame,
) -> impl Iterator<Item = (usize, Vector2<f64>, Vector3<f64>)> + 's {
    let places = frame.positions.iter().flatten().enumerate().filter(|(_, place)| is_seen(place));
    places.map(|(vertex, place)| {
        (vertex, specimen.place(&sequence.mesh.positions[vertex]).xy(), specimen.place(place))
    })
}
