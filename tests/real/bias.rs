//! Source: bias extension. A glass and polypropylene plain weave (cao2008_bias_extension/, Cao et al. 2008, figure
//! 38), and the bias strips of a cotton knit and a cupro weave in a tensile machine (u3m_fab_*/B_S2.csv).
//!
//! Goal: the bias sets that determine a shear curve, their reference values, and the agreement of the fit.
//!
//! ```text
//!   fixed ┌──────────────────┐ moving   yarns at ±45°; H × W = 450 × 150 mm, pulled by 106 mm;
//!         │ ╲╱╲╱╲╱╲╱╲╱╲╱╲╱╲╱ │ ───▶     81 × 40 or 50 mm, the last loading
//!         └──────────────────┘
//! ```
//!
//! With inextensible yarns the middle zone is in homogeneous shear:
//!
//! ```text
//! γ = π/2 − 2 acos((L + d)/(√2 L))        L = H − W, d the displacement (Cao et al. 2008, eq. 13)
//! F_s(γ) = [(H/W − 1) F (cos γ/2 − sin γ/2) − W F_s(γ/2) cos γ/2] / [(2H − 3W) cos γ]        (eq. 18)
//! ```
//!
//! Parameters: eq. 13 agrees with the file's column within 0.01° + 0.1 %, eq. 18 within 0.1 %; forces and extensions
//! in the sets equal the files'. Glass with yarns of 1e5 N/m: the simulated angle, as the mean along the axis of the
//! zone described by eq. 13, is within 2° of it up to 35°, and the curve predicts the pull of a strip of 230 × 115 mm
//! at 10–40° within 35 %. Knit, stretch from L_S2 and W_S2: RMS ≤ 3 % of the largest force; stress at strain 1 within
//! 0.5 % of each other on three grids.
//!
//! At the centre alone the angle is up to 4.5° below eq. 13. Inextensible yarns fix the elongation of the middle zone
//! (H − W long), and thus the mean of γ over its axis. A yarn that crosses yarns from a clamp shears only these, at
//! half the angle, and yields more: with the fitted curve γ runs from 25° at the centre to 32° at the zone's ends
//! where eq. 13 gives 29°. Finer cells (21 × 61 nodes), soft constraints and yarns of 1e6 N/m change it by 0.4° at
//! most: it is the energy minimum.

use cloth_data::frame::{Frame, Kind, MeasurementSet, Sequence};
use cloth_data::strip::{Direction, Extension, StripTest, read_strip};
use cloth_fit::equilibria::Settled;
use cloth_fit::incremental::{Stage, fit};
use cloth_fit::judge::prediction::predict;
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::{Settings, Watch};
use cloth_fit::twin::specimen::{Cells, GridSize, Specimen};
use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use cloth_sim::material::{Component, Curves};
use cloth_sim::mesh::Diagonals;
use fit_cloth_tests::own_mesh::equilibria;
use fit_cloth_tests::{data, rows, weightless};
use nalgebra::{Matrix2, Matrix3x2, Vector2, Vector3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, SQRT_2};
use std::path::Path;

/// The specimen with a table.
pub(crate) const LARGE: BiasStrip = BiasStrip { length: 0.45, width: 0.15 };

/// Another specimen of the same weave; the README gives its normalised shear force at four angles.
pub(crate) const SMALL: BiasStrip = BiasStrip { length: 0.23, width: 0.115 };

/// Shear angle, °, and normalised shear force of [`SMALL`], N/m.
const SMALL_FORCES: [[f64; 2]; 4] = [[10.0, 5.3], [20.0, 9.8], [30.0, 13.2], [40.0, 19.1]];

/// A strip cut at 45°, with inextensible yarns.
#[derive(Clone, Copy)]
pub(crate) struct BiasStrip {
    /// Clamp distance, m.
    pub(crate) length: f64,
    /// Width across the pull, m.
    pub(crate) width: f64,
}

