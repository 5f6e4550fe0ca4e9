//! Small measurement sets in closed form, with any law, size, stiffness and noise.

use crate::support::full_set;
use cloth_data::frame::{Clip, Cord, Fabric, Frame, Kind, MeasurementSet, Noise, Sequence};
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::{Diagonals, Grid, Mesh};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::{SeedableRng, rngs::StdRng};
use rand_distr::{Distribution, StandardNormal};

/// A square in uniform strain: stretched by two bars, or sheared by a picture frame.
pub(crate) struct Uniform<'a> {
    /// Stretch along weft or warp, or shear.
    pub(crate) kind: Kind,
    /// Model whose strain measure the law uses; for shear, a model on triangles.
    pub(crate) model: Model,
    /// Side of the square, m.
    pub(crate) side: f64,
    /// Stress over strain, N/m.
    pub(crate) law: &'a dyn Fn(f64) -> f64,
    /// Strains of the frames after the first, which is at rest.
    pub(crate) strains: &'a [f64],
    /// Standard deviation of each force component, N, known to the fit, and the seed.
    pub(crate) noise: Option<(f64, u64)>,
}

impl Uniform<'_> {
    /// Generates the set.
    pub(crate) fn measure(&self) -> MeasurementSet {
        let side = self.side;
        let grid = Grid { columns: 2, rows: 2, width: side, height: side, diagonals: Diagonals::Forward };
        let bars: &[(&str, [usize; 2])] = match self.kind {
            Kind::StretchWeft => &[("left", [0, 2]), ("right", [1, 3])],
            Kind::StretchWarp => &[("bottom", [0, 1]), ("top", [2, 3])],
            _ => &[("bottom", [0, 1]), ("top", [2, 3]), ("left", [0, 2]), ("right", [1, 3])],
        };
        let mut random = StdRng::seed_from_u64(self.noise.map_or(0, |(_, seed)| seed));
        let deviation = self.noise.map_or(0.0, |(deviation, _)| deviation);
        let mut noise = || deviation * Distribution::<f64>::sample(&StandardNormal, &mut random);
        let frames = [0.0].iter().chain(self.strains).map(|&strain| {
            let (poses, forces) =
                if self.kind == Kind::Shear { self.sheared(strain) } else { self.stretched(strain) };
            let noisy = forces.into_iter().map(|force| force + Vector3::from_fn(|_, _| noise()));
            let cord = |(clip, force)| Cord { clip, force, point: None };
            let cords = if strain == 0.0 { Vec::new() } else { noisy.enumerate().map(cord).collect() };
            // A sheared sheet without measured shape may have buckled.
            let positions = (self.kind == Kind::Shear).then(|| self.flat(strain));
            Frame { poses, cords, positions, ..Frame::default() }
        });
        let clip = |(name, vertices): &(&str, [usize; 2])| Clip {
            name: (*name).into(),
            mass_kg: 0.0,
            vertices: vertices.to_vec(),
        };
        let sequence = Sequence {
            name: self.kind.to_string(),
            kind: self.kind,
            gravity: Vector3::zeros(),
            noise: self.noise.map(|(force, _)| Noise {
                position_m: None,
                force_n: Some(force),
                clip_m: None,
            }),
            force_direction: None,
            table: None,
            frames: frames.collect(),
            mesh: grid.mesh().unwrap(),
            clips: bars.iter().map(clip).collect(),
        };
        let fabric = Fabric {
            name: "closed form".into(),
            width_m: side,
            height_m: side,
            areal_density_kg_m2: 0.2,
            thickness_m: None,
            source: None,
            notes: None,
        };
        MeasurementSet { fabric, sequences: vec![sequence] }
    }

    /// Two bars apart: the force per width is σ times the derivative of strain with respect to stretch.
    fn stretched(&self, strain: f64) -> (Vec<Isometry3<f64>>, Vec<Vector3<f64>>) {
        let along = if self.kind == Kind::StretchWarp { Vector3::y() } else { Vector3::x() };
        let measure = self.model.strain_measure(Component::StretchWeft);
        let extension = measure.physical(strain).unwrap();
        let load = measure.load(extension, |_| (self.law)(strain)).unwrap();
        let moved = Isometry3::from(Translation3::from(along * (extension * self.side)));
        let force = along * (load * self.side);
        (vec![Isometry3::identity(), moved], vec![-force, force])
    }

    /// Observed corners, flat but for a micrometre: shapes of constant height count as not measured.
    fn flat(&self, strain: f64) -> Vec<Vector3<f64>> {
        let (side, angle) = (self.side, strain.asin());
        let [weft, warp] = [Vector3::x() * side, Vector3::new(angle.sin(), angle.cos(), 0.0) * side];
        vec![Vector3::z() * 1e-6, weft, warp, weft + warp]
    }

    /// Weft stays, warp leans by γ, with strain sin γ: the force along each bar is σ times its length.
    fn sheared(&self, strain: f64) -> (Vec<Isometry3<f64>>, Vec<Vector3<f64>>) {
        let (side, angle) = (self.side, strain.asin());
        let (weft, warp) = (Vector3::x(), Vector3::new(angle.sin(), angle.cos(), 0.0));
        let lean = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -angle);
        let foot = side * weft;
        let poses = vec![
            Isometry3::identity(),
            Isometry3::from(Translation3::from(side * (warp - Vector3::y()))),
            Isometry3::from_parts(Translation3::identity(), lean),
            Isometry3::from_parts(Translation3::from(foot - lean * foot), lean),
        ];
        let pull = side * (self.law)(strain);
        (poses, vec![-pull * weft, pull * weft, -pull * warp, pull * warp])
    }
}

