//! Instruments: noise and friction added to the exact values.

use super::protocol::Rig;
use crate::frame::{Clip, MeasurementSet, Noise, Phase};
use crate::kind::Holding;
use cloth_sim::mesh::Mesh;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use rand::{SeedableRng, rngs::StdRng};
use rand_distr::{Distribution, StandardNormal};

/// Standard deviation of each coordinate of an observed vertex, m (Miguel et al. 2012, §3).
const POSITION_NOISE: f64 = 7.5e-5;

/// Standard deviation of each component of a clip's force, N (Miguel et al. 2012, §3).
const FORCE_NOISE: f64 = 3.0e-3;

/// Friction of the cords, N: half the width of the resulting hysteresis of about 0.1 N (Miguel et al. 2012, §3).
const CORD_FRICTION: f64 = 0.05;

/// A body whose pose the cameras see: by many vertices in reality, here by one at each of its ends.
pub(super) struct Tracked {
    /// Centre of its vertices at rest, m.
    centre: Point3<f64>,
    /// Distance of the two that are farthest apart, m.
    length: f64,
}

impl Tracked {
    /// One body a clip; bars hinged together are one, with common corners.
    pub(super) fn of(clips: &[Clip], mesh: &Mesh, hinged: bool) -> Vec<Self> {
        let body = |vertices: Vec<usize>| {
            let at = |&vertex: &usize| mesh.positions[vertex];
            let centre = vertices.iter().map(at).sum::<Vector3<f64>>() / vertices.len() as f64;
            let apart = |a: &usize| vertices.iter().map(|b| (at(a) - at(b)).norm()).fold(0.0, f64::max);
            Self { centre: centre.into(), length: vertices.iter().map(apart).fold(0.0, f64::max) }
        };
        let vertices = clips.iter().map(|clip| clip.vertices.clone());
        if hinged { vec![body(vertices.flatten().collect())] } else { vertices.map(body).collect() }
    }
}

/// The instruments of one sequence.
pub(super) struct Instruments<'a> {
    rig: &'a Rig,
    /// Ratio of loading to unloading force of the fabric; 1 for a fabric without hysteresis.
    loading_ratio: f64,
    random: StdRng,
}

impl<'a> Instruments<'a> {
    /// Instruments with their own random stream.
    pub(super) fn new(rig: &'a Rig, loading_ratio: f64, sequence: &str) -> Self {
        let loading_ratio = if rig.fabric_hysteresis { loading_ratio } else { 1.0 };
        Self { rig, loading_ratio, random: stream(rig.seed, sequence) }
    }

    /// The standard deviations; `None` without noise.
    ///
    /// * `clips` — there are any
    pub(super) fn noise(&self, clips: bool) -> Option<Noise> {
        let clip_m = clips.then_some(if self.rig.clip_noise { POSITION_NOISE } else { 0.0 });
        let noise = Noise { position_m: Some(POSITION_NOISE), force_n: Some(FORCE_NOISE), clip_m };
        self.rig.noise.then_some(noise)
    }

    /// Measured position of a vertex.
    pub(super) fn position(&mut self, exact: Vector3<f64>) -> Vector3<f64> {
        self.noisy(exact, POSITION_NOISE)
    }

    /// Measured force of a cord.
    ///
    /// ```text
    /// fabric   hold × 2r/(1 + r) on loading, × 2/(1 + r) on unloading: the mean is the curve, the ratio r
    /// clip     cord + weight = hold
    /// cord     ± 0.05 N along the force: friction
    /// ```
    ///
    /// * `hold` — force that holds the clip in equilibrium with the cloth, N
    /// * `weight` — weight of the clip, N
    pub(super) fn cord(&mut self, hold: Vector3<f64>, weight: Vector3<f64>, phase: Phase) -> Vector3<f64> {
        let ratio = self.loading_ratio;
        let (share, sign) = match phase {
            Phase::Loading => (2.0 * ratio / (1.0 + ratio), 1.0),
            Phase::Unloading => (2.0 / (1.0 + ratio), -1.0),
            Phase::Hold => (1.0, 0.0),
        };
        let mut force = hold * share - weight;
        if self.rig.cord_hysteresis {
            force += force.try_normalize(0.0).unwrap_or_default() * (sign * CORD_FRICTION);
        }
        self.noisy(force, FORCE_NOISE)
    }