impl BiasStrip {
    /// Shear angle in the middle, rad, at a displacement, m: eq. 13.
    pub(crate) fn angle(&self, displacement: f64) -> f64 {
        let free = self.length - self.width;
        FRAC_PI_2 - 2.0 * ((free + displacement) / (SQRT_2 * free)).acos()
    }

    /// Inverse of [`BiasStrip::angle`].
    pub(crate) fn displacement(&self, angle: f64) -> f64 {
        let free = self.length - self.width;
        free * (SQRT_2 * (FRAC_PI_4 - angle / 2.0).cos() - 1.0)
    }

    /// Shear force per length, N/m, from the pull, N, and the value at half the angle: eq. 18.
    fn normalised(&self, angle: f64, pull: f64, at_half: f64) -> f64 {
        let Self { length, width } = self;
        let (sine, cosine) = (angle / 2.0).sin_cos();
        ((length / width - 1.0) * pull * (cosine - sine) - width * at_half * cosine)
            / ((2.0 * length - 3.0 * width) * angle.cos())
    }

    /// Normalised shear forces, N/m, for ascending angles, rad, and pulls, N. The force at half an angle is
    /// interpolated from the values computed so far.
    pub(crate) fn normalised_forces(&self, pulls: &[[f64; 2]]) -> Vec<f64> {
        let mut known: Vec<[f64; 2]> = Vec::new();
        for &[angle, pull] in pulls {
            known.push([angle, self.normalised(angle, pull, interpolated(&known, angle / 2.0))]);
        }
        known.into_iter().map(|[_, force]| force).collect()
    }

    /// Pull that corresponds to a normalised shear force, N.
    fn pull(&self, angle: f64, force: f64, at_half: f64) -> f64 {
        let without = self.normalised(angle, 0.0, at_half);
        (force - without) / (self.normalised(angle, 1.0, at_half) - without)
    }

    /// Reads a set from a table.
    fn read(&self, table: &Path) -> MeasurementSet {
        let displacement = Extension::Displacement("displacement_mm".into());
        let test = StripTest::new(Direction::Bias, self.length, self.width, displacement, "force_N".into());
        weightless("glass plain weave", vec![read_strip(table, &test).unwrap().sequence])
    }
}

/// Linear interpolation, constant beyond the ends; 0 without points.
fn interpolated(points: &[[f64; 2]], at: f64) -> f64 {
    match points.iter().position(|[x, _]| *x >= at) {
        Some(0) => points[0][1],
        Some(after) => {
            let ([x, y], [x_after, y_after]) = (points[after - 1], points[after]);
            y + (y_after - y) * (at - x) / (x_after - x)
        }
        None => points.last().map_or(0.0, |[_, y]| *y),
    }
}

/// The measured pulls of the weave.
pub(crate) fn glass() -> MeasurementSet {
    LARGE.read(&data("cao2008_bias_extension").join("glass_plain_150x450mm.csv"))
}

