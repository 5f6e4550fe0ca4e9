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
    curve(text, Component::StretchWeft, Model::STVK)
}

#[test]
fn rows_are_control_points_and_the_stiffness_at_zero_is_the_first() {
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
    let found = curve(text, Component::BendWarp, Model::SOFT_CONSTRAINT).unwrap();
    assert!((found.stress(30.0) - 2e-4).abs() < 1e-15 && (found.stress(60.0) - 6e-4).abs() < 1e-15);
    let error = curve(text, Component::BendWarp, Model::SPRINGS).unwrap_err().to_string();
    assert!(error.contains("model: found moments over curvature"), "{error}");
    let error = curve(text, Component::Shear, Model::STVK).unwrap_err().to_string();
    assert!(error.contains("found a column curvature_per_m, expected shear_strain"), "{error}");
}

#[test]
fn rows_below_zero_must_be_what_the_model_makes_of_those_above() {
    let shear = |low| {
        let text = format!("strain,stress_n_per_m\n-0.1,{low}\n0,0\n0.1,12\n");
        curve(&text, Component::Shear, Model::STVK)
    };
    assert_eq!(shear(-12.05).unwrap().strains(), [0.0, 0.1]);
    let error = shear(-12.5).unwrap_err().to_string();
    assert!(error.contains(":2 stress_n_per_m: found -12.5 at -0.1") && error.contains("odd"), "{error}");
    // Tables of a fit may have no row at zero.
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
        ("0,0\n1e-5,1e308\n1,1", ":3 stiffness_n_per_m: found control point 0: its stiffness is not finite"),
        (
            "0,0\n1e-6,1\n2e-6,1e305",
            ":4 stiffness_n_per_m: found control point 2: its stiffness is not finite",
        ),
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
        let component =
            if file.measure == Some(StrainMeasure::Hinge) { Component::BendWeft } else { Component::Shear };
        let found = file.curve(component, Model::STVK, NegativeStrain::Odd).unwrap();
        assert_eq!(file.to_csv(), text);
        let again = file.with_curve(&found);
        let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-15 * b.abs());
        assert!(close(&again.stresses, &file.stresses));
        assert!(close(again.stiffnesses.as_ref().unwrap(), file.stiffnesses.as_ref().unwrap()));
    }
}

#[test]
fn in_compression_without_stress_rows_below_zero_must_have_none() {
    let slack = |low| {
        let text = format!("strain,stress_n_per_m\n-0.1,{low}\n0,0\n0.1,12\n");
        read(&text)?.curve(Component::StretchWeft, Model::STVK, NegativeStrain::Slack)
    };
    assert!(slack("0").is_ok());
    let error = slack("-1").unwrap_err().to_string();
    assert!(error.contains(":2 stress_n_per_m: found -1 at -0.1, expected 0.000000"), "{error}");
    assert!(error.contains("no stress in compression"), "{error}");
}

const BANDED: &str = "strain,stiffness_n_per_m,stress_n_per_m,stress_low_n_per_m,stress_high_n_per_m\n\
                      -0.25,120,-30,-31,-29\n-0,90,-0,0,0\n0.25,120,30,29,31\n0.5,100,50,48,51\n";

#[test]
fn scaling_takes_stiffnesses_and_bands_along() {
    let file = read(BANDED).unwrap();
    let scaled = file.scaled(2.0, 3.0);
    assert_eq!(scaled.strains, [-0.5, 0.0, 0.5, 1.0]);
    assert_eq!(scaled.stiffnesses, Some(vec![180.0, 135.0, 180.0, 150.0]));
    assert_eq!(scaled.stresses, [-90.0, 0.0, 90.0, 150.0]);
    assert_eq!(scaled.band[1], Some(vec![-87.0, 0.0, 93.0, 153.0]));
    let [curve, wider] =
        [&file, &scaled].map(|f| f.curve(Component::Shear, Model::STVK, NegativeStrain::Odd).unwrap());
    for strain in [0.1, 0.3, 0.7] {
        assert!((wider.stress(2.0 * strain) - 3.0 * curve.stress(strain)).abs() < 1e-11);
    }
}

#[test]
fn another_curve_on_the_same_rows_keeps_the_width_of_the_band() {
    let file = read(BANDED).unwrap();
    let line = StiffnessCurve::new(vec![0.0, 0.5], vec![80.0, 80.0], NegativeStrain::Odd).unwrap();
    let again = file.with_curve(&line);
    assert_eq!(again.stresses, [-20.0, 0.0, 20.0, 40.0]);
    assert_eq!(again.stiffnesses, Some(vec![80.0; 4]));
    assert_eq!(again.band, [Some(vec![-21.0, 0.0, 19.0, 38.0]), Some(vec![-19.0, 0.0, 21.0, 41.0])]);
}

