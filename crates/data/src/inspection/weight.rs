//! Compares the cord forces with the weight and with each other: a specimen at rest is in equilibrium.

use crate::frame::{Fabric, MeasurementSet, Sequence};
use crate::kind::Holding;
use crate::measure::{mean, median};
use crate::notice::Notice;
use nalgebra::Vector3;

/// Share of the weight: cords have friction, and readings of scales are coarse.
const SHARE: f64 = 0.1;

/// Number of standard deviations.
const SURE: f64 = 6.0;

/// Two ratios, or two densities, agree within these factors. Only the remainder after the clips determines a density.
const ONE_RATIO: f64 = 1.15;
const ONE_DENSITY: f64 = 1.5;

/// Share of the forces: the accuracy of load cells, and a tilt of their axes by a third of a degree.
const FORCE_SHARE: f64 = 5e-3;

/// Forces whose variation between frames is below this share (rms) are constant, apart from cord friction.
const ALIKE: f64 = 0.25;

/// Share of the largest force: cords of stationary clips may hold by friction.
const APART: f64 = 0.1;

/// Doubts a sequence whose cords carry a weight other than that of cloth and clips, or do not balance across gravity.
pub(super) fn check(fabric: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    notices.extend(unbalanced(sequence));
    if let Some(weight) = Weight::of(fabric, sequence).filter(Weight::disagrees) {
        notices.push(Notice::doubt(&sequence.name, "forces.csv", format!(
                "cords that carry {:.3} N against gravity, while the cloth ({:.1} g) and the clips ({:.1} g) weigh {:.3} N",
                weight.borne,
                1e3 * weight.cloth,
                1e3 * weight.clips,
                weight.expected()
            ), "the same: the unit or calibration of forces.csv, areal_density_kg_m2 of fabric.toml, mass_kg of the clips or \
                       gravity_m_s2 in test.toml, or forces zeroed under load"));
    }
}

/// Forces that do not sum to zero across gravity, in most frames.
fn unbalanced(sequence: &Sequence) -> Option<Notice> {
    if sequence.force_direction.is_some() || sequence.clips.len() < 2 {
        return None;
    }
    let up = sequence.gravity.try_normalize(0.0).unwrap_or_default();
    let frames = sequence.frames.iter().enumerate().filter_map(|(index, frame)| {
        let forces: Option<Vec<Vector3<f64>>> = (0..sequence.clips.len())
            .map(|clip| frame.clip_force(clip).map(|force| force - up * force.dot(&up)))
            .collect();
        let forces = forces?;
        let largest = forces.iter().map(|force| force.norm()).fold(0.0, f64::max);
        Some((index, forces.iter().sum(), largest))
    });
    let mut frames: Vec<(usize, Vector3<f64>, f64)> = frames.collect();
    let noise = sequence.force_noise();
    let allowed = SURE * noise * (sequence.clips.len() as f64).sqrt();
    let off =
        frames.iter().filter(|(_, sum, largest)| sum.norm() > f64::max(APART * largest, allowed)).count();
    let count = frames.len();
    let usual = mean(frames.iter().map(|(_, sum, _)| *sum));
    let squares: f64 = frames.iter().map(|(_, sum, _)| (sum - usual).norm_squared()).sum();
    let varies = (squares / count as f64).sqrt();
    frames.sort_by(|a, b| a.1.norm().total_cmp(&b.1.norm()));
    let (index, sum, largest) = frames.pop().filter(|_| 2 * off > count)?;
    if varies <= f64::max(allowed, ALIKE * usual.norm()) {
        return Some(Notice::doubt(
            &sequence.name,
            "test.toml gravity_m_s2",
            format!(
                "cords that pull the specimen equally in every frame, by {:.3}, {:.3}, {:.3} N, across gravity",
                usual.x, usual.y, usual.z
            ),
            "gravity opposite to it, if they carry weight: gravity_m_s2, in the axes of forces.csv",
        ));
    }
    let sum = sum.norm();
    Some(Notice::doubt(
        &sequence.name,
        "forces.csv",
        format!(
            "cords that pull the specimen to one side in {off} of {count} frames, most in frame {index}, by {sum:.3} N; the \
             largest force is {largest:.3} N"
        ),
        "forces that add up to zero across gravity: the calibration of each load cell, or cords that forces.csv leaves \
                   out",
    ))
}