    /// Measured poses of the clips.
    pub(super) fn poses(&mut self, exact: Vec<Isometry3<f64>>, tracked: &[Tracked]) -> Vec<Isometry3<f64>> {
        match self.rig.noise && self.rig.clip_noise {
            true => misplaced(&exact, tracked, |deviation| self.normals(deviation)),
            false => exact,
        }
    }

    fn noisy(&mut self, exact: Vector3<f64>, deviation: f64) -> Vector3<f64> {
        if self.rig.noise { exact + self.normals(deviation) } else { exact }
    }

    fn normals(&mut self, deviation: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| {
            let sample: f64 = StandardNormal.sample(&mut self.random);
            deviation * sample
        })
    }
}

/// Poses of clips with errors: one for each tracked body or, of bars hinged together, for all.
///
/// * `normals` — three samples of a deviation
fn misplaced(
    exact: &[Isometry3<f64>],
    tracked: &[Tracked],
    mut normals: impl FnMut(f64) -> Vector3<f64>,
) -> Vec<Isometry3<f64>> {
    let mut error = |pose: &Isometry3<f64>, Tracked { centre, length }: &Tracked| {
        let turn = UnitQuaternion::from_scaled_axis(normals(POSITION_NOISE / length));
        let about = Isometry3::rotation_wrt_point(turn, pose * centre);
        Translation3::from(normals(POSITION_NOISE)) * about
    };
    match tracked {
        [all] => {
            let common = exact.first().map(|first| error(first, all));
            exact.iter().map(|pose| common.unwrap_or_default() * pose).collect()
        }
        _ => exact.iter().zip(tracked).map(|(pose, own)| error(pose, own) * pose).collect(),
    }
}

/// Adds the noise of the instruments, or a multiple of it, to shapes, forces and, if asked, poses of clips, and declares
/// it in the set.
///
/// * `exact` — without noise, with one cord per clip
/// * `drawn` — multiple of the instrument noise to add
/// * `told` — multiple of it to declare
pub fn with_noise(
    exact: &MeasurementSet,
    drawn: f64,
    told: f64,
    clip_noise: bool,
    seed: u64,
) -> MeasurementSet {
    let mut set = exact.clone();
    for sequence in &mut set.sequences {
        let mut random = stream(seed, &sequence.name);
        let mut normals = |deviation: f64| {
            Vector3::from_fn(|_, _| {
                let sample: f64 = StandardNormal.sample(&mut random);
                drawn * deviation * sample
            })
        };
        let hinged = sequence.kind.holding() == Holding::PictureFrame;
        let tracked = Tracked::of(&sequence.clips, &sequence.mesh, hinged);
        for frame in &mut sequence.frames {
            frame.cords.iter_mut().for_each(|cord| cord.force += normals(FORCE_NOISE));
            frame.positions.iter_mut().flatten().for_each(|place| *place += normals(POSITION_NOISE));
            if clip_noise {
                frame.poses = misplaced(&frame.poses, &tracked, &mut normals);
            }
        }
        let of_clips = if clip_noise { told * POSITION_NOISE } else { 0.0 };
        sequence.noise = Some(Noise {
            position_m: Some(told * POSITION_NOISE),
            force_n: Some(told * FORCE_NOISE),
            clip_m: (!sequence.clips.is_empty()).then_some(of_clips),
        });
    }
    set
}

/// A separate random stream per seed and name: omitting one sequence does not change the others.
pub(super) fn stream(seed: u64, name: &str) -> StdRng {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..].iter_mut().zip(name.bytes()).for_each(|(place, byte)| *place = byte);
    StdRng::from_seed(key)
}
