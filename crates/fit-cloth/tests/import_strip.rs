//! `fit-cloth import strip`: output, files and exit codes.
//!
//! Goal: a small table becomes a set that reads back; bad input gives exit code 3, one message and no file.
//! Specimen: a strip of 0.08 m × 0.04 m, pulled to 10 % and 20 % and back, 50 N/m.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which may stop where they cannot go on")]

use cloth_data::frame::Kind;
use cloth_data::io::read_set;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

const TABLE: &str = "\
branch,operator,clamp_distance_m,force_N
0,\"Smith, J.\",0.08,0
0,Smith,0.084,0.2
0,Smith,0.088,0.4
1,Smith,0.08,0
2,Smith,0.088,0.4
2,Smith,0.096,0.8
3,Smith,0.08,0
";

const OPTIONS: [&str; 14] = [
    "--set",
    "knit",
    "--name",
    "cotton knit",
    "--areal-density-kg-m2=0.3",
    "--direction=weft",
    "--gauge-m",
    "0.08",
    "--width-m",
    "0.04",
    "--separation",
    "clamp_distance_m",
    "--force",
    "force_N",
];

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fit-cloth"));
    command.current_dir(folder).args(arguments).stdin(Stdio::null());
    command
}

/// Imports `weft.csv` with the options for a new set and additional ones.
fn import(folder: &Path, more: &[&str]) -> Output {
    command(folder, &[&["import", "strip", "weft.csv"], &OPTIONS[..], more].concat()).output().unwrap()
}

/// A folder with the table.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("weft.csv"), TABLE).unwrap();
    folder
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// Asserts exit code 0 and an empty standard error; returns standard output.
fn told(output: &Output) -> &str {
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""));
    text(&output.stdout)
}

#[test]
fn a_table_becomes_a_sequence_of_a_set() {
    let folder = folder();
    let sum = "stretch-weft: 4 rows, strain 0.0000 to 0.2000, force 0.0000 to 0.8000 N";
    let first = import(folder.path(), &["--branches", "2,1,3"]);
    let more = "rows 4 to 7, branches 1, 2, 3; free length 80.00 mm, first force 0.0000 N";
    assert_eq!(told(&first), format!("{sum}\n{more}\nfirst sequence of a new set: knit/stretch-weft\n"));
    let set = read_set(&folder.path().join("knit")).unwrap();
    assert_eq!((set.fabric.name.as_str(), set.fabric.areal_density_kg_m2), ("cotton knit", 0.3));
    assert_eq!((set.sequences.len(), set.sequences[0].frames.len()), (1, 5));

    let second = import(folder.path(), &["--branches", "2", "--sequence", "second", "--json", "-q"]);
    let json: serde_json::Value = serde_json::from_str(told(&second)).unwrap();
    assert_eq!(
        (&json["rows"], &json["sequence"], &json["new_set"]),
        (&2.into(), &"second".into(), &false.into())
    );
    assert_eq!(json["force_n"], serde_json::json!([0.4, 0.8]));
    assert_eq!(
        (&json["first_row"], &json["last_row"], &json["branches"], &json["notices"]),
        (&5.into(), &6.into(), &serde_json::json!([2]), &serde_json::json!([]))
    );

    let third = import(folder.path(), &["--sequence", "second", "--replace", "--rows", "2-", "--quiet"]);
    assert_eq!(told(&third), "");
    let set = read_set(&folder.path().join("knit")).unwrap();
    assert_eq!((set.sequences.len(), set.sequences[0].frames.len()), (2, 7));
    assert_eq!(names(folder.path()), ["knit", "weft.csv"]);
}

/// A strip of 50 N/m, free at 78 mm, with the load cell offset by `zero`.
fn tight(zero: f64) -> String {
    let rows = (0..60).map(|row| {
        let separation = 0.08 + 2e-4 * f64::from(row);
        format!("{separation},{}\n", 50.0 * (separation - 0.078) + zero)
    });
    format!("clamp_distance_m,force_N\n{}", rows.collect::<String>())
}

