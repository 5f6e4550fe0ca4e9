//! A shear test computed without cloth code: a square in a frame of four bars, in homogeneous shear.

use crate::weightless;
use cloth_data::frame::{Clip, Cord, Frame, Kind, MeasurementSet, Noise, Sequence};
use cloth_sim::mesh::{Diagonals, Grid};
use nalgebra::{Isometry3, Matrix2, Translation3, UnitQuaternion, Vector2, Vector3};
use rand::{SeedableRng, rngs::StdRng};
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::FRAC_PI_4;

/// Side of the specimen, m.
pub const SIDE: f64 = 0.1;

/// Standard deviation of each component of a clip force in noisy sets, N.
pub const FORCE_NOISE: f64 = 3e-3;

/// A 100 mm square held by bars on all four sides, hinged at the corners; its centre is fixed.
///
/// ```text
///      left ╱────────╱ ─▶ high          w_u = (cos γ/2, sin γ/2)   along low and high
///        ╱  ▲     ╱ right               w_v = (sin γ/2, cos γ/2)   along left and right
///   low ╱────────╱                      ε = w_u·w_v = sin γ
/// ```
///
/// With energy per area W(ε), the first Piola–Kirchhoff stress has the columns ∂W/∂w_u = σ w_v and ∂W/∂w_v = σ w_u.
/// On a side with material normal n the bar must pull with P n per rest length to hold the cloth: σ w_v on the right,
/// σ w_u at the top, the opposite on the left and at the bottom; along the bar on every side. A clip is in
/// equilibrium, so this is the total force of its cords:
///
/// ```text
/// F_right = σ(sin γ) a w_v = −F_left        F_high = σ(sin γ) a w_u = −F_low
/// ```
///
/// The result is the same for StVK and soft constraints, whose shear strain is w_u·w_v. Nothing is stretched: the
/// sides keep their length.
pub struct PictureFrame {
    /// Shear angle, rad, and force along each bar, N, of the frames after the first, which is at rest.
    pub pulls: Vec<[f64; 2]>,
    /// Columns and rows of the measured mesh.
    pub measured: [usize; 2],
    /// Adds exact vertex positions to the frames. The first vertex is a micron high, since constant heights count as
    /// not measured.
    pub shapes: bool,
    /// Seed of [`FORCE_NOISE`], which is also declared to the fit; `None` = exact.
    pub noise: Option<u64>,
}

/// The bars, in clip order.
const BARS: [&str; 4] = ["low", "high", "left", "right"];

impl PictureFrame {
    /// Exact forces of a law, without shapes, on four vertices.
    ///
    /// * `law` — stress, N/m, over ε = sin γ; odd
    /// * `angles` — shear angles of the frames, rad
    pub fn of_law(law: &dyn Fn(f64) -> f64, angles: &[f64]) -> Self {
        Self::of_pulls(angles.iter().map(|&angle| [angle, law(angle.sin()) * SIDE]).collect())
    }

    /// As [`PictureFrame::of_law`], from shear angles, rad, and forces along each bar, N.
    pub fn of_pulls(pulls: Vec<[f64; 2]>) -> Self {
        Self { pulls, measured: [2, 2], shapes: false, noise: None }
    }

    /// The measurement set.
    pub fn measure(&self) -> MeasurementSet {
        weightless("picture frame", vec![self.sequence()])
    }

    /// The sequence alone, named after its kind.
    pub fn sequence(&self) -> Sequence {
        let [columns, rows] = self.measured;
        let grid = Grid { columns, rows, width: SIDE, height: SIDE, diagonals: Diagonals::Alternating };
        let mesh = grid.mesh().expect("a grid of some nodes");
        let (low, high) = (|column| grid.node(column, 0), |column| grid.node(column, rows - 1));
        let (left, right) = (|row| grid.node(0, row), |row| grid.node(columns - 1, row));
        let vertices = [
            (0..columns).map(low).collect(),
            (0..columns).map(high).collect(),
            (0..rows).map(left).collect(),
            (0..rows).map(right).collect(),
        ];
        let clip = |(name, vertices): (&str, Vec<usize>)| Clip { name: name.into(), mass_kg: 0.0, vertices };
        let mut random = self.noise.map(StdRng::seed_from_u64);
        let rest = Frame { cords: Vec::new(), ..self.frame(&mesh.material, 0.0, 0.0, &mut None) };
        let sheared =
            self.pulls.iter().map(|&[angle, force]| self.frame(&mesh.material, angle, force, &mut random));
        let frames = [rest].into_iter().chain(sheared).collect();
        Sequence {
            name: Kind::Shear.to_string(),
            kind: Kind::Shear,
            gravity: Vector3::zeros(),
            noise: self.noise.map(|_| Noise { position_m: None, force_n: Some(FORCE_NOISE), clip_m: None }),
            force_direction: None,
            table: None,
            mesh,
            clips: BARS.into_iter().zip(vertices).map(clip).collect(),
            frames,
        }
    }