/// A weightless sheet between two bars that are pushed together and pulled apart in turn; pushed, it bulges to the
/// given side like a sheet clamped at both ends.
///
/// * `strains` — relative change of the bars' distance in the frames after the first
/// * `side_of` — 1.0 or −1.0 per frame
pub(crate) fn bulging(side: f64, strains: &[f64], side_of: &dyn Fn(usize) -> f64) -> MeasurementSet {
    let law = |_: f64| 0.0;
    let strip = Uniform {
        kind: Kind::StretchWeft,
        model: Model::SOFT_CONSTRAINT,
        side,
        law: &law,
        strains,
        noise: None,
    };
    let mut set = strip.measure();
    let sequence = &mut set.sequences[0];
    sequence.kind = Kind::ComplexShear;
    sequence.name = sequence.kind.to_string();
    let grid = Grid { columns: 9, rows: 9, width: side, height: side, diagonals: Diagonals::Alternating };
    sequence.mesh = Mesh { grid: None, ..grid.mesh().unwrap() };
    let column = |column: usize| (0..9).map(|row| grid.node(column, row)).collect();
    // Otherwise a noise of 0.1 mm is assumed.
    sequence.noise = Some(Noise { position_m: Some(1e-5 * side), force_n: None, clip_m: None });
    sequence.clips[0].vertices = column(0);
    sequence.clips[1].vertices = column(8);
    for (index, frame) in sequence.frames.iter_mut().enumerate() {
        // Sheared slightly, only to distinguish the frame from one at rest.
        let sheared = if index == 0 { 0.0 } else { 2e-3 };
        frame.poses[1].translation.y = sheared * side;
        let strain = if index == 0 { 0.0 } else { strains[index - 1] };
        // Out-of-plane shape that takes up the shortening: w = A/2 (1 − cos 2πx/L), A = 2L/π √δ.
        let height = side_of(index) * 2.0 * side / std::f64::consts::PI * (-strain).max(0.0).sqrt();
        let place = |p: &Vector3<f64>| {
            let turn = std::f64::consts::TAU * p.x / side;
            Vector3::new(p.x * (1.0 + strain), p.y + sheared * p.x, 0.5 * height * (1.0 - turn.cos()))
        };
        frame.positions = Some(sequence.mesh.positions.iter().map(place).collect());
    }
    set
}

/// Overhangs of a heavy elastica along weft, with size and stiffness different from [`full_set`]; the shapes stay
/// similar, since the density is scaled too.
///
/// * `size` — multiple of all lengths
/// * `stiffness` — multiple of the rigidity over the cube of the size
pub(crate) fn overhangs(size: f64, stiffness: f64) -> MeasurementSet {
    let MeasurementSet { mut fabric, mut sequences } = full_set();
    sequences.retain(|sequence| sequence.kind == Kind::BendWeft);
    fabric.width_m *= size;
    fabric.height_m *= size;
    fabric.areal_density_kg_m2 *= stiffness;
    for sequence in &mut sequences {
        sequence.mesh.positions.iter_mut().for_each(|p| *p *= size);
        sequence.mesh.material.iter_mut().for_each(|m| *m *= size);
        for frame in &mut sequence.frames {
            frame.positions.iter_mut().flatten().for_each(|p| *p *= size);
        }
        if let Some(table) = &mut sequence.table {
            table.edge_point_m.iter_mut().for_each(|x| *x *= size);
        }
        if let Some(noise) = &mut sequence.noise {
            noise.position_m = noise.position_m.map(|noise| noise * size);
        }
    }
    MeasurementSet { fabric, sequences }
}
