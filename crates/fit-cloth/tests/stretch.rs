//! `fit-cloth stretch` and `fit-cloth rig`, run as a user does.
//!
//! The fixture gives two curves and a residual table; every file is the same on one and two threads; bad input gives
//! exit code 3, a message with file, line and field, and no output.

#![allow(clippy::unwrap_used)]

use cloth_sim::material::Model;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn fixture() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/cotton-denim")
}

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fit-cloth")).args(arguments).output().unwrap()
}

fn text(path: &Path) -> String {
    path.to_str().unwrap().to_string()
}

fn fit(set: &Path, out: &Path, more: &[&str]) -> Output {
    run(&[&["stretch", &text(set), "--out", &text(out), "--nodes", "9x9"], more].concat())
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for file in files(from) {
        let place = to.join(file.strip_prefix(from).unwrap());
        fs::create_dir_all(place.parent().unwrap()).unwrap();
        fs::copy(file, place).unwrap();
    }
}

#[test]
fn the_fixture_ends_with_two_curves_and_a_residual_table() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("new/out");
    let output = fit(&fixture(), &out, &["--verbose"]);
    let stdout = String::from_utf8(output.stdout).unwrap();
    assert!(
        output.status.success() && output.stderr.is_empty(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(stdout.contains("iteration"), "{stdout}");
    assert!(
        stdout.contains("rms force [N]") && stdout.contains("stretch-weft: green: known to ±"),
        "{stdout}"
    );
    let names: Vec<String> = files(&out).iter().map(|file| text(file.strip_prefix(&out).unwrap())).collect();
    assert_eq!(
        names,
        [
            "curves/stretch-warp.csv",
            "curves/stretch-weft.csv",
            "forces.csv",
            "material.json",
            "plots/convergence.svg",
            "plots/correlation.svg",
            "plots/residuals.svg",
            "plots/stretch-warp-force.svg",
            "plots/stretch-warp-residual.svg",
            "plots/stretch-warp-shape.svg",
            "plots/stretch-warp-stress.svg",
            "plots/stretch-weft-force.svg",
            "plots/stretch-weft-residual.svg",
            "plots/stretch-weft-shape.svg",
            "plots/stretch-weft-stress.svg",
            "report.html",
            "report.json",
            "residuals.csv"
        ]
    );
    let curve = fs::read_to_string(out.join("curves/stretch-weft.csv")).unwrap();
    let mut lines = curve.lines();
    assert_eq!(
        lines.next().unwrap(),
        "green_strain,stiffness_n_per_m,pk2_stress_n_per_m,pk2_stress_low_n_per_m,pk2_stress_high_n_per_m,\
         engineering_strain,nominal_stress_n_per_m"
    );
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|field| field.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 201);
    assert!(rows.windows(2).all(|pair| pair[0][0] < pair[1][0]));
    assert!(rows.iter().flatten().all(|value| value.is_finite()));
    // λ = √(1 + 2E), F/w = λ S.
    for row in &rows {
        let stretch = (1.0 + 2.0 * row[0]).sqrt();
        assert!(
            (row[5] - (stretch - 1.0)).abs() < 1e-12 && (row[6] / row[2].max(1e-300) - stretch).abs() < 1e-9
                || row[2] == 0.0
        );
    }
    let material = fs::read_to_string(out.join("material.json")).unwrap();
    assert!(material.contains("fit-cloth/material/2") && !material.contains("null"));
}

#[test]
fn the_bytes_are_the_same_on_one_and_on_two_threads() {
    let folder = tempfile::tempdir().unwrap();
    let outs = ["1", "2"].map(|threads| {
        let out = folder.path().join(threads);
        assert!(fit(&fixture(), &out, &["--model", "all", "--threads", threads]).status.success());
        out
    });
    let contents = outs.map(|out| {
        let content = |file: PathBuf| {
            let text = fs::read_to_string(&file).unwrap();
            // The last column of residuals.csv is wall time.
            let timed = file.ends_with("residuals.csv");
            let cut = |line: &str| line.rsplit_once(',').unwrap().0.to_string();
            (
                file.strip_prefix(&out).unwrap().to_path_buf(),
                if timed { text.lines().map(cut).collect::<Vec<_>>().join("\n") } else { text },
            )
        };
        files(&out).into_iter().map(content).collect::<Vec<_>>()
    });
    assert_eq!(contents[0].len(), Model::ALL.len() * 16 + 2);
    assert!(contents[0] == contents[1]);
}

