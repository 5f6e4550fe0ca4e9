//! `fit-cloth check` and `fit-cloth curve`: output, files and exit codes.
//!
//! Goal: a defect is found, reported with its interval, and repaired; inputs are never changed; edits match the source.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which may stop where they cannot go on")]

use cloth_data::curve_file::CurveFile;
use cloth_fit::material::file::MaterialFile;
use cloth_sim::curve::NegativeStrain;
use cloth_sim::material::{Component, Model};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn fixture(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/curves");
    folder.join(name).display().to_string()
}

/// Exit code, standard output, standard error.
fn run(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fit-cloth"));
    let output = command.current_dir(folder).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// Largest and last stress of a table.
fn end(path: &Path) -> (f64, f64) {
    let file = CurveFile::read(path).unwrap();
    (*file.strains.last().unwrap(), *file.stresses.last().unwrap())
}

/// A fit's file with a stable weft curve, a shear curve with a kink, and a bending curve in the wrong unit or not.
fn material(folder: &Path, bend: f64) -> PathBuf {
    let point = |strain: f64, k: f64| format!(r#"{{"strain":{strain},"stiffness_n_per_m":{k}}}"#);
    let curve = |points: &[String], more: &str| {
        format!(r#"{{"observed":true,"control_points":[{}]{more}}}"#, points.join(","))
    };
    let weft = curve(&[point(0.0, 100.0), point(0.1, 150.0)], r#","visited_strain":[0.0,0.05]"#);
    let shear = curve(&[0.0, 0.1, 0.2, 0.3].map(|e| point(e, if e == 0.2 { 10.0 } else { 100.0 })), "");
    let bend = format!(r#"{{"observed":true,"control_points":[{{"strain":0.0,"stiffness_n_m":{bend}}}]}}"#);
    let text = format!(
        r#"{{"schema":"fit-cloth/material/1","model":"stvk","compression":"zero-strain",
        "fabric":{{"name":"f","width_m":0.1,"height_m":0.1,"areal_density_kg_m2":0.2}},
        "curves":{{"stretch-weft":{weft},"shear":{shear},"bend-weft":{bend}}},
        "residuals":[],"provenance":{{"program":"p","constraints":"stable","nodes":{{}}}}}}"#
    );
    let path = folder.join("material.json");
    fs::write(&path, text).unwrap();
    path
}

#[test]
fn a_kink_is_found_and_mended_and_the_mended_curve_stays() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let kinked = fixture("kinked.csv");
    let before = fs::read(&kinked).unwrap();
    let (code, text, _) = run(at, &["check", &kinked, "--repair", "mended.csv"]);
    assert_eq!(code, Some(3), "{text}");
    assert!(text.contains("low-tangent") && text.contains("stress falls as strain grows"), "{text}");
    assert!(text.contains("0.0538 to 0.0613") && text.contains("repaired: stress changed by"), "{text}");
    assert!(text.ends_with("Written to mended.csv\n"), "{text}");
    let (code, text, _) = run(at, &["check", "mended.csv", "--repair", "again.csv"]);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("sound, unchanged") && text.contains("mended.csv: sound"), "{text}");
    let read = |name: &str| fs::read_to_string(at.join(name)).unwrap();
    assert_eq!(read("mended.csv"), read("again.csv"));
    assert!(read("mended.csv").starts_with("strain,stiffness_n_per_m,stress_n_per_m\n0,"));
    assert_eq!(fs::read(&kinked).unwrap(), before);
    // Sound rows far from the kink hardly change.
    let [mended, weft] =
        [at.join("mended.csv"), fixture("weft.csv").into()].map(|path| CurveFile::read(&path).unwrap());
    assert!((mended.stresses[24] / weft.stresses[24] - 1.0).abs() < 0.01);
}

#[test]
fn nothing_is_written_over_the_input_or_of_what_cannot_be_mended() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::copy(fixture("kinked.csv"), at.join("in.csv")).unwrap();
    let (code, _, error) = run(at, &["check", "in.csv", "--repair", "absent/in.csv"]);
    assert_eq!(code, Some(1), "{error}");
    let (code, _, error) = run(at, &["check", "in.csv", "--repair", "./in.csv"]);
    assert_eq!(code, Some(3));
    assert!(error.contains("the input itself"), "{error}");
    assert_eq!(fs::read(at.join("in.csv")).unwrap(), fs::read(fixture("kinked.csv")).unwrap());

    fs::write(at.join("pascal.csv"), "strain,stress_n_per_m\n0,0\n0.1,38e6\n").unwrap();
    let (code, _, error) = run(at, &["check", "pascal.csv", "--repair", "out.csv"]);
    assert_eq!(code, Some(3));
    assert!(error.contains("probably another unit") && !at.join("out.csv").exists(), "{error}");
    fs::write(at.join("nan.csv"), "strain,stress_n_per_m\n0,0\n0.1,nan\n").unwrap();
    let (code, _, error) = run(at, &["check", "nan.csv"]);
    assert!(code == Some(3) && error.contains("nan.csv:3 stress_n_per_m"), "{error}");
    let (code, _, error) = run(at, &["check", &fixture("shear.csv")]);
    assert!(code == Some(3) && error.contains("--component"), "{error}");
}

