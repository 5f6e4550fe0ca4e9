//! `fit-cloth fit` and `validate` on fixtures with all eight tests, run as a user does.

#![allow(clippy::unwrap_used)]

use cloth_data::frame::Kind;
use cloth_data::io::{read_set, write_set};
use cloth_fit::judge::prediction::predict;
use cloth_fit::stage::{Settings, Watch};
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::material::{Component, Compression, Model};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

const COARSE: [&str; 4] = ["--nodes", "13x13", "--points", "3"];

fn fixture(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(name).to_str().unwrap().into()
}

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fit-cloth")).args(arguments).output().unwrap()
}

fn said(output: &Output) -> [String; 2] {
    [&output.stdout, &output.stderr].map(|bytes| String::from_utf8(bytes.clone()).unwrap())
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// A folder with a fit of the denim in `fit`, made once.
fn fitted() -> &'static Path {
    static FOLDER: OnceLock<(tempfile::TempDir, PathBuf)> = OnceLock::new();
    let (_, path) = FOLDER.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fit");
        let output = run(&[&["fit", &fixture("cotton-denim"), "--out", text(&path)], &COARSE[..]].concat());
        assert!(output.status.success() && output.stderr.is_empty(), "{}", said(&output)[1]);
        (folder, path)
    });
    path
}

/// Validates on the grid of the fit.
fn validate(set: &str, out: &Path, more: &[&str]) -> Output {
    let material = fitted().join("material.json");
    run(&[&["validate", set, "--material", text(&material), "--out", text(out)], &COARSE[..2], more].concat())
}

/// Imports a bias strip, pulled in even steps to a strain of 0.1 by the given forces, into a set of that name; returns
/// the set's folder.
fn bias_strip(folder: &Path, name: &str, [length, width]: [f64; 2], forces: &[f64]) -> PathBuf {
    let [table, set] = [format!("{name}.csv"), name.to_string()].map(|name| folder.join(name));
    let row = |(i, force)| format!("{},{force}\n", 0.1 * length * (i + 1) as f64 / forces.len() as f64);
    let rows: String = forces.iter().enumerate().map(row).collect();
    fs::write(&table, format!("pull_m,force_N\n0,0\n{rows}")).unwrap();
    let [length, width] = [length, width].map(|side| side.to_string());
    let output = run(&[
        &[
            "import",
            "strip",
            text(&table),
            "--set",
            text(&set),
            "--name",
            "made",
            "--areal-density-kg-m2",
            "0.2",
        ],
        &["--direction", "bias", "--gauge-m", &length, "--width-m", &width, "--replace"][..],
        &["--displacement", "pull_m", "--force", "force_N"],
    ]
    .concat());
    assert!(output.status.success(), "{}", said(&output)[1]);
    set
}

