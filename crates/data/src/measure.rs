//! Scalar summaries of a test, measured or simulated: one angle, torque, force or profile per frame.
//!
//! ```text
//!  effective shear        aggregated torque      force difference         bend profile
//!    ______                  ──▶                  ↖        ↗
//!   /     /  γ             ▲ ┌──┐ │                 ┌────┐               ───────╮   outward ─▶
//!  /_____/               + │ │  │ ▼ −               └────┘               table  │╲
//!                            └──┘                 ↙        ↘                    ╰ ╲  height ▼
//!                            ◀──
//! ```
//!
//! Plain functions on plain data, so that measured and simulated frames are evaluated identically. [`clamped`],
//! [`clip_centres`] and [`pulls`] extract the inputs from a measured frame. A simulation supplies the positions of
//! its nodes, and one [`Pull`] per clip or per clamped node.
//!
//! Source: Miguel et al. 2012, §6 and figure 7, which name the measures; details they leave open are defined here.

use crate::frame::{Clip, Cord, Frame, Sequence, Table};
use cloth_sim::mesh::Grid;
use nalgebra::{Isometry3, Matrix2, Matrix3x2, Point3, SVector, Vector2, Vector3};
use std::f64::consts::TAU;

/// Ratio of extent across to extent along below which points are collinear.
const COLLINEAR: f64 = 1e-6;

/// A force on a clip and its point of application. A clip may have several.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pull {
    /// Index of the clip.
    pub clip: usize,
    /// Force of the cords on the clip, N.
    pub force: Vector3<f64>,
    /// Point of application, m.
    pub point: Vector3<f64>,
}

/// A line of the cloth parallel to the table edge; the mean of its nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfilePoint {
    /// Rest distance from the rear line on the table, m.
    pub rest: f64,
    /// Distance beyond the edge, m; negative on the table.
    pub outward: f64,
    /// Height above the table, m; negative below it.
    pub height: f64,
}

/// Material coordinates and positions in a frame, m, of all clamped vertices.
pub fn clamped(sequence: &Sequence, frame: &Frame) -> (Vec<Vector2<f64>>, Vec<Vector3<f64>>) {
    let clips = sequence.clips.iter().zip(&frame.poses);
    let vertices = clips.flat_map(|(clip, pose)| clip.vertices.iter().map(move |&vertex| (vertex, pose)));
    let place = |(vertex, pose): (usize, &Isometry3<f64>)| {
        (sequence.mesh.material[vertex], moved(pose, &sequence.mesh.positions[vertex]))
    };
    vertices.map(place).unzip()
}

/// Centre of each clip in a frame, m: the mean of its vertices.
pub fn clip_centres(sequence: &Sequence, frame: &Frame) -> Vec<Vector3<f64>> {
    let centre = |(clip, pose): (&Clip, &Isometry3<f64>)| {
        let vertices = clip.vertices.iter().map(|&vertex| sequence.mesh.positions[vertex]);
        moved(pose, &mean(vertices))
    };
    sequence.clips.iter().zip(&frame.poses).map(centre).collect()
}

/// Cord forces of a frame. A force without a point of application acts at the centre of its clip.
pub fn pulls(sequence: &Sequence, frame: &Frame) -> Vec<Pull> {
    let centres = clip_centres(sequence, frame);
    let pull = |cord: &Cord| Pull {
        clip: cord.clip,
        force: cord.force,
        point: cord.point.unwrap_or(centres[cord.clip]),
    };
    frame.cords.iter().map(pull).collect()
}

/// Shear angle of the affine map that fits the motion of the clamped vertices best, rad.
///
/// ```text
/// minimise over A, b   Σ |A mᵢ + b − xᵢ|²        A (3×2) = (w_u w_v)
/// γ = π/2 − ∠(w_u, w_v) = atan2(w_u·w_v, |w_u × w_v|)
/// ```
///
/// * `material` — material coordinates mᵢ, m
/// * `now` — positions xᵢ, m; points that are not finite are unobserved and ignored
/// * returns — positive if the angle between weft and warp closes; `None` if the points are collinear, at rest or now
///
/// Source: Miguel et al. 2012, figure 7 ("effective shear").
pub fn effective_shear(material: &[Vector2<f64>], now: &[Vector3<f64>]) -> Option<f64> {
    let map = affine_map(material, now)?;
    let (weft, warp) = (map.column(0), map.column(1));
    let across = weft.cross(&warp).norm();
    (across > COLLINEAR * weft.norm().max(warp.norm()).powi(2)).then(|| weft.dot(&warp).atan2(across))
}

