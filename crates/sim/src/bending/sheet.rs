//! Triangles of a sheet whose law is moment against curvature.

use super::fold::{Fold, wrapped};
use crate::element::{Block, Element, Point, complete, stacked};
use crate::error::{Error, Result};
use crate::material::Component;
use crate::mesh::{Edge, Mesh};
use nalgebra::{Vector2, Vector3};
use std::collections::HashMap;

/// Two triangles form a parallelogram if the middles of its diagonals are no farther apart than this share of their edge.
const PARALLELOGRAM: f64 = 1e-6;

/// Corners and wings, which are nodes; the seventh point has rotations.
const NODES: usize = 6;

/// A triangle and the three beside it, with the curvature of a surface whose normals are those at the middles of its edges.
///
/// ```text
///     w₁ ───── x₂ ───── w₀      θ_e   angle across the edge e opposite to x_e, as of a hinge
///       \     /  \     /        φ_e = s_e (θ_e − θ⁰_e) ± r_e/l_e      from the triangle's normal to that at the edge's middle
///        \   /    \   /         κ   = Σ_e (2 φ_e/h_e) ν_e ν_eᵀ
///         x₀ ───── x₁           ε   = (κ_u, κ_v, κ_uv, κ_vu)
///           \     /
///            \   /              l_e, h_e, ν_e   the edge's length, the height and the unit normal on it, in material coordinates
///             w₂
/// ```
///
/// s_e is ½ between two triangles, 1 beside one that is held, whose normal is prescribed, and 0 at a border. The rotation
/// r_e/l_e is + for one triangle and − for the other; it settles where the moments on both sides are equal, at a border none.
/// Two triangles that form a parallelogram share every constant curvature evenly, and their edge needs no rotation.
///
/// Source: Morley 1968 (the plate); Grinspun, Gingold, Reisman and Zorin 2006 (mid-edge normals), here with angles in place
/// of differences of normals, which saturate at sharp folds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SheetTriangle {
    /// Corners x₀ x₁ x₂, opposite corners w₀ w₁ w₂, and the rotations r₀ r₁ r₂: indices of stacked coordinates.
    pub coordinates: [[usize; 3]; 7],
    /// Area, m².
    pub area: f64,
    /// The edges opposite to the corners.
    pub edges: [SheetEdge; 3],
}

/// An edge of a sheet's triangle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SheetEdge {
    /// θ⁰, rad.
    pub rest_angle: f64,
    /// s, the triangle's share of the angle.
    pub share: f64,
    /// ±1/l, 1/m; 0 if the edge does not rotate.
    pub turn: f64,
    /// 2/h (ν_u², ν_v², ν_u ν_v, ν_u ν_v), 1/m.
    pub curvature: [f64; 4],
}

/// The triangles of a sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Those that are not held.
    pub triangles: Vec<SheetTriangle>,
    /// Middles of the edges that rotate, m, in the order of their rotations, which follow the nodes' coordinates in a state.
    pub rotating: Vec<Vector3<f64>>,
}