/// As above for a cloth of stiff yarns and constant shear stiffness; each strip is simulated on its own grid.
fn cloth_on_the_bias(folder: &Path, name: &str, size: [f64; 2]) -> PathBuf {
    let set = read_set(&bias_strip(folder, name, size, &[1.0; 8])).unwrap();
    let stiffnesses =
        [(Component::StretchWeft, 2e4), (Component::StretchWarp, 2e4), (Component::Shear, 40.0)];
    let curve = |(component, stiffness)| {
        let negative = Model::STVK.negative_strain(component, Compression::ZeroStrain);
        (component, StiffnessCurve::constant(stiffness, negative).unwrap())
    };
    let curves = stiffnesses.into_iter().map(curve).collect();
    let found = predict(
        &set,
        &[Kind::StretchBias],
        &curves,
        &Default::default(),
        &Settings::default(),
        &Watch::default(),
    )
    .unwrap();
    let rows = &found.sequences[0].forces;
    let forces: Vec<f64> = rows.iter().map(|row| row.world.x * row.simulated).collect();
    bias_strip(folder, name, size, &forces)
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// Rms force of a set's only sequence, from the output of a fit or a validation.
fn force_rms(path: &Path, sequences: &str) -> f64 {
    json(path)[sequences][0]["rms_force_n"].as_f64().unwrap()
}

#[test]
fn a_strip_of_other_proportions_has_a_grid_of_its_own_and_is_met_as_by_its_own_fit() {
    let folder = tempfile::tempdir().unwrap();
    let [narrow, wide] = [("narrow", [0.2, 0.05]), ("wide", [0.1, 0.05])]
        .map(|(name, size)| cloth_on_the_bias(folder.path(), name, size));
    let fit = |set: &Path| {
        let out = set.with_extension("fit");
        let output = run(&["shear", text(set), "--points", "1", "--out", text(&out)]);
        assert!(output.status.success(), "{}", said(&output)[1]);
        out.join("material.json")
    };
    let [of_narrow, of_wide] = [&narrow, &wide].map(|set| fit(set));
    let nodes = |material: &Path| json(material)["provenance"]["nodes"]["stretch-bias"].clone();
    assert_ne!(nodes(&of_narrow), nodes(&of_wide));
    let out = folder.path().join("out");
    let output = run(&["validate", text(&wide), "--material", text(&of_narrow), "--out", text(&out)]);
    let [words, errors] = said(&output);
    assert!(output.status.success(), "{errors}");
    let largest = json(&out.join("validation.json"))["sequences"][0]["largest_force_n"].as_f64().unwrap();
    let [alone, other] =
        [force_rms(&of_wide, "residuals"), force_rms(&out.join("validation.json"), "sequences")];
    // Each fit assumes its own yarn stiffness. Cells of the other strip's shape would lock and double the error.
    assert!((other - alone).abs() < 0.02 * largest, "{alone} {other} of {largest}: {words}");
}

#[test]
fn what_shear_made_of_a_strip_on_the_bias_alone_meets_that_strip() {
    let folder = tempfile::tempdir().unwrap();
    let set = cloth_on_the_bias(folder.path(), "set", [0.1, 0.05]);
    let [fit, out] = ["fit", "out"].map(|name| folder.path().join(name));
    let output = run(&["shear", text(&set), "--out", text(&fit)]);
    assert!(output.status.success(), "{}", said(&output)[1]);
    let material = fit.join("material.json");
    let output = run(&["validate", text(&set), "--material", text(&material), "--out", text(&out)]);
    let [words, errors] = said(&output);
    assert!(output.status.success(), "{errors}");
    assert!(words.contains("assumed constant, since not known: stretch-weft, stretch-warp"), "{words}");
    let validation = out.join("validation.json");
    assert_eq!(json(&validation)["assumed"], serde_json::json!(["stretch-weft", "stretch-warp"]));
    let largest = json(&validation)["sequences"][0]["largest_force_n"].as_f64().unwrap();
    let [alone, again] = [force_rms(&material, "residuals"), force_rms(&validation, "sequences")];
    assert!((again - alone).abs() < 1e-3 * largest, "{alone} {again} of {largest}: {words}");
}

#[test]
fn the_denim_ends_with_six_curves() {
    let curves = fs::read_dir(fitted().join("curves")).unwrap();
    assert_eq!(curves.count(), 6);
    let residuals = fs::read_to_string(fitted().join("residuals.csv")).unwrap();
    assert_eq!(residuals.lines().count(), 1 + 6, "{residuals}");
    let plot = fs::read_to_string(fitted().join("plots/shear-force.svg")).unwrap();
    // The bars turn, and all frames are in the figure.
    assert!(plot.matches("<circle").count() > 8, "{plot}");
}

#[test]
fn motions_that_no_fit_saw_are_met_within_a_tenth() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let output = validate(&fixture("cotton-denim"), &out, &[]);
    let [words, errors] = said(&output);
    assert!(output.status.success(), "{errors}");
    assert!(
        words.contains("aggregated torque") && words.contains("reproduce the aggregated torque"),
        "{words}"
    );
    // The second run replaces the first.
    let output = validate(&fixture("cotton-denim"), &out, &["--json", "--threads", "1"]);
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["schema"], "fit-cloth/validation/2");
    for (sequence, measure) in
        json["sequences"].as_array().unwrap().iter().zip(["aggregated-torque", "stretching-force-difference"])
    {
        assert_eq!(sequence["measure"]["name"], measure);
        assert!(sequence["measure"]["share_of_range"].as_f64().unwrap() < 0.1, "{sequence}");
        assert_eq!(sequence["measure"]["rows"].as_array().unwrap().len(), sequence["frames"]);
    }
    for name in ["validation.csv", "measures.csv", "forces.csv"] {
        let table = fs::read_to_string(out.join(name)).unwrap();
        let cells = |line: &str| line.split(',').count();
        assert!(table.lines().count() > 2, "{name}");
        assert!(table.lines().all(|line| cells(line) == cells(table.lines().next().unwrap())), "{table}");
    }
    assert!(
        out.join("plots/corner-pull-measure.svg").exists()
            && out.join("plots/complex-shear-force.svg").exists()
    );
}

