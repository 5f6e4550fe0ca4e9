//! Triangle meshes: rest positions, material coordinates, triangles, and the edges between them.
//!
//! A mesh is geometry and connectivity only; the energy is defined in [`membrane`](crate::membrane) and
//! [`bending`](crate::bending).

use crate::error::{Error, Result};
use nalgebra::{Vector2, Vector3};
use std::collections::{BTreeMap, HashMap};

/// Split of a grid's cells into triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Diagonals {
    /// '/' in every cell, from its low corner to its high one.
    Forward,
    /// '\' in every cell.
    Backward,
    /// '/' and '\' alternating, as on a chessboard.
    Alternating,
    /// Both in every cell, with a node at its centre.
    ///
    /// For strips cut on the bias: nearly inextensible yarns lock triangles that lack an edge along each yarn, and
    /// these have one along both. Source: Hamila and Boisse 2013; Yu et al. 2006.
    Crossed,
}

/// A regular grid of nodes over a rectangle; node `(column, row)` has index `row · columns + column`. The centres of
/// crossed cells follow, row by row.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Grid {
    /// Nodes along x, at least 2.
    pub columns: usize,
    /// Nodes along y, at least 2.
    pub rows: usize,
    /// Extent along x, m.
    pub width: f64,
    /// Extent along y, m.
    pub height: f64,
    /// Split of the cells.
    pub diagonals: Diagonals,
}

impl Grid {
    /// Index of a node.
    pub fn node(&self, column: usize, row: usize) -> usize {
        row * self.columns + column
    }

    /// Size of a cell along x and y, m.
    pub fn cell(&self) -> [f64; 2] {
        [self.width / (self.columns - 1) as f64, self.height / (self.rows - 1) as f64]
    }

    /// True if a cell is split by '/'; false for '\' or both.
    fn is_forward(&self, column: usize, row: usize) -> bool {
        match self.diagonals {
            Diagonals::Forward => true,
            Diagonals::Backward | Diagonals::Crossed => false,
            Diagonals::Alternating => (column + row).is_multiple_of(2),
        }
    }

    /// Builds the grid as a flat mesh in the plane z = 0; material coordinates equal x and y.
    ///
    /// # Errors
    /// Fewer than two nodes per side, or a side that is not positive.
    pub fn mesh(&self) -> Result<Mesh> {
        let count = |value, field| match value {
            0 | 1 => Err(Error::InvalidValue { field, value: value as f64, expected: "at least 2 nodes" }),
            _ => Ok(()),
        };
        count(self.columns, "columns")?;
        count(self.rows, "rows")?;
        for (field, value) in [("width", self.width), ("height", self.height)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::InvalidValue { field, value, expected: "a positive length in metres" });
            }
        }
        let material = self.nodes();
        let positions = material.iter().map(|p| Vector3::new(p.x, p.y, 0.0)).collect();
        let cells = (0..self.rows - 1).flat_map(|row| (0..self.columns - 1).map(move |column| [column, row]));
        let triangles = cells.flat_map(|cell| self.triangles(cell)).collect();
        let mut mesh = Mesh::new(positions, material, triangles)?;
        mesh.grid = Some(*self);
        Ok(mesh)
    }

    /// Positions of the nodes, m.
    fn nodes(&self) -> Vec<Vector2<f64>> {
        let [dx, dy] = self.cell();
        let places = |columns: usize, rows: usize, offset: f64| {
            (0..rows).flat_map(move |row| {
                (0..columns).map(move |column| {
                    Vector2::new((column as f64 + offset) * dx, (row as f64 + offset) * dy)
                })
            })
        };
        let centres = if self.diagonals == Diagonals::Crossed { self.rows - 1 } else { 0 };
        places(self.columns, self.rows, 0.0).chain(places(self.columns - 1, centres, 0.5)).collect()
    }

    /// Triangles of a cell.
    fn triangles(&self, [column, row]: [usize; 2]) -> Vec<[usize; 3]> {
        let [low, right] = [self.node(column, row), self.node(column + 1, row)];
        let [up, high] = [self.node(column, row + 1), self.node(column + 1, row + 1)];
        if self.diagonals == Diagonals::Crossed {
            let centre = self.columns * self.rows + row * (self.columns - 1) + column;
            [[low, right], [right, high], [high, up], [up, low]].map(|[a, b]| [a, b, centre]).into()
        } else if self.is_forward(column, row) {
            vec![[low, right, high], [low, high, up]]
        } else {
            vec![[low, right, up], [right, high, up]]
        }
    }
}

