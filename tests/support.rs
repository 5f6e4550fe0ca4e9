//! Shared test code.

#[path = "support/cantilever.rs"]
pub mod cantilever;
#[path = "support/elastica.rs"]
pub mod elastica;
#[path = "support/fault.rs"]
pub mod fault;
#[path = "support/hang.rs"]
pub mod hang;
#[path = "support/own_mesh.rs"]
pub mod own_mesh;
#[path = "support/picture_frame.rs"]
pub mod picture_frame;
#[path = "support/random_curve.rs"]
pub mod random_curve;
#[path = "support/strip.rs"]
pub mod strip;
#[path = "support/triangulation.rs"]
pub mod triangulation;

use cloth_data::frame::{Clip, Cord, Fabric, Frame, Kind, MeasurementSet, Noise, Sequence};
use cloth_fit::stage::report::CurveRow;
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::{Diagonals, Grid};
use nalgebra::{Isometry3, Vector3};
use std::path::PathBuf;

/// Uniform stretch of a 100 mm square along weft, without shapes: four vertices, two bars, and forces of a known law.
pub struct UniformStretch<'a> {
    /// Model of the strain of the law.
    pub model: Model,
    /// Stress over strain, N/m.
    pub law: &'a dyn Fn(f64) -> f64,
    /// Largest strain.
    pub largest: f64,
    /// Depth of the bars, as a multiple of 10 mm; the cloth between them is stretched.
    pub grip: f64,
    /// Number of frames.
    pub frames: usize,
    /// Noise to add to each force component, N; also declared to the fit.
    pub noise: Option<(f64, &'a mut dyn FnMut() -> f64)>,
}

impl UniformStretch<'_> {
    /// The measurement set.
    pub fn measure(self) -> MeasurementSet {
        let side = 0.1;
        let columns = if self.grip > 0.0 { 11 } else { 2 };
        let grid = Grid { columns, rows: 2, width: side, height: side, diagonals: Diagonals::Forward };
        let noise = self.noise.as_ref().map(|(force, _)| Noise {
            position_m: None,
            force_n: Some(*force),
            clip_m: None,
        });
        let mut draw = self.noise;
        let mut noisy = |force: Vector3<f64>| match &mut draw {
            Some((deviation, normal)) => force + Vector3::from_fn(|_, _| *deviation * normal()),
            None => force,
        };
        let frames = (0..=self.frames)
            .map(|index| {
                let strain = self.largest * index as f64 / self.frames as f64;
                let measure = self.model.strain_measure(Component::StretchWeft);
                let extension = measure.physical(strain).expect("a possible strain");
                let load = measure.load(extension, |_| (self.law)(strain)).expect("a load");
                let force = Vector3::x() * (load * side);
                let cords =
                    if index == 0 { vec![] } else { vec![cord(0, noisy(-force)), cord(1, noisy(force))] };
                Frame {
                    poses: vec![
                        Isometry3::identity(),
                        Isometry3::translation((side - 2.0 * self.grip) * extension, 0.0, 0.0),
                    ],
                    cords,
                    ..Frame::default()
                }
            })
            .collect();
        let mesh = grid.mesh().expect("a grid of some nodes");
        let gripped = |inside: &dyn Fn(f64) -> bool| {
            (0..mesh.len()).filter(|&vertex| inside(mesh.positions[vertex].x)).collect::<Vec<_>>()
        };
        let (low, high) = (gripped(&|x| x < self.grip + 1e-6), gripped(&|x| x > side - self.grip - 1e-6));
        let clip = |name: &str, vertices| Clip { name: name.into(), mass_kg: 0.0, vertices };
        let sequence = Sequence {
            name: "stretch-weft".into(),
            kind: Kind::StretchWeft,
            gravity: Vector3::zeros(),
            noise,
            force_direction: None,
            table: None,
            mesh,
            clips: vec![clip("low", low), clip("high", high)],
            frames,
        };
        weightless("closed form", vec![sequence])
    }
}

/// A set of sequences without gravity, for which mass and sample size are irrelevant.
pub fn weightless(name: &str, sequences: Vec<Sequence>) -> MeasurementSet {
    let fabric = Fabric {
        name: name.into(),
        width_m: 0.1,
        height_m: 0.1,
        areal_density_kg_m2: 0.2,
        thickness_m: None,
        source: None,
        notes: None,
    };
    MeasurementSet { fabric, sequences }
}

fn cord(clip: usize, force: Vector3<f64>) -> Cord {
    Cord { clip, force, point: None }
}

/// Relative L2 error of the stress over the visited range.
pub fn stress_error(samples: &[CurveRow], truth: &dyn Fn(f64) -> f64) -> f64 {
    let square = |f: &dyn Fn(&CurveRow) -> f64| samples.iter().map(|sample| f(sample).powi(2)).sum::<f64>();
    (square(&|s| s.stress - truth(s.strain)) / square(&|s| truth(s.strain))).sqrt()
}

/// Share of the rows whose 95 % band contains the truth.
pub fn coverage(samples: &[CurveRow], truth: &dyn Fn(f64) -> f64) -> f64 {
    let inside = |sample: &&CurveRow| {
        let stress = truth(sample.strain);
        // Both are zero at zero strain, up to rounding.
        let slack = 1e-12 * (1.0 + stress.abs());
        sample.band.is_some_and(|[low, high]| low - slack <= stress && stress <= high + slack)
    };
    samples.iter().filter(inside).count() as f64 / samples.len() as f64
}

/// A folder or file of the real measurements, in the folder named by `FIT_CLOTH_DATA`.
///
/// # Panics
/// If the variable is not set or the file is missing: a test without its data has not been run.
pub fn data(name: &str) -> PathBuf {
    let Some(root) = std::env::var_os("FIT_CLOTH_DATA") else {
        panic!("set FIT_CLOTH_DATA to the folder with the real measurements: this test needs {name} from it");
    };
    let path = PathBuf::from(root).join(name);
    assert!(path.exists(), "{} does not exist: is FIT_CLOTH_DATA the right folder?", path.display());
    path
}

/// Fields of a comma-separated file of the reference data, without its header; quoted commas do not occur.
///
/// # Panics
/// If it cannot be read.
pub fn rows(name: &str) -> Vec<Vec<String>> {
    let path = data(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.lines().skip(1).map(|line| line.split(',').map(|field| field.trim().to_owned()).collect()).collect()
}
