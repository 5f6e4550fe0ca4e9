//! Source: exact homogeneous stretch of a 100 mm square under the weft curve of a wool fabric (Volino et al. 2009, as
//! published again by Strohkorb 2019), diagonalised StVK.
//!
//! Goal: the fit recovers the stress from clip separation and clip force alone.
//!
//! ```text
//!   ┌───────────┐
//!   │ fixed     │─▶ moving   100 mm square, 1–10 % in ten frames
//!   └───────────┘
//! ```
//!
//! Parameters: five control points at most; force residual ≤ 0.7 % of the largest force, stress within 2 % (relative L2
//! over the frames' strains).

use cloth_data::strip::{Direction, Extension, StripTest, read_strip};
use cloth_fit::stage::{Settings, Watch, stretch};
use cloth_sim::material::{Component, Model};
use fit_cloth_tests::{data, weightless};
use std::fs::read_to_string;

/// Expected form of the file.
const SHAPE: &str = "a table with the columns that its README describes";

const GREEN_STRAIN: usize = 3;
const STRESS: usize = 4;

#[test]
fn five_points_find_the_stress_of_wool() {
    let path = data("synthetic_frames").join("weft_stretch_100mm.csv");
    let separation = Extension::Separation("clip_separation_m".into());
    let test = StripTest::new(Direction::Weft, 0.1, 0.1, separation, "clip_force_N".into());
    let set = weightless("wool", vec![read_strip(&path, &test).unwrap().sequence]);
    let settings = Settings { model: Model::STVK, ..Settings::default() };
    let report =
        stretch::fit(&set, Component::StretchWeft, &settings, &mut Watch::default()).unwrap().unwrap();
    let residual = report.sequences[0].force_rms.unwrap() / report.sequences[0].force_largest;

    let (mut difference, mut sum) = (0.0, 0.0);
    for line in read_to_string(path).expect(SHAPE).lines().skip(1) {
        let row: Vec<f64> = line.split(',').map(|field| field.parse().expect(SHAPE)).collect();
        difference += (report.curve.curve.stress(row[GREEN_STRAIN]) - row[STRESS]).powi(2);
        sum += row[STRESS].powi(2);
    }
    let error = (difference / sum).sqrt();
    let points = report.curve.curve.len();
    println!(
        "{points} points: force residual {:.3} % of the largest force, stress {:.3} % off",
        100.0 * residual,
        100.0 * error
    );
    assert!(report.converged && points <= 5 && report.sequences[0].frames == 10);
    assert!(residual <= 0.007, "{residual}");
    assert!(error <= 0.02, "{error}");
}