impl Sheet {
    /// All triangles of a mesh.
    ///
    /// * `held` — true for nodes at prescribed positions
    /// * `turns` — edges rotate, unless the sheet bends as a cylinder along lines of the mesh
    ///
    /// # Errors
    /// A mesh that is no surface; a triangle without area at rest.
    pub fn new(mesh: &Mesh, held: &[bool], turns: bool) -> Result<Self> {
        let edges = mesh.edges()?;
        let rotates =
            |edge: &&Edge| turns && !is_clamp(edge, held) && !is_diagonal_of_parallelogram(edge, mesh);
        let between = |ends: [usize; 2]| [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let middle = |edge: &Edge| 0.5 * (mesh.positions[edge.ends[0]] + mesh.positions[edge.ends[1]]);
        let rotating = || edges.iter().filter(rotates);
        let rotation_of: HashMap<[usize; 2], usize> = rotating()
            .enumerate()
            .map(|(index, edge)| (between(edge.ends), 3 * mesh.len() + index))
            .collect();
        let edge_of: HashMap<[usize; 2], &Edge> =
            edges.iter().map(|edge| (between(edge.ends), edge)).collect();
        let triangles = mesh.triangles.iter().filter(|corners| !is_held(&corners[..], held));
        let of_corners = |&corners: &[usize; 3]| -> Result<SheetTriangle> {
            let at = corners.map(|node| mesh.material[node]);
            let double = (at[1] - at[0]).perp(&(at[2] - at[0])).abs();
            // Points that an edge lacks repeat others, with zero derivatives.
            let own = stacked(corners);
            let mut coordinates =
                [own[0], own[1], own[2], own[0], own[1], own[2], corners.map(|node| 3 * node)];
            let mut sheet_edges = [SheetEdge::default(); 3];
            for e in 0..3 {
                let ends = [corners[(e + 1) % 3], corners[(e + 2) % 3]];
                let Some(edge) = edge_of.get(&between(ends)) else { continue };
                let along: Vector2<f64> = at[(e + 2) % 3] - at[(e + 1) % 3];
                let length = along.norm();
                // Negated to catch NaN.
                if !(double > 1e-10 * length * length) {
                    return Err(Error::CollapsedWing { edge: ends, wing: corners[e] });
                }
                let is_first = edge.left == corners[e];
                let wing = if is_first { edge.right } else { Some(edge.left) };
                let own = &mut sheet_edges[e];
                if let Some(wing) = wing {
                    coordinates[3 + e] = stacked([wing])[0];
                    let fold = [ends[0], ends[1], corners[e], wing].map(|node| mesh.positions[node]);
                    own.rest_angle = Fold::new(&fold).angle();
                    own.share = if is_clamp(edge, held) { 1.0 } else { 0.5 };
                }
                if let Some(&rotation) = rotation_of.get(&between(ends)) {
                    coordinates[NODES][e] = rotation;
                    own.turn = if is_first { 1.0 / length } else { -1.0 / length };
                }
                let (normal, scale) = (Vector2::new(along.y, -along.x) / length, 2.0 * length / double);
                own.curvature = [(0, 0), (1, 1), (0, 1), (1, 0)].map(|(i, j)| scale * normal[i] * normal[j]);
            }
            Ok(SheetTriangle { coordinates, area: 0.5 * double, edges: sheet_edges })
        };
        Ok(Self {
            triangles: triangles.map(of_corners).collect::<Result<_>>()?,
            rotating: rotating().map(middle).collect(),
        })
    }
}

fn is_held(nodes: &[usize], held: &[bool]) -> bool {
    nodes.iter().all(|&node| held[node])
}

/// True if one of an edge's triangles is held.
fn is_clamp(edge: &Edge, held: &[bool]) -> bool {
    let wings = std::iter::once(edge.left).chain(edge.right);
    is_held(&edge.ends, held) && wings.into_iter().any(|wing| held[wing])
}

/// True if an edge's triangles form a parallelogram, in material coordinates.
fn is_diagonal_of_parallelogram(edge: &Edge, mesh: &Mesh) -> bool {
    let at = |node: usize| mesh.material[node];
    let [from, to] = edge.ends.map(at);
    let apart = edge.right.map(|right| (at(edge.left) + at(right) - from - to).norm());
    apart.is_some_and(|apart| apart <= PARALLELOGRAM * (to - from).norm())
}

impl SheetTriangle {
    /// Places of an edge's ends, corner and wing among the points.
    fn places(edge: usize) -> [usize; 4] {
        [(edge + 1) % 3, (edge + 2) % 3, edge, 3 + edge]
    }

    fn fold(x: &[Point<3>; 7], edge: usize) -> Fold {
        Fold::new(&Self::places(edge).map(|place| x[place]))
    }

    /// φ_e, rad.
    fn angle(&self, x: &[Point<3>; 7], edge: usize, fold: Option<&Fold>) -> f64 {
        let SheetEdge { rest_angle, share, turn, .. } = self.edges[edge];
        fold.map_or(0.0, |fold| share * wrapped(fold.angle() - rest_angle)) + turn * x[NODES][edge]
    }

