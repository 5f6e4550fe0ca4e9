//! Cases 13 to 17: invalid meshes. Every defect is an error that names its place.

use crate::property::for_all;
use crate::table::{Extent, Row};
use cloth_sim::error::{Error, Result};
use cloth_sim::mesh::{Diagonals, Grid, Mesh};
use nalgebra::{Rotation3, Vector2, Vector3};
use proptest::prelude::*;

/// Arrays that make up a mesh.
#[derive(Debug, Clone)]
pub(crate) struct Parts {
    pub(crate) positions: Vec<Vector3<f64>>,
    pub(crate) material: Vec<Vector2<f64>>,
    triangles: Vec<[usize; 3]>,
}

impl Parts {
    fn mesh(&self) -> Result<Mesh> {
        Mesh::new(self.positions.clone(), self.material.clone(), self.triangles.clone())
    }

    /// Twice the rest area over the square of the longest side.
    fn slimness(&self, triangle: usize) -> f64 {
        let [p, q, r] = self.triangles[triangle].map(|vertex| self.positions[vertex]);
        let longest = (q - p).norm_squared().max((r - q).norm_squared()).max((p - r).norm_squared());
        (q - p).cross(&(r - p)).norm() / longest
    }
}

/// Sheets of 1 mm to 10 m, with any position and orientation, of 2×2 to 6×6 nodes; and a number that selects a place in
/// them.
fn sheets() -> impl Strategy<Value = (Parts, usize)> {
    let splits = prop::sample::select(vec![
        Diagonals::Forward,
        Diagonals::Backward,
        Diagonals::Alternating,
        Diagonals::Crossed,
    ]);
    let turn = prop::array::uniform3(-3.0..3.0);
    (2..7usize, 2..7usize, -3.0..1.0, -1.0..1.0, splits, turn, 0..100_000usize).prop_map(
        |(columns, rows, size, aspect, diagonals, turn, at)| {
            let width = 10f64.powf(size);
            let height = width * 10f64.powf(aspect);
            let mesh = Grid { columns, rows, width, height, diagonals }.mesh().unwrap();
            let rotation = Rotation3::new(Vector3::from(turn));
            let positions =
                mesh.positions.iter().map(|p| rotation * p + Vector3::from(turn) * width).collect();
            (Parts { positions, material: mesh.material, triangles: mesh.triangles }, at)
        },
    )
}

/// A row of sheets with a defect somewhere.
///
/// * `spoil` — inserts the defect at a place
/// * `named` — the words that the message must contain; `None` if the error is a wrong one
pub(crate) fn spoilt(
    case: u8,
    condition: &str,
    extent: Extent,
    spoil: impl Fn(&mut Parts, usize),
    named: impl Fn(&Error, &Parts) -> Option<String>,
) -> Row {
    for_all(Row::new(case, condition), extent.runs(300, 10_000), sheets(), |row, (mut sheet, at)| {
        if let Err(error) = sheet.mesh() {
            return row.holds(false, || format!("sound, but {error}"));
        }
        spoil(&mut sheet, at);
        let found = sheet.mesh().err();
        let words = found.as_ref().and_then(|error| named(error, &sheet));
        let holds =
            found.as_ref().zip(words).is_some_and(|(error, words)| error.to_string().contains(&words));
        row.holds(holds, || format!("{at}: {found:?}"))
    })
}