#[test]
fn a_strip_that_is_not_free_is_told_of_and_each_option_mends_it() {
    let folder = folder();
    let import_of = |table: &str, more: &[&str]| {
        fs::write(folder.path().join("weft.csv"), table).unwrap();
        import(folder.path(), &[&["--replace"], more].concat())
    };
    let warned = import_of(&tight(0.0), &[]);
    assert_eq!(warned.status.code(), Some(0));
    let words = text(&warned.stderr);
    let start = "warning: sequence stretch-weft, weft.csv row 1: found 0.100 N at the gauge length, 80.00 mm";
    assert!(words.starts_with(start) && words.lines().count() == 1, "{words}");
    for option in ["(import strip --replace --free-length-m 0.07800", "--zero 0.1)"] {
        assert!(words.contains(option), "{words}");
    }
    for option in [["--free-length-m", "0.078"], ["--preload", "0.1"]] {
        let output = import_of(&tight(0.0), &option);
        let line = "rows 1 to 60, branch 0; free length 78.00 mm, first force 0.1000 N\n";
        assert!(told(&output).contains(line), "{}", told(&output));
    }
    // A force of 0.1 N at rest, corrected by --zero, and a machine compliance of 5 mm/N.
    let output = import_of(&tight(0.0), &["--zero", "0.1", "--compliance-m-per-n", "0.005"]);
    // (0.0118 m − 0.00295 m)/0.08 m = 0.1106.
    let said = told(&output);
    assert!(said.starts_with("stretch-weft: 60 rows, strain 0.0000 to 0.1106"), "{said}");
    assert!(said.contains(", force 0.0000 to 0.5900 N\n"), "{said}");
    let both = command(
        folder.path(),
        &[&["import", "strip", "weft.csv"], &OPTIONS[..], &["--preload", "1", "--free-length-m", "0.1"]]
            .concat(),
    );
    assert_eq!({ both }.output().unwrap().status.code(), Some(2));
    let quiet = import_of(&tight(0.0), &["--json", "--quiet"]);
    let json: serde_json::Value = serde_json::from_str(told(&quiet)).unwrap();
    assert_eq!(json["notices"][0]["severity"], "doubt");
}

#[test]
fn a_bias_strip_has_its_yarns_at_45_degrees() {
    let folder = folder();
    let options =
        OPTIONS.map(|option| if option == "--direction=weft" { "--direction=bias" } else { option });
    let output =
        command(folder.path(), &[&["import", "strip", "weft.csv"], &options[..]].concat()).output().unwrap();
    assert!(told(&output).ends_with("first sequence of a new set: knit/stretch-bias\n"));
    let set = read_set(&folder.path().join("knit")).unwrap();
    let [sequence] = &set.sequences[..] else { panic!("one sequence") };
    assert_eq!((sequence.name.as_str(), sequence.kind), ("stretch-bias", Kind::StretchBias));
    // Vertex 0 is in the fixed clamp, vertex 2 in the moving one: the pull is midway between weft and warp.
    let along = sequence.mesh.material[2] - sequence.mesh.material[0];
    let part = 0.08 * 0.5f64.sqrt();
    assert!((along.x - part).abs() < 1e-12 && (along.y - part).abs() < 1e-12, "{along}");
    let pull = sequence.mesh.positions[2] - sequence.mesh.positions[0];
    assert!((pull.normalize() - sequence.force_direction.unwrap()).norm() < 1e-12);
}

#[test]
fn bad_input_ends_in_3_and_writes_nothing() {
    let check = |old: &str, new: &str, more: &[&str], expected: &str| {
        let folder = folder();
        assert!(TABLE.contains(old));
        fs::write(folder.path().join("weft.csv"), TABLE.replace(old, new)).unwrap();
        let output = import(folder.path(), more);
        let found = (output.status.code(), text(&output.stdout), text(&output.stderr));
        assert_eq!(found, (Some(3), "", format!("error: {expected}\n").as_str()));
        assert_eq!(names(folder.path()), ["weft.csv"]);
    };
    check("0.084", "nan", &[], "weft.csv:3 clamp_distance_m: found nan, expected a finite number");
    check(
        "force_N",
        "force",
        &[],
        "weft.csv:1 header: found no column \"force_N\", expected one of branch, operator, clamp_distance_m, force, exactly as it stands there",
    );
    check(
        "",
        "",
        &["--branches", "6"],
        "weft.csv branch: found no row of branch 6, expected branches that the table has: 0, 1, 2, 3",
    );
    check("", "", &["--rows", "5-8"], "weft.csv row: found rows 5 to 8 asked for, expected rows from 1 to 7");
    check(
        "",
        "",
        &["--force-noise-n", "-1"],
        "force_noise: found -1, expected a standard deviation above 0, in N (--force-noise-n)",
    );
    check(
        "",
        "",
        &["--thickness-m", "2"],
        "knit/fabric.toml:5 thickness_m: found 2, expected a length above 0 and at most 0.1 m (millimetres?)",
    );
}

#[test]
fn a_negative_gauge_is_bad_input_and_not_an_unknown_option() {
    let folder = folder();
    let options = OPTIONS.map(|option| if option == "0.08" { "-0.08" } else { option });
    let output =
        command(folder.path(), &[&["import", "strip", "weft.csv"], &options[..]].concat()).output().unwrap();
    let expected = "error: gauge: found -0.08, expected a length above 0 and at most 10 m (--gauge-m)\n";
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(3), expected));
}

