//! Source: bias extension. A glass and polypropylene plain weave (cao2008_bias_extension/, Cao et al. 2008, figure 38), and
//! the bias strips of a cotton knit and a cupro weave in a tensile machine (u3m_fab_*/B_S2.csv).
//!
//! Goal: the sets from which a shear curve is fitted, and what is known of them.
//!
//! ```text
//!   fixed ┌──────────────────┐ moving   yarns at ±45°; H × W = 450 × 150 mm, pulled by 106 mm;
//!         │ ╲╱╲╱╲╱╲╱╲╱╲╱╲╱╲╱ │ ───▶     81 × 40 or 50 mm, the last loading
//!         └──────────────────┘
//! ```
//!
//! Yarns that do not stretch make the middle shear alike everywhere:
//!
//! ```text
//! γ = π/2 − 2 acos((L + d)/(√2 L))        L = H − W, d the displacement (Cao et al. 2008, eq. 13)
//! F_s(γ) = [(H/W − 1) F (cos γ/2 − sin γ/2) − W F_s(γ/2) cos γ/2] / [(2H − 3W) cos γ]        (eq. 18)
//! ```
//!
//! Parameters: eq. 13 meets the file's column within 0.01° + 0.1 %, eq. 18 within 0.1 %; forces and extensions in the sets are the files'.

use cloth_fit::frame::{Frame, Kind, MeasurementSet, Sequence};
use cloth_fit::specimen::Specimen;
use cloth_fit::strip::{Direction, Extension, StripTest, read_strip};
use cloth_sim::mesh::Diagonals;
use fit_cloth_tests::{data, rows, weightless};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, SQRT_2};
use std::path::Path;

/// The specimen whose table there is.
pub(crate) const LARGE: BiasStrip = BiasStrip { length: 0.45, width: 0.15 };

/// Another of the same weave, of which the README has the normalised shear force at four angles.
pub(crate) const SMALL: BiasStrip = BiasStrip { length: 0.23, width: 0.115 };

/// Shear angle, °, and normalised shear force of [`SMALL`], N/m.
const SMALL_FORCES: [[f64; 2]; 4] = [[10.0, 5.3], [20.0, 9.8], [30.0, 13.2], [40.0, 19.1]];

/// A strip cut at 45°, with yarns that do not stretch.
#[derive(Clone, Copy)]
pub(crate) struct BiasStrip {
    /// Between the clamps, m.
    pub(crate) length: f64,
    /// Across the pull, m.
    pub(crate) width: f64,
}

impl BiasStrip {
    /// Shear angle in the middle, rad, at a displacement, m: eq. 13.
    pub(crate) fn angle(&self, displacement: f64) -> f64 {
        let free = self.length - self.width;
        FRAC_PI_2 - 2.0 * ((free + displacement) / (SQRT_2 * free)).acos()
    }

    /// Its inverse.
    pub(crate) fn displacement(&self, angle: f64) -> f64 {
        let free = self.length - self.width;
        free * (SQRT_2 * (FRAC_PI_4 - angle / 2.0).cos() - 1.0)
    }

    /// Shear force per length, N/m, from pull, N, and the one at half the angle: eq. 18.
    fn normalised(&self, angle: f64, pull: f64, at_half: f64) -> f64 {
        let Self { length, width } = self;
        let (sine, cosine) = (angle / 2.0).sin_cos();
        ((length / width - 1.0) * pull * (cosine - sine) - width * at_half * cosine)
            / ((2.0 * length - 3.0 * width) * angle.cos())
    }

    /// Normalised shear forces, N/m, of rising angles, rad, and pulls, N. At half an angle the force is interpolated in
    /// what is known by then.
    pub(crate) fn normalised_forces(&self, pulls: &[[f64; 2]]) -> Vec<f64> {
        let mut known: Vec<[f64; 2]> = Vec::new();
        for &[angle, pull] in pulls {
            known.push([angle, self.normalised(angle, pull, interpolated(&known, angle / 2.0))]);
        }
        known.into_iter().map(|[_, force]| force).collect()
    }

    /// The pull that a normalised shear force stands for, N.
    fn pull(&self, angle: f64, force: f64, at_half: f64) -> f64 {
        let without = self.normalised(angle, 0.0, at_half);
        (force - without) / (self.normalised(angle, 1.0, at_half) - without)
    }

    /// A set from a table.
    fn read(&self, table: &Path) -> MeasurementSet {
        let displacement = Extension::Displacement("displacement_mm".into());
        let test = StripTest::new(Direction::Bias, self.length, self.width, displacement, "force_N".into());
        weightless("glass plain weave", vec![read_strip(table, &test).unwrap()])
    }
}

/// Linear between points, constant beyond; 0 if there is none.
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

/// The weave's measured pulls.
pub(crate) fn glass() -> MeasurementSet {
    LARGE.read(&data("cao2008_bias_extension").join("glass_plain_150x450mm.csv"))
}

/// The pulls of the smaller strip at 10, 20, 30 and 40°, by eq. 18 from its normalised shear forces; they start from 0.
pub(crate) fn small_glass() -> MeasurementSet {
    let forces = SMALL_FORCES.map(|[degrees, force]| [degrees.to_radians(), force]);
    let known = [&[[0.0; 2]], &forces[..]].concat();
    let mut table = "displacement_mm,force_N\n".to_owned();
    for [angle, force] in forces {
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
    let specimen = Specimen::new(sequence, None, Diagonals::Alternating).unwrap();
    let cells = specimen.grid.cell();
    println!("glass: {} × {} nodes", specimen.grid.columns, specimen.grid.rows);
    assert!((cells[0] / cells[1] - 1.0).abs() < 0.1);
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
    // At 20° half the angle is one of the four: eq. 18 gives the force back.
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