    /// True if an angle jumps across ±π between two states.
    pub(crate) fn jumps(&self, x: &[Point<3>; 7], to: &[Point<3>; 7]) -> bool {
        (0..3).any(|e| {
            let SheetEdge { rest_angle, share, .. } = self.edges[e];
            let angle = |x: &[Point<3>; 7]| wrapped(Self::fold(x, e).angle() - rest_angle);
            share > 0.0 && (angle(to) - angle(x)).abs() > std::f64::consts::PI
        })
    }
}

impl Element<7, 3, 4> for SheetTriangle {
    const TRANSLATED: usize = NODES;

    fn coordinates(&self) -> [[usize; 3]; 7] {
        self.coordinates
    }

    fn components(&self) -> [Component; 4] {
        [Component::BendWeft, Component::BendWarp, Component::BendTwist, Component::BendTwist]
    }

    fn area(&self) -> f64 {
        self.area
    }

    fn extent(&mut self) -> &mut f64 {
        &mut self.area
    }

    #[inline(always)]
    fn strains(&self, x: &[Point<3>; 7]) -> [f64; 4] {
        let mut strains = [0.0; 4];
        for (e, edge) in self.edges.iter().enumerate() {
            let fold = (edge.share > 0.0).then(|| Self::fold(x, e));
            let angle = self.angle(x, e, fold.as_ref());
            strains.iter_mut().zip(edge.curvature).for_each(|(strain, of_edge)| *strain += angle * of_edge);
        }
        strains
    }

    fn gradients(&self, x: &[Point<3>; 7]) -> [[Point<3>; 7]; 4] {
        self.evaluate(x).1
    }

    #[inline(always)]
    fn evaluate(&self, x: &[Point<3>; 7]) -> ([f64; 4], [[Point<3>; 7]; 4]) {
        let (mut strains, mut gradients) = ([0.0; 4], [[Point::zeros(); 7]; 4]);
        for (e, edge) in self.edges.iter().enumerate() {
            let fold = (edge.share > 0.0).then(|| Self::fold(x, e));
            let angle = self.angle(x, e, fold.as_ref());
            strains.iter_mut().zip(edge.curvature).for_each(|(strain, of_edge)| *strain += angle * of_edge);
            if let Some(fold) = fold {
                for (place, gradient) in Self::places(e).into_iter().zip(fold.gradient(edge.share)) {
                    (0..3).for_each(|c| gradients[c][place] += edge.curvature[c] * gradient);
                }
            }
            (0..3).for_each(|c| gradients[c][NODES][e] = edge.curvature[c] * edge.turn);
        }
        gradients[3] = gradients[2];
        (strains, gradients)
    }

    #[inline(always)]
    fn add_geometric(&self, x: &[Point<3>; 7], stress: &[f64; 4], blocks: &mut [[Block<3>; 7]; 7]) {
        for (e, edge) in self.edges.iter().enumerate().filter(|(_, edge)| edge.share > 0.0) {
            let moment: f64 =
                stress.iter().zip(edge.curvature).map(|(stress, of_edge)| stress * of_edge).sum();
            let mut own = [[Block::zeros(); 4]; 4];
            Self::fold(x, e).add_hessian(edge.share * moment, &mut own);
            complete::<4, 3>(&mut own, 4);
            let places = Self::places(e);
            for (i, &a) in places.iter().enumerate() {
                for (j, &b) in places.iter().enumerate().filter(|&(_, &b)| 1 <= b && b <= a) {
                    blocks[a][b] += if j <= i { own[i][j] } else { own[j][i].transpose() };
                }
            }
        }
    }

    /// As a hinge's, the matrix is semi-definite without the geometric part, which never is.
    fn add_clamped(&self, _x: &[Point<3>; 7], _stress: &[f64; 4], _blocks: &mut [[Block<3>; 7]; 7]) {}
}