#[test]
fn a_fit_as_published_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let output = fit(&fixture(), &out, &["--as-published"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let stdout = String::from_utf8(output.stdout).unwrap();
    assert!(stdout.starts_with("stvk, fitted as published (Miguel et al. 2012)\n"), "{stdout}");
    let provenance = |out: &Path| -> serde_json::Value {
        let text = fs::read_to_string(out.join("material.json")).unwrap();
        serde_json::from_str::<serde_json::Value>(&text).unwrap()["provenance"].clone()
    };
    assert_eq!(provenance(&out)["as_published"], true);
    assert_eq!(provenance(&out)["constraints"], "control-points");
    // The default method gives a different but close result, and prints no such line.
    let ours = folder.path().join("ours");
    assert!(fit(&fixture(), &ours, &[]).status.success());
    assert!(provenance(&ours).get("as_published").is_none());
    let last_stress = |out: &Path| -> f64 {
        let text = fs::read_to_string(out.join("curves/stretch-weft.csv")).unwrap();
        text.lines().last().unwrap().split(',').nth(2).unwrap().parse().unwrap()
    };
    let [published, own] = [&out, &ours].map(|out| last_stress(out));
    assert!(published != own && (published / own - 1.0).abs() < 0.02, "{published} {own}");
}

#[test]
fn what_the_published_method_sets_cannot_be_chosen_beside_it() {
    for other in ["--robust", "--constraints=stable"] {
        let output = run(&["stretch", "set", "--as-published", other]);
        assert_eq!(output.status.code(), Some(2), "{other}");
        assert!(String::from_utf8(output.stderr).unwrap().contains("cannot be used with"), "{other}");
    }
    for command in ["stretch", "shear", "bend", "fit"] {
        let help = String::from_utf8(run(&[command, "--help"]).stdout).unwrap();
        assert!(help.contains("--as-published"), "{command}: {help}");
    }
}

#[test]
fn json_holds_the_material() {
    let folder = tempfile::tempdir().unwrap();
    let output = fit(&fixture(), &folder.path().join("out"), &["--json"]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["stvk"]["curves"]["shear"]["observed"], false);
    assert_eq!(json["stvk"]["curves"]["stretch-weft"]["control_points"].as_array().unwrap().len(), 5);
}

#[test]
fn bad_input_is_named_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let broken = |name: &str, change: &dyn Fn(&Path)| {
        let set = folder.path().join(name);
        copy(&fixture(), &set);
        change(&set);
        let output = fit(&set, &out, &[]);
        assert_eq!(output.status.code(), Some(3), "{name}");
        assert!(!out.exists(), "{name}");
        String::from_utf8(output.stderr).unwrap()
    };
    let edit = |file: &str, from: &str, to: &str| {
        let (file, from, to) = (file.to_string(), from.to_string(), to.to_string());
        move |set: &Path| {
            let path = set.join(&file);
            let text = fs::read_to_string(&path).unwrap();
            assert!(text.contains(&from));
            fs::write(&path, text.replacen(&from, &to, 1)).unwrap();
        }
    };
    let said = broken("millimetres", &edit("stretch-weft/clips.csv", "tx_m", "tx_mm"));
    assert!(said.contains("clips.csv:1") && said.contains("tx_mm"), "{said}");
    let said = broken("key", &edit("fabric.toml", "width_m", "breadth_m"));
    assert!(said.contains("fabric.toml:") && said.contains("breadth_m"), "{said}");
    let said = broken("index", &edit("stretch-warp/mesh.obj", "f 1/1", "f 0/1"));
    assert!(said.contains("mesh.obj:"), "{said}");
    let said = broken("no forces", &|set| {
        for name in ["stretch-weft", "stretch-warp"] {
            fs::remove_file(set.join(name).join("forces.csv")).unwrap();
        }
    });
    assert!(said.contains("deformed and measured"), "{said}");
    let said = broken("empty", &|set| {
        fs::remove_dir_all(set.join("stretch-weft")).unwrap();
        fs::remove_dir_all(set.join("stretch-warp")).unwrap();
    });
    assert!(said.contains("stretch-weft or stretch-warp"), "{said}");
}