#[test]
fn control_points_of_another_curve_become_rows_above_those_below_zero() {
    let file = read(BANDED).unwrap();
    assert!(file.is_two_sided() && !read("strain,stress_n_per_m\n0,0\n1,1\n").unwrap().is_two_sided());
    let line = StiffnessCurve::new(vec![0.0, 1.0], vec![80.0, 80.0], NegativeStrain::Odd).unwrap();
    let rows = file.with_points(&line);
    assert_eq!((rows.strains, rows.stresses), (vec![-0.25, 0.0, 1.0], vec![-20.0, 0.0, 80.0]));
    assert_eq!(rows.band, [None, None]);
    let text = "curvature_per_m,moment_n\n0,0\n10,2e-4\n";
    let hinges = StiffnessCurve::new(vec![0.0, 60.0], vec![1e-5, 1e-5], NegativeStrain::Odd).unwrap();
    let rows = read(text).unwrap().with_points(&hinges);
    assert_eq!(rows.strains, [0.0, 20.0]);
    assert!((rows.stresses[1] - 6e-4).abs() < 1e-18 && (rows.stiffnesses.unwrap()[1] - 3e-5).abs() < 1e-18);
    assert_eq!(file.strain_per_unit(), 1.0);
}

/// A strip pulled to 10 % and 20 %: nominal stresses of 200 and 600 N/m.
const GREEN: &str = "green_strain,pk2_stress_n_per_m\n0,0\n0.105,181.8181818181818\n0.22,500\n";

#[test]
fn beside_green_strain_stand_engineering_strain_and_nominal_stress() {
    let file = read(GREEN).unwrap();
    assert_eq!(file.measure, Some(StrainMeasure::Green));
    let text = file.to_csv();
    let mut rows = text.lines();
    let header = "green_strain,pk2_stress_n_per_m,engineering_strain,nominal_stress_n_per_m";
    assert_eq!(rows.next(), Some(header));
    for (row, expected) in rows.zip([[0.0, 0.0], [0.1, 200.0], [0.2, 600.0]]) {
        let found: Vec<f64> = row.split(',').skip(2).map(|field| field.parse().unwrap()).collect();
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12 * b.max(1.0)), "{row}");
    }
    // The columns read back; editing only one of them makes the table contradict itself.
    let again = read(&text).unwrap();
    assert_eq!((&again.strains, &again.stresses), (&file.strains, &file.stresses));
    let error = read(&text.replace(",500,", ",550,")).unwrap_err().to_string();
    assert!(error.contains(":4 nominal_stress_n_per_m: found 600") && error.contains("660"), "{error}");
    // At a Green strain of −1/2 the length is zero.
    let folded = read("green_strain,pk2_stress_n_per_m\n-0.5,-1\n0,0\n0.5,1\n").unwrap();
    assert!(folded.to_csv().starts_with("green_strain,pk2_stress_n_per_m\n"));
}

#[test]
fn a_table_says_whose_strain_it_is_over() {
    let of = |header: &str| format!("{header}\n0,0\n0.1,12\n0.2,28\n");
    let tables = [
        ("green_strain,pk2_stress_n_per_m", Component::StretchWarp, Model::STVK),
        ("engineering_strain,nominal_stress_n_per_m", Component::StretchWarp, Model::SOFT_CONSTRAINT),
        ("engineering_strain,nominal_stress_n_per_m", Component::StretchWeft, Model::SPRINGS),
        ("shear_strain,shear_stress_n_per_m", Component::Shear, Model::SOFT_CONSTRAINT),
        ("diagonal_strain,diagonal_stress_n_per_m", Component::Shear, Model::SPRINGS),
    ];
    for (header, component, model) in tables {
        let named = curve(&of(header), component, model).unwrap();
        assert_eq!(named, curve(&of("strain,stress_n_per_m"), component, model).unwrap());
        assert_eq!(read(&of(header)).unwrap().measure, Some(model.strain_measure(component)));
        for (_, other, another) in tables.iter().filter(|(other, ..)| *other != header) {
            let error = curve(&of(header), *other, *another).unwrap_err().to_string();
            let column = header.split(',').next().unwrap();
            let owner = format!("the columns of {other} in {another}");
            assert!(error.contains(&format!("found a column {column}")) && error.contains(&owner), "{error}");
        }
    }
}

#[test]
fn quantities_in_other_units_are_named_with_the_unit_that_is_expected() {
    let error = read("curvature [1/cm],moment [gf·cm/cm]\n0,0\n1,0.05\n").unwrap_err().to_string();
    let words = "header: found curvature [1/cm], moment [gf·cm/cm], expected curvature_per_m (convert 1/cm to per metre), \
                 moment_n (convert gf·cm/cm to newtons, newton metres per metre of width)";
    assert!(error.contains(words), "{error}");
}

#[test]
fn rows_without_a_band_stay_without_one() {
    let text = BANDED.replace("-31,-29", ",").replace("29,31", ",");
    let again = read(&text).unwrap().scaled(1.0, 2.0).to_csv();
    let lines: Vec<&str> = again.lines().collect();
    assert!(
        lines[1].ends_with(",-60,,") && lines[3].ends_with(",60,,") && lines[4].ends_with(",100,96,102"),
        "{again}"
    );
    let error = read(&BANDED.replace("29,31", "29,wide")).unwrap_err().to_string();
    assert!(error.contains("stress_high_n_per_m: found wide"), "{error}");
}