    fn frame(&self, material: &[Vector2<f64>], angle: f64, force: f64, random: &mut Option<StdRng>) -> Frame {
        let mut noise = || match random {
            Some(random) => FORCE_NOISE * Distribution::<f64>::sample(&StandardNormal, random),
            None => 0.0,
        };
        let [weft, warp] = yarns(angle);
        let forces = [-weft, weft, -warp, warp].map(|direction| (direction * force).push(0.0));
        let cords = forces.into_iter().enumerate().map(|(clip, force)| Cord {
            clip,
            force: force + Vector3::from_fn(|_, _| noise()),
            point: None,
        });
        let place =
            |(vertex, m): (usize, &Vector2<f64>)| placed(m, angle).push(if vertex == 0 { 1e-6 } else { 0.0 });
        Frame {
            cords: cords.collect(),
            poses: poses(angle).to_vec(),
            positions: self.shapes.then(|| material.iter().enumerate().map(place).collect()),
            ..Frame::default()
        }
    }
}

/// Images of the weft and the warp direction.
fn yarns(angle: f64) -> [Vector2<f64>; 2] {
    let (sine, cosine) = (angle / 2.0).sin_cos();
    [Vector2::new(cosine, sine), Vector2::new(sine, cosine)]
}

/// Position of a point of the square at a shear angle.
fn placed(material: &Vector2<f64>, angle: f64) -> Vector2<f64> {
    let middle = Vector2::repeat(SIDE / 2.0);
    middle + Matrix2::from_columns(&yarns(angle)) * (material - middle)
}

/// Poses of the bars: low and high turn with the weft, left and right with the warp.
fn poses(angle: f64) -> [Isometry3<f64>; 4] {
    let half = SIDE / 2.0;
    let bars = [([half, 0.0], 0.5), ([half, SIDE], 0.5), ([0.0, half], -0.5), ([SIDE, half], -0.5)];
    bars.map(|(middle, share)| {
        let rotation = UnitQuaternion::from_scaled_axis(Vector3::z() * (share * angle));
        let middle = Vector2::from(middle);
        let now = placed(&middle, angle).push(0.0);
        Isometry3::from_parts(Translation3::from(now - rotation * middle.push(0.0)), rotation)
    })
}

/// Force along each bar, N, when two opposite corners of the frame are pulled apart by a given force, N.
///
/// The diagonal is d = 2a cos(π/4 − γ/2). The work of its pull equals the stored energy a² W(sin γ):
///
/// ```text
/// F dd/dγ = a² σ cos γ        dd/dγ = a sin(π/4 − γ/2),  cos γ = 2 sin(π/4 − γ/2) cos(π/4 − γ/2)
/// F = 2 a σ cos(π/4 − γ/2)    per bar  σ a = F / (2 cos(π/4 − γ/2))
/// ```
///
/// This is also the pull resolved along the two bars at the corner, each at π/4 − γ/2 to the diagonal.
pub fn force_along_bars(diagonal_force: f64, angle: f64) -> f64 {
    diagonal_force / (2.0 * (FRAC_PI_4 - angle / 2.0).cos())
}

