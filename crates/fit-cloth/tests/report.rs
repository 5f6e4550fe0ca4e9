//! `report.html` and `report.json` are written, hold the numbers of the other files, and can be rewritten.

#![allow(clippy::unwrap_used)]

mod support;

use cloth_data::io::write_set;
use cloth_sim::material::Model;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Size limit, so that a page can be sent by mail.
const LARGEST_PAGE: usize = 3_000_000;

fn run(arguments: &[&str], within: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fit-cloth")).args(arguments).current_dir(within).output().unwrap()
}

fn error(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// A folder with the full set in `set`, and a fit of it in `out`.
fn fitted(more: &[&str]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_path_buf();
    write_set(&path.join("set"), &support::full_set()).unwrap();
    let output = run(&[&["fit", "set", "--nodes", "9x9", "--out", "out"], more].concat(), &path);
    assert!(output.status.success(), "{}", error(&output));
    (folder, path)
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// The data embedded in a page.
fn embedded(page: &Path) -> Value {
    let text = fs::read_to_string(page).unwrap();
    let (_, rest) = text.split_once("<script type=\"application/json\" id=\"data\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

/// Rows of a table as objects by column.
fn table(path: &Path) -> Vec<Value> {
    let text = fs::read_to_string(path).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let cell = |text: &str| {
        text.parse::<f64>().map_or(if text.is_empty() { Value::Null } else { text.into() }, Value::from)
    };
    let row = |line: &str| {
        Value::Object(header.split(',').map(String::from).zip(line.split(',').map(cell)).collect())
    };
    rows.lines().map(row).collect()
}

fn array(value: &Value) -> &Vec<Value> {
    value.as_array().unwrap()
}

#[test]
fn the_page_holds_the_numbers_of_the_result() {
    let (_keep, path) = fitted(&[]);
    let out = path.join("out");
    let data = embedded(&out.join("report.html"));
    assert_eq!(data, json(&out.join("report.json")));
    assert_eq!(array(&data["fits"]).len(), 1);
    let (fit, material) = (&data["fits"][0], json(&out.join("material.json")));
    assert_eq!([&fit["model"], &fit["variant"]], [&material["model"], &material["variant"]]);

    let curves: Vec<&Value> =
        array(&fit["curves"]).iter().filter(|curve| curve["observed"] == true).collect();
    assert_eq!(curves.len(), 5);
    for curve in curves {
        let name = curve["component"].as_str().unwrap();
        let (entry, points) = (&material["curves"][name]["control_points"], array(&curve["points"]));
        assert_eq!(points.len(), array(entry).len());
        let mut quantiles = Vec::new();
        for (point, entry) in points.iter().zip(array(entry)) {
            // Bending is over the model's own strain in the material, over curvature on the page.
            let bends = name.starts_with("bend");
            let unit = if bends { "n_m" } else { "n_per_m" };
            let [value, deviation] = ["stiffness", "deviation"].map(|what| &entry[format!("{what}_{unit}")]);
            if !bends {
                assert_eq!([&point["strain"], &point["stiffness"]], [&entry["strain"], value], "{name}");
            }
            quantiles.push(
                point["share"].as_f64().unwrap() * value.as_f64().unwrap() / deviation.as_f64().unwrap(),
            );
        }
        // 95 % quantile of a normal or Student distribution, with the same degrees of freedom for all points.
        let first = quantiles[0];
        assert!(first > 1.959 && first < 13.0, "{name}: {first}");
        assert!(quantiles.iter().all(|other| (other / first - 1.0).abs() < 1e-12), "{name}: {quantiles:?}");

        let rows = table(&out.join(format!("curves/{name}.csv")));
        let (strain, stress, unit, label) = match name {
            "shear" => ("shear_strain", "shear_stress", "n_per_m", "shear strain [–]"),
            name if name.starts_with("bend") => ("curvature_per_m", "moment", "n", "curvature [1/m]"),
            _ => ("green_strain", "pk2_stress", "n_per_m", "Green strain [–]"),
        };
        let columns: [String; 4] = [
            strain.into(),
            format!("{stress}_{unit}"),
            format!("{stress}_low_{unit}"),
            format!("{stress}_high_{unit}"),
        ];
        assert_eq!(curve["x_label"], label);
        assert_eq!(rows.len(), array(&curve["samples"]).len());
        for (row, sample) in rows.iter().zip(array(&curve["samples"])) {
            assert_eq!(
                &columns.clone().map(|column| row[column.as_str()].clone())[..],
                &array(sample)[..],
                "{name}"
            );
        }
        let shares: f64 =
            array(&curve["histogram"]["shares"]).iter().map(|share| share.as_f64().unwrap()).sum();
        assert!(shares > 0.5 && shares < 1.0 + 1e-9, "{name}: {shares}");
    }

    let residuals = table(&out.join("residuals.csv"));
    assert_eq!(array(&fit["residuals"]).len(), residuals.len());
    for ((shown, row), entry) in
        array(&fit["residuals"]).iter().zip(&residuals).zip(array(&material["residuals"]))
    {
        assert_eq!(shown["sequence"], row["sequence"]);
        for key in ["rms_force_n", "largest_force_n", "rms_position_m"] {
            assert_eq!(shown[key], row[key], "{key}");
            assert_eq!(shown[key], entry.get(key).cloned().unwrap_or_default(), "{key}");
        }
        for key in ["frames", "frames_left_out"] {
            assert_eq!(shown[key].as_f64(), row[key].as_f64(), "{key}");
        }
    }
}

#[test]
fn forces_and_shapes_are_those_of_the_measurement_and_of_the_fit() {
    let (_keep, path) = fitted(&[]);
    let data = json(&path.join("out/report.json"));
    let sequences = array(&data["fits"][0]["sequences"]);
    assert_eq!(sequences.len(), 5);
    let forces = table(&path.join("out/forces.csv"));
    for sequence in sequences {
        for force in array(&sequence["forces"]) {
            // The page shows absolute values.
            let size = |value: &Value| value.as_f64().unwrap().abs();
            let is_it = |row: &&Value| {
                row["sequence"] == sequence["name"]
                    && row["frame"].as_f64() == force["frame"].as_f64()
                    && size(&row["measured_n"]) == size(&force["measured"])
                    && size(&row["simulated_n"]) == size(&force["simulated"])
            };
            assert!(forces.iter().any(|row| is_it(&row)), "{force}");
        }
        let shown: usize = array(&sequence["frames"]).len();
        assert!(shown > 0);
        let bends = sequence["name"].as_str().unwrap().starts_with("bend");
        assert_eq!(array(&sequence["profiles"]).len(), if bends { shown } else { 0 });
        // A strip at 5 %: both bars are pulled along one line in opposite directions, and the model's force is close.
        if sequence["name"] == "stretch-weft" {
            let last = array(&sequence["frames"]).last().unwrap();
            let arrows = array(&last["arrows"]);
            let pull = |arrow: usize, what: &str| arrows[arrow][what][0].as_f64().unwrap();
            let expected = 1.05 * support::STRETCH[0] * 0.5 * (1.05f64.powi(2) - 1.0) * 0.1;
            for (arrow, sign) in [(0, -1.0), (1, 1.0)] {
                assert!((pull(arrow, "measured") - sign * expected).abs() < 1e-9);
                assert!((pull(arrow, "simulated") - sign * expected).abs() < 1e-3 * expected);
            }
        }
    }
}

#[test]
fn the_page_can_be_written_again_or_left_out() {
    let (_keep, path) = fitted(&[]);
    let page = path.join("out/report.html");
    let first = fs::read(&page).unwrap();
    assert!(first.len() < LARGEST_PAGE);
    fs::remove_file(&page).unwrap();
    let output = run(&["report", "out"], &path);
    assert!(output.status.success(), "{}", error(&output));
    assert_eq!(fs::read(&page).unwrap(), first);

    let output = run(&["fit", "set", "--nodes", "9x9", "--out", "out", "--no-report"], &path);
    assert!(output.status.success(), "{}", error(&output));
    assert!(!page.exists() && !path.join("out/report.json").exists());
    let output = run(&["report", "out"], &path);
    assert_eq!(output.status.code(), Some(3));
    let expected = "report.json: found nothing, expected a result folder of fit, stretch, shear, bend or compare, without --no-report";
    assert!(error(&output).contains(expected), "{}", error(&output));
}

#[test]
fn models_share_a_page() {
    let (_keep, path) = fitted(&["--model", "all"]);
    let data = embedded(&path.join("out/report.html"));
    let models: Vec<&Value> = array(&data["fits"]).iter().map(|fit| &fit["model"]).collect();
    assert_eq!(models, Model::ALL.map(|model| model.name()));
    assert!(!path.join("out/stvk/report.html").exists());
    // A previous result of several models is replaced.
    let output = run(&["fit", "set", "--nodes", "9x9", "--out", "out", "--no-report"], &path);
    assert!(output.status.success(), "{}", error(&output));
}

#[test]
fn a_comparison_shows_every_model_and_variant_beside_what_none_has_seen() {
    let (_keep, path) = fitted(&["--no-report"]);
    let output = run(&["compare", "set", "--nodes", "5x5", "--out", "compared"], &path);
    assert!([Some(0), Some(4)].contains(&output.status.code()), "{}", error(&output));
    let page = path.join("compared/report.html");
    assert!(fs::metadata(&page).unwrap().len() < LARGEST_PAGE as u64);
    let data = embedded(&page);
    let rows = array(&json(&path.join("compared/compare.json"))["rows"]).clone();
    let ranked = array(&data["ranking"]["rows"]);
    assert_eq!(ranked.len(), 12);
    for (row, cells) in rows.iter().zip(ranked) {
        assert_eq!([&row["model"], &row["variant"]], [&cells[0], &cells[1]]);
        assert_eq!(cells[2], row["parameters"].to_string());
    }
    let fits = array(&data["fits"]);
    assert_eq!(fits.len(), 12);
    for fit in fits {
        let predicted =
            array(&fit["residuals"]).iter().find(|row| row["sequence"] == "complex-shear").unwrap();
        assert_eq!(predicted["predicted"], true);
        let shown =
            array(&fit["sequences"]).iter().find(|sequence| sequence["name"] == "complex-shear").unwrap();
        assert!(!array(&shown["forces"]).is_empty() && array(&shown["frames"]).is_empty());
    }
    let output = run(&["compare", "set", "--nodes", "5x5", "--out", "compared", "--no-report"], &path);
    assert!([Some(0), Some(4)].contains(&output.status.code()), "{}", error(&output));
    assert!(!page.exists());
}

#[test]
fn the_verdict_says_what_is_missing_given_and_unsure() {
    let (_keep, path) = fitted(&["--no-report"]);
    let words = |more: &[&str]| {
        let output = run(&[more, &["--nodes", "9x9", "--out", "said"]].concat(), &path);
        assert!(output.status.success(), "{}", error(&output));
        json(&path.join("said/report.json"))["fits"][0].clone()
    };
    let says = |fit: &Value, key: &str, expected: &str| {
        assert!(fit[key].as_str().unwrap().contains(expected), "{key}: {}, not {expected}", fit[key]);
    };
    // The set has no test of diagonal bending.
    let all = words(&["fit", "set"]);
    says(&all, "state", "Converged: 5 of 6 curves fitted, without a curve: bend-diagonal.");
    says(&all, "next", "Most informative next: a test that observes bend-diagonal, then more frames of");
    says(&all, "good", "Worst rms residuals: forces 0.");
    assert_eq!(all["sound"], false);
    let given = words(&["bend", "set", "--known", "out/material.json"]);
    says(&given, "state", "Converged: 2 of 6 curves fitted, 3 given, without a curve: bend-diagonal.");
    says(&given, "good", "Worst rms residuals: shapes");
    // A sheet off a table does not determine ring-2 springs: the test exists and is not suggested again.
    let springs = words(&["fit", "set", "--model", "springs"]);
    says(
        &springs,
        "state",
        "Converged: 3 of 6 curves fitted, without a curve: bend-weft, bend-warp, bend-diagonal.",
    );
    says(
        &springs,
        "next",
        "other frames, or another model, for bend-weft, bend-warp, bend-diagonal, then more frames of",
    );
}

#[test]
fn a_name_is_text_wherever_it_stands() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let mut set = support::full_set();
    set.fabric.name = "</script><b>\"5\" & 'x'".into();
    set.sequences.retain(|sequence| sequence.name.starts_with("stretch"));
    write_set(&path.join("set"), &set).unwrap();
    let output = run(&["stretch", "set", "--nodes", "5x5", "--out", "out"], path);
    assert!(output.status.success(), "{}", error(&output));
    let text = fs::read_to_string(path.join("out/report.html")).unwrap();
    assert!(!text.contains("</script><b>") && text.contains("<h1>&lt;&#x2f;script&gt;&lt;b&gt;"));
    assert_eq!(embedded(&path.join("out/report.html"))["fabric"], set.fabric.name.as_str());
}

#[test]
fn bad_data_of_a_page_is_named_with_line_and_key() {
    let (_keep, path) = fitted(&[]);
    let file = path.join("out/report.json");
    let good = fs::read_to_string(&file).unwrap();
    let says = |text: &str, expected: &str| {
        fs::write(&file, text).unwrap();
        let output = run(&["report", "out"], &path);
        assert_eq!(output.status.code(), Some(3));
        assert!(error(&output).contains(expected), "{}", error(&output));
    };
    says(
        &good.replace("report/1", "report/2"),
        "schema: found \"fit-cloth/report/2\", expected fit-cloth/report/1 or older",
    );
    says(&good[..good.len() / 2], "report.json:1 ");
    says(
        &good.replacen("\"sound\":false", "\"sound\":1", 1),
        "fits[0].sound: found integer `1`, expected a boolean",
    );
    says(&good.replacen("\"about\"", "\"abuot\"", 1), "fits[0].abuot: found an unknown key");
    let (head, _) = good.split_once("\"fits\":").unwrap();
    says(&format!("{head}\"fits\":[],\"ranking\":null}}"), "fits: found none, expected at least one");
}