/// Doubts tests without a weight measurement of their own, on the evidence of the other tests of the set. Stretch:
/// all those tests carry the same multiple of the weight, as with another unit. Bending: they all imply the same
/// different areal density, to which rigidity is proportional. Both: a single test cannot tell the two apart.
pub(super) fn doubt_others(set: &MeasurementSet, notices: &mut Vec<Notice>) {
    // A sequence that is out of equilibrium itself is no evidence about others.
    let balanced = set.sequences.iter().filter(|sequence| unbalanced(sequence).is_none());
    let weights = balanced.map(|sequence| Some((sequence, Weight::of(&set.fabric, sequence)?)));
    let weighed: Vec<(&Sequence, Weight)> = weights.flatten().collect();
    let off: Vec<&(&Sequence, Weight)> = weighed.iter().filter(|(_, weight)| weight.disagrees()).collect();
    // Agreeing tests speak for the rest of the set.
    let Some((first, weight)) = off.first().filter(|_| off.len() == weighed.len()) else { return };
    let is_one = |values: Vec<f64>, factor: f64| {
        let [low, high] = values.iter().fold([f64::MAX, f64::MIN], |[l, h], v| [l.min(*v), h.max(*v)]);
        low > 0.0 && high < factor * low
    };
    let ratio = is_one(off.iter().map(|(_, weight)| weight.borne / weight.expected()).collect(), ONE_RATIO);
    let shares: Option<Vec<f64>> = off.iter().map(|(_, weight)| weight.cloth_share()).collect();
    let density = shares.is_some_and(|shares| is_one(shares, ONE_DENSITY));
    let mut doubt = |sequence: &Sequence, place: &str, found: String, expected: &str| {
        notices.push(Notice::doubt(&sequence.name, place, found, expected));
    };
    for other in &set.sequences {
        let stretched = other.kind.holding() == Holding::Strip;
        if stretched && ratio && Weight::of(&set.fabric, other).is_none() {
            let times = weight.borne / weight.expected();
            let found = format!("a load cell that reads {times:.3} times the weight in {}", first.name);
            let expected = "1, if it is the same cell: the unit or the calibration of forces.csv";
            doubt(other, "forces.csv", found, expected);
        }
        if let Some(share) = weight.cloth_share().filter(|_| other.table.is_some() && density) {
            let told = set.fabric.areal_density_kg_m2;
            let found = format!(
                "{told} kg/m², while the cords of {} carry the weight of {:.3} kg/m²",
                first.name,
                share * told
            );
            let expected = "the same, if mass_kg of the clips is right: rigidity is proportional to it";
            doubt(other, "fabric.toml areal_density_kg_m2", found, expected);
        }
    }
}

/// Weight carried by the cords, and expected weight.
struct Weight {
    /// Against gravity, N.
    borne: f64,
    /// Allowed difference, N.
    error: f64,
    /// Masses, kg.
    cloth: f64,
    clips: f64,
    /// m/s².
    gravity: f64,
}

impl Weight {
    /// Uses the median over all frames, since cord friction acts in both directions; `None` without gravity or
    /// without a force measured along it.
    fn of(fabric: &Fabric, sequence: &Sequence) -> Option<Self> {
        let gravity = sequence.gravity.norm();
        if gravity == 0.0 || sequence.force_direction.is_some() || sequence.clips.is_empty() {
            return None;
        }
        let up = -sequence.gravity / gravity;
        let clips = 0..sequence.clips.len();
        let forces = sequence.frames.iter().filter_map(|frame| -> Option<Vec<Vector3<f64>>> {
            clips.clone().map(|clip| frame.clip_force(clip)).collect()
        });
        let (along, sizes): (Vec<f64>, Vec<f64>) = forces
            .map(|forces| -> (f64, f64) {
                (forces.iter().map(|f| f.dot(&up)).sum(), forces.iter().map(|f| f.norm()).sum())
            })
            .unzip();
        // A column of zeros is not a measurement.
        if along.iter().all(|force| *force == 0.0) {
            return None;
        }
        let noise = sequence.force_noise();
        let error = noise * (sequence.clips.len() as f64 / along.len() as f64).sqrt();
        Some(Self {
            borne: median(along)?,
            error: f64::max(SURE * error, FORCE_SHARE * median(sizes)?),
            cloth: sequence.area() * fabric.areal_density_kg_m2,
            clips: sequence.clips.iter().map(|clip| clip.mass_kg).sum(),
            gravity,
        })
    }

    fn expected(&self) -> f64 {
        (self.cloth + self.clips) * self.gravity
    }

    fn disagrees(&self) -> bool {
        let least = self.expected().min(self.borne.abs());
        (self.borne - self.expected()).abs() > f64::max(self.error, SHARE * least)
    }

    /// Mass of the cloth derived from the cord forces, relative to the declared mass; `None` if nothing, or less,
    /// remains for it.
    fn cloth_share(&self) -> Option<f64> {
        Some((self.borne / self.gravity - self.clips) / self.cloth).filter(|share| *share > 0.0)
    }
}