#[test]
fn another_cloth_is_met_worse_in_all_its_tests() {
    let folder = tempfile::tempdir().unwrap();
    let shares = ["cotton-denim", "wool-cotton"].map(|name| {
        let more = ["--kinds", "stretch-weft,shear,bend-warp", "--json"];
        let output = validate(&fixture(name), &folder.path().join("out"), &more);
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        let sequences = json["sequences"].as_array().unwrap();
        assert_eq!(sequences.len(), 3, "{}", said(&output)[1]);
        assert!(sequences.iter().any(|sequence| sequence["rms_position_m"].is_f64()), "{json}");
        let shear = sequences.iter().find(|sequence| sequence["kind"] == "shear").unwrap();
        shear["measure"]["share_of_range"].as_f64().unwrap()
    });
    assert!(shares[0] < 0.05 && shares[1] > 2.0 * shares[0], "{shares:?}");
}

#[test]
fn what_cannot_be_validated_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (denim, out) = (fixture("cotton-denim"), folder.path().join("out"));
    let refused = |output: Output, words: &str| {
        let [_, errors] = said(&output);
        assert_eq!(output.status.code(), Some(3), "{errors}");
        assert!(errors.contains(words), "{errors}");
    };
    refused(validate(&denim, fitted(), &[]), "another --out");
    refused(validate(&denim, &Path::new(&denim).join("result"), &[]), "outside the measurement set");
    refused(validate(&denim, &out, &["--kinds", "stretch-bias"]), "stretch-bias (--kinds, --all)");
    refused(
        run(&["validate", &denim, "--material", &format!("{denim}/fabric.toml"), "--out", text(&out)]),
        "fabric.toml",
    );
    fs::create_dir(&out).unwrap();
    fs::write(out.join("notes.txt"), "mine").unwrap();
    refused(validate(&denim, &out, &[]), "--out: found a folder with other things in it, such as notes.txt");
    assert_eq!(validate(&denim, &out, &["--kinds", "silk"]).status.code(), Some(2));
}

#[test]
fn without_its_test_the_diagonal_is_not_observed() {
    let folder = tempfile::tempdir().unwrap();
    let set = folder.path().join("set");
    for name in ["bend-weft", "bend-warp", "stretch-weft", "stretch-warp", "shear"] {
        let from = Path::new(&fixture("cotton-denim")).join(name);
        fs::create_dir_all(set.join(name)).unwrap();
        for entry in fs::read_dir(from).unwrap() {
            let path = entry.unwrap().path();
            fs::copy(&path, set.join(name).join(path.file_name().unwrap())).unwrap();
        }
    }
    fs::copy(Path::new(&fixture("cotton-denim")).join("fabric.toml"), set.join("fabric.toml")).unwrap();
    let output =
        run(&[&["bend", text(&set), "--out", text(&folder.path().join("out"))], &COARSE[..]].concat());
    let [words, warnings] = said(&output);
    assert!(output.status.success(), "{warnings}");
    assert_eq!(warnings.lines().count(), 1, "{warnings}");
    assert!(warnings.contains("bend-diagonal is not observed"), "{warnings}");
    assert!(words.contains("known: stretch-weft, stretch-warp"), "{words}");
    assert!(words.contains("assumed constant, since not known: bend-diagonal"), "{words}");
}

#[test]
fn all_models_and_shared_curves() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let denim = fixture("cotton-denim");
    let more = ["--model", "all", "--variant", "isotropic", "--nodes", "9x9", "--points", "2", "--json"];
    let output = run(&[&["fit", &denim, "--out", text(&out)], &more[..]].concat());
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    for model in ["stvk", "soft-constraint"] {
        let curve = &json[model]["curves"]["stretch-warp"];
        assert_eq!(curve["shared_by"], serde_json::json!(["stretch-weft", "stretch-warp"]), "{curve}");
        assert_eq!(json[model]["curves"]["bend-diagonal"]["observed"], true);
    }
    assert_eq!(json["springs"]["curves"]["shear"]["observed"], true, "{}", said(&output)[1]);
    let material = out.join("springs/material.json");
    let valid =
        run(&["validate", &denim, "--material", text(&material), "--out", text(&folder.path().join("v"))]);
    assert!(valid.status.success(), "{}", said(&valid)[1]);
}