/// Length of the pulled diagonal, m.
pub fn diagonal(angle: f64) -> f64 {
    2.0 * SIDE * (FRAC_PI_4 - angle / 2.0).cos()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_data::io::{read_set, write_set};
    use cloth_data::measure::{aggregated_torque, clamped, clip_centres, effective_shear, pulls};
    use cloth_sim::cloth::ForceScale;
    use cloth_sim::material::{Component, Model};
    use cloth_sim::samples::{Sample, linear_curves};
    use nalgebra::Point3;

    const STIFFNESS: f64 = 40.0;

    fn law(strain: f64) -> f64 {
        STIFFNESS * strain
    }

    fn sheared(angles: &[f64]) -> PictureFrame {
        PictureFrame { measured: [7, 7], shapes: true, ..PictureFrame::of_law(&law, angles) }
    }

    #[test]
    fn bars_take_their_sides_where_the_shape_has_them() {
        let sequence = sheared(&[0.2, 0.7, -0.4]).sequence();
        assert!(sequence.frames[0].cords.is_empty());
        for frame in &sequence.frames {
            let shape = frame.positions.as_ref().unwrap();
            for (clip, pose) in sequence.clips.iter().zip(&frame.poses) {
                assert_eq!(clip.vertices.len(), 7);
                for &vertex in &clip.vertices {
                    let now = pose * Point3::from(sequence.mesh.positions[vertex]);
                    assert!((now.coords - shape[vertex]).xy().norm() < 1e-16, "{}", clip.name);
                }
            }
        }
    }

    #[test]
    fn measures_give_back_angle_and_torque() {
        let angles = [0.2, 0.7, -0.4];
        let sequence = sheared(&angles).sequence();
        for (frame, angle) in sequence.frames[1..].iter().zip(angles) {
            let (material, now) = clamped(&sequence, frame);
            assert!((effective_shear(&material, &now).unwrap() - angle).abs() < 1e-14);
            let middle = Vector3::new(SIDE / 2.0, SIDE / 2.0, 0.0);
            let torque = aggregated_torque(
                &pulls(&sequence, frame),
                &clip_centres(&sequence, frame),
                &middle,
                &Vector3::z(),
            );
            // Four bars, each σ a on an arm of a/2 cos γ; low turns it clockwise.
            let expected = -2.0 * law(angle.sin()) * SIDE * SIDE * angle.cos();
            assert!((torque - expected).abs() < 1e-15, "{torque} {expected}");
        }
    }

    #[test]
    fn forces_do_the_work_that_the_cloth_stores() {
        let (angle, step) = (0.5, 1e-5);
        let [before, now, after] =
            [angle - step, angle, angle + step].map(|angle| sheared(&[angle]).sequence());
        let energy = |angle: f64| SIDE * SIDE * 0.5 * STIFFNESS * angle.sin().powi(2);
        let [low, high] = [&before, &after].map(|sequence| clip_centres(sequence, &sequence.frames[1]));
        let work: f64 =
            now.frames[1].cords.iter().map(|cord| cord.force.dot(&(high[cord.clip] - low[cord.clip]))).sum();
        let stored = energy(angle + step) - energy(angle - step);
        assert!((work / stored - 1.0).abs() < 1e-8, "{work} {stored}");
        let pulled = now.frames[1].cords[1].force.norm() * 2.0 * (FRAC_PI_4 - angle / 2.0).cos();
        let along_diagonal = pulled * (diagonal(angle + step) - diagonal(angle - step));
        assert!((along_diagonal / stored - 1.0).abs() < 1e-8);
        assert!((force_along_bars(pulled, angle) - law(angle.sin()) * SIDE).abs() < 1e-15);
    }

    #[test]
    fn they_are_what_holds_the_cloth_in_both_membranes() {
        let sequence = sheared(&[0.6]).sequence();
        let frame = &sequence.frames[1];
        for model in [Model::STVK, Model::SOFT_CONSTRAINT] {
            let stiffnesses = [
                (Component::StretchWeft, 900.0),
                (Component::StretchWarp, 700.0),
                (Component::Shear, STIFFNESS),
            ];
            let mut sample =
                Sample::at_rest(sequence.mesh.clone(), model, linear_curves(model, &stiffnesses).unwrap());
            sample.hold(|p| (p.x == 0.0).then_some(0));
            let cloth = sample.cloth().unwrap();
            let x: Vec<f64> = frame.positions.iter().flatten().flat_map(|p| <[f64; 3]>::from(*p)).collect();
            let mut gradient = vec![0.0; x.len()];
            cloth.gradient(&sample.curves, &x, &mut gradient, &mut ForceScale::new(cloth.points()));
            let force = |vertex: usize| Vector2::new(gradient[3 * vertex], gradient[3 * vertex + 1]);
            let axes = Matrix2::from_columns(&yarns(0.6));
            for cord in &frame.cords {
                // A corner belongs to two bars: each takes the component along itself.
                let own = usize::from(cord.clip > 1);
                let part = |&vertex: &usize| {
                    axes.column(own) * axes.try_inverse().unwrap().row(own).dot(&force(vertex).transpose())
                };
                let held: Vector2<f64> = sequence.clips[cord.clip].vertices.iter().map(part).sum();
                assert!((held - cord.force.xy()).norm() < 1e-13, "{model}: {held} {}", cord.force);
            }
            let inside = (0..49).filter(|i| (1..6).contains(&(i % 7)) && (1..6).contains(&(i / 7)));
            assert!(inside.map(force).all(|force| force.norm() < 1e-13));
        }
    }

    #[test]
    fn noise_is_on_every_component_and_the_set_fits_a_folder() {
        let exact = sheared(&[0.1; 50]);
        let noisy = PictureFrame { noise: Some(5), ..sheared(&[0.1; 50]) };
        let forces = |sequence: Sequence| -> Vec<f64> {
            sequence.frames.iter().flat_map(|f| &f.cords).flat_map(|c| <[f64; 3]>::from(c.force)).collect()
        };
        let (a, b) = (forces(exact.sequence()), forces(noisy.sequence()));
        let square: f64 = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum();
        assert!(((square / a.len() as f64).sqrt() / FORCE_NOISE - 1.0).abs() < 0.1);
        let folder = tempfile::tempdir().unwrap();
        let set = PictureFrame { shapes: false, ..noisy }.measure();
        write_set(&folder.path().join("set"), &set).unwrap();
        assert_eq!(
            read_set(&folder.path().join("set")).unwrap().sequences[0].frames,
            set.sequences[0].frames
        );
    }
}