#[test]
fn every_curve_of_a_material_is_checked_and_mended_in_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    material(at, 1e-6);
    let (code, text, _) = run(at, &["check", "material.json", "--json", "--repair", "mended.json"]);
    assert_eq!(code, Some(3), "{text}");
    let json: Value = serde_json::from_str(&text).unwrap();
    let curve = |name: &str| json["curves"][name].clone();
    assert!(curve("stretch-weft")["sound"] == true && curve("bend-weft")["sound"] == true);
    assert_eq!(curve("stretch-weft")["findings"][0]["kind"], "unvisited");
    assert_eq!(curve("shear")["findings"][0]["kind"], "low-tangent");
    let mended = MaterialFile::read(&at.join("mended.json")).unwrap();
    let given = MaterialFile::read(&at.join("material.json")).unwrap();
    assert!(mended.curves[&Component::StretchWeft] == given.curves[&Component::StretchWeft]);
    assert!(matches!(&mended.provenance.changes[..], [change] if change.starts_with("shear: repaired")));
    assert_eq!(run(at, &["check", "mended.json"]).0, Some(0));
    // A fit refuses unstable known curves.
    let set = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/cotton-denim");
    let fit = ["bend", &set.display().to_string(), "--known", "material.json"];
    let (code, _, error) = run(at, &fit);
    assert_eq!(code, Some(3));
    assert!(error.contains("shear: found low-tangent") && error.contains("--allow-unstable"), "{error}");

    material(at, 1.0);
    let (code, text, error) = run(at, &["check", "material.json", "--repair", "other.json"]);
    assert!(
        code == Some(3) && error.contains("bend-weft") && !at.join("other.json").exists(),
        "{text}{error}"
    );
}

