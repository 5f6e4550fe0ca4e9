//! `fit-cloth shear`, `bend`, `fit` and `compare`, run as a user does, on a set with every kind of test and closed-form
//! curves.

#![allow(clippy::unwrap_used)]

mod support;

use cloth_data::io::write_set;
use cloth_fit::incremental::{self, Stage};
use cloth_fit::material::file::MaterialFile;
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::{Settings, Watch};
use cloth_sim::material::{Component, Model};
use fit_cloth::text;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn run(arguments: &[&str], within: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fit-cloth")).args(arguments).current_dir(within).output().unwrap()
}

/// A folder with the full set in `set`.
fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_path_buf();
    write_set(&path.join("set"), &support::full_set()).unwrap();
    (folder, path)
}

fn fit(command: &str, within: &Path, out: &str, more: &[&str]) -> Output {
    run(&[&[command, "set", "--nodes", "9x9", "--out", out], more].concat(), within)
}

fn said(output: &Output) -> [String; 2] {
    [&output.stdout, &output.stderr].map(|bytes| String::from_utf8(bytes.clone()).unwrap())
}

fn rows(file: &Path) -> (String, Vec<Vec<f64>>) {
    let text = fs::read_to_string(file).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let row = |line: &str| line.split(',').map(|field| field.parse().unwrap()).collect();
    (header.into(), rows.lines().map(row).collect())
}

#[test]
fn fit_finds_every_curve_that_is_shown_and_says_which_is_not() {
    let (_keep, path) = folder();
    fs::remove_dir_all(path.join("set/bend-warp")).unwrap();
    let output = fit("fit", &path, "out", &["--variant", "linear"]);
    let [text, warnings] = said(&output);
    assert!(output.status.success(), "{warnings}");
    assert!(warnings.starts_with("warning: stvk: bend-warp is not observed by any sequence"), "{warnings}");
    for words in ["fitted to the shapes of bend-weft", "moment", "complex-shear (complex-shear) is not used"]
    {
        assert!(text.contains(words), "{words}: {text}");
    }
    let expected = [("stretch-weft", 500.0), ("stretch-warp", 800.0), ("shear", 60.0), ("bend-weft", 6e-4)];
    for (component, stiffness) in expected {
        let (header, rows) = rows(&path.join(format!("out/curves/{component}.csv")));
        let bends = component.starts_with("bend");
        assert_eq!(header.starts_with("curvature_per_m,rigidity_n_m,moment_n"), bends, "{header}");
        let last = rows.last().unwrap();
        assert_eq!(rows.len(), 201);
        assert!((last[1] / stiffness - 1.0).abs() < 0.05, "{component}: {last:?}");
    }
    assert!(!path.join("out/curves/bend-warp.csv").exists());
    assert!(
        path.join("out/plots/bend-weft-moment.svg").exists()
            && path.join("out/plots/shear-force.svg").exists()
    );
    let residuals = fs::read_to_string(path.join("out/residuals.csv")).unwrap();
    assert_eq!(residuals.lines().count(), 1 + 4, "{residuals}");
    assert!(residuals.lines().any(|line| line.starts_with("bend-weft,bend-weft,,,")), "{residuals}");
    let material = MaterialFile::read(&path.join("out/material.json")).unwrap();
    assert!(!material.curves[&Component::BendWarp].observed);
    assert_eq!(warnings.lines().count(), 6 - material.curves().unwrap().components().count());
}

#[test]
fn the_material_file_gives_every_curve_back_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let set = support::full_set();
    let mut extrapolated = false;
    for model in Model::ALL {
        let settings = Settings { model, nodes: Some([9, 9]), points: 2, ..Settings::default() };
        let known = Knowledge::default();
        let report = incremental::fit(&set, &Stage::ALL, &known, &settings, &mut Watch::default()).unwrap();
        let file = MaterialFile::new(&set, &settings, &report, None);
        let path = folder.path().join("material.json");
        fs::write(&path, file.to_json()).unwrap();
        let read = MaterialFile::read(&path).unwrap();
        assert_eq!(read, file);
        assert_eq!(read.curves().unwrap(), *report.curves());
        // A stage's interventions are in the file and in the text output.
        for stage in report.last_stages() {
            let told = text::stage(stage, false).contains("interventions: ");
            assert_eq!(told, !stage.interventions.none(), "{}", text::stage(stage, false));
            assert_eq!(read.curves[&stage.components[0]].interventions, stage.interventions);
        }
        extrapolated |= report.stages.iter().any(|stage| !stage.interventions.share_extrapolated.is_empty());
    }
    assert!(extrapolated);
}

#[test]
fn the_curves_are_the_same_on_one_and_on_two_threads() {
    let (_keep, path) = folder();
    let [one, two] = ["1", "2"].map(|threads| {
        let _ = fit("fit", &path, threads, &["--points", "2", "--threads", threads]);
        fs::read(path.join(threads).join("material.json")).unwrap()
    });
    assert!(one == two);
}