#[test]
fn springs_that_bend_on_another_grid_than_their_fits_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let [fit, out] = ["fit", "out"].map(|name| folder.path().join(name));
    let denim = fixture("cotton-denim");
    let coarse = ["--nodes", "13x13", "--points", "2"];
    let output = run(&[&["bend", &denim, "--model", "springs", "--out", text(&fit)], &coarse[..]].concat());
    assert!(output.status.success(), "{}", said(&output)[1]);
    let material = fit.join("material.json");
    let validate = |more: &[&str]| {
        let output = run(&[
            &["validate", &denim, "--kinds", "bend-warp", "--material", text(&material), "--out", text(&out)],
            more,
        ]
        .concat());
        assert!(output.status.success(), "{}", said(&output)[1]);
        said(&output)[1].clone()
    };
    let warning = "warning: bending curves of springs hold only on the grid of their fit, 13x13; simulate bend-warp on it with --nodes\n";
    // Findings of `check` on so short a curve are warnings, too.
    let [own_grid, grid_of_fit] = [validate(&[]), validate(&coarse[..2])];
    assert!(
        own_grid.contains(warning) && !grid_of_fit.contains("the grid of its fit"),
        "{own_grid}{grid_of_fit}"
    );
}

#[test]
fn curves_for_a_mesh_are_validated_on_it() {
    let folder = tempfile::tempdir().unwrap();
    let [fit, out] = ["fit", "out"].map(|name| folder.path().join(name));
    let denim = fixture("cotton-denim");
    let material = fit.join("material.json");
    let output = run(&["stretch", &denim, "--for-mesh", "10", "--points", "2", "--out", text(&fit)]);
    let [stdout, stderr] = said(&output);
    assert!(output.status.success(), "{stderr}");
    assert!(
        stdout.starts_with("Curves for a mesh with cells of 10 mm: they make up for its error\n"),
        "{stdout}"
    );
    assert!(fs::read_to_string(&material).unwrap().contains("\"for_mesh_m\": 0.01,"));
    let page = fs::read_to_string(fit.join("report.html")).unwrap();
    assert!(page.contains("tests. Curves for a mesh with cells of 10 mm"));
    let validate = |more: &[&str]| {
        let output = run(&[
            &[
                "validate",
                &denim,
                "--kinds",
                "stretch-warp",
                "--material",
                text(&material),
                "--out",
                text(&out),
            ],
            more,
        ]
        .concat());
        assert!(output.status.success(), "{}", said(&output)[1]);
        said(&output)[1].clone()
    };
    let warning = "these curves hold only on cells of 10 mm";
    assert!(!validate(&[]).contains(warning));
    assert!(validate(&["--nodes", "13x13"]).contains(warning));
    // Curves of the continuum and of another mesh would answer for each other's errors.
    let elsewhere = folder.path().join("elsewhere");
    let refused = |more: &[&str]| {
        let output = run(&[&["shear", &denim, "--out", text(&elsewhere)], more].concat());
        assert_eq!(output.status.code(), Some(3), "{}", said(&output)[1]);
        said(&output)[1].clone()
    };
    let known = refused(&["--known", text(&material)]);
    assert!(known.contains("provenance.for_mesh_m: found curves of a mesh with cells of 10 mm"), "{known}");
    let odd = text(&material).replace("material.json", "odd.json");
    fs::write(
        &odd,
        fs::read_to_string(&material).unwrap().replace("\"for_mesh_m\": 0.01", "\"for_mesh_m\": -1"),
    )
    .unwrap();
    assert!(refused(&["--known", &odd]).contains("expected the side of a mesh's cells"));
    let refused = run(&["stretch", &denim, "--for-mesh", "30", "--out", text(&elsewhere)]);
    assert!(said(&refused)[1].contains("a whole number within 10 %"), "{}", said(&refused)[1]);
    let refused = run(&["bend", &denim, "--for-mesh", "25", "--out", text(&elsewhere)]);
    assert!(
        said(&refused)[1].contains("cells of the mesh past the edge, of at least 4"),
        "{}",
        said(&refused)[1]
    );
    let refused = run(&["stretch", &denim, "--for-mesh", "10", "--nodes", "9x9"]);
    assert!(said(&refused)[1].contains("cannot be used with"));
    for side in ["0", "-3", "much"] {
        let refused = run(&["stretch", &denim, "--for-mesh", side]);
        assert_eq!(refused.status.code(), Some(2), "{}", said(&refused)[1]);
    }
}

#[test]
fn a_bias_strip_that_hangs_by_unknown_shear_is_amber() {
    let folder = tempfile::tempdir().unwrap();
    let [set, out] = ["set", "out"].map(|name| folder.path().join(name));
    let mut alone = read_set(Path::new(&fixture("cotton-denim"))).unwrap();
    alone.sequences.retain(|sequence| sequence.kind == Kind::BendBias);
    write_set(&set, &alone).unwrap();
    let output = run(&["bend", text(&set), "--nodes", "9x9", "--out", text(&out)]);
    let told = "bend-diagonal: AMBER: a sheet cut on the bias lengthens under its weight by its shear";
    assert!(said(&output)[0].contains(told), "{}", said(&output)[0]);
}
