//! Settings of the rig: tests, resolution and errors.

use crate::frame::Kind;
use cloth_sim::mesh::Diagonals;

/// Tests that the rig can simulate, ordered by name.
pub const KINDS: [Kind; 8] = [
    Kind::BendBias,
    Kind::BendWarp,
    Kind::BendWeft,
    Kind::ComplexShear,
    Kind::CornerPull,
    Kind::Shear,
    Kind::StretchWarp,
    Kind::StretchWeft,
];

/// Settings of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// Tests to simulate. Default: all of [`KINDS`].
    pub sequences: Vec<Kind>,
    /// Columns and rows of the simulation. Default: 61×61.
    pub nodes: [usize; 2],
    /// Diagonals of the simulation grid. Default: alternating, as in a fit but finer. With all diagonals in one
    /// direction, hinges are up to three times as stiff along one diagonal as along the other, unlike any sheet.
    pub diagonals: Diagonals,
    /// Columns and rows of the measured mesh. Default: 100×100.
    pub measured: [usize; 2],
    /// Frames per loading; an unloading has the same number. Default: 12.
    pub frames: usize,
    /// Number of load cycles. Default: 1. Does not apply to bending, where the sheet is pushed out once.
    pub cycles: usize,
    /// Instrument noise. Default: on.
    pub noise: bool,
    /// Noise of the clip poses too, equal to that of a single vertex. Default: off.
    pub clip_noise: bool,
    /// Friction of the cords: clip forces 0.05 N larger on loading and smaller on unloading. Default: off.
    pub cord_hysteresis: bool,
    /// Hysteresis of the fabric, from its `loading_ratio`. Default: off.
    pub fabric_hysteresis: bool,
    /// Number of the fabric sample. Default: 1, the fabric itself. See [`super::KnownFabric::sample`].
    pub sample: usize,
    /// Seed of all noise. Default: 1.
    pub seed: u64,
}

impl Default for Rig {
    fn default() -> Self {
        Self {
            sequences: KINDS.to_vec(),
            nodes: [61, 61],
            diagonals: Diagonals::Alternating,
            measured: [100, 100],
            frames: 12,
            cycles: 1,
            noise: true,
            clip_noise: false,
            cord_hysteresis: false,
            fabric_hysteresis: false,
            sample: 1,
            seed: 1,
        }
    }
}
