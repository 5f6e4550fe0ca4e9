//! Faults in the fields of a measurement set, drawn from a seed: flipped signs, swapped axes, zeroed and scaled
//! values.

use cloth_data::frame::{Frame, MeasurementSet, Sequence};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::seq::{IndexedRandom, IteratorRandom};
use rand::{Rng, rngs::StdRng};
use std::fmt;

/// A field in the files of a set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Field {
    /// `areal_density_kg_m2` of fabric.toml.
    Density,
    /// `width_m` and `height_m` of fabric.toml.
    Size,
    /// `gravity_m_s2` of test.toml.
    Gravity,
    /// `position_m` and `force_n` of test.toml.
    Noise,
    /// `edge_point_m` of test.toml.
    EdgePoint,
    /// `edge_direction` of test.toml.
    EdgeDirection,
    /// `outward` of test.toml.
    Outward,
    /// `mass_kg` of test.toml.
    Masses,
    /// `v` of mesh.obj.
    Rest,
    /// `vt` of mesh.obj.
    Material,
    /// `tx_m` … of clips.csv.
    Translations,
    /// `qw` … of clips.csv.
    Rotations,
    /// `fx_n` … of forces.csv.
    Forces,
    /// positions.npy.
    Positions,
}

impl Field {
    /// All fields.
    pub const ALL: [Self; 14] = [
        Self::Density,
        Self::Size,
        Self::Gravity,
        Self::Noise,
        Self::EdgePoint,
        Self::EdgeDirection,
        Self::Outward,
        Self::Masses,
        Self::Rest,
        Self::Material,
        Self::Translations,
        Self::Rotations,
        Self::Forces,
        Self::Positions,
    ];

    /// True if a sequence has the field.
    fn is_in(self, sequence: &Sequence) -> bool {
        match self {
            Self::EdgePoint | Self::EdgeDirection | Self::Outward => sequence.table.is_some(),
            Self::Masses | Self::Translations | Self::Rotations | Self::Forces => !sequence.clips.is_empty(),
            _ => true,
        }
    }

    /// True if the field has a value per frame.
    fn is_of_frames(self) -> bool {
        matches!(self, Self::Translations | Self::Rotations | Self::Forces | Self::Positions)
    }

    /// True if the field is a scalar.
    fn is_scalar(self) -> bool {
        matches!(self, Self::Density | Self::Size | Self::Noise | Self::Masses)
    }
}

/// Change of a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// Flips the sign of one axis, or of a scalar.
    Flip(usize),
    /// Flips the sign of all axes.
    FlipAll,
    /// Swaps two axes.
    Swap(usize, usize),
    /// Zeroes one axis, or a scalar.
    Zero(usize),
    /// Zeroes all axes.
    ZeroAll,
    /// Scales all axes.
    Scale(f64),
}

/// Factors of wrong units and slipped digits; a calibration error may have any factor.
const FACTORS: [f64; 11] = [1e-6, 1e-3, 1e-2, 0.1, 1.0 / 9.81, 0.5, 2.0, 9.81, 10.0, 100.0, 1000.0];

impl Change {
    fn draw(random: &mut StdRng, scalar: bool) -> Self {
        let axis = random.random_range(0..3);
        match random.random_range(0..6) {
            0 => Self::Flip(axis),
            1 if !scalar => Self::FlipAll,
            2 if !scalar => Self::Swap(axis, (axis + random.random_range(1..3)) % 3),
            3 if !scalar => Self::Zero(axis),
            1 | 3 | 4 if random.random_bool(0.5) => Self::ZeroAll,
            _ if random.random_bool(0.3) => Self::Scale(random.random_range(0.75..1.33)),
            _ => Self::Scale(*FACTORS.choose(random).expect("factors")),
        }
    }

    fn of_vector(self, mut vector: Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Flip(axis) => vector[axis] = -vector[axis],
            Self::FlipAll => vector = -vector,
            Self::Swap(a, b) => vector.swap_rows(a, b),
            Self::Zero(axis) => vector[axis] = 0.0,
            Self::ZeroAll => vector = Vector3::zeros(),
            Self::Scale(factor) => vector *= factor,
        }
        vector
    }

    fn of_number(self, number: f64) -> f64 {
        match self {
            Self::Flip(_) | Self::FlipAll => -number,
            Self::Zero(_) | Self::ZeroAll => 0.0,
            Self::Scale(factor) => number * factor,
            Self::Swap(..) => number,
        }
    }
}