/// The pulls of the smaller strip at 10, 20, 30 and 40°, by eq. 18 from its normalised shear forces. At 5°, half of the
/// first angle, its force is taken to be the same share of that at 10° as in the larger strip.
pub(crate) fn small_glass() -> MeasurementSet {
    let large: Vec<_> = rows("cao2008_bias_extension/glass_plain_150x450mm.csv")
        .iter()
        .map(|row| [2, 3].map(|column| row[column].parse::<f64>().expect("a number")))
        .collect();
    let [[first, force], ..] = SMALL_FORCES;
    let at_half = force * interpolated(&large, first / 2.0) / interpolated(&large, first);
    let forces = [&[[first / 2.0, at_half]], &SMALL_FORCES[..]].concat();
    let known: Vec<_> = forces.into_iter().map(|[degrees, force]| [degrees.to_radians(), force]).collect();
    let mut table = "displacement_mm,force_N\n".to_owned();
    for &[angle, force] in &known[1..] {
        let pull = SMALL.pull(angle, force, interpolated(&known, angle / 2.0));
        table += &format!("{},{pull}\n", 1e3 * SMALL.displacement(angle));
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("small.csv");
    std::fs::write(&path, table).expect("a temporary file");
    SMALL.read(&path)
}

#[test]
fn glass_is_a_bias_strip_with_the_forces_and_angles_of_its_table() {
    let set = glass();
    let [sequence] = &set.sequences[..] else { panic!("one sequence") };
    assert_eq!(sequence.kind, Kind::StretchBias);
    let pull = sequence.force_direction.unwrap();
    let table = rows("cao2008_bias_extension/glass_plain_150x450mm.csv");
    assert_eq!(sequence.frames.len(), table.len() + 1);
    for (row, frame) in table.iter().zip(&sequence.frames[1..]) {
        let number = |column: usize| row[column].parse::<f64>().unwrap();
        let displacement = frame.poses[1].translation.vector.dot(&pull);
        assert!((displacement - 1e-3 * number(0)).abs() < 1e-12);
        assert_eq!((frame.cords.len(), frame.cords[0].force.dot(&pull)), (1, number(1)));
        let (angle, expected) = (LARGE.angle(displacement).to_degrees(), number(2));
        assert!((LARGE.displacement(angle.to_radians()) - displacement).abs() < 1e-12);
        assert!(
            (angle - expected).abs() < 0.01 + 1e-3 * expected,
            "{displacement} m: {angle}, not {expected}"
        );
    }
    // Square cells: their diagonals run along the yarns.
    let specimen = Specimen::new(
        sequence,
        &Cells { size: GridSize::NearSquare, diagonals: Diagonals::Crossed, refinement: 1, to_clips: true },
    )
    .unwrap();
    let cells = specimen.grid.cell();
    println!("glass: {} × {} nodes", specimen.grid.columns, specimen.grid.rows);
    assert!((cells[0] / cells[1] - 1.0).abs() < 1e-9);
    let along = specimen.mesh.material[1] - specimen.mesh.material[0];
    assert!((along.x.abs() - along.y.abs()).abs() < 1e-12);
}

#[test]
fn pulls_become_shear_forces_and_back() {
    let table = rows("cao2008_bias_extension/glass_plain_150x450mm.csv");
    let number = |row: &[String], column: usize| row[column].parse::<f64>().unwrap();
    let pulls: Vec<_> = table.iter().map(|row| [number(row, 2).to_radians(), number(row, 1)]).collect();
    let mut worst = 0.0f64;
    for (force, row) in LARGE.normalised_forces(&pulls).iter().zip(&table) {
        worst = worst.max((force / number(row, 3) - 1.0).abs());
    }
    println!("normalised shear force: within {worst:.1e} of the table's");
    assert!(worst < 1e-3);

    let small = small_glass();
    let pull = |frame: &Frame| frame.cords[0].force.x;
    let frames = &small.sequences[0].frames[1..];
    for ([degrees, force], frame) in SMALL_FORCES.iter().zip(frames) {
        println!("small strip at {degrees}°: {force} N/m, pulled with {:.2} N", pull(frame));
        let angle = SMALL.angle(frame.poses[1].translation.vector.x);
        assert!((angle.to_degrees() - degrees).abs() < 1e-9);
    }
    let rising: Vec<f64> = frames.iter().map(pull).collect();
    assert!(rising.is_sorted() && rising[0] > 0.5 && rising[3] < 20.0);
    // At 20°, half of the angle is one of the four: eq. 18 returns the force.
    let angle = 20f64.to_radians();
    assert!((SMALL.normalised(angle, rising[1], 5.3) - 9.8).abs() < 1e-9);
}

#[test]
fn bias_strips_of_the_tensile_machine_are_read() {
    for fabric in crate::strips::FABRICS {
        let sequence: Sequence = crate::strips::import(fabric, "B_S2", Direction::Bias);
        assert_eq!((sequence.kind, sequence.name.as_str()), (Kind::StretchBias, "stretch-bias"));
        let pull = sequence.force_direction.unwrap();
        let largest = sequence.frames.iter().flat_map(|frame| &frame.cords).map(|c| c.force.dot(&pull));
        let largest = largest.fold(0.0, f64::max);
        let shift = sequence.frames.last().unwrap().poses[1].translation.vector.dot(&pull);
        println!("{fabric}: {} frames to {:.1} mm and {largest:.2} N", sequence.frames.len(), 1e3 * shift);
        assert!(sequence.frames.len() > 50 && largest > 1.0 && shift > 0.0);
    }
}

/// Mean shear angle, rad, of the triangles with centres in a rectangle around the centre of the strip.
///
/// * `half` — half its length and half its width, m
fn mean_angle(settled: &Settled<'_>, half: [f64; 2]) -> f64 {
    let specimen = &settled.replica.specimen;
    let mesh = &specimen.mesh;
    let size = Vector2::new(specimen.grid.width, specimen.grid.height);
    let [long, short] = [size.imax(), size.imin()];
    let place = |node: usize| Vector3::from_column_slice(&settled.x[3 * node..3 * node + 3]);
    let angle = |&[a, b, c]: &[usize; 3]| {
        let off = (mesh.positions[a] + mesh.positions[b] + mesh.positions[c]).xy() / 3.0 - size / 2.0;
        let rest = Matrix2::from_columns(&[b, c].map(|node| mesh.material[node] - mesh.material[a]));
        let yarns =
            Matrix3x2::from_columns(&[b, c].map(|node| place(node) - place(a))) * rest.try_inverse()?;
        let inside = off[long].abs() <= half[0] && off[short].abs() <= half[1];
        inside.then(|| yarns.column(0).normalize().dot(&yarns.column(1).normalize()).asin().abs())
    };
    let angles: Vec<f64> = mesh.triangles.iter().filter_map(angle).collect();
    angles.iter().sum::<f64>() / angles.len() as f64
}

#[test]
fn glass_shears_as_its_yarns_let_it_and_predicts_another_strip() {
    let set = glass();
    let yarn = StiffnessCurve::constant(1e5, NegativeStrain::Green).unwrap();
    let yarns: Curves =
        [Component::StretchWeft, Component::StretchWarp].map(|c| (c, yarn.clone())).into_iter().collect();
    let settings = Settings::default();
    let known = Knowledge::exact(yarns);
    let report = fit(&set, &[Stage::Shear], &known, &settings, &mut Watch::default()).unwrap();
    let stage = report.stage(Component::Shear).unwrap();
    let sequence = &stage.sequences[0];
    println!(
        "glass: {} points {:.1?} N/m to {:.2}, {} frames, {} dropped, RMS {:.2} % of {:.1} N, {:.1} s",
        stage.curve.curve.len(),
        stage.curve.curve.stiffnesses(),
        stage.curve.visited[1],
        sequence.frames,
        stage.dropped.len(),
        100.0 * sequence.force_rms.unwrap() / sequence.force_largest,
        sequence.force_largest,
        stage.seconds
    );
    for level in &stage.levels {
        println!("    {} points: {:.4} N, {}", level.points, level.rms, level.status);
    }
    let BiasStrip { length, width } = LARGE;
    let (mut centre, mut zone) = (0.0f64, 0.0f64);
    equilibria(&set, &set.sequences[0], report.curves(), &settings, |settled, _| {
        let displacement = set.sequences[0].frames[settled.frame.index].poses[1].translation.vector.x;
        let expected = LARGE.angle(displacement).to_degrees();
        let [middle, axis] = [[0.03, 0.03], [(length - width) / 2.0, 0.02]]
            .map(|half| mean_angle(&settled, half).to_degrees());
        println!("    eq. 13 {expected:5.2}°, along the axis {axis:5.2}°, at the centre {middle:5.2}°");
        if expected <= 35.0 {
            centre = centre.max((middle - expected).abs());
            zone = zone.max((axis - expected).abs());
        }
    });
    println!("glass: up to 35° within {zone:.2}° along the axis, within {centre:.2}° at the centre");
    let small = predict(
        &small_glass(),
        &[Kind::StretchBias],
        report.curves(),
        &report.assumed(),
        &settings,
        &Watch::default(),
    )
    .unwrap();
    let mut off = 0.0f64;
    for row in &small.sequences[0].forces {
        println!("    230 × 115 mm: {:.2} N measured, {:.2} N predicted", row.measured, row.simulated);
        off = off.max((row.simulated / row.measured - 1.0).abs());
    }
    println!("glass: the smaller strip within {:.0} %", 100.0 * off);
    assert!(stage.converged && stage.dropped.is_empty() && small.dropped.is_empty());
    // The lower bound of the tangent is inactive, however little the yarns stretch.
    assert_eq!(stage.curve.active_constraints, 0);
    assert!(zone <= 2.0 && centre <= 4.5 && off <= 0.35);
}

#[test]
fn a_knit_on_the_bias_is_met_within_3_percent() {
    for (fabric, allowed) in crate::strips::FABRICS.into_iter().zip([0.03, f64::INFINITY]) {
        let strips = [("W_S2", Direction::Weft), ("L_S2", Direction::Warp), ("B_S2", Direction::Bias)];
        let sequences = strips.map(|(strip, direction)| crate::strips::import(fabric, strip, direction));
        let set = weightless(fabric, sequences.to_vec());
        let report = fit(
            &set,
            &[Stage::Stretch, Stage::Shear],
            &Knowledge::default(),
            &Settings::default(),
            &mut Watch::default(),
        )
        .unwrap();
        for stage in report.last_stages() {
            let sequence = &stage.sequences[0];
            let share = sequence.force_rms.unwrap() / sequence.force_largest;
            println!(
                "{fabric} {}: {} points {:.1?} N/m to {:.2}, RMS {:.2} % of {:.2} N, {} frames, {} dropped, {:.1} s",
                stage.name(),
                stage.curve.curve.len(),
                stage.curve.curve.stiffnesses(),
                stage.curve.visited[1],
                100.0 * share,
                sequence.force_largest,
                sequence.frames,
                stage.dropped.len(),
                stage.seconds
            );
            assert!(share <= allowed, "{share}");
            assert!(stage.converged && stage.dropped.is_empty() || allowed > 1.0);
        }
    }
}

#[test]
fn the_shear_stress_of_a_knit_on_the_bias_does_not_depend_on_the_grid() {
    let fabric = crate::strips::FABRICS[0];
    let strips = [("W_S2", Direction::Weft), ("L_S2", Direction::Warp), ("B_S2", Direction::Bias)];
    let sequences = strips.map(|(strip, direction)| crate::strips::import(fabric, strip, direction));
    let mut set = weightless(fabric, sequences.to_vec());
    // Every fourth frame suffices for a comparison of grids.
    for sequence in &mut set.sequences {
        sequence.frames = sequence.frames.iter().step_by(4).cloned().collect();
    }
    let stages = [Stage::Stretch, Stage::Shear];
    let stresses = [[7, 13], [13, 25], [25, 49]].map(|nodes| {
        let settings = Settings { nodes: Some(nodes), ..Settings::default() };
        let report = fit(&set, &stages, &Knowledge::default(), &settings, &mut Watch::default()).unwrap();
        let stress = report.stage(Component::Shear).unwrap().curve.curve.stress(1.0);
        println!("{fabric}, B_S2 on {nodes:?} nodes: shear stress {stress:.3} N/m at strain 1");
        stress
    });
    let [low, high] = stresses.iter().fold([f64::MAX, f64::MIN], |[a, b], s| [a.min(*s), b.max(*s)]);
    assert!(high / low - 1.0 <= 0.005, "{stresses:?}");
}
