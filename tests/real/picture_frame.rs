//! Source: exact homogeneous shear of a 100 mm square in a picture frame: under the shear curve of a wool fabric
//! (synthetic_frames/), and under a constant stiffness (analytic/).
//!
//! Goal: the fit recovers the stress from shear angle and diagonal pull alone.
//!
//! ```text
//!      ╱────────╱ ↗ F      four bars of 100 mm, hinged at the corners; wool 0.5–7.5° in eight frames,
//!    ╱        ╱            50 N/m at 2–30° in five
//! F ╱────────╱
//! ```
//!
//! Parameters: the force along each bar F / (2 cos(π/4 − γ/2)) is the files' stress times the side within 1e-6, the
//! diagonals within 1e-8. Wool: five control points at most, force residual ≤ 0.6 % of the largest force, stress
//! within 1 % (relative L2 over the frames' strains). Constant: simulated forces within 1e-8, and so the fitted
//! stiffness.

use cloth_data::frame::{Kind, MeasurementSet};
use cloth_data::measure::{clamped, effective_shear};
use cloth_fit::incremental::{Stage, fit};
use cloth_fit::judge::prediction::predict;
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::report::StageReport;
use cloth_fit::stage::{Settings, Variant, Watch};
use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use cloth_sim::equilibrium::{self, Tolerance};
use cloth_sim::material::{Component, Curves, Model};
use fit_cloth_tests::picture_frame::{PictureFrame, SIDE, diagonal, force_along_bars};
use fit_cloth_tests::rows;

/// A set and its exact law: shear strain and stress, N/m, of the frames after the first.
pub(crate) struct Known {
    pub(crate) set: MeasurementSet,
    pub(crate) law: Vec<[f64; 2]>,
}

/// Fields of a frame.
struct Row {
    angle: f64,
    diagonal: f64,
    force: f64,
    strain: f64,
    stress: f64,
}

fn known(rows: &[Row]) -> Known {
    let pulls = rows.iter().map(|row| [row.angle, force_along_bars(row.force, row.angle)]);
    // Observed flat: an unobserved sheet may have buckled.
    Known {
        set: PictureFrame { shapes: true, ..PictureFrame::of_pulls(pulls.collect()) }.measure(),
        law: rows.iter().map(|row| [row.strain, row.stress]).collect(),
    }
}

fn read(name: &str, row: fn(&[f64]) -> Row) -> Vec<Row> {
    let numbers = |fields: &Vec<String>| -> Vec<f64> {
        fields.iter().map(|field| field.parse().expect("numbers, as its README describes")).collect()
    };
    rows(name).iter().map(|fields| row(&numbers(fields))).collect()
}

fn wool_rows() -> Vec<Row> {
    read("synthetic_frames/picture_frame_100mm.csv", |r| Row {
        angle: r[1].to_radians(),
        diagonal: r[2],
        force: r[3],
        strain: r[4],
        stress: r[5],
    })
}

fn linear_rows() -> Vec<Row> {
    read("analytic/picture_frame_linear.csv", |r| Row {
        angle: r[2].to_radians(),
        diagonal: r[5],
        force: r[4],
        strain: r[3],
        stress: r[1] * r[3],
    })
}

/// The wool set.
pub(crate) fn wool() -> Known {
    known(&wool_rows())
}

/// The set with a constant 50 N/m.
pub(crate) fn linear() -> Known {
    known(&linear_rows())
}

#[test]
fn diagonal_pulls_become_forces_along_the_bars() {
    for (rows, Known { set, law }, count) in [(wool_rows(), wool(), 8), (linear_rows(), linear(), 5)] {
        let [sequence] = &set.sequences[..] else { panic!("one sequence") };
        assert_eq!((rows.len(), law.len(), sequence.frames.len()), (count, count, count + 1));
        let mut worst = 0.0f64;
        for (row, frame) in rows.iter().zip(&sequence.frames[1..]) {
            assert!((diagonal(row.angle) - row.diagonal).abs() <= 1e-8 * row.diagonal);
            assert!((row.angle.sin() - row.strain).abs() <= 1e-8 * row.strain);
            let (material, now) = clamped(sequence, frame);
            assert!((effective_shear(&material, &now).unwrap() - row.angle).abs() < 1e-12);
            for cord in &frame.cords {
                worst = worst.max((cord.force.norm() / SIDE / row.stress - 1.0).abs());
            }
        }
        println!("{count} frames: stress within {worst:.1e}");
        assert!(worst <= 1e-6);
    }
}

/// Relative L2 error of a curve's stress over the frames.
fn stress_off(curve: &StiffnessCurve, law: &[[f64; 2]]) -> f64 {
    let square = |f: &dyn Fn(&[f64; 2]) -> f64| law.iter().map(|row| f(row).powi(2)).sum::<f64>();
    (square(&|[strain, stress]| curve.stress(*strain) - stress) / square(&|[_, stress]| *stress)).sqrt()
}

fn fit_shear(set: &MeasurementSet, settings: &Settings) -> StageReport {
    let report = fit(set, &[Stage::Shear], &Knowledge::default(), settings, &mut Watch::default()).unwrap();
    report.stage(Component::Shear).unwrap().clone()
}

#[test]
fn five_points_find_the_shear_stress_of_wool() {
    let Known { set, law } = wool();
    for model in [Model::STVK, Model::SOFT_CONSTRAINT] {
        let stage = fit_shear(&set, &Settings { model, ..Settings::default() });
        let sequence = &stage.sequences[0];
        let residual = sequence.force_rms.unwrap() / sequence.force_largest;
        let error = stress_off(&stage.curve.curve, &law);
        let points = stage.curve.curve.len();
        println!(
            "wool, {model}: {points} points, force residual {:.3} % of the largest, stress {:.3} % off",
            100.0 * residual,
            100.0 * error
        );
        assert!(stage.converged && points <= 5 && sequence.frames == 8);
        assert!(residual <= 0.006 && error <= 0.01);
    }
}

#[test]
fn a_constant_shear_stiffness_gives_the_forces_and_comes_back() {
    let Known { set, law } = linear();
    let stiffness = StiffnessCurve::constant(50.0, NegativeStrain::Odd).unwrap();
    let stretch = StiffnessCurve::constant(5000.0, NegativeStrain::Green).unwrap();
    let curves: Curves = [
        (Component::StretchWeft, stretch.clone()),
        (Component::StretchWarp, stretch),
        (Component::Shear, stiffness),
    ]
    .into_iter()
    .collect();
    let equilibrium = equilibrium::Settings { tolerance: Tolerance::Relative(1e-10), ..Default::default() };
    let settings = Settings { equilibrium, variant: Variant::Linear, ..Settings::default() };
    let prediction =
        predict(&set, &[Kind::Shear], &curves, &Default::default(), &settings, &Watch::default()).unwrap();
    let forces = &prediction.sequences[0].forces;
    assert_eq!((forces.len(), prediction.dropped.len()), (4 * law.len(), 0));
    let off = forces.iter().map(|row| (row.simulated / row.measured - 1.0).abs()).fold(0.0, f64::max);
    let stage = fit_shear(&set, &settings);
    let found = stage.curve.curve.stiffnesses()[0] / 50.0 - 1.0;
    println!("constant: simulated forces within {off:.1e}, fitted stiffness {found:+.1e} off");
    assert!(stage.converged && off <= 1e-8 && found.abs() <= 1e-8);
}