/// NaN, duplicate, unreferenced and missing vertices.
pub(crate) fn case_13(extent: Extent) -> Vec<Row> {
    let not_finite = |error: &Error, _: &Parts| match error {
        Error::NotFinite { vertex, .. } => Some(format!("vertex {vertex}: ")),
        _ => None,
    };
    let mut rows = Vec::new();
    for (what, bad) in [("NaN", f64::NAN), ("infinite", f64::INFINITY)] {
        rows.push(spoilt(
            13,
            &format!("{what} rest position"),
            extent,
            |sheet, at| {
                let len = sheet.positions.len();
                sheet.positions[at % len][at % 3] = bad;
            },
            not_finite,
        ));
        rows.push(spoilt(
            13,
            &format!("{what} material coordinate"),
            extent,
            |sheet, at| {
                let len = sheet.material.len();
                sheet.material[at % len][at % 2] = bad;
            },
            not_finite,
        ));
    }
    rows.push(spoilt(
        13,
        "duplicate vertex",
        extent,
        |sheet, at| {
            let len = sheet.positions.len();
            let from = (at + 1 + at / len % (len - 1)) % len;
            sheet.positions[at % len] = sheet.positions[from];
        },
        |error, sheet| match *error {
            Error::DuplicateVertex { first, second } if sheet.positions[first] == sheet.positions[second] => {
                Some(format!("vertices {first} and {second}"))
            }
            _ => None,
        },
    ));
    rows.push(spoilt(
        13,
        "vertex without a triangle",
        extent,
        |sheet, _| {
            sheet.positions.push(Vector3::repeat(1e3));
            sheet.material.push(Vector2::repeat(1e3));
        },
        |error, sheet| match *error {
            Error::UnreferencedVertex { vertex } if vertex + 1 == sheet.positions.len() => {
                Some(format!("vertex {vertex} belongs to no triangle"))
            }
            _ => None,
        },
    ));
    for (what, twice) in [("index out of range", false), ("a vertex twice in a triangle", true)] {
        rows.push(spoilt(
            13,
            what,
            extent,
            |sheet, at| {
                let (triangle, len) = (at % sheet.triangles.len(), sheet.positions.len());
                sheet.triangles[triangle][at % 3] =
                    if twice { sheet.triangles[triangle][(at + 1) % 3] } else { len + at };
            },
            |error, sheet| match *error {
                Error::BadIndex { triangle, vertex, .. } if sheet.triangles[triangle].contains(&vertex) => {
                    Some(format!("triangle {triangle}: vertex {vertex}"))
                }
                _ => None,
            },
        ));
    }
    rows
}

/// A triangle without rest area.
pub(crate) fn case_14(extent: Extent) -> Vec<Row> {
    [("exactly on the edge", 0.0), ("1e-12 of the edge above it", 1e-12)]
        .into_iter()
        .map(|(condition, height)| {
            spoilt(
                14,
                condition,
                extent,
                |sheet, at| {
                    let [a, b, c] = sheet.triangles[at % sheet.triangles.len()];
                    let [p, q, r] = [a, b, c].map(|vertex| sheet.positions[vertex]);
                    let foot = 0.1 + 0.8 * (at % 97) as f64 / 97.0;
                    let across = (r - p) - (q - p) * ((r - p).dot(&(q - p)) / (q - p).norm_squared());
                    let up = across.normalize() * (height * (q - p).norm());
                    sheet.positions[c] = p + (q - p) * foot + up;
                },
                |error, sheet| match *error {
                    Error::ZeroArea { triangle } if sheet.slimness(triangle) <= 1e-10 => {
                        Some(format!("triangle {triangle}: its rest area is zero"))
                    }
                    _ => None,
                },
            )
        })
        .collect()
}

/// An edge with three faces: a fin on any inner edge.
pub(crate) fn case_15(extent: Extent) -> Vec<Row> {
    [false, true]
        .into_iter()
        .map(|turned| {
            let condition = if turned { "wound one way" } else { "wound the other way" };
            spoilt(
                15,
                condition,
                extent,
                |sheet, at| {
                    let edges = sheet.mesh().unwrap().edges().unwrap();
                    let inner: Vec<_> = edges.iter().filter(|edge| edge.right.is_some()).collect();
                    let [a, b] = inner[at % inner.len()].ends;
                    let fin = sheet.positions.len();
                    // A mirrored copy of the edge's left wing, turned up: positions and material coordinates keep its
                    // lengths.
                    let left = inner[at % inner.len()].left;
                    let [p, q, r] = [a, b, left].map(|vertex| sheet.positions[vertex]);
                    let turn = Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(q - p), 1.0);
                    sheet.positions.push(p + turn * (r - p));
                    sheet.material.push(sheet.material[left]);
                    sheet.triangles.push(if turned { [b, a, fin] } else { [a, b, fin] });
                },
                |error, sheet| match *error {
                    Error::ThreeTriangles { edge, triangles } => {
                        let share =
                            |triangle: usize| edge.iter().all(|v| sheet.triangles[triangle].contains(v));
                        triangles.into_iter().all(share).then(|| format!("edge {}-{} ", edge[0], edge[1]))
                    }
                    _ => None,
                },
            )
        })
        .collect()
}

