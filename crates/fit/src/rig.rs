//! The virtual measurement rig: a known cloth in, a measurement set out.
//!
//! The cloth is simulated on a finer mesh with other diagonals than the fit's, so that a fit is not tested on its own
//! discretisation; what is "measured" is sampled from it on a third mesh, and the instruments add their noise.
//!
//! ```text
//! fabric.toml ──▶ simulation 61×61, '\' ──▶ vertices of the measured mesh  + 0.075 mm ──▶ positions.npy
//!                                      └──▶ forces of the cords on the clips + 3 mN    ──▶ forces.csv
//! ```
//!
//! Source: Miguel et al. 2012, §3 (specimen, clips, instruments and their accuracy).

mod fabric;

pub use fabric::{ControlPoints, KnownFabric};

use crate::error::{Error, Result};
use crate::frame::{Clip, Cord, Fabric, Frame, Kind, MeasurementSet, Noise, Phase, Sequence};
use crate::specimen::Specimen;
use cloth_sim::cloth::{Cloth, Problem};
use cloth_sim::equilibrium::{self, Solver};
use cloth_sim::load::Held;
use cloth_sim::material::{Component, Curves};
use cloth_sim::mesh::{Diagonals, Grid};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::{SeedableRng, rngs::StdRng};
use rand_distr::{Distribution, StandardNormal};

/// Standard deviation of each coordinate of an observed vertex, m (checklist: camera calibration).
const POSITION_NOISE: f64 = 7.5e-5;

/// Standard deviation of each component of a clip's force, N (checklist: load cells).
const FORCE_NOISE: f64 = 3.0e-3;

/// Mass of a long bar clip, kg.
const BAR_MASS: f64 = 0.0133;

/// What is measured, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// Columns and rows of the simulation; default 61×61.
    pub nodes: [usize; 2],
    /// Columns and rows of the measured mesh; default 21×21.
    pub measured: [usize; 2],
    /// Frames of one pull, and as many of its release; default 12.
    pub frames: usize,
    /// Pulls; default 1.
    pub cycles: usize,
    /// Noise of the instruments; default on.
    pub noise: bool,
    /// Noise of the clips' poses too, as of a single vertex; default off.
    pub clip_noise: bool,
    /// Seed of all noise; default 1.
    pub seed: u64,
}

impl Default for Rig {
    fn default() -> Self {
        Self {
            nodes: [61, 61],
            measured: [21, 21],
            frames: 12,
            cycles: 1,
            noise: true,
            clip_noise: false,
            seed: 1,
        }
    }
}

