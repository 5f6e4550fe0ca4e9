//! A small measurement set with every kind of test, in closed form: StVK cloth of constant stiffness, hinges of
//! constant rigidity.

#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use cloth_data::frame::{Clip, Cord, Fabric, Frame, Kind, MeasurementSet, Noise, Sequence, Table};
use cloth_sim::mesh::{Diagonals, Grid, Mesh};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// Side of the specimen, m.
const SIDE: f64 = 0.1;
/// Stretch stiffness along weft and warp, N/m.
pub(crate) const STRETCH: [f64; 2] = [500.0, 800.0];
/// Shear stiffness, N/m.
pub(crate) const SHEAR: f64 = 60.0;
/// Flexural rigidity along weft and warp, N·m.
pub(crate) const RIGIDITY: [f64; 2] = [6e-4, 9e-4];

const DENSITY: f64 = 0.2;
const GRAVITY: f64 = 9.81;
const POSITION_NOISE: f64 = 2e-4;

/// Stretch, shear, bending, and another shear test for validation.
pub(crate) fn full_set() -> MeasurementSet {
    let fabric = Fabric {
        name: "closed forms".into(),
        width_m: SIDE,
        height_m: SIDE,
        areal_density_kg_m2: DENSITY,
        thickness_m: None,
        source: None,
        notes: None,
    };
    let sequences = vec![
        bend(Kind::BendWarp),
        bend(Kind::BendWeft),
        shear(Kind::ComplexShear),
        shear(Kind::Shear),
        stretch(Kind::StretchWarp),
        stretch(Kind::StretchWeft),
    ];
    MeasurementSet { fabric, sequences }
}

/// Two bars, up to 5 %: nominal stress λ k (λ² − 1)/2.
fn stretch(kind: Kind) -> Sequence {
    let axis = usize::from(kind == Kind::StretchWarp);
    let along = [Vector3::x(), Vector3::y()][axis];
    let frames = (0..=6).map(|i| {
        let ratio = 1.0 + 0.05 * f64::from(i) / 6.0;
        let pull = along * (ratio * STRETCH[axis] * 0.5 * (ratio * ratio - 1.0) * SIDE);
        let poses =
            vec![Isometry3::identity(), Isometry3::from(Translation3::from(along * ((ratio - 1.0) * SIDE)))];
        Frame { poses, cords: cords(&[-pull, pull]), ..Frame::default() }
    });
    let bars: &[(&str, [usize; 2])] = match axis {
        0 => &[("left", [0, 2]), ("right", [1, 3])],
        _ => &[("bottom", [0, 1]), ("top", [2, 3])],
    };
    sequence(kind, square(2), clips(bars), frames.collect())
}

/// A picture frame, observed flat: weft stays, warp leans by γ. The force along each bar is L k sin γ.
fn shear(kind: Kind) -> Sequence {
    let frames = (0..=6).map(|i| {
        let angle = 0.3 * f64::from(i) / 6.0;
        let (weft, warp) = (Vector3::x(), Vector3::new(angle.sin(), angle.cos(), 0.0));
        let lean = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -angle);
        let foot = SIDE * weft;
        let poses = vec![
            Isometry3::identity(),
            Isometry3::from(Translation3::from(SIDE * (warp - Vector3::y()))),
            Isometry3::from_parts(Translation3::identity(), lean),
            Isometry3::from_parts(Translation3::from(foot - lean * foot), lean),
        ];
        let pull = SIDE * SHEAR * angle.sin();
        Frame {
            poses,
            cords: cords(&[-pull * weft, pull * weft, -pull * warp, pull * warp]),
            // Shapes of constant height count as not measured.
            positions: (kind == Kind::Shear)
                .then(|| vec![Vector3::z() * 1e-6, SIDE * weft, SIDE * warp, SIDE * (weft + warp)]),
            ..Frame::default()
        }
    });
    let bars = [("bottom", [0, 1]), ("top", [2, 3]), ("left", [0, 2]), ("right", [1, 3])];
    sequence(kind, square(2), clips(&bars), frames.collect())
}

