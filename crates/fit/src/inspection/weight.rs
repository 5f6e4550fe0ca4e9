//! The weight of cloth and clips against what the cords bear.

use super::{Notice, Severity, area, median};
use crate::frame::{Fabric, MeasurementSet, Sequence};
use nalgebra::Vector3;

/// Of the weight: cords have friction, and clips are weighed with their screws or without.
const SHARE: f64 = 0.3;

/// A standard deviation of a force component where none is told, N.
const NOISE: f64 = 0.01;

/// Of the forces: what cells are sure of, and what a tilt of their axes by a third of a degree makes.
const FORCE_SHARE: f64 = 5e-3;

/// Doubts a sequence whose cords bear another weight than cloth and clips have.
pub(super) fn check(fabric: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    if let Some(weight) = Weight::of(fabric, sequence).filter(Weight::disagrees) {
        notices.push(Notice {
            severity: Severity::Doubt,
            sequence: sequence.name.clone(),
            place: "forces.csv".into(),
            found: format!(
                "cords that bear {:.3} N against gravity, where the cloth ({:.1} g) and the clips ({:.1} g) weigh {:.3} N",
                weight.borne,
                1e3 * weight.cloth,
                1e3 * weight.clips,
                weight.expected()
            ),
            expected: "the same: areal_density_kg_m2 of fabric.toml, mass_kg of the clips or gravity_m_s2 in test.toml, or forces \
                       that were set to zero under load"
                .into(),
        });
    }
}

/// Doubts the bending tests of a set in which the cords of another test bear another weight than the areal density gives:
/// rigidity is proportional to it.
pub(super) fn doubt_bending(set: &MeasurementSet, notices: &mut Vec<Notice>) {
    let weights =
        set.sequences.iter().filter_map(|sequence| Some((sequence, Weight::of(&set.fabric, sequence)?)));
    let Some((sequence, density)) =
        weights.filter(|(_, weight)| weight.disagrees()).find_map(|(sequence, weight)| {
            Some((sequence, set.fabric.areal_density_kg_m2 * weight.cloth_share()?))
        })
    else {
        return;
    };
    for bending in set.sequences.iter().filter(|bending| bending.table.is_some()) {
        notices.push(Notice {
            severity: Severity::Doubt,
            sequence: bending.name.clone(),
            place: "fabric.toml areal_density_kg_m2".into(),
            found: format!(
                "{} kg/m², where the cords of {} bear what {density:.3} kg/m² would weigh",
                set.fabric.areal_density_kg_m2, sequence.name
            ),
            expected: "the same, if mass_kg of the clips is right: rigidity is proportional to it".into(),
        });
    }
}

/// What cords bear, and what they should.
struct Weight {
    /// Against gravity, N.
    borne: f64,
    /// By so much it may differ, N.
    error: f64,
    /// Masses, kg.
    cloth: f64,
    clips: f64,
    /// m/s².
    gravity: f64,
}

impl Weight {
    /// From the middle of all frames, about which friction of cords errs either way; `None` where there is no gravity, or no
    /// force was measured along it.
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
        // A column of zeros is no measurement.
        if along.iter().all(|force| *force == 0.0) {
            return None;
        }
        let noise = sequence.noise.and_then(|noise| noise.force_n).unwrap_or(NOISE);
        let error = noise * (sequence.clips.len() as f64 / along.len() as f64).sqrt();
        Some(Self {
            borne: median(along),
            error: f64::max(6.0 * error, FORCE_SHARE * median(sizes)),
            cloth: area(sequence) * fabric.areal_density_kg_m2,
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

    /// The cloth's mass by what is borne, as a share of that told; `None` if nothing, or less, is left for it.
    fn cloth_share(&self) -> Option<f64> {
        Some((self.borne / self.gravity - self.clips) / self.cloth).filter(|share| *share > 0.0)
    }
}
