//! Virtual measurement rig: simulates the tests of a known fabric and returns a measurement set.
//!
//! The simulation uses a finer mesh than the fit, so that a fit is not tested on its own discretisation. The measured
//! values are sampled on another mesh, with instrument noise added.
//!
//! ```text
//! fabric.toml ──▶ simulation 61×61      ──▶ vertices of the measured mesh  + 0.075 mm ──▶ positions.npy
//!                                      └──▶ forces of the cords on the clips + 3 mN    ──▶ forces.csv
//! ```
//!
//! | sequence | held by | driven |
//! |---|---|---|
//! | stretch-weft, stretch-warp | two bars | apart and back; in the plane, without weight |
//! | shear | four hinged bars: a picture frame | sheared and back |
//! | bend-weft, bend-warp, bend-bias | a table | off its edge |
//! | complex-shear | two bars | along each other and back |
//! | corner-pull | four small clips | one diagonal pair apart and back, then the other |
//!
//! Source: Miguel et al. 2012, §3 (specimen, clips, tests, instruments and their accuracy).

mod complex_shear;
mod corner_pull;
mod fabric;
mod noise;
mod overhang;
mod picture_frame;
mod protocol;
mod sample;
mod schedule;
mod sheet;
mod stretch;
mod test;
mod truth;

pub use fabric::{BendingPoints, KnownCurves, KnownFabric, LargestExtension, MembranePoints};
pub use noise::with_noise;
pub use protocol::{KINDS, Rig};

use crate::error::{Error, Result};
use crate::frame::{Clip, Cord, Fabric, Frame, Kind, MeasurementSet, Sequence};
use crate::kind::Holding;
use crate::locator::Locator;
use cloth_sim::material::Curves;
use cloth_sim::mesh::{Diagonals, Mesh};
use nalgebra::Vector3;
use noise::{Instruments, Tracked};
use rayon::prelude::*;
use schedule::{Step, outward, there_and_back};
use std::collections::BTreeSet;
use test::{Support, Test};
use truth::{State, Truth};

/// Time between two frames, s (Miguel et al. 2012, §3).
const FRAME_TIME: f64 = 2.0;

impl Rig {
    /// Measures a known fabric. The result does not depend on the number of threads; that of a sequence does not
    /// depend on the other sequences.
    ///
    /// # Errors
    /// Invalid settings or fabric; a frame without a stable equilibrium.
    pub fn measure(&self, fabric: &KnownFabric) -> Result<MeasurementSet> {
        self.validate()?;
        let fabric = fabric.sample(self.sample);
        let curves = fabric.curves()?;
        let mut sequences: Vec<Sequence> = self
            .sequences
            .par_iter()
            .map(|&kind| self.sequence(&fabric, &curves, kind))
            .collect::<Result<_>>()?;
        sequences.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(MeasurementSet {
            fabric: Fabric {
                source: Some(self.source(&fabric)),
                name: fabric.name,
                width_m: fabric.width_m,
                height_m: fabric.height_m,
                areal_density_kg_m2: fabric.areal_density_kg_m2,
                thickness_m: None,
                notes: fabric.notes,
            },
            sequences,
        })
    }

    fn validate(&self) -> Result<()> {
        let setting = |field, found: String, expected: &str| {
            Err(Error::Setting { field, found, expected: expected.into() })
        };
        for (field, [columns, rows]) in [("nodes", self.nodes), ("measured", self.measured)] {
            if columns.min(rows) < 3 || columns.max(rows) > 400 {
                return setting(field, format!("{columns}x{rows}"), "3 to 400 nodes a side");
            }
        }
        if self.frames == 0
            || self.cycles == 0
            || self.frames.checked_mul(self.cycles).is_none_or(|all| all > 10_000)
        {
            return setting(
                "frames",
                format!("{} in {} cycles", self.frames, self.cycles),
                "at least one frame and cycle, and at most 10000 in all",
            );
        }
        if self.sample == 0 {
            return setting("sample", "0".into(), "1 for the fabric itself, or more");
        }
        let once: BTreeSet<Kind> = self.sequences.iter().copied().collect();
        if once.is_empty() || once.len() < self.sequences.len() || once.contains(&Kind::StretchBias) {
            let names = |kinds: &[Kind]| kinds.iter().map(Kind::to_string).collect::<Vec<_>>().join(", ");
            let found = if once.is_empty() { "none".into() } else { names(&self.sequences) };
            return setting("sequences", found, &format!("some of {}, each once", names(&KINDS)));
        }
        Ok(())
    }

