//! What the rig measures of a fabric, how finely, and with which errors.

use crate::frame::Kind;
use cloth_sim::mesh::Diagonals;

/// The tests that the rig can make, in the order of their names.
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

/// What is measured, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// The tests to make; default all of [`KINDS`].
    pub sequences: Vec<Kind>,
    /// Columns and rows of the simulation; default 61×61.
    pub nodes: [usize; 2],
    /// How the simulation's cells are split; default alternating, as in a fit, but finer. Split all one way, hinges are up
    /// to three times as stiff along one diagonal as along the other, and no sheet is.
    pub diagonals: Diagonals,
    /// Columns and rows of the measured mesh; default 100×100.
    pub measured: [usize; 2],
    /// Frames of one loading, and as many of its unloading; default 12.
    pub frames: usize,
    /// Loadings, but in bending, where the sheet is pushed out once; default 1.
    pub cycles: usize,
    /// Noise of the instruments; default on.
    pub noise: bool,
    /// Noise of the clips' poses too, as of a single vertex; default off.
    pub clip_noise: bool,
    /// Friction of the cords: clip forces 0.05 N larger on loading and smaller on unloading; default off.
    pub cord_hysteresis: bool,
    /// The fabric's own hysteresis, by its `loading_ratio`; default off.
    pub fabric_hysteresis: bool,
    /// Which sample of the fabric; the first, the default, is the fabric itself. See [`super::KnownFabric::sample`].
    pub sample: usize,
    /// Seed of all noise; default 1.
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
