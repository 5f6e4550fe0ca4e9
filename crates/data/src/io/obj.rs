//! Wavefront OBJ: the subset needed for measured cloth, with the line in every error.

use super::number::{number, number_or_unseen};
use super::source::{read_text, shown};
use crate::error::{Error, Result};
use crate::rectangle::bounds;
use cloth_sim::error::Error as Defect;
use cloth_sim::mesh::Mesh;
use nalgebra::{Vector2, Vector3};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Corner of a face: indices of its vertex and its material coordinates, both from 0.
type Corner = (usize, Option<usize>);

/// World directions of the yarns of a flat mesh at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct YarnAxes {
    /// Along weft.
    pub weft: Vector3<f64>,
    /// Along warp.
    pub warp: Vector3<f64>,
}

/// Remedy for texture coordinates.
const TEXTURE: &str = "vt in metres; these, from 0 to 1, are texture coordinates: multiply u by the sample's width and v by its height";

/// Reads a rest mesh; polygons are split into triangles from their first corner.
///
/// * `axes` — if given, the material coordinates are the components of the rest positions along them, and `vt`
///   (possibly texture coordinates) is ignored
///
/// # Errors
/// A file without a valid cloth mesh, with the line; a file without `vt` if no `axes` are given.
pub fn read_mesh(path: &Path, axes: Option<YarnAxes>) -> Result<Mesh> {
    let mut obj = Obj::read(path)?;
    if let Some(YarnAxes { weft, warp }) = axes {
        let along = |(_, p): &(usize, Vector3<f64>)| Vector2::new(p.dot(&weft), p.dot(&warp));
        obj.coordinates = obj.vertices.iter().map(along).collect();
        for (_, corners) in &mut obj.faces {
            corners.iter_mut().for_each(|(vertex, coordinate)| *coordinate = Some(*vertex));
        }
    }
    obj.mesh()
}

/// Statements of a text without comments, each with its first line; a `\` at the end of a line continues the
/// statement.
fn statements(text: &str) -> Vec<(usize, String)> {
    let mut statements: Vec<(usize, String)> = Vec::new();
    let mut goes_on = false;
    for (line, text) in (1..).zip(text.lines()) {
        let text = text.split('#').next().unwrap_or_default().trim_end();
        let (words, more) = text.strip_suffix('\\').map_or((text, false), |words| (words, true));
        match statements.last_mut().filter(|_| goes_on) {
            Some((_, statement)) => *statement += &format!(" {words}"),
            None => statements.push((line, words.into())),
        }
        goes_on = more;
    }
    statements
}

/// Contents of an OBJ file.
pub(super) struct Obj {
    path: PathBuf,
    vertices: Vec<(usize, Vector3<f64>)>,
    coordinates: Vec<Vector2<f64>>,
    faces: Vec<(usize, Vec<Corner>)>,
}

