//! A sequence that contradicts itself removes only the curves that no other sequence determines.

use cloth_data::error::Error;
use cloth_data::frame::MeasurementSet;
use cloth_data::io::read_set;
use cloth_data::rig::KnownFabric;
use cloth_fit::incremental::{FitReport, Stage, fit};
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::{Settings, Watch};
use cloth_sim::material::Component;
use std::path::Path;

const FIXTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures");

/// Fits bending alone, with known membrane curves.
fn bent(set: &MeasurementSet) -> Result<FitReport, Error> {
    let fabric = KnownFabric::read(&Path::new(FIXTURES).join("fabrics/cotton-denim.toml")).unwrap();
    let known = Knowledge::exact(fabric.curves().unwrap()).without(&[
        Component::BendWeft,
        Component::BendWarp,
        Component::BendDiagonal,
    ]);
    let settings = Settings { nodes: Some([9, 9]), ..Settings::default() };
    fit(set, &[Stage::Bend], &known, &settings, &mut Watch::default())
}

fn denim(names: &[&str]) -> MeasurementSet {
    let mut set = read_set(&Path::new(FIXTURES).join("cotton-denim")).unwrap();
    set.sequences.retain(|sequence| names.contains(&&sequence.name[..]));
    set
}

#[test]
fn one_sequence_against_gravity_loses_its_own_curve_only() {
    let mut set = denim(&["bend-weft", "bend-warp"]);
    let rises = set.sequences.iter_mut().find(|sequence| sequence.name == "bend-warp").unwrap();
    rises.gravity = -rises.gravity;
    let report = bent(&set).unwrap();
    let without = bent(&denim(&["bend-weft"])).unwrap();
    let curve = |report: &FitReport| report.stage(Component::BendWeft).unwrap().curve.clone();
    assert!(curve(&report).observed);
    assert_eq!(curve(&report), curve(&without));
    assert!(report.stage(Component::BendWarp).is_none());
    assert!(!report.failures.is_empty() && report.failures[0].reason.contains("gravity_m_s2"));
    assert_eq!(report.notices.len(), 1);
}

#[test]
fn a_set_of_which_nothing_is_left_is_an_error_that_names_the_field() {
    let mut set = denim(&["bend-weft"]);
    set.sequences[0].gravity = -set.sequences[0].gravity;
    let error = bent(&set).unwrap_err();
    assert!(
        matches!(error, Error::Contradiction(_)) && error.to_string().contains("test.toml gravity_m_s2"),
        "{error}"
    );
}