    /// The `source` text of the set.
    fn source(&self, fabric: &KnownFabric) -> String {
        let [[a, b], [c, d]] = [self.nodes, self.measured];
        let mut source = format!("virtual rig: {} on {a}x{b} nodes, seen on {c}x{d}", fabric.model);
        source += match (self.noise, self.clip_noise) {
            (false, _) => ", no noise",
            (true, false) => ", noise of vertices and forces",
            (true, true) => ", noise of vertices, forces and clip poses",
        };
        if self.cord_hysteresis {
            source += ", friction of cords";
        }
        if self.fabric_hysteresis {
            source += &format!(", loading {} times unloading", fabric.loading_ratio);
        }
        format!("{source}, seed {}", self.seed)
    }

    fn test(&self, fabric: &KnownFabric, kind: Kind) -> Test {
        let back = |ends: &[f64]| there_and_back(ends, self.frames, self.cycles);
        match kind.holding() {
            Holding::Strip => stretch::test(fabric, kind, back(&[stretch::largest(fabric, kind)])),
            Holding::PictureFrame => picture_frame::test(fabric, back(&[fabric.largest_shear_rad])),
            Holding::Table => {
                overhang::test(fabric, kind, self.nodes, outward(fabric.overhang_m, self.frames))
            }
            Holding::Bars => complex_shear::test(fabric, back(&[fabric.complex_shear_m])),
            Holding::Corners => {
                corner_pull::test(fabric, back(&[fabric.corner_pull_m, -fabric.corner_pull_m]))
            }
        }
    }

    fn sequence(&self, fabric: &KnownFabric, curves: &Curves, kind: Kind) -> Result<Sequence> {
        let test = self.test(fabric, kind);
        let grid = test.sheet.grid(self.nodes, self.diagonals);
        let mesh = test.sheet.mesh(grid)?;
        let seen = test.sheet.mesh(test.sheet.grid(self.measured, Diagonals::Alternating))?;
        let states = Truth::new(&test, &mesh, &grid, fabric, curves).frames()?;
        let own = |mesh: &Mesh| -> Vec<_> { mesh.material.iter().map(|m| test.sheet.own(m)).collect() };
        let flat = own(&mesh);
        let locator = Locator::new(&mesh, &flat, test.sheet.size);
        let samples: Vec<_> = own(&seen).into_iter().map(|point| locator.find(point)).collect();
        let shape = |state: &State| -> Vec<Vector3<f64>> {
            samples.iter().map(|sample| sample.interpolate(&mesh, &state.positions)).collect()
        };
        let mut instruments = Instruments::new(self, fabric.loading_ratio, &kind.to_string());
        let clips = test.grips().iter().map(|grip| Clip {
            name: grip.name.into(),
            mass_kg: grip.mass_kg,
            vertices: test.gripped(&seen, grip),
        });
        let clips: Vec<Clip> = clips.collect();
        let tracked = Tracked::of(&clips, &seen, kind.holding() == Holding::PictureFrame);
        let frames = states.iter().zip(&test.steps).enumerate().map(|(index, (state, step))| Frame {
            time: Some(FRAME_TIME * index as f64),
            ..observe(&test, &tracked, step, state, shape(state), &mut instruments)
        });
        let frames = frames.collect();
        Ok(Sequence {
            name: kind.to_string(),
            kind,
            gravity: test.gravity,
            noise: instruments.noise(!clips.is_empty()),
            force_direction: None,
            table: match test.support {
                Support::Table { table, .. } => Some(table),
                Support::Clips(_) => None,
            },
            clips,
            frames,
            mesh: seen,
        })
    }
}

/// Measures a frame with the instruments.
fn observe(
    test: &Test,
    tracked: &[Tracked],
    step: &Step,
    state: &State,
    shape: Vec<Vector3<f64>>,
    instruments: &mut Instruments<'_>,
) -> Frame {
    let grips = test.grips();
    let mut cord = |(clip, hold): (usize, &Vector3<f64>)| {
        let weight = test.gravity * grips[clip].mass_kg;
        Cord { clip, force: instruments.cord(*hold, weight, step.phase), point: None }
    };
    let cords = state.holds.iter().enumerate().map(&mut cord).collect();
    let positions = shape.into_iter().map(|exact| instruments.position(exact)).collect();
    // On a table there is no clip, although the sheet moves.
    let poses = state.motions[..grips.len()].to_vec();
    Frame {
        time: None,
        cycle: Some(step.cycle),
        phase: Some(step.phase),
        poses: instruments.poses(poses, tracked),
        cords,
        positions: Some(positions),
    }
}