/// Linear part of the best-fit affine map.
pub fn affine_map(material: &[Vector2<f64>], now: &[Vector3<f64>]) -> Option<Matrix3x2<f64>> {
    let seen = || material.iter().zip(now).filter(|(_, x)| x.iter().all(|c| c.is_finite()));
    let (m, x) = (mean(seen().map(|(m, _)| *m)), mean(seen().map(|(_, x)| *x)));
    let (mut spread, mut image) = (Matrix2::zeros(), Matrix3x2::zeros());
    for (material, now) in seen() {
        spread += (material - m) * (material - m).transpose();
        image += (now - x) * (material - m).transpose();
    }
    // This form also catches an empty set, whose mean is NaN.
    if !(spread.determinant() > (COLLINEAR * spread.trace()).powi(2)) {
        return None;
    }
    Some(image * spread.try_inverse()?)
}

/// Torque of the clip forces about the centre of the cloth along the rest normal, with alternating signs, N·m.
///
/// ```text
/// T = Σ s_c (p − centre) × F · n        s = +1, −1, +1, … around the sheet, +1 for clip 0; two clips: +1
/// ```
///
/// Without the signs the sum is the torque on the whole sheet, which is zero in equilibrium. Neighbouring bars of a
/// sheared sheet turn it in opposite directions, each by τ a · a/2, where τ is the shear force per length and a the
/// side.
///
/// * `pulls` — the forces
/// * `centres` — centres of the clips, m; they define the order around the sheet
/// * `centre` — centre of the cloth, m
/// * `normal` — normal of the sheet at rest, unit length
///
/// Source: Miguel et al. 2012, figure 7 ("aggregated torque"); the clips are ordered around the sheet, not as in the
/// file.
pub fn aggregated_torque(
    pulls: &[Pull],
    centres: &[Vector3<f64>],
    centre: &Vector3<f64>,
    normal: &Vector3<f64>,
) -> f64 {
    let signs = alternating(centres, centre, normal);
    pulls.iter().map(|pull| signs[pull.clip] * (pull.point - centre).cross(&pull.force).dot(normal)).sum()
}

/// Alternating signs around the sheet, +1 for clip 0. For two clips both are +1: opposite bars pulled in opposite
/// directions turn the sheet the same way, and alternating signs would cancel the torque.
fn alternating(centres: &[Vector3<f64>], centre: &Vector3<f64>, normal: &Vector3<f64>) -> Vec<f64> {
    if centres.len() < 3 {
        return vec![1.0; centres.len()];
    }
    let from_first = |clip: usize| {
        let [first, arm] = [centres[0] - centre, centres[clip] - centre];
        first.cross(&arm).dot(normal).atan2(first.dot(&arm)).rem_euclid(TAU)
    };
    let mut order: Vec<usize> = (0..centres.len()).collect();
    order.sort_by(|&a, &b| from_first(a).total_cmp(&from_first(b)));
    let mut signs = vec![1.0; centres.len()];
    order.iter().skip(1).step_by(2).for_each(|&clip| signs[clip] = -1.0);
    signs
}

/// Difference of the two corner-to-corner forces of a sheet held by four clips, N: the pair of clip 0 minus the
/// other.
///
/// `None` unless there are four clips with a force on each.
///
/// Source: Miguel et al. 2012, figure 7 ("stretching force difference").
pub fn stretching_force_difference(pulls: &[Pull], centres: &[Vector3<f64>]) -> Option<f64> {
    let [of_first, other] = corner_forces(pulls, centres)?;
    Some(of_first - other)
}