#[test]
fn what_is_given_is_not_fitted() {
    let (_keep, path) = folder();
    assert!(fit("stretch", &path, "first", &[]).status.success());
    let known = "first/material.json";
    let output = fit("shear", &path, "second", &["--known", known]);
    let [text, warnings] = said(&output);
    assert!(output.status.success() && warnings.is_empty(), "{warnings}");
    assert!(text.contains("taken as exact: stretch-weft, stretch-warp"), "{text}");
    let material = MaterialFile::read(&path.join("second/material.json")).unwrap();
    let given = |component| material.curves[&component].given;
    assert!(given(Component::StretchWeft) && !given(Component::Shear));
    assert!(!path.join("second/curves/stretch-weft.csv").exists());
    for (more, words) in [
        (&["--model", "springs"][..], "model: found stvk, expected springs"),
        (&["--compression", "none"], "(--compression zero-strain, or another --known)"),
        (&["--out", "first"], "another --out"),
    ] {
        let out = if more[0] == "--out" { "first" } else { "third" };
        let more = if more[0] == "--out" { &[][..] } else { more };
        let output = fit("bend", &path, out, &[&["--known", known], more].concat());
        let [_, errors] = said(&output);
        assert_eq!(output.status.code(), Some(3), "{errors}");
        assert!(errors.contains(words), "{errors}");
    }
    // Curves of another fabric may be entirely different.
    let other = fs::read_to_string(path.join(known)).unwrap();
    let name = format!("\"name\": \"{}\"", material.fabric.name);
    assert!(other.contains(&name));
    fs::write(path.join("other.json"), other.replace(&name, "\"name\": \"canvas\"")).unwrap();
    let [text, _] = said(&fit("shear", &path, "fourth", &["--known", "other.json"]));
    assert!(
        text.contains("--known: found curves of canvas, taken as exact") && text.contains("Verdict: AMBER"),
        "{text}"
    );
    let output = fit("fit", &path, "third", &["--known", "second/residuals.csv"]);
    assert_eq!(output.status.code(), Some(3));
}

#[test]
fn a_set_without_the_tests_that_a_command_is_about_is_refused() {
    let (_keep, path) = folder();
    assert!(fit("fit", &path, "known", &["--variant", "linear"]).status.success());
    let refused = |command: &str, more: &[&str], words: &str| {
        let output = fit(command, &path, "out", more);
        let [text, errors] = said(&output);
        assert_eq!((output.status.code(), &text[..]), (Some(3), ""), "{command} {more:?}: {errors}");
        assert!(
            errors.contains(words) && errors.contains("(fit-cloth fit uses all tests of a set)"),
            "{errors}"
        );
        assert!(!path.join("out").exists() && !path.join(".out.work").exists());
    };
    let known = ["--known", "known/material.json"];
    fs::remove_dir_all(path.join("set/shear")).unwrap();
    for more in [&[][..], &known] {
        let words = "found stretch-weft, stretch-warp, bend-weft, bend-warp, complex-shear, expected a sequence of kind \
                     stretch-bias or shear";
        refused("shear", more, words);
    }
    // One bending test is enough; without any, the command is refused.
    fs::remove_dir_all(path.join("set/bend-warp")).unwrap();
    assert!(fit("bend", &path, "bent", &["--variant", "linear"]).status.success());
    fs::remove_dir_all(path.join("set/bend-weft")).unwrap();
    for more in [&[][..], &known] {
        refused("bend", more, "expected a sequence of kind bend-weft or bend-warp or bend-bias");
    }
    assert!(fit("fit", &path, "rest", &["--variant", "linear"]).status.success());
    ["stretch-weft", "stretch-warp"]
        .iter()
        .for_each(|name| fs::remove_dir_all(path.join("set").join(name)).unwrap());
    refused("stretch", &[], "found complex-shear, expected a sequence of kind stretch-weft or stretch-warp");
}

