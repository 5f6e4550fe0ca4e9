//! A bending test computed without cloth code: a square pushed off a table, with a heavy elastica in every frame.

use crate::elastica::Elastica;
use cloth_data::frame::{Fabric, Frame, Kind, MeasurementSet, Noise, Sequence, Table};
use cloth_sim::mesh::{Diagonals, Grid};
use nalgebra::{Rotation2, Vector2, Vector3};
use rand::{SeedableRng, rngs::StdRng};
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Side of the specimen, m.
pub const SIDE: f64 = 0.1;

/// Gravity, m/s².
pub const GRAVITY: f64 = 9.81;

/// Standard deviation of each vertex coordinate in noisy sets, m.
pub const POSITION_NOISE: f64 = 7.5e-5;

/// A rectangle pushed off a table edge along x; the edge runs along y through the origin.
///
/// ```text
///   z │  rest       frames
///     │ ▒▒▒▒▒▒▒▒▒▒   ▒▒▒▒▒▒───╮
///     │ 0.2 … 0.3 m        ▒   ╲
///     └──────────────────  ▒ 0   x
/// ```
///
/// The part on the table is flat. The part beyond the edge is clamped level there and bends under its own weight,
/// uniformly across. Frame 0 lies flat on the table up to the edge.
pub struct Cantilever<'a> {
    /// [`Kind::BendWeft`], [`Kind::BendWarp`] or [`Kind::BendBias`]: the direction along x.
    pub kind: Kind,
    /// Mass per area, kg/m².
    pub areal_density: f64,
    /// Moment per width, N, over curvature, 1/m; odd and increasing.
    pub moment: &'a dyn Fn(f64) -> f64,
    /// Overhangs of the frames after the first, m.
    pub overhangs: &'a [f64],
    /// Extent outward and along the edge, m.
    pub size: [f64; 2],
    /// Columns and rows of the measured mesh.
    pub measured: [usize; 2],
    /// Standard deviation of each vertex coordinate, m, which is also declared to the fit, and a seed; `None` = exact.
    pub noise: Option<(f64, u64)>,
}

impl Cantilever<'_> {
    /// The measurement set.
    ///
    /// # Panics
    /// If the kind is not a bending test, or an overhang exceeds the specimen.
    pub fn measure(&self) -> MeasurementSet {
        let fabric = Fabric {
            name: "heavy elastica".into(),
            width_m: self.size[0],
            height_m: self.size[1],
            areal_density_kg_m2: self.areal_density,
            thickness_m: None,
            source: None,
            notes: None,
        };
        MeasurementSet { fabric, sequences: vec![self.sequence()] }
    }

    /// The sequence alone, named after its kind.
    ///
    /// # Panics
    /// As [`measure`](Self::measure).
    pub fn sequence(&self) -> Sequence {
        let [columns, rows] = self.measured;
        let [width, height] = self.size;
        let grid = Grid { columns, rows, width, height, diagonals: Diagonals::Alternating };
        let mut mesh = grid.mesh().expect("a grid of some nodes");
        let flat = mesh.material.clone();
        let turn = Rotation2::new(match self.kind {
            Kind::BendWeft => 0.0,
            Kind::BendWarp => FRAC_PI_2,
            Kind::BendBias => FRAC_PI_4,
            other => panic!("{other} is no bending test"),
        });
        mesh.material.iter_mut().for_each(|material| *material = turn * *material);
        mesh.positions.iter_mut().for_each(|position| *position += Vector3::new(0.2, 0.0, 0.05));
        let mut random = self.noise.map(|(_, seed)| StdRng::seed_from_u64(seed));
        let overhangs = [0.0].iter().chain(self.overhangs);
        let frame = |&overhang: &f64| Frame {
            positions: Some(self.shape(&flat, overhang, &mut random)),
            ..Frame::default()
        };
        let frames = overhangs.map(frame).collect();
        Sequence {
            name: self.kind.to_string(),
            kind: self.kind,
            gravity: Vector3::new(0.0, 0.0, -GRAVITY),
            noise: self.noise.map(|(noise, _)| Noise {
                position_m: Some(noise),
                force_n: None,
                clip_m: None,
            }),
            force_direction: None,
            table: Some(Table {
                edge_point_m: [0.0; 3],
                edge_direction: [0.0, 1.0, 0.0],
                outward: [1.0, 0.0, 0.0],
            }),
            mesh,
            clips: Vec::new(),
            frames,
        }
    }

    /// Position of every vertex, from its place on the flat square.
    fn shape(&self, flat: &[Vector2<f64>], overhang: f64, random: &mut Option<StdRng>) -> Vec<Vector3<f64>> {
        assert!((0.0..=self.size[0]).contains(&overhang), "an overhang of {overhang} m");
        let hanging =
            (overhang > 0.0).then(|| Elastica::solve(overhang, self.areal_density * GRAVITY, self.moment));
        let place = |p: &Vector2<f64>| {
            let beyond = p.x - (self.size[0] - overhang);
            let across = p.y - self.size[1] / 2.0;
            match &hanging {
                Some(shape) if beyond > 0.0 => {
                    let place = shape.at(beyond);
                    Vector3::new(place.outward, across, -place.below)
                }
                _ => Vector3::new(beyond, across, 0.0),
            }
        };
        let mut noise = |_, _| match random {
            Some(random) => {
                self.noise.map_or(0.0, |(noise, _)| noise)
                    * Distribution::<f64>::sample(&StandardNormal, random)
            }
            None => 0.0,
        };
        flat.iter().map(|p| place(p) + Vector3::from_fn(&mut noise)).collect()
    }
}

