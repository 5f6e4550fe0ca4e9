//! Runs the commands of the README in order; the rows of tables that it shows are rows that they print.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;
use std::process::Command;

/// The fenced blocks as lines; a line may continue after a backslash.
fn blocks(text: &str) -> Vec<Vec<String>> {
    let inside = text.split("```").skip(1).step_by(2);
    inside.map(|block| block.replace("\\\n", " ").lines().skip(1).map(String::from).collect()).collect()
}

/// The arguments of a command, without a trailing comment.
fn command(line: &str) -> Option<Vec<String>> {
    let line = line.split(" #").next().unwrap_or_default();
    let arguments =
        ["fit-cloth ", "cargo run --release -- "].iter().find_map(|program| line.strip_prefix(program))?;
    Some(arguments.split_whitespace().map(String::from).collect())
}

/// True for a synopsis, in which SET is a placeholder.
fn is_synopsis(block: &[String]) -> bool {
    block.iter().flat_map(|line| line.split_whitespace()).any(|word| word == "SET")
}

#[test]
fn the_tour_can_be_taken() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    let blocks = blocks(&readme);
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink(root.join("fixtures"), folder.path().join("fixtures")).unwrap();
    let table =
        blocks.iter().find(|block| block.iter().any(|line| line.starts_with("branch,clamp_distance_m")));
    fs::write(folder.path().join("weft.csv"), table.unwrap().join("\n") + "\n").unwrap();

    let commands: Vec<_> = blocks
        .iter()
        .filter(|block| !is_synopsis(block))
        .flatten()
        .filter_map(|line| command(line))
        .collect();
    let (mut taken, mut printed) = (Vec::new(), String::new());
    // The first command must still run after all others.
    for arguments in commands.iter().chain(&commands[..1]) {
        let output = Command::new(env!("CARGO_BIN_EXE_fit-cloth"))
            .args(arguments)
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        taken.push(arguments[0].clone());
        printed += &String::from_utf8_lossy(&output.stdout);
    }
    let is_result = |block: &&Vec<String>| block.first().is_some_and(|line| line.starts_with("sequence "));
    let shown: Vec<&String> =
        blocks.iter().filter(is_result).flatten().filter(|line| !line.is_empty()).collect();
    assert!(shown.len() >= 4);
    for row in shown {
        assert!(printed.lines().any(|line| line == row), "no command prints {row}");
    }
    for expected in
        ["fit", "import", "stretch", "compare", "validate", "report", "rig", "simulate", "check", "curve"]
    {
        assert!(taken.iter().any(|name| name == expected), "no command {expected} among {taken:?}");
    }
    for written in ["out/fit/material.json", "out/fit/report.html", "out/my-knit/curves/stretch-weft.csv"] {
        assert!(folder.path().join(written).is_file(), "{written}");
    }
}