#[test]
fn a_folder_with_other_things_in_it_is_refused_and_a_former_result_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    fs::write(out.join("thesis.tex"), "years").unwrap();
    assert_eq!(fit(&fixture(), &out, &[]).status.code(), Some(3));
    assert_eq!(fs::read_to_string(out.join("thesis.tex")).unwrap(), "years");
    assert_eq!(fit(&fixture(), &fixture(), &[]).status.code(), Some(3));
    fs::remove_file(out.join("thesis.tex")).unwrap();
    for points in ["1", "3"] {
        assert!(fit(&fixture(), &out, &["--points", points]).status.success());
    }
    let material = fs::read_to_string(out.join("material.json")).unwrap();
    assert_eq!(material.matches("stiffness_n_per_m").count(), 3 + 3);
}

#[test]
fn nothing_beside_a_result_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    assert!(fit(&fixture(), &out, &[]).status.success());
    fs::write(out.join("notes.txt"), "mine").unwrap();
    assert_eq!(fit(&fixture(), &out, &[]).status.code(), Some(3));
    assert_eq!(fs::read_to_string(out.join("notes.txt")).unwrap(), "mine");
    let set = folder.path().join("set");
    copy(&fixture(), &set);
    for inside in [set.clone(), set.join("result")] {
        assert_eq!(fit(&set, &inside, &[]).status.code(), Some(3));
    }
    fs::write(set.join("notes.txt"), "mine").unwrap();
    let rig = run(&[
        "rig",
        "--fabric",
        "cotton-denim",
        "--out",
        &text(&set),
        "--nodes",
        "5x5",
        "--measured",
        "3x3",
    ]);
    assert_eq!(rig.status.code(), Some(3));
    assert_eq!(fs::read_to_string(set.join("notes.txt")).unwrap(), "mine");
}

#[test]
fn a_reader_who_has_read_enough_does_not_cost_the_result() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let mut child = Command::new(env!("CARGO_BIN_EXE_fit-cloth"))
        .args(["stretch", &text(&fixture()), "--out", &text(&out), "--nodes", "9x9"])
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
    assert!(out.join("material.json").exists());
}

#[test]
fn a_rig_makes_a_set_that_can_be_fitted() {
    let folder = tempfile::tempdir().unwrap();
    let set = folder.path().join("denim");
    let fabric = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/fabrics/cotton-denim.toml");
    for fabric in ["cotton-denim".to_string(), text(&fabric)] {
        let arguments = [
            "rig",
            "--fabric",
            &fabric,
            "--out",
            &text(&set),
            "--nodes",
            "13x13",
            "--measured",
            "5x5",
            "--frames",
            "6",
            "--sequences",
            "stretch-weft,stretch-warp",
        ];
        assert!(run(&arguments).status.success());
    }
    assert!(fit(&set, &folder.path().join("out"), &[]).status.success());
    let unknown = run(&["rig", "--fabric", "chainmail", "--out", &text(&set)]);
    assert_eq!(unknown.status.code(), Some(3));
    assert!(String::from_utf8(unknown.stderr).unwrap().contains("cotton-denim"));
}

#[test]
fn every_help_has_an_example() {
    for command in [&["rig"][..], &["import", "strip"]] {
        let output = run(&[command, &["--help"]].concat());
        assert!(output.status.success());
        assert!(String::from_utf8(output.stdout).unwrap().contains("Example"), "{command:?}");
    }
    assert_eq!(run(&["stretch", "--model", "silk"]).status.code(), Some(2));
}