/// A triangle with opposite winding to its neighbours.
pub(crate) fn case_16(extent: Extent) -> Vec<Row> {
    [("one triangle", 1), ("every second triangle", 2)]
        .into_iter()
        .map(|(condition, every)| {
            spoilt(
                16,
                condition,
                extent,
                |sheet, at| {
                    let len = sheet.triangles.len();
                    let flip = |i: usize| if every == 1 { i == at % len } else { i % 2 == at % 2 };
                    let triangles = sheet.triangles.iter_mut().enumerate();
                    triangles.filter(|(i, _)| flip(*i)).for_each(|(_, triangle)| triangle.swap(0, 1));
                },
                |error, sheet| match *error {
                    Error::MixedWinding { edge, triangles: [a, b] } => {
                        let share =
                            |triangle: usize| edge.iter().all(|v| sheet.triangles[triangle].contains(v));
                        (share(a) && share(b) && a != b).then(|| format!("triangles {a} and {b} "))
                    }
                    _ => None,
                },
            )
        })
        .collect()
}

/// Material coordinates that are missing, mirrored or of different size; agreement within 1 % is accepted.
pub(crate) fn case_17(extent: Extent) -> Vec<Row> {
    let lengths = |error: &Error, _: &Parts| match *error {
        Error::EdgeLength { edge, .. } => Some(format!("edge {}-{}: ", edge[0], edge[1])),
        _ => None,
    };
    let mirrored = |error: &Error, _: &Parts| match *error {
        Error::MirroredMaterial { triangle } => Some(format!("triangle {triangle}: ")),
        _ => None,
    };
    let map = |of: fn(Vector2<f64>) -> Vector2<f64>| {
        move |sheet: &mut Parts, _: usize| sheet.material.iter_mut().for_each(|m| *m = of(*m))
    };
    let mut rows = vec![
        spoilt(
            17,
            "missing",
            extent,
            |sheet, at| sheet.material.truncate(at % sheet.material.len()),
            |error, _| matches!(error, Error::ShapeMismatch { .. }).then(|| "material coordinates".into()),
        ),
        spoilt(17, "mirrored", extent, map(|m| Vector2::new(-m.x, m.y)), mirrored),
        spoilt(17, "weft and warp exchanged", extent, map(|m| m.yx()), mirrored),
        spoilt(17, "1.1 % too long", extent, map(|m| m * 1.011), lengths),
        spoilt(
            17,
            "one in thousand of a vertex's",
            extent,
            |sheet, at| {
                let len = sheet.material.len();
                sheet.material[at % len] *= 1e3;
                sheet.material[at % len].x += 1e3;
            },
            lengths,
        ),
        spoilt(17, "sheared by 30 %", extent, map(|m| Vector2::new(m.x + 0.3 * m.y, m.y)), lengths),
    ];
    let row = Row::new(17, "0.9 % too long or short: taken");
    rows.push(for_all(
        row,
        extent.runs(300, 10_000),
        (sheets(), -0.009..0.009),
        |row, ((mut sheet, _), by)| {
            sheet.material.iter_mut().for_each(|m| *m *= 1.0 + by);
            let found = sheet.mesh();
            row.holds(found.is_ok(), || format!("{by}: {found:?}"))
        },
    ));
    rows
}