impl Obj {
    /// Reads vertices (`nan` = unobserved), material coordinates and faces; skips normals, groups and materials.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let text = read_text(path)?;
        let (vertices, coordinates, faces) = Default::default();
        let mut obj = Self { path: path.to_path_buf(), vertices, coordinates, faces };
        for (line, words) in statements(&text) {
            obj.read_line(line, &words)?;
        }
        for (line, corners) in &obj.faces {
            for &(vertex, coordinate) in corners {
                obj.check_index(*line, "v", vertex, obj.vertices.len())?;
                obj.check_index(*line, "vt", coordinate.unwrap_or(0), obj.coordinates.len().max(1))?;
            }
        }
        Ok(obj)
    }

    /// The vertices alone: the shape of one frame.
    pub(super) fn positions(self) -> Vec<Vector3<f64>> {
        self.vertices.into_iter().map(|(_, position)| position).collect()
    }

    /// The rest mesh; polygons are split into triangles from their first corner.
    pub(super) fn mesh(self) -> Result<Mesh> {
        let material = self.material()?;
        let mut triangles = Vec::with_capacity(2 * self.faces.len());
        let mut lines = Vec::with_capacity(2 * self.faces.len());
        for (line, corners) in &self.faces {
            for pair in corners[1..].windows(2) {
                triangles.push([corners[0].0, pair[0].0, pair[1].0]);
                lines.push(*line);
            }
        }
        let positions: Vec<_> = self.vertices.iter().map(|(_, position)| *position).collect();
        let is_texture = fill_unit_square(&material);
        Mesh::new(positions, material, triangles.clone()).map_err(|defect| {
            let line = self.line_of(&defect, &triangles, &lines);
            let found = format!("{defect} (counted from 0)");
            let expected = match defect {
                Defect::EdgeLength { .. } if is_texture => TEXTURE,
                _ => "a sheet of cloth in metres",
            };
            Error::input(&self.path, line, "mesh", found, expected)
        })
    }

    fn read_line(&mut self, line: usize, text: &str) -> Result<()> {
        let mut words = text.split_whitespace();
        let Some(keyword) = words.next() else { return Ok(()) };
        let words: Vec<_> = words.collect();
        match keyword {
            "v" => {
                let [x, y, z] = self.numbers(line, keyword, &words, true)?;
                let unseen = [x, y, z].iter().filter(|value| value.is_nan()).count();
                if unseen == 1 || unseen == 2 {
                    let found = format!("nan in {unseen} of 3 coordinates");
                    return Err(self.invalid(line, keyword, found, "finite numbers, or nan in all three"));
                }
                self.vertices.push((line, Vector3::new(x, y, z)));
            }
            "vt" => {
                let [u, v] = self.numbers(line, keyword, &words, false)?;
                self.coordinates.push(Vector2::new(u, v));
            }
            "f" => {
                if words.len() < 3 {
                    let found = format!("{} corners", words.len());
                    return Err(self.invalid(line, keyword, found, "three or more"));
                }
                let corners = words.iter().map(|word| self.corner(line, word)).collect::<Result<_>>()?;
                self.faces.push((line, corners));
            }
            "vn" | "vp" | "g" | "o" | "s" | "l" | "p" | "usemtl" | "mtllib" => {}
            _ => {
                return Err(self.invalid(
                    line,
                    "keyword",
                    shown(keyword),
                    "v, vt, f, or another keyword of OBJ",
                ));
            }
        }
        Ok(())
    }

    /// Parses the first `N` numbers; further ones (a weight, a colour) are skipped.
    fn numbers<const N: usize>(
        &self,
        line: usize,
        field: &str,
        words: &[&str],
        unseen: bool,
    ) -> Result<[f64; N]> {
        let mut values = [f64::NAN; N];
        if words.len() < N {
            return Err(self.invalid(
                line,
                field,
                format!("{} numbers", words.len()),
                format!("{N} numbers"),
            ));
        }
        for (value, word) in values.iter_mut().zip(words) {
            let read = if unseen { number_or_unseen(word) } else { number(word) };
            *value = read.map_err(|expected| self.invalid(line, field, shown(word), expected))?;
        }
        Ok(values)
    }

    /// Parses `v`, `v/vt`, `v/vt/vn` or `v//vn`.
    fn corner(&self, line: usize, word: &str) -> Result<Corner> {
        let mut parts = word.split('/');
        let vertex = self.index(line, "v", parts.next().unwrap_or_default(), self.vertices.len())?;
        let coordinate = match parts.next() {
            None | Some("") => None,
            Some(text) => Some(self.index(line, "vt", text, self.coordinates.len())?),
        };
        Ok((vertex, coordinate))
    }

    /// Converts an OBJ index, from 1 or backwards from the latest element, to an index from 0.
    fn index(&self, line: usize, field: &str, text: &str, so_far: usize) -> Result<usize> {
        let refuse = |expected: &str| self.invalid(line, &format!("f {field}"), shown(text), expected);
        match text.parse::<i64>() {
            Err(_) => Err(refuse("an index")),
            Ok(0) => Err(refuse("an index from 1, or from -1 backwards")),
            Ok(index) => {
                let size =
                    usize::try_from(index.unsigned_abs()).map_err(|_| refuse("an index that exists"))?;
                if index > 0 {
                    return Ok(size - 1);
                }
                so_far.checked_sub(size).ok_or_else(|| refuse(&format!("at most {so_far} backwards")))
            }
        }
    }

    fn check_index(&self, line: usize, field: &str, index: usize, count: usize) -> Result<()> {
        if index < count {
            return Ok(());
        }
        let found = index.saturating_add(1).to_string();
        Err(self.invalid(
            line,
            &format!("f {field}"),
            found,
            format!("an index that exists (there are {count})"),
        ))
    }

    /// The unique material coordinates of every vertex.
    fn material(&self) -> Result<Vec<Vector2<f64>>> {
        let mut found: Vec<Option<(usize, Vector2<f64>)>> = vec![None; self.vertices.len()];
        for (line, corners) in &self.faces {
            for &(vertex, coordinate) in corners {
                let Some(pair) = coordinate.and_then(|index| self.coordinates.get(index)).copied() else {
                    let expected = "v/vt at every corner: vt are the material coordinates in metres";
                    return Err(self.invalid(*line, "f vt", "nothing", expected));
                };
                match found[vertex] {
                    Some((first, other)) if other != pair => {
                        let found =
                            format!("another vt for vertex {vertex} (counted from 0) than on line {first}");
                        return Err(self.invalid(*line, "f vt", found, "one vt for every vertex (no seams)"));
                    }
                    Some(_) => {}
                    None => found[vertex] = Some((*line, pair)),
                }
            }
        }
        let unused = |vertex: usize| {
            self.invalid(self.vertices[vertex].0, "v", "a vertex of no face", "every vertex in a face")
        };
        if found.is_empty() {
            return Err(Error::input(&self.path, None, "v", "no vertex", "the rest mesh"));
        }
        found
            .iter()
            .enumerate()
            .map(|(vertex, pair)| pair.map(|(_, pair)| pair).ok_or_else(|| unused(vertex)))
            .collect()
    }

    /// Line of the vertex or face named by a defect.
    fn line_of(&self, defect: &Defect, triangles: &[[usize; 3]], lines: &[usize]) -> Option<usize> {
        let vertex = |vertex: usize| self.vertices.get(vertex).map(|(line, _)| *line);
        let triangle = |triangle: usize| lines.get(triangle).copied();
        match *defect {
            Defect::NotFinite { vertex: at, .. }
            | Defect::DuplicateVertex { second: at, .. }
            | Defect::UnreferencedVertex { vertex: at } => vertex(at),
            Defect::BadIndex { triangle: at, .. }
            | Defect::ZeroArea { triangle: at }
            | Defect::MirroredMaterial { triangle: at }
            | Defect::ThreeTriangles { triangles: [.., at], .. }
            | Defect::MixedWinding { triangles: [.., at], .. } => triangle(at),
            Defect::EdgeLength { edge: [from, to], .. } => {
                let has = |corners: &[usize; 3]| corners.contains(&from) && corners.contains(&to);
                triangles.iter().position(has).and_then(triangle)
            }
            _ => None,
        }
    }

    fn invalid(
        &self,
        line: usize,
        field: &str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Error {
        Error::input(&self.path, line, field, found, expected)
    }
}

/// True for texture-like coordinates: from 0 to 1 in both directions.
fn fill_unit_square(coordinates: &[Vector2<f64>]) -> bool {
    let [low, high] = bounds(coordinates.iter().copied());
    // A texture leaves at most a margin.
    low.amin() >= 0.0 && high.amax() <= 1.0 && (high - low).amin() > 0.9
}

/// OBJ text of a mesh; it reads back bit-identical.
pub(super) fn written(mesh: &Mesh) -> String {
    let comment = "# v = rest position [m], vt = material coordinates [m]: u = weft, v = warp\n";
    comment.to_string() + &shape(mesh, &mesh.positions)
}

/// OBJ text of the mesh with other vertex positions.
pub(super) fn shape(mesh: &Mesh, positions: &[Vector3<f64>]) -> String {
    let mut text = String::new();
    // Writing into a String cannot fail.
    for p in positions {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for m in &mesh.material {
        let _ = writeln!(text, "vt {} {}", m.x, m.y);
    }
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|vertex| vertex + 1);
        let _ = writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}");
    }
    text
}