impl Rig {
    /// Measures a known fabric: one stretch sequence along weft, one along warp.
    ///
    /// # Errors
    /// Settings or a fabric that cannot be; a frame without an equilibrium.
    pub fn measure(&self, fabric: &KnownFabric) -> Result<MeasurementSet> {
        self.validate()?;
        let curves = fabric.curves()?;
        let mut random = StdRng::seed_from_u64(self.seed);
        let sequences = [Kind::StretchWarp, Kind::StretchWeft]
            .into_iter()
            .map(|kind| self.stretch(fabric, &curves, kind, &mut random))
            .collect::<Result<_>>()?;
        let noise = match (self.noise, self.clip_noise) {
            (false, _) => "no noise",
            (true, false) => "noise of vertices and forces",
            (true, true) => "noise of vertices, forces and clip poses",
        };
        let source = format!(
            "virtual rig: {} on {}x{} nodes, seen on {}x{}, {noise}, seed {}",
            fabric.model, self.nodes[0], self.nodes[1], self.measured[0], self.measured[1], self.seed
        );
        Ok(MeasurementSet {
            fabric: Fabric {
                name: fabric.name.clone(),
                width_m: fabric.width_m,
                height_m: fabric.height_m,
                areal_density_kg_m2: fabric.areal_density_kg_m2,
                thickness_m: None,
                source: Some(source),
                notes: fabric.notes.clone(),
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
        Ok(())
    }

    /// Two bars on opposite sides, pulled apart and let back.
    fn stretch(
        &self,
        fabric: &KnownFabric,
        curves: &Curves,
        kind: Kind,
        random: &mut StdRng,
    ) -> Result<Sequence> {
        let along_weft = kind == Kind::StretchWeft;
        let (component, direction) = if along_weft {
            (Component::StretchWeft, Vector3::x())
        } else {
            (Component::StretchWarp, Vector3::y())
        };
        let length = if along_weft { fabric.width_m } else { fabric.height_m };
        let largest = fabric.largest_extension(component)? * length;
        let grid = |[columns, rows]: [usize; 2], diagonals| Grid {
            columns,
            rows,
            width: fabric.width_m,
            height: fabric.height_m,
            diagonals,
        };
        let mechanics = |source| Error::Mechanics { context: format!("rig, {kind}"), source };
        let seen = grid(self.measured, Diagonals::Alternating).mesh().map_err(mechanics)?;
        let end = |place: f64, positions: &[Vector3<f64>]| -> Vec<usize> {
            let at = |p: &Vector3<f64>| (p.dot(&direction) - place).abs() < 1e-9 * length;
            (0..positions.len()).filter(|&node| at(&positions[node])).collect()
        };
        let clip = |name: &str, place| Clip {
            name: name.into(),
            mass_kg: BAR_MASS,
            vertices: end(place, &seen.positions),
        };
        let mut sequence = Sequence {
            name: kind.to_string(),
            kind,
            gravity: Vector3::zeros(),
            noise: self
                .noise
                .then_some(Noise { position_m: Some(POSITION_NOISE), force_n: Some(FORCE_NOISE) }),
            force_direction: None,
            table: None,
            clips: vec![clip("low", 0.0), clip("high", length)],
            mesh: seen,
            frames: Vec::new(),
        };
        let specimen = Specimen::new(&sequence, Some(self.nodes), Diagonals::Backward)?;
        // The rig's own mesh carries the truth; the measured mesh is looked up in it.
        let truth = Sequence { mesh: specimen.mesh.clone(), clips: Vec::new(), ..sequence.clone() };
        let lookup = Specimen::new(&truth, Some(self.measured), Diagonals::Alternating)?;
        let ends = [end(0.0, &specimen.mesh.positions), end(length, &specimen.mesh.positions)];
        let held: Vec<Held> = ends
            .iter()
            .enumerate()
            .flat_map(|(clip, nodes)| nodes.iter().map(move |&node| Held { node, clip: Some(clip) }))
            .collect();
        let components: Vec<Component> =
            curves.components().filter(|component| !component.is_bending()).collect();
        let cloth = Cloth::new(&Problem {
            mesh: &specimen.mesh,
            model: fabric.model,
            components: &components,
            areal_density: fabric.areal_density_kg_m2,
            gravity: Vector3::zeros(),
            held: &held,
            tied: &[],
            planar: true,
        })
        .map_err(mechanics)?;
        let mut solver = Solver::new(&cloth);
        let settings = equilibrium::Settings::default();
        for (index, (share, cycle, phase)) in self.schedule().into_iter().enumerate() {
            let shift = direction * (0.5 * share * largest);
            let poses = [-shift, shift]
                .map(|shift| Isometry3::from_parts(Translation3::from(shift), UnitQuaternion::identity()));
            let mut x: Vec<f64> = specimen
                .mesh
                .positions
                .iter()
                .flat_map(|p| {
                    let q = p + shift * (2.0 * p.dot(&direction) / length - 1.0);
                    [q.x, q.y, q.z]
                })
                .collect();
            let mut cords = Vec::new();
            if share > 0.0 {
                let equilibrium = solver.solve(curves, &mut x, &settings);
                if !equilibrium.converged() {
                    return Err(Error::Geometry {
                        sequence: sequence.name,
                        found: format!("frame {index}: {}", equilibrium.status),
                        expected: "a fabric that has an equilibrium at every extension".into(),
                    });
                }
                for (clip, force) in solver.clip_forces().into_iter().enumerate() {
                    cords.push(Cord { clip, force: self.noisy(force, FORCE_NOISE, random), point: None });
                }
            }
            let state: Vec<Vector3<f64>> = x.chunks_exact(3).map(Vector3::from_column_slice).collect();
            let positions = lookup
                .samples
                .iter()
                .map(|sample| self.noisy(sample.interpolate(&specimen.mesh, &state), POSITION_NOISE, random))
                .collect();
            let time = 2.0 * index as f64;
            sequence.frames.push(Frame {
                time: Some(time),
                cycle: Some(cycle),
                phase: Some(phase),
                poses: poses.map(|pose| self.noisy_pose(pose, length, random)).to_vec(),
                cords,
                positions: Some(positions),
            });
        }
        Ok(sequence)
    }

    /// Share of the largest extension, cycle and phase of every frame; the first is at rest.
    fn schedule(&self) -> Vec<(f64, usize, Phase)> {
        let share = |step: usize| step as f64 / self.frames as f64;
        let mut schedule = vec![(0.0, 0, Phase::Hold)];
        for cycle in 0..self.cycles {
            schedule.extend((1..=self.frames).map(|step| (share(step), cycle, Phase::Loading)));
            schedule.extend((0..self.frames).rev().map(|step| (share(step), cycle, Phase::Unloading)));
        }
        schedule
    }

    fn noisy(&self, exact: Vector3<f64>, deviation: f64, random: &mut StdRng) -> Vector3<f64> {
        if !self.noise {
            return exact;
        }
        exact + Vector3::from_fn(|_, _| normal(random, deviation))
    }

    /// A clip is seen through many vertices, but let us say through one at each of its ends.
    fn noisy_pose(&self, exact: Isometry3<f64>, length: f64, random: &mut StdRng) -> Isometry3<f64> {
        if !(self.noise && self.clip_noise) {
            return exact;
        }
        let shift = Vector3::from_fn(|_, _| normal(random, POSITION_NOISE));
        let turn = Vector3::from_fn(|_, _| normal(random, POSITION_NOISE / length));
        Isometry3::from_parts(
            Translation3::from(exact.translation.vector + shift),
            UnitQuaternion::from_scaled_axis(turn) * exact.rotation,
        )
    }
}

fn normal(random: &mut StdRng, deviation: f64) -> f64 {
    let sample: f64 = StandardNormal.sample(random);
    deviation * sample
}