#[test]
fn weft_and_warp_share_the_curves_of_an_isotropic_cloth() {
    let (_keep, path) = folder();
    let output = fit("bend", &path, "out", &["--variant", "linear-isotropic", "--robust", "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let curve = &json["stvk"]["curves"]["bend-warp"];
    assert_eq!(curve["shared_by"], serde_json::json!(["bend-weft", "bend-warp"]));
    assert!(curve["control_points"][0]["stiffness_n_m"].is_f64() && curve["noise_m"].is_f64(), "{curve}");
    assert_eq!(json["stvk"]["variant"], "linear-isotropic");
    let [weft, warp] =
        ["weft", "warp"].map(|d| fs::read(path.join(format!("out/curves/bend-{d}.csv"))).unwrap());
    assert!(weft == warp);
    assert_eq!(fit("stretch", &path, "out", &["--robust=0"]).status.code(), Some(3));
}

#[test]
fn a_model_that_fails_costs_only_its_own_result() {
    let (_keep, path) = folder();
    // Cells so elongated that a diagonal would count as a yarn.
    let output =
        run(&["stretch", "set", "--nodes", "65x3", "--model", "all", "--out", "out", "--json"], &path);
    let [text, warnings] = said(&output);
    assert_eq!(output.status.code(), Some(4), "{warnings}");
    assert!(warnings.contains("warning: springs has no result"), "{warnings}");
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert!(json["springs"]["failure"].is_string() && json["stvk"]["curves"].is_object(), "{text}");
    assert!(path.join("out/soft-constraint/material.json").exists() && !path.join("out/springs").exists());
}

#[test]
fn compare_ranks_all_by_what_no_fit_saw() {
    let (_keep, path) = folder();
    // The second replaces the first.
    for more in [&["--points", "1"][..], &["--points", "2"]] {
        let output = fit("compare", &path, "out", more);
        let [text, errors] = said(&output);
        // Some may not converge; this is reported, and the others are valid.
        assert!(matches!(output.status.code(), Some(0 | 4)), "{errors}");
        assert!(text.contains("Ranked by the residual on the validation sequences"), "{text}");
    }
    let text = fs::read_to_string(path.join("out/compare.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let rows = json["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 4 * Model::ALL.len());
    // The picture frame is uniform shear, in which springs cannot follow the law of the set.
    assert_ne!(rows[0]["model"], "springs");
    assert_eq!(rows[rows.len() - 1]["model"], "springs");
    assert!(rows[0]["validation"]["relative"].as_f64().unwrap() < 1e-3, "{text}");
    let table = fs::read_to_string(path.join("out/compare.csv")).unwrap();
    let cells = |line: &str| line.split(',').count();
    assert!(table.lines().all(|line| cells(line) == cells(table.lines().next().unwrap())), "{table}");
    fs::write(path.join("out/notes.txt"), "mine").unwrap();
    assert_eq!(fit("compare", &path, "out", &[]).status.code(), Some(3));
}

#[test]
fn a_sequence_that_others_replace_can_be_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let mut set = support::full_set();
    set.sequences.retain(|sequence| sequence.name.starts_with("stretch"));
    let mut again = set.sequences[1].clone();
    again.name = "stretch-weft-again".into();
    set.sequences.push(again);
    write_set(&folder.path().join("set"), &set).unwrap();
    let output = fit("compare", folder.path(), "out", &["--points", "1", "--leave-one-out", "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = json["rows"].as_array().unwrap();
    let linear = rows.iter().find(|row| row["model"] == "stvk" && row["variant"] == "linear").unwrap();
    let left = |name: &str| {
        let all = linear["left_out"].as_array().unwrap();
        all.iter().find(|left| left["sequence"] == name).unwrap().clone()
    };
    assert!(left("stretch-weft")["distance"]["relative"].as_f64().unwrap() < 1e-6, "{linear}");
    assert_eq!(left("stretch-warp")["lost"], serde_json::json!(["stretch-warp"]));
    // Not every variant can leave out the same sequences.
    assert_eq!(json["ranked_by"], "fit");
}

#[test]
fn shapes_that_rise_against_gravity_are_exit_3_and_name_the_field() {
    let (_keep, path) = folder();
    let file = path.join("set/bend-warp/test.toml");
    let text = fs::read_to_string(&file).unwrap();
    assert!(text.contains("-9.81"));
    fs::write(&file, text.replace("-9.81", "9.81")).unwrap();
    let output = fit("bend", &path, "both", &["--variant", "linear"]);
    let [text, warnings] = said(&output);
    assert!(text.contains("fitted to the shapes of bend-weft"), "{text}");
    assert!(warnings.contains("warning: sequence bend-warp, test.toml gravity_m_s2"), "{warnings}");
    fs::remove_dir_all(path.join("set/bend-weft")).unwrap();
    // Refused although stretch and shear could be fitted: they were not requested.
    for more in [&["--known", "both/material.json"][..], &[]] {
        let output = fit("bend", &path, "none", more);
        let [_, errors] = said(&output);
        assert_eq!(output.status.code(), Some(3), "{errors}");
        for words in ["error: sequence bend-warp, test.toml gravity_m_s2", "the sign of gravity", "mm above"]
        {
            assert!(errors.contains(words), "{words}: {errors}");
        }
    }
}

#[test]
fn without_shapes_bending_is_refused_and_the_rest_is_fitted() {
    let (_keep, path) = folder();
    for name in ["shear", "bend-weft", "bend-warp"] {
        fs::remove_file(path.join("set").join(name).join("positions.npy")).unwrap();
    }
    let output = fit("fit", &path, "out", &["--variant", "linear"]);
    let [text, warnings] = said(&output);
    assert_eq!(output.status.code(), Some(4), "{warnings}");
    assert!(warnings.contains("sequence bend-weft, positions.npy: found nothing"), "{warnings}");
    assert!(text.contains("its bending is assumed (bend-weft, bend-warp, bend-diagonal)"), "{text}");
    for (curve, there) in [("stretch-weft", true), ("shear", true), ("bend-weft", false)] {
        assert_eq!(path.join("out/curves").join(format!("{curve}.csv")).exists(), there, "{curve}");
    }
}