/// Corner-to-corner forces of a sheet held by four clips, N: the pair with clip 0, then the other.
///
/// ```text
/// F = ½ (F_b − F_a)·(x_b − x_a)/|x_b − x_a|        positive in tension
/// ```
///
/// Opposite pairs are those with the largest sum of distances: the diagonals of a quadrilateral are together longer
/// than two opposite sides.
///
/// * `pulls` — the forces; those on the same clip are summed
/// * `centres` — centres of the clips, m
/// * returns — `None` unless there are four clips with a force on each
pub fn corner_forces(pulls: &[Pull], centres: &[Vector3<f64>]) -> Option<[f64; 2]> {
    let &[p, q, r, s] = centres else { return None };
    let lengths = [(1, q, r, s), (2, r, q, s), (3, s, q, r)]
        .map(|(opposite, beside, a, b)| (opposite, (beside - p).norm() + (b - a).norm()));
    let (opposite, _) = lengths.into_iter().max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let force = |clip: usize| {
        pulls.iter().filter(|pull| pull.clip == clip).map(|pull| pull.force).reduce(|a, b| a + b)
    };
    let between = |a: usize, b: usize| {
        Some(0.5 * (force(b)? - force(a)?).dot(&(centres[b] - centres[a]).try_normalize(0.0)?))
    };
    let others: Vec<usize> = (1..4).filter(|&clip| clip != opposite).collect();
    Some([between(0, opposite)?, between(others[0], others[1])?])
}

/// Profile of a sheet over a table edge: one point per grid line parallel to the edge, from the rear line on the
/// table to the tip.
///
/// * `grid` — its lines run along and across the edge
/// * `positions` — node positions in the axes of the table, m; nodes that are not finite are unobserved
/// * `table` — the table
/// * `gravity` — defines the downward direction, m/s²
/// * returns — lines without observed nodes are NaN
///
/// Source: Miguel et al. 2012, figure 7 (profiles across the edge).
pub fn bend_profile(
    grid: &Grid,
    positions: &[Vector3<f64>],
    table: &Table,
    gravity: &Vector3<f64>,
) -> Vec<ProfilePoint> {
    let [origin, edge, outward] =
        [table.edge_point_m, table.edge_direction, table.outward].map(Vector3::from);
    let normal = outward.cross(&edge);
    let up = if normal.dot(gravity) > 0.0 { -normal } else { normal };
    let (columns, rows) = (grid.columns, grid.rows);
    let along_edge = |a: usize, b: usize| (positions[b] - positions[a]).dot(&edge).abs();
    let seen = |length: &f64| length.is_finite();
    let along_x =
        (0..rows).flat_map(|row| (1..columns).map(move |i| (grid.node(i - 1, row), grid.node(i, row))));
    let along_y = (1..rows).flat_map(|j| (0..columns).map(move |i| (grid.node(i, j - 1), grid.node(i, j))));
    let [along_x, along_y] = [
        along_x.map(|(a, b)| along_edge(a, b)).filter(seen).sum::<f64>(),
        along_y.map(|(a, b)| along_edge(a, b)).filter(seen).sum::<f64>(),
    ];
    let rows_run_along_the_edge = along_x > along_y;
    let [dx, dy] = grid.cell();
    let (lines, nodes, spacing) =
        if rows_run_along_the_edge { (rows, columns, dy) } else { (columns, rows, dx) };
    let node = |line: usize, place: usize| match rows_run_along_the_edge {
        true => grid.node(place, line),
        false => grid.node(line, place),
    };
    let point = |line: usize| {
        let seen = (0..nodes).map(|place| positions[node(line, place)] - origin);
        let middle = mean(seen.filter(|p| p.iter().all(|c| c.is_finite())));
        ProfilePoint { rest: line as f64 * spacing, outward: middle.dot(&outward), height: middle.dot(&up) }
    };
    let mut profile: Vec<ProfilePoint> = (0..lines).map(point).collect();
    if tip_comes_first(&profile) {
        let length = (lines - 1) as f64 * spacing;
        profile.reverse();
        profile.iter_mut().for_each(|point| point.rest = length - point.rest);
    }
    profile
}

/// True if the observed line nearest the rear is the last one.
fn tip_comes_first(profile: &[ProfilePoint]) -> bool {
    let seen = || profile.iter().filter(|point| !point.outward.is_nan());
    seen().next().zip(seen().next_back()).is_some_and(|(first, last)| first.outward > last.outward)
}

/// Drop of the tip of a profile below the table, m; `None` if it was not observed.
pub fn tip_deflection(profile: &[ProfilePoint]) -> Option<f64> {
    profile.last().map(|tip| -tip.height).filter(|deflection| !deflection.is_nan())
}