/// Overhangs with the edge between two rows of a 25×25 grid: the given number of rows and 0.4 of a cell, m.
pub fn between_rows(rows: impl IntoIterator<Item = usize>) -> Vec<f64> {
    rows.into_iter().map(|row| (row as f64 + 0.4) * SIDE / 24.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_data::io::{read_set, write_set};
    use cloth_data::measure::{bend_profile, tip_deflection};
    use cloth_fit::twin::specimen::{Cells, GridSize, Specimen};

    const RIGIDITY: f64 = 2e-5;

    fn cantilever<'a>(kind: Kind, overhangs: &'a [f64], noise: Option<(f64, u64)>) -> Cantilever<'a> {
        let moment = &|curvature: f64| RIGIDITY * curvature;
        Cantilever { kind, areal_density: 0.2, moment, overhangs, size: [SIDE; 2], measured: [81, 61], noise }
    }

    #[test]
    fn the_sheet_keeps_its_lengths_and_starts_flat() {
        let overhangs = between_rows([5, 12, 20]);
        for kind in [Kind::BendWeft, Kind::BendWarp, Kind::BendBias] {
            let set = cantilever(kind, &overhangs, None).measure();
            let [Sequence { mesh, frames, .. }] = &set.sequences[..] else { panic!("one sequence") };
            assert_eq!(frames.len(), 4);
            for (index, frame) in frames.iter().enumerate() {
                let positions = frame.positions.as_ref().unwrap();
                for edge in mesh.edges().unwrap() {
                    let [a, b] = edge.ends;
                    let length = (positions[b] - positions[a]).norm();
                    let rest = (mesh.positions[b] - mesh.positions[a]).norm();
                    // A chord is shorter than its arc by κ²h²/24: κ ≤ 140/m, h = 1.25 mm.
                    assert!(length < rest * (1.0 + 1e-9) && length > rest * (1.0 - 1.3e-3), "{index}");
                }
                let flat = positions.iter().all(|p| p.z == 0.0);
                assert_eq!(flat, index == 0);
                assert!(positions.iter().all(|p| p.x > 0.0 || p.z == 0.0));
            }
        }
    }

    #[test]
    fn what_runs_outwards_is_what_the_kind_says() {
        for (kind, direction) in [
            (Kind::BendWeft, Vector2::x()),
            (Kind::BendWarp, Vector2::y()),
            (Kind::BendBias, Vector2::new(1.0, 1.0).normalize()),
        ] {
            let Sequence { mesh, frames, .. } = cantilever(kind, &[0.03], None).sequence();
            let flat = frames[0].positions.as_ref().unwrap();
            let outwards = (0..mesh.len()).max_by(|&a, &b| flat[a].x.total_cmp(&flat[b].x)).unwrap();
            let inwards = (0..mesh.len()).find(|&i| flat[i].x == -SIDE && flat[i].y == flat[outwards].y);
            let along = mesh.material[outwards] - mesh.material[inwards.unwrap()];
            assert!((along - direction * SIDE).norm() < 1e-15, "{kind}");
        }
    }

    #[test]
    fn its_profile_is_the_elastica() {
        let overhangs = between_rows([9, 21]);
        for kind in [Kind::BendWeft, Kind::BendWarp, Kind::BendBias] {
            let sequence = cantilever(kind, &overhangs, None).sequence();
            // In the outward direction every second measured vertex is a node.
            let specimen = Specimen::new(
                &sequence,
                &Cells {
                    size: GridSize::Nodes([41, 41]),
                    diagonals: Diagonals::Alternating,
                    refinement: 1,
                    to_clips: true,
                },
            )
            .unwrap();
            for (frame, overhang) in sequence.frames[1..].iter().zip(&overhangs) {
                let positions = frame.positions.as_ref().unwrap();
                let nodes: Vec<_> =
                    specimen.samples.iter().map(|s| s.interpolate(&sequence.mesh, positions)).collect();
                let profile =
                    bend_profile(&specimen.grid, &nodes, sequence.table.as_ref().unwrap(), &sequence.gravity);
                let shape = Elastica::solve(*overhang, 0.2 * GRAVITY, &|k| RIGIDITY * k);
                let tip = shape.tip();
                assert!((tip_deflection(&profile).unwrap() - tip.below).abs() < 1e-9, "{kind}");
                for point in &profile {
                    let beyond = point.rest - (SIDE - overhang);
                    let place = shape.at(beyond);
                    let expected = [if beyond > 0.0 { place.outward } else { beyond }, -place.below];
                    let off = (Vector2::from(expected) - Vector2::new(point.outward, point.height)).norm();
                    assert!(off < 1e-9, "{kind} {beyond}: {off:.1e}");
                }
            }
        }
    }

    #[test]
    fn noise_is_as_large_as_it_says_and_the_same_again() {
        let exact = cantilever(Kind::BendWeft, &[0.05, 0.08], None).sequence();
        let noisy = |seed| cantilever(Kind::BendWeft, &[0.05, 0.08], Some((POSITION_NOISE, seed))).sequence();
        let sequence = noisy(3);
        assert_eq!(
            sequence.noise,
            Some(Noise { position_m: Some(POSITION_NOISE), force_n: None, clip_m: None })
        );
        assert_eq!(sequence, noisy(3));
        assert_ne!(sequence, noisy(4));
        let shapes = sequence.frames.iter().zip(&exact.frames);
        let errors = shapes.flat_map(|(a, b)| a.positions.iter().flatten().zip(b.positions.iter().flatten()));
        let squares: Vec<f64> = errors.flat_map(|(a, b)| <[f64; 3]>::from(a - b)).map(|e| e * e).collect();
        let deviation = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        assert!((deviation / POSITION_NOISE - 1.0).abs() < 0.03, "{deviation:.2e}");
    }

    #[test]
    fn it_is_a_set_that_a_folder_can_hold() {
        let folder = tempfile::tempdir().unwrap();
        let set = cantilever(Kind::BendBias, &[0.05], Some((POSITION_NOISE, 1))).measure();
        write_set(&folder.path().join("set"), &set).unwrap();
        let read = read_set(&folder.path().join("set")).unwrap();
        assert_eq!((read.fabric, read.sequences[0].table), (set.fabric, set.sequences[0].table));
    }
}