#[test]
fn the_edits_of_the_source_are_one_or_two_commands() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let [weft, warp, shear] = ["weft.csv", "warp.csv", "shear.csv"].map(fixture);
    let edit = |arguments: &[&str]| {
        let (code, text, error) = run(at, &[&["curve"], arguments].concat());
        assert_eq!(code, Some(0), "{text}{error}");
        text
    };
    // Figure 8: larger strain steps.
    for (file, factor, last) in [(&weft, "10", 1.2), (&warp, "200", 4.0), (&shear, "10", 1.5)] {
        let before = end(file.as_ref());
        edit(&[
            "scale",
            file,
            "--strain",
            factor,
            "--component",
            if file == &shear { "shear" } else { "stretch-warp" },
            "--out",
            "wide.csv",
        ]);
        let (strain, stress) = end(&at.join("wide.csv"));
        assert!((strain - last).abs() < 1e-12 && (stress - before.1).abs() < 1e-9);
    }
    // Figure 9: unchanged up to half the range, then straight.
    edit(&[
        "extend",
        &weft,
        "--from",
        "0.057",
        "--to",
        "0.1",
        "--stress-at-end",
        "950",
        "--out",
        "trend.csv",
    ]);
    let near = |(strain, stress): (f64, f64), to: [f64; 2]| {
        (strain - to[0]).abs() < 1e-12 && (stress - to[1]).abs() < 1e-9
    };
    assert!(near(end(&at.join("trend.csv")), [0.1, 950.0]));
    let curve = |path: &Path| {
        CurveFile::read(path)
            .unwrap()
            .curve(Component::StretchWeft, Model::STVK, NegativeStrain::Slack)
            .unwrap()
    };
    let [given, edited] = [curve(weft.as_ref()), curve(&at.join("trend.csv"))];
    assert!((edited.stress(0.03) / given.stress(0.03) - 1.0).abs() < 1e-3);
    let slope = (950.0 - given.stress(0.057)) / 0.043;
    assert!((edited.response(0.09).tangent / slope - 1.0).abs() < 0.02);
    // Figure 10: larger steps, then straight, at the same step.
    edit(&["scale", &warp, "--strain", "10", "--out", "wide.csv"]);
    let text = edit(&[
        "extend",
        "wide.csv",
        "--from",
        "0.08",
        "--to",
        "0.13",
        "--stress-at-end",
        "400",
        "--out",
        "trend.csv",
    ]);
    assert!(text.contains("sound"), "{text}");
    assert!(near(end(&at.join("trend.csv")), [0.13, 400.0]));
    // Figure 11: all stresses in proportion, on both sides.
    edit(&["scale", &shear, "--component", "shear", "--largest-stress", "27", "--out", "stiff.csv"]);
    let file = CurveFile::read(&at.join("stiff.csv")).unwrap();
    assert!((file.stresses[0] + 27.0).abs() < 1e-12 && (file.stresses[30] - 27.0).abs() < 1e-12);
    assert_eq!(file.stresses[15], 0.0);
}

#[test]
fn an_edit_in_a_material_is_told_in_it_and_a_bad_one_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    material(at, 1e-6);
    let (code, _, error) =
        run(at, &["curve", "scale", "material.json", "--strain", "2", "--out", "out.json"]);
    assert!(code == Some(3) && error.contains("--component"), "{error}");
    let weft = [
        "curve",
        "extend",
        "material.json",
        "--component",
        "stretch-weft",
        "--to",
        "0.2",
        "--slope=-90",
        "--out",
        "out.json",
    ];
    let (code, text, error) = run(at, &weft);
    assert_eq!(code, Some(0), "{error}");
    assert!(
        error.contains("warning: stretch-weft: end-slope") && text.contains("NOT sound"),
        "{error}{text}"
    );
    let file = MaterialFile::read(&at.join("out.json")).unwrap();
    let entry = &file.curves[&Component::StretchWeft];
    assert!(entry.visited_strain.is_none() && entry.control_points.len() == 3);
    assert!(file.provenance.changes[0].starts_with("stretch-weft: straight from"));
    let wrong = ["curve", "scale", &fixture("weft.csv"), "--stress", "-1", "--out", "out.csv"];
    let (code, _, error) = run(at, &wrong);
    assert!(code == Some(3) && error.contains("a factor above 0") && !at.join("out.csv").exists(), "{error}");
}

#[test]
fn a_tables_columns_say_how_it_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let rows = "\n-0.1,-10\n0,0\n0.1,10\n";
    fs::write(at.join("soft.csv"), format!("engineering_strain,nominal_stress_n_per_m{rows}")).unwrap();
    fs::write(at.join("shear.csv"), format!("shear_strain,shear_stress_n_per_m{rows}")).unwrap();
    for file in ["soft.csv", "shear.csv"] {
        let (code, text, error) = run(at, &["check", file]);
        assert_eq!(code, Some(0), "{text} {error}");
    }
    let (code, _, error) = run(at, &["check", "soft.csv", "--model", "stvk"]);
    assert!(code == Some(3) && error.contains("expected green_strain and pk2_stress_n_per_m"), "{error}");
    let (code, _, error) = run(at, &["curve", "scale", "soft.csv", "--stress", "2", "--out", "twice.csv"]);
    assert_eq!(code, Some(0), "{error}");
    let twice = fs::read_to_string(at.join("twice.csv")).unwrap();
    assert!(twice.starts_with("engineering_strain,") && twice.contains("nominal_stress_n_per_m"), "{twice}");
}