/// An edge and the vertices opposite it: one at the border, two inside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// End vertices, in the winding of the first triangle.
    pub ends: [usize; 2],
    /// The vertex opposite the edge in its first triangle.
    pub left: usize,
    /// The vertex opposite the edge in its second triangle, if it has one.
    pub right: Option<usize>,
}

/// A validated triangle mesh at rest.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Mesh {
    /// Rest positions, m.
    pub positions: Vec<Vector3<f64>>,
    /// Material coordinates, m: x along weft, y along warp. One pair per vertex.
    pub material: Vec<Vector2<f64>>,
    /// Vertex indices of each triangle, with consistent winding.
    pub triangles: Vec<[usize; 3]>,
    /// The grid from which the mesh was made, if any.
    pub grid: Option<Grid>,
}

impl Mesh {
    /// Validates a mesh.
    ///
    /// # Errors
    /// Non-finite, duplicate or unreferenced vertices; invalid indices; triangles with zero area; an edge with three
    /// triangles; mixed winding; material coordinates that are mirrored or disagree with the rest lengths by more than
    /// 1 %.
    pub fn new(
        positions: Vec<Vector3<f64>>,
        material: Vec<Vector2<f64>>,
        triangles: Vec<[usize; 3]>,
    ) -> Result<Self> {
        if material.len() != positions.len() {
            return Err(Error::ShapeMismatch {
                what: "material coordinates",
                expected: positions.len(),
                found: material.len(),
            });
        }
        let mesh = Self { positions, material, triangles, grid: None };
        mesh.check_vertices()?;
        mesh.check_triangles()?;
        mesh.check_lengths()?;
        Ok(mesh)
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// True if the mesh has no vertices.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Rest positions of the vertices, 3 stacked coordinates each, m: a state from which a solve can start.
    pub fn coordinates(&self) -> Vec<f64> {
        self.positions.iter().flat_map(|p| [p.x, p.y, p.z]).collect()
    }

    /// Twice the signed area of a triangle in material coordinates, m².
    pub fn double_area(&self, triangle: usize) -> f64 {
        let [a, b, c] = self.triangles[triangle].map(|vertex| self.material[vertex]);
        (b - a).perp(&(c - a))
    }

    /// All edges, sorted by their vertices.
    ///
    /// # Errors
    /// An edge with three triangles, or neighbours with opposite winding.
    pub fn edges(&self) -> Result<Vec<Edge>> {
        let mut found: BTreeMap<[usize; 2], (Edge, Vec<usize>)> = BTreeMap::new();
        for (index, &[a, b, c]) in self.triangles.iter().enumerate() {
            for (from, to, opposite) in [(a, b, c), (b, c, a), (c, a, b)] {
                let key = [from.min(to), from.max(to)];
                let Some((edge, triangles)) = found.get_mut(&key) else {
                    found.insert(key, (Edge { ends: [from, to], left: opposite, right: None }, vec![index]));
                    continue;
                };
                triangles.push(index);
                if let [first, second, third] = triangles[..] {
                    return Err(Error::ThreeTriangles { edge: key, triangles: [first, second, third] });
                }
                if edge.ends == [from, to] {
                    return Err(Error::MixedWinding { edge: key, triangles: [triangles[0], index] });
                }
                edge.right = Some(opposite);
            }
        }
        Ok(found.into_values().map(|(edge, _)| edge).collect())
    }

    /// Connected part of each vertex, identified by the part's lowest vertex.
    pub fn parts(&self) -> Vec<usize> {
        let mut part: Vec<usize> = (0..self.len()).collect();
        fn root(part: &mut [usize], mut vertex: usize) -> usize {
            while part[vertex] != vertex {
                part[vertex] = part[part[vertex]];
                vertex = part[vertex];
            }
            vertex
        }
        for &[a, b, c] in &self.triangles {
            for (from, to) in [(a, b), (b, c)] {
                let [from, to] = [root(&mut part, from), root(&mut part, to)];
                part[from.max(to)] = from.min(to);
            }
        }
        (0..self.len()).map(|vertex| root(&mut part, vertex)).collect()
    }

    fn check_vertices(&self) -> Result<()> {
        let mut seen = HashMap::with_capacity(self.len());
        for (vertex, (position, material)) in self.positions.iter().zip(&self.material).enumerate() {
            for (what, finite) in [
                ("rest position", position.iter().all(|c| c.is_finite())),
                ("material coordinate", material.iter().all(|c| c.is_finite())),
            ] {
                if !finite {
                    return Err(Error::NotFinite { what, vertex });
                }
            }
            // Adding zero gives -0 and 0 the same key.
            let key = [position.x, position.y, position.z].map(|c| (c + 0.0).to_bits());
            if let Some(first) = seen.insert(key, vertex) {
                return Err(Error::DuplicateVertex { first, second: vertex });
            }
        }
        Ok(())
    }

    fn check_triangles(&self) -> Result<()> {
        let mut referenced = vec![false; self.len()];
        for (triangle, &[a, b, c]) in self.triangles.iter().enumerate() {
            for vertex in [a, b, c] {
                if vertex >= self.len() {
                    return Err(Error::BadIndex { triangle, vertex, vertices: self.len() });
                }
                referenced[vertex] = true;
            }
            if a == b || b == c || c == a {
                let vertex = if a == b { a } else { c };
                return Err(Error::BadIndex { triangle, vertex, vertices: self.len() });
            }
            let [p, q, r] = [a, b, c].map(|vertex| self.positions[vertex]);
            let longest = (q - p).norm_squared().max((r - q).norm_squared()).max((p - r).norm_squared());
            // Negated to catch NaN.
            if !((q - p).cross(&(r - p)).norm() > 1e-10 * longest) {
                return Err(Error::ZeroArea { triangle });
            }
        }
        if let Some(vertex) = referenced.iter().position(|&seen| !seen) {
            return Err(Error::UnreferencedVertex { vertex });
        }
        Ok(())
    }

    fn check_lengths(&self) -> Result<()> {
        for Edge { ends: [from, to], .. } in self.edges()? {
            let rest = (self.positions[to] - self.positions[from]).norm();
            let material = (self.material[to] - self.material[from]).norm();
            // Negated to catch NaN from overflowing lengths.
            if !((material - rest).abs() <= 0.01 * rest) {
                return Err(Error::EdgeLength { edge: [from, to], rest, material });
            }
        }
        match (0..self.triangles.len()).find(|&triangle| !(self.double_area(triangle) > 0.0)) {
            Some(triangle) => Err(Error::MirroredMaterial { triangle }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;
    use serde::de::IntoDeserializer;

    type Change<'a> = &'a dyn Fn(&mut Vec<Vector3<f64>>, &mut Vec<Vector2<f64>>, &mut Vec<[usize; 3]>);
    type Parts = (Vec<Vector3<f64>>, Vec<Vector2<f64>>, Vec<[usize; 3]>);

    fn square() -> Parts {
        let material = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        (
            material.iter().map(|p: &[f64; 2]| Vector3::new(p[0], p[1], 0.0)).collect(),
            material.into_iter().map(Vector2::from).collect(),
            vec![[0, 1, 2], [0, 2, 3]],
        )
    }

    #[test]
    fn a_grid_has_its_cells_split_as_asked() {
        let mut grid = Grid { columns: 3, rows: 4, width: 2.0, height: 3.0, diagonals: Diagonals::Forward };
        for (diagonals, ends) in [(Diagonals::Forward, [0, 4]), (Diagonals::Backward, [1, 3])] {
            grid.diagonals = diagonals;
            let edges = grid.mesh().unwrap().edges().unwrap();
            assert_eq!(edges.len(), 2 * 4 + 3 * 3 + 6);
            assert!(edges.iter().any(|e| e.ends == ends || e.ends == [ends[1], ends[0]]));
        }
        grid.diagonals = Diagonals::Alternating;
        let mesh = grid.mesh().unwrap();
        let area: f64 = (0..mesh.triangles.len()).map(|t| mesh.double_area(t) / 2.0).sum();
        assert!((area - 6.0).abs() < 1e-12);
        assert!(mesh.parts().iter().all(|&part| part == 0));
    }

    #[test]
    fn crossed_cells_have_a_node_at_their_centre() {
        let grid = Grid { columns: 4, rows: 3, width: 3.0, height: 1.0, diagonals: Diagonals::Crossed };
        let mesh = grid.mesh().unwrap();
        assert_eq!((mesh.len(), mesh.triangles.len()), (4 * 3 + 3 * 2, 4 * 3 * 2));
        assert_eq!(mesh.edges().unwrap().len(), 3 * 3 + 4 * 2 + 4 * 6);
        // Grid nodes first, then the centres row by row.
        assert_eq!(mesh.material[grid.node(3, 1)], Vector2::new(3.0, 0.5));
        assert_eq!(mesh.material[4 * 3 + 4], Vector2::new(1.5, 0.75));
        // Every triangle is a quarter of a cell, with the same winding.
        assert!((0..24).all(|triangle| (mesh.double_area(triangle) - 0.25).abs() < 1e-15));
        assert!(mesh.parts().iter().all(|&part| part == 0));
        let name = IntoDeserializer::<serde::de::value::Error>::into_deserializer("crossed");
        assert_eq!(Diagonals::deserialize(name), Ok(Diagonals::Crossed));
    }

    #[test]
    fn every_defect_is_named() {
        let check = |change: Change<'_>| {
            let (mut p, mut m, mut t) = square();
            change(&mut p, &mut m, &mut t);
            Mesh::new(p, m, t).unwrap_err()
        };
        assert_eq!(
            check(&|p, _, _| p[2].x = f64::NAN),
            Error::NotFinite { what: "rest position", vertex: 2 }
        );
        assert_eq!(check(&|p, _, _| p[3] = p[0]), Error::DuplicateVertex { first: 0, second: 3 });
        assert_eq!(check(&|_, _, t| t.truncate(1)), Error::UnreferencedVertex { vertex: 3 });
        assert_eq!(check(&|_, _, t| t[1][2] = 4), Error::BadIndex { triangle: 1, vertex: 4, vertices: 4 });
        assert_eq!(
            check(&|_, _, t| t[1] = [0, 2, 2]),
            Error::BadIndex { triangle: 1, vertex: 2, vertices: 4 }
        );
        assert_eq!(check(&|p, _, _| p[3] = (p[0] + p[2]) / 2.0), Error::ZeroArea { triangle: 1 });
        assert_eq!(
            check(&|_, _, t| t[1] = [0, 3, 2]),
            Error::MixedWinding { edge: [0, 2], triangles: [0, 1] }
        );
        assert_eq!(
            check(&|_, m, _| m.iter_mut().for_each(|m| m.x *= -1.0)),
            Error::MirroredMaterial { triangle: 0 }
        );
        assert!(matches!(check(&|_, m, _| m.iter_mut().for_each(|m| *m *= 1e3)), Error::EdgeLength { .. }));
        assert!(matches!(check(&|_, m, _| _ = m.pop()), Error::ShapeMismatch { .. }));
        let (mut p, mut m, mut t) = square();
        p.push(Vector3::new(0.5, 0.5, 1.0));
        m.push(Vector2::new(0.5, 0.5));
        t.push([2, 0, 4]);
        assert!(matches!(
            Mesh::new(p, m, t),
            Err(Error::ThreeTriangles { edge: [0, 2], triangles: [0, 1, 2] })
        ));
    }

    #[test]
    fn separate_pieces_are_separate_parts() {
        let (mut p, mut m, mut t) = square();
        let (p2, m2, _) = square();
        p.extend(p2.iter().map(|p| p + Vector3::x() * 5.0));
        m.extend(m2);
        t.extend([[4, 5, 6], [4, 6, 7]]);
        assert_eq!(Mesh::new(p, m, t).unwrap().parts(), [0, 0, 0, 0, 4, 4, 4, 4]);
    }
}
