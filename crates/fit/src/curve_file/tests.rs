use super::*;
use std::fs;

fn read(text: &str) -> Result<CurveFile> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("curve.csv");
    fs::write(&path, text).unwrap();
    CurveFile::read(&path)
}

fn curve(text: &str, component: Component, model: Model) -> Result<StiffnessCurve> {
    let negative = model.negative_strain(component, cloth_sim::material::Compression::ZeroStrain);
    read(text)?.curve(component, model, negative)
}

fn weft(text: &str) -> Result<StiffnessCurve> {
    curve(text, Component::StretchWeft, Model::Stvk)
}

#[test]
fn rows_are_control_points_and_the_stress_starts_straight() {
    let found = weft("strain,stress_n_per_m\n0,0\n0.1,12\n0.2,28\n").unwrap();
    assert_eq!(found.strains(), [0.0, 0.1, 0.2]);
    let expected = [120.0, 120.0, 140.0];
    assert!(found.stiffnesses().iter().zip(expected).all(|(k, e)| (k - e).abs() < 1e-10));
    let stated = weft("strain,stiffness_n_per_m,stress_n_per_m\n0,90,0\n0.1,120,12\n0.2,140,28\n").unwrap();
    assert_eq!(stated.stiffnesses(), [90.0, 120.0, 140.0]);
    let line = weft("stress_n_per_m,strain\n0,0\n12,0.1\n").unwrap();
    assert_eq!(line.stiffnesses(), [120.0, 120.0]);
}

#[test]
fn moments_over_curvature_become_stresses_of_hinges() {
    let text = "curvature_per_m,moment_n\n0,0\n10,2e-4\n20,6e-4\n";
    let found = curve(text, Component::BendWarp, Model::SoftConstraint).unwrap();
    assert!((found.stress(30.0) - 2e-4).abs() < 1e-15 && (found.stress(60.0) - 6e-4).abs() < 1e-15);
    let error = curve(text, Component::BendWarp, Model::Springs).unwrap_err().to_string();
    assert!(error.contains("model: found moments over curvature"), "{error}");
    let error = curve(text, Component::Shear, Model::Stvk).unwrap_err().to_string();
    assert!(error.contains("found a column curvature_per_m, expected strain"), "{error}");
}

#[test]
fn rows_below_zero_must_be_what_the_model_makes_of_those_above() {
    let shear = |low| {
        let text = format!("strain,stress_n_per_m\n-0.1,{low}\n0,0\n0.1,12\n");
        curve(&text, Component::Shear, Model::Stvk)
    };
    assert_eq!(shear(-12.05).unwrap().strains(), [0.0, 0.1]);
    let error = shear(-12.5).unwrap_err().to_string();
    assert!(error.contains(":2 stress_n_per_m: found -12.5 at -0.1") && error.contains("odd"), "{error}");
    // Tables of a fit may step over zero.
    let text = "strain,stress_n_per_m\n-0.01,-1.015\n0.01,1\n0.03,3\n";
    let found = weft(text).unwrap();
    assert_eq!((found.strains(), found.stiffnesses()[0]), (&[0.0, 0.01, 0.03][..], 100.0));
    assert!(weft(&text.replace("-1.015", "-3")).unwrap_err().to_string().contains("compression"));
}

#[test]
fn what_is_wrong_is_named_by_its_line() {
    for (rows, words) in [
        ("0,0\n0.1,1\n0.1,2", ":4 strain: found 0.1, the same as the row before"),
        ("0,0\n0.2,1\n0.1,2", ":4 strain: found 0.1, below the row before"),
        ("0,0\nnan,1", ":3 strain: found nan, expected a finite number"),
        ("0,0\n0.1,inf", ":3 stress_n_per_m: found inf"),
        ("0.05,1\n0.1,2", ":2 strain: found 0.05 in the first row, expected 0"),
        ("0,1\n0.1,2", ":2 stress_n_per_m: found 1 at zero"),
        ("0,0", "found no row above zero"),
        ("-0.1,-1", "found no row above zero"),
        ("0,0\n1e-320,1\n1,1", ":3 strain: found"),
        ("", "found nothing below the header"),
    ] {
        let error = weft(&format!("strain,stress_n_per_m\n{rows}\n")).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let error = weft("strain,stress_mpa\n0,0\n").unwrap_err().to_string();
    assert!(error.contains(":1 header"), "{error}");
    let stated = "strain,stiffness_n_per_m,stress_n_per_m\n0,90,0\n0.1,110,12\n";
    let error = weft(stated).unwrap_err().to_string();
    assert!(error.contains(":3 stiffness_n_per_m: found 110"), "{error}");
}

#[test]
fn a_table_comes_back_from_its_curve() {
    for text in [
        "strain,stiffness_n_per_m,stress_n_per_m,stress_low_n_per_m,stress_high_n_per_m\n0,90,0,0,0\n0.25,120,30,29,31\n",
        "curvature_per_m,rigidity_n_m,moment_n\n0,0.0003,0\n8,0.0006,0.0048\n",
    ] {
        let file = read(text).unwrap();
        let component = if file.kind == Kind::Bending { Component::BendWeft } else { Component::Shear };
        let found = file.curve(component, Model::Stvk, NegativeStrain::Odd).unwrap();
        assert_eq!(file.to_csv(), text);
        let again = file.with_curve(&found);
        let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-15 * b.abs());
        assert!(close(&again.stresses, &file.stresses));
        assert!(close(again.stiffnesses.as_ref().unwrap(), file.stiffnesses.as_ref().unwrap()));
    }
}