/// Position of a rest point under a pose, m.
pub fn moved(pose: &Isometry3<f64>, rest: &Vector3<f64>) -> Vector3<f64> {
    (pose * Point3::from(*rest)).coords
}

/// Mean of vectors; NaN for an empty sequence.
pub fn mean<const D: usize>(vectors: impl Iterator<Item = SVector<f64, D>>) -> SVector<f64, D> {
    let (count, sum) = vectors.fold((0usize, SVector::zeros()), |(count, sum), v| (count + 1, sum + v));
    sum / count as f64
}

/// Median, the upper of the middle two; `None` for an empty list.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Kind;
    use cloth_sim::mesh::Diagonals;

    const SIDE: f64 = 0.1;

    /// A square with a bar on every side: low, high (along weft), left, right (along warp).
    fn framed() -> Sequence {
        let grid = Grid { columns: 3, rows: 3, width: SIDE, height: SIDE, diagonals: Diagonals::Forward };
        let clip = |name: &str, vertices: [usize; 3]| Clip {
            name: name.into(),
            mass_kg: 0.0,
            vertices: vertices.into(),
        };
        Sequence {
            name: "frame".into(),
            kind: Kind::Shear,
            gravity: Vector3::zeros(),
            noise: None,
            force_direction: None,
            table: None,
            mesh: grid.mesh().unwrap(),
            clips: vec![
                clip("low", [0, 1, 2]),
                clip("high", [6, 7, 8]),
                clip("left", [0, 3, 6]),
                clip("right", [2, 5, 8]),
            ],
            frames: Vec::new(),
        }
    }

    /// An arbitrary rigid motion.
    fn motion() -> Isometry3<f64> {
        Isometry3::new(Vector3::new(0.3, -0.2, 0.9), Vector3::new(0.4, 1.2, -0.7))
    }

    fn sheared(angle: f64) -> Matrix3x2<f64> {
        let (sine, cosine) = (angle / 2.0).sin_cos();
        let local = Matrix3x2::new(cosine, sine, sine, cosine, 0.0, 0.0);
        motion().rotation.to_rotation_matrix().matrix() * local
    }

    #[test]
    fn shear_is_that_of_the_affine_map_wherever_it_is() {
        let Sequence { mesh, .. } = framed();
        for angle in [-0.6, 0.0, 1e-9, 0.4, 1.5] {
            let map = sheared(angle) * Matrix2::new(1.2, 0.0, 0.0, 0.9);
            let now: Vec<_> = mesh.material.iter().map(|m| map * m + Vector3::repeat(2.0)).collect();
            let found = effective_shear(&mesh.material, &now).unwrap();
            assert!((found - angle).abs() < 1e-14, "{angle} {found}");
        }
    }

    #[test]
    fn shear_is_a_least_squares_fit_of_what_was_seen() {
        let Sequence { mesh, .. } = framed();
        // A pattern without an affine part: + − + − at the corners.
        let mut now: Vec<_> = mesh.material.iter().map(|m| sheared(0.3) * m).collect();
        for (corner, sign) in [(0, 1.0), (2, -1.0), (6, -1.0), (8, 1.0)] {
            now[corner] += Vector3::new(0.002, -0.001, 0.003) * sign;
        }
        assert!((effective_shear(&mesh.material, &now).unwrap() - 0.3).abs() < 1e-14);
        let mut now: Vec<_> = mesh.material.iter().map(|m| sheared(0.3) * m).collect();
        now[4].x = f64::NAN;
        assert!((effective_shear(&mesh.material, &now).unwrap() - 0.3).abs() < 1e-14);
    }

    #[test]
    fn a_line_has_no_shear() {
        let Sequence { mesh, .. } = framed();
        let now: Vec<_> = mesh.material.iter().map(|m| sheared(0.3) * m).collect();
        assert_eq!(effective_shear(&mesh.material[..3], &now[..3]), None);
        assert_eq!(effective_shear(&mesh.material[..1], &now[..1]), None);
        assert_eq!(effective_shear(&[], &[]), None);
        let collapsed: Vec<_> = mesh.material.iter().map(|m| Vector3::new(m.x + m.y, 0.0, 0.0)).collect();
        assert_eq!(effective_shear(&mesh.material, &collapsed), None);
        assert_eq!(effective_shear(&mesh.material, &[Vector3::repeat(f64::NAN); 9]), None);
    }

    /// Frame of a sheet pulled along its bars by τ a each, without shapes.
    fn pulled_along_the_bars(sequence: &Sequence, force: f64) -> Frame {
        let directions = [-Vector3::x(), Vector3::x(), -Vector3::y(), Vector3::y()];
        let cord =
            |(clip, direction): (usize, Vector3<f64>)| Cord { clip, force: direction * force, point: None };
        Frame {
            poses: vec![Isometry3::identity(); sequence.clips.len()],
            cords: directions.into_iter().enumerate().map(cord).collect(),
            ..Frame::default()
        }
    }

    #[test]
    fn neighbouring_bars_turn_opposite_ways() {
        let sequence = framed();
        let frame = pulled_along_the_bars(&sequence, 3.0);
        let (centres, pulls) = (clip_centres(&sequence, &frame), pulls(&sequence, &frame));
        let centre = mean(centres.iter().copied());
        assert!((centre - Vector3::new(0.05, 0.05, 0.0)).norm() < 1e-15);
        let torque =
            |pulls: &[Pull], normal: Vector3<f64>| aggregated_torque(pulls, &centres, &centre, &normal);
        // Low and high turn it clockwise by 3 N × 50 mm each, left and right counter-clockwise.
        assert!((torque(&pulls, Vector3::z()) + 0.6).abs() < 1e-15);
        assert!((torque(&pulls, -Vector3::z()) - 0.6).abs() < 1e-15);
        let whole: f64 = pulls.iter().map(|pull| (pull.point - centre).cross(&pull.force).z).sum();
        assert!(whole.abs() < 1e-15);
    }

    #[test]
    fn torque_follows_the_cords_and_the_order_around_the_sheet() {
        let sequence = framed();
        let mut frame = pulled_along_the_bars(&sequence, 0.0);
        let cord = |clip, force, point| Cord { clip, force, point: Some(point) };
        // Two cords at the ends of a bar: a couple of 2 N × 0.1 m on low, half of it on left.
        frame.cords = vec![
            cord(0, Vector3::new(0.0, -2.0, 1.0), Vector3::zeros()),
            cord(0, Vector3::new(0.0, 2.0, 1.0), Vector3::new(SIDE, 0.0, 0.0)),
            cord(2, Vector3::new(1.0, 0.0, 0.0), Vector3::zeros()),
            cord(2, Vector3::new(-1.0, 0.0, 0.0), Vector3::new(0.0, SIDE, 0.0)),
        ];
        let (centres, pulls) = (clip_centres(&sequence, &frame), pulls(&sequence, &frame));
        let centre = Vector3::new(0.05, 0.05, 0.0);
        // Left follows low around the sheet, although high does in the file: 0.2 − 0.1.
        let torque = aggregated_torque(&pulls, &centres, &centre, &Vector3::z());
        assert!((torque - 0.1).abs() < 1e-15, "{torque}");
    }

    /// Four clips at the corners, arbitrarily placed, in the given file order; 1.5 N along one diagonal, 4 N along
    /// the other, and a common force on all.
    fn corners(order: [usize; 4]) -> (Vec<Pull>, Vec<Vector3<f64>>) {
        let place =
            [[0.0, 0.0], [SIDE, 0.0], [SIDE, SIDE], [0.0, SIDE]].map(|[x, y]| Vector3::new(x, y, 0.0));
        let middle = Vector3::new(0.05, 0.05, 0.0);
        let pull = |(clip, corner): (usize, usize)| {
            let size = if corner % 2 == 0 { 1.5 } else { 4.0 };
            let force = (place[corner] - middle).normalize() * size + Vector3::new(0.2, 0.1, -0.3);
            Pull { clip, force: motion().rotation * force, point: moved(&motion(), &place[corner]) }
        };
        let pulls: Vec<Pull> = order.into_iter().enumerate().map(pull).collect();
        let centres = pulls.iter().map(|pull| pull.point).collect();
        (pulls, centres)
    }

    #[test]
    fn corner_forces_are_of_opposite_clips_in_any_order() {
        for (order, expected) in [([0, 1, 2, 3], -2.5), ([0, 2, 1, 3], -2.5), ([3, 0, 2, 1], 2.5)] {
            let (mut pulls, centres) = corners(order);
            let found = stretching_force_difference(&pulls, &centres).unwrap();
            assert!((found - expected).abs() < 1e-14, "{order:?}: {found}");
            // Two cords on a clip count as one; a clip without cords was not measured.
            let half = Pull { force: pulls[1].force / 2.0, ..pulls[1] };
            pulls[1] = half;
            assert!((stretching_force_difference(&pulls, &centres).unwrap() - expected).abs() > 0.1);
            pulls.push(half);
            assert!((stretching_force_difference(&pulls, &centres).unwrap() - expected).abs() < 1e-14);
            pulls.retain(|pull| pull.clip != 1);
            assert_eq!(stretching_force_difference(&pulls, &centres), None);
        }
        let (pulls, centres) = corners([0, 1, 2, 3]);
        assert_eq!(corner_forces(&pulls, &centres[..3]), None);
    }

    #[test]
    fn clamped_vertices_move_with_their_clips() {
        let sequence = framed();
        let frame = Frame { poses: vec![motion(); 4], ..Frame::default() };
        let (material, now) = clamped(&sequence, &frame);
        assert_eq!((material.len(), now.len()), (12, 12));
        assert!((now[4] - moved(&motion(), &Vector3::new(0.05, SIDE, 0.0))).norm() < 1e-15);
        assert!(effective_shear(&material, &now).unwrap().abs() < 1e-14);
    }

    const TABLE: Table =
        Table { edge_point_m: [0.5, 0.0, 0.2], edge_direction: [0.0, -1.0, 0.0], outward: [1.0, 0.0, 0.0] };

    /// Bent to a right angle at the edge, half of it hanging; `turns` quarter turns place the tip on each of its
    /// sides.
    fn folded(grid: &Grid, turns: usize) -> Vec<Vector3<f64>> {
        let place = |p: &Vector3<f64>| {
            let along = [p.x, p.y, grid.width - p.x, grid.height - p.y][turns];
            let across = [p.y, p.x][turns % 2];
            let out = along - 0.5 * [grid.width, grid.height][turns % 2];
            Vector3::new(0.5 + out.min(0.0), across, 0.2 - out.max(0.0))
        };
        grid.mesh().unwrap().positions.iter().map(place).collect()
    }

    #[test]
    fn a_profile_runs_from_the_table_to_the_tip() {
        let grid = Grid { columns: 9, rows: 5, width: 0.2, height: SIDE, diagonals: Diagonals::Forward };
        for turns in 0..4 {
            let positions = folded(&grid, turns);
            let profile = bend_profile(&grid, &positions, &TABLE, &Vector3::new(0.0, 0.0, -9.81));
            let (lines, length) = [(9, 0.2), (5, SIDE)][turns % 2];
            assert_eq!(profile.len(), lines);
            for (line, point) in profile.iter().enumerate() {
                let rest = line as f64 * 0.025;
                let expected = [rest, (rest - length / 2.0).min(0.0), (length / 2.0 - rest).min(0.0)];
                let found = [point.rest, point.outward, point.height];
                let off = (Vector3::from(found) - Vector3::from(expected)).norm();
                assert!(off < 1e-14, "{turns}: {found:?} {expected:?}");
            }
            assert!((tip_deflection(&profile).unwrap() - length / 2.0).abs() < 1e-14);
        }
    }

    #[test]
    fn what_was_not_observed_is_not_in_the_profile() {
        let grid = Grid { columns: 5, rows: 5, width: SIDE, height: SIDE, diagonals: Diagonals::Forward };
        let mut positions = folded(&grid, 0);
        let gravity = -Vector3::z();
        let whole = bend_profile(&grid, &positions, &TABLE, &gravity);
        positions[grid.node(1, 3)].y = f64::NAN;
        assert_eq!(bend_profile(&grid, &positions, &TABLE, &gravity), whole);
        (0..5).for_each(|row| positions[grid.node(4, row)] = Vector3::repeat(f64::NAN));
        let profile = bend_profile(&grid, &positions, &TABLE, &gravity);
        assert_eq!(profile[..4], whole[..4]);
        assert!(profile[4].height.is_nan() && tip_deflection(&profile).is_none());
        assert_eq!(tip_deflection(&[]), None);
    }
}