/// The kind of change, without axis and factor, as counted in a table.
impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Flip(_) => "sign of one",
            Self::FlipAll => "sign of all",
            Self::Swap(..) => "two exchanged",
            Self::Zero(_) => "one zero",
            Self::ZeroAll => "all zero",
            Self::Scale(factor) if (0.7..1.4).contains(factor) => "up to a quarter off",
            Self::Scale(factor) if (0.4..2.5).contains(factor) => "twice or half",
            Self::Scale(_) => "9.81 times or more off",
        })
    }
}

/// A change of one field.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// The field.
    pub field: Field,
    /// The change.
    pub change: Change,
    /// Affected sequence; `None` = all.
    pub sequence: Option<String>,
    /// Affected frame; `None` = all.
    pub frame: Option<usize>,
}

impl Fault {
    /// Draws a fault applicable to a set.
    ///
    /// # Panics
    /// If the set has no sequences.
    pub fn draw(random: &mut StdRng, set: &MeasurementSet) -> Self {
        let has = |field: &Field| set.sequences.iter().any(|sequence| field.is_in(sequence));
        let field = Field::ALL.into_iter().filter(has).choose(random).expect("a sequence");
        let of = |sequence: &&Sequence| field.is_in(sequence);
        let sequence = set.sequences.iter().filter(of).choose(random).expect("has it");
        let one_frame = field.is_of_frames() && random.random_bool(0.25);
        Self {
            field,
            change: Change::draw(random, field.is_scalar()),
            sequence: random.random_bool(0.5).then(|| sequence.name.clone()),
            frame: one_frame.then(|| random.random_range(0..sequence.frames.len())),
        }
    }

    /// Applies the change.
    pub fn apply(&self, set: &mut MeasurementSet) {
        let change = self.change;
        match self.field {
            Field::Density => {
                set.fabric.areal_density_kg_m2 = change.of_number(set.fabric.areal_density_kg_m2);
            }
            Field::Size => {
                let fabric = &mut set.fabric;
                match change {
                    Change::Swap(..) => std::mem::swap(&mut fabric.width_m, &mut fabric.height_m),
                    _ => [&mut fabric.width_m, &mut fabric.height_m]
                        .into_iter()
                        .for_each(|size| *size = change.of_number(*size)),
                }
            }
            _ => {
                let named = |s: &&mut Sequence| self.sequence.as_ref().is_none_or(|name| *name == s.name);
                set.sequences.iter_mut().filter(named).for_each(|sequence| self.apply_to(sequence));
            }
        }
    }

    fn apply_to(&self, sequence: &mut Sequence) {
        let change = self.change;
        let vector = |v: &mut Vector3<f64>| *v = change.of_vector(*v);
        let array = |array: &mut [f64; 3]| *array = change.of_vector((*array).into()).into();
        match self.field {
            Field::Gravity => vector(&mut sequence.gravity),
            Field::Noise => {
                if let Some(noise) = &mut sequence.noise {
                    noise.position_m = noise.position_m.map(|n| change.of_number(n));
                    noise.force_n = noise.force_n.map(|n| change.of_number(n));
                }
            }
            Field::EdgePoint => sequence.table.iter_mut().for_each(|table| array(&mut table.edge_point_m)),
            Field::EdgeDirection => {
                sequence.table.iter_mut().for_each(|table| array(&mut table.edge_direction));
            }
            Field::Outward => sequence.table.iter_mut().for_each(|table| array(&mut table.outward)),
            Field::Masses => {
                sequence.clips.iter_mut().for_each(|clip| clip.mass_kg = change.of_number(clip.mass_kg));
            }
            Field::Rest => sequence.mesh.positions.iter_mut().for_each(vector),
            Field::Material => {
                for material in &mut sequence.mesh.material {
                    *material = change.of_vector(material.push(0.0)).xy();
                }
            }
            _ => {
                let taken = |(index, _): &(usize, &mut Frame)| self.frame.is_none_or(|frame| frame == *index);
                for (_, frame) in sequence.frames.iter_mut().enumerate().filter(taken) {
                    match self.field {
                        Field::Translations => {
                            frame.poses.iter_mut().for_each(|pose| vector(&mut pose.translation.vector));
                        }
                        Field::Rotations => {
                            for pose in &mut frame.poses {
                                let (w, axis) = (pose.rotation.w, change.of_vector(pose.rotation.imag()));
                                pose.rotation =
                                    UnitQuaternion::new_normalize(Quaternion::from_parts(w, axis));
                            }
                        }
                        Field::Forces => frame.cords.iter_mut().for_each(|cord| vector(&mut cord.force)),
                        _ => frame.positions.iter_mut().flatten().for_each(vector),
                    }
                }
            }
        }
    }
}