/// A sheet pushed over an edge, five overhangs: the heavy elastica. No noise is added; the stated instrument noise is
/// the error of a coarse grid.
fn bend(kind: Kind) -> Sequence {
    let axis = usize::from(kind == Kind::BendWarp);
    let [along, across] = [[Vector3::x(), Vector3::y()], [Vector3::y(), Vector3::x()]][axis];
    let mesh = square(17);
    let frames = [0.055, 0.06, 0.065, 0.07, 0.075].map(|overhang| {
        let shape = elastica(RIGIDITY[axis], overhang);
        let place = |rest: &Vector3<f64>| {
            let beyond = rest.dot(&along) + overhang - SIDE;
            let [out, drop] = if beyond > 0.0 { shape(beyond) } else { [beyond, 0.0] };
            along * (SIDE + out) + across * rest.dot(&across) - Vector3::z() * drop
        };
        Frame { positions: Some(mesh.positions.iter().map(place).collect()), ..Frame::default() }
    });
    let table =
        Table { edge_point_m: (SIDE * along).into(), edge_direction: across.into(), outward: along.into() };
    let gravity = Vector3::new(0.0, 0.0, -GRAVITY);
    let noise = Some(Noise { position_m: Some(POSITION_NOISE), force_n: None, clip_m: None });
    Sequence { gravity, noise, table: Some(table), ..sequence(kind, mesh.clone(), Vec::new(), frames.into()) }
}

/// Outward distance and drop at an arc length of the elastica B θ″ = q (s − L) cos θ, clamped at the edge.
fn elastica(rigidity: f64, length: f64) -> impl Fn(f64) -> [f64; 2] {
    const STEPS: usize = 2000;
    let step = length / STEPS as f64;
    let at = |i: usize| (i as f64 + 0.5) * step;
    let mut angle = vec![0.0f64; STEPS];
    for _ in 0..60 {
        let mut curvature = vec![0.0; STEPS];
        let mut moment = 0.0;
        for i in (0..STEPS).rev() {
            moment += DENSITY * GRAVITY * (length - at(i)) * angle[i].cos() * step;
            curvature[i] = moment / rigidity;
        }
        let mut sum = 0.0;
        for i in 0..STEPS {
            angle[i] = sum + 0.5 * curvature[i] * step;
            sum += curvature[i] * step;
        }
    }
    move |arc| {
        let mut place = [0.0; 2];
        for (i, angle) in angle.iter().enumerate() {
            let part = (arc - i as f64 * step).clamp(0.0, step);
            place[0] += angle.cos() * part;
            place[1] += angle.sin() * part;
        }
        place
    }
}

fn square(nodes: usize) -> Mesh {
    let diagonals = Diagonals::Backward;
    Grid { columns: nodes, rows: nodes, width: SIDE, height: SIDE, diagonals }.mesh().unwrap()
}

fn clips(bars: &[(&str, [usize; 2])]) -> Vec<Clip> {
    let clip = |(name, vertices): &(&str, [usize; 2])| Clip {
        name: (*name).into(),
        mass_kg: 0.0,
        vertices: vertices.to_vec(),
    };
    bars.iter().map(clip).collect()
}

fn cords(forces: &[Vector3<f64>]) -> Vec<Cord> {
    forces.iter().enumerate().map(|(clip, &force)| Cord { clip, force, point: None }).collect()
}

fn sequence(kind: Kind, mesh: Mesh, clips: Vec<Clip>, frames: Vec<Frame>) -> Sequence {
    Sequence {
        name: kind.to_string(),
        kind,
        gravity: Vector3::zeros(),
        noise: None,
        force_direction: None,
        table: None,
        mesh: Mesh { grid: None, ..mesh },
        clips,
        frames,
    }
}
