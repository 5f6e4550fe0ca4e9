//! Every example in a help text runs unchanged on the fixtures.

#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::{Command, Output};

fn run(arguments: &[&str], within: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fit-cloth")).args(arguments).current_dir(within).output().unwrap()
}

fn examples_run(command: &str) {
    let folder = tempfile::tempdir().unwrap();
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").canonicalize().unwrap();
    let help = String::from_utf8(
        run(&[&command.split(' ').collect::<Vec<_>>()[..], &["--help"]].concat(), folder.path()).stdout,
    )
    .unwrap();
    // An example may continue after a backslash.
    let joined = help.replace("\\\n", " ");
    let examples: Vec<&str> = joined.lines().filter_map(|line| line.strip_prefix("  fit-cloth ")).collect();
    assert!(!examples.is_empty() && help.contains("Example"), "{help}");
    for example in examples {
        let example = example.replace("fixtures/", &format!("{}/", fixtures.display()));
        let output = run(&example.split_whitespace().collect::<Vec<_>>(), folder.path());
        let said = String::from_utf8_lossy(&output.stderr);
        // A contestant may not converge, and `check` finds the kink in the example's curve: other exit codes.
        let told = match command {
            "compare" => Some(4),
            "check" if example.contains("kinked") => Some(3),
            _ => Some(0),
        };
        let done = output.status.success() || output.status.code() == told;
        assert!(done, "{example}: {said}");
    }
}

#[test]
fn the_examples_of_stretch_run() {
    examples_run("stretch");
}

#[test]
fn the_examples_of_shear_run() {
    examples_run("shear");
}

#[test]
fn the_examples_of_bend_run() {
    examples_run("bend");
}

#[test]
fn the_examples_of_fit_run() {
    examples_run("fit");
}

#[test]
fn the_examples_of_validate_run() {
    examples_run("validate");
}

#[test]
fn the_examples_of_compare_run() {
    examples_run("compare");
}

#[test]
fn the_examples_of_report_run() {
    examples_run("report");
}

#[test]
fn the_examples_of_study_run() {
    examples_run("study");
}

#[test]
fn the_examples_of_simulate_run() {
    examples_run("simulate");
}

#[test]
fn the_examples_of_check_run() {
    examples_run("check");
}

#[test]
fn the_examples_of_curve_run() {
    examples_run("curve");
}

#[test]
fn the_examples_of_curve_scale_run() {
    examples_run("curve scale");
}

#[test]
fn the_examples_of_curve_extend_run() {
    examples_run("curve extend");
}

#[test]
fn the_examples_of_import_table_run() {
    examples_run("import table");
}