#[test]
fn lines_above_the_header_are_passed_over_and_said() {
    let folder = folder();
    let path = folder.path().join("weft.csv");
    fs::write(&path, format!("***\n*** made by a program\n{TABLE}")).unwrap();
    let output = import(folder.path(), &[]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(text(&output.stderr), "weft.csv: skipped 2 lines above the header\n");
    assert!(text(&output.stdout).starts_with("stretch-weft: 7 rows, "));
    fs::write(&path, b"PK\x03\x04\x14\0\x06\0").unwrap();
    let output = import(folder.path(), &["--replace"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stderr).contains("found a workbook") && text(&output.stderr).contains("as CSV"));
}

#[test]
fn what_is_there_is_not_overwritten() {
    let folder = folder();
    told(&import(folder.path(), &[]));
    let refused = |arguments: &[&str], expected: &str| {
        let output = command(folder.path(), arguments).output().unwrap();
        assert_eq!(
            (output.status.code(), text(&output.stderr)),
            (Some(3), format!("error: {expected}\n").as_str())
        );
        assert_eq!(fs::read_to_string(folder.path().join("weft.csv")).unwrap(), TABLE);
        assert_eq!(read_set(&folder.path().join("knit")).unwrap().sequences.len(), 1);
    };
    let with = |file: &'static str, set: &'static str, more: &[&'static str]| {
        let options = OPTIONS.map(|option| if option == "knit" { set } else { option });
        [&["import", "strip", file], &options[..], more].concat()
    };
    refused(
        &with("weft.csv", "knit", &[]),
        "knit/stretch-weft sequence: found one of that name, expected a new name, or leave to replace it (--sequence, --replace)",
    );
    refused(
        &with("weft.csv", "weft.csv", &["--replace"]),
        "weft.csv folder: found something else, expected a set's folder, or nothing (--set)",
    );
    refused(
        &with("weft.csv", "knit/stretch-weft", &[]),
        "knit/stretch-weft folder: found other files, expected a new folder, an empty one, or one with fabric.toml to replace (--set)",
    );
    // The set's own frames.csv as the table: it lies in the folder to be replaced.
    fs::copy(folder.path().join("weft.csv"), folder.path().join("knit/stretch-weft/frames.csv")).unwrap();
    let frames = with("knit/stretch-weft/frames.csv", "knit", &["--replace"]);
    let output = command(folder.path(), &frames).output().unwrap();
    let expected = "error: knit/stretch-weft/frames.csv file: found a table within knit/stretch-weft, which would be \
                    replaced, expected a table elsewhere, or another --sequence\n";
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(3), expected));
    assert_eq!(fs::read_to_string(folder.path().join("knit/stretch-weft/frames.csv")).unwrap(), TABLE);
}

#[test]
fn usage_errors_end_in_2() {
    let folder = folder();
    let check = |arguments: &[&str], part: &str| {
        let output = command(folder.path(), arguments).output().unwrap();
        assert_eq!((output.status.code(), text(&output.stdout)), (Some(2), ""));
        assert!(text(&output.stderr).contains(part), "{}", text(&output.stderr));
    };
    let import = |more: &[&'static str]| [&["import", "strip", "weft.csv"], &OPTIONS[..], more].concat();
    check(&[], "Usage: fit-cloth");
    check(&["import", "strip", "weft.csv"], "--set <SET>");
    check(&import(&["--strain", "strain"]), "cannot be used with");
    check(&import(&["--rows", "five"]), "such as 3-90 or 3-");
    check(&["import", "strip", "weft.csv", "--force", ":N"], "the column name is missing");
    check(&import(&["--branches", "a"]), "--branches");
    assert_eq!(names(folder.path()), ["weft.csv"]);
}

#[test]
fn every_help_has_an_example_that_runs() {
    for arguments in [&["import", "strip", "--help"][..], &["import", "--help"], &["import", "strip", "-h"]] {
        let folder = folder();
        let help = command(folder.path(), arguments).output().unwrap();
        let (_, example) = told(&help).split_once("Example:\n").unwrap();
        let example = example.split("\n\n").next().unwrap().replace("\\\n", " ");
        let words: Vec<_> = example.split_whitespace().collect();
        assert_eq!(words[0], "fit-cloth");
        assert!(told(&command(folder.path(), &words[1..]).output().unwrap()).contains("new set"));
    }
}

#[test]
fn closed_standard_output_is_no_failure() {
    let folder = folder();
    let run = |arguments: &[&str]| {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = command(folder.path(), arguments).stdout(writer).stderr(Stdio::piped()).spawn();
        let output = output.unwrap().wait_with_output().unwrap();
        assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""));
    };
    run(&[&["import", "strip", "weft.csv"], &OPTIONS[..]].concat());
    run(&["--help"]);
    assert_eq!(read_set(&folder.path().join("knit")).unwrap().sequences.len(), 1);
}
