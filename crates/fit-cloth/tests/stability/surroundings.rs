//! Cases 53 to 55: the environment of a run: a concurrent run, the number of threads, closed output streams.

use crate::fault::{PROGRAM, Tree, names, small_set, tree};
use crate::table::{Extent, Row};
use cloth_data::store::OutputFolder;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// The commands that write a folder `out` from a small set, by name.
fn writers() -> Vec<(&'static str, Vec<String>)> {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures");
    let fixture = |name: &str| fixtures.join(name).display().to_string();
    let words = |text: &str| text.split_whitespace().map(String::from).collect::<Vec<_>>();
    let mut strip =
        words("import strip strip.csv --set out --name knit --areal-density-kg-m2 0.3 --direction weft");
    strip.extend(words("--gauge-m 0.08 --width-m 0.04 --separation clamp_distance_m --force force_N"));
    let mut simulate = words("simulate SCENE --material MATERIAL --rest --out out");
    simulate[1] = fixture("scenes/hang.toml");
    simulate[3] = fixture("materials/cotton.toml");
    vec![
        ("fit", words("fit set --nodes 7x7 --points 1 --out out")),
        ("stretch", words("stretch set --nodes 7x7 --points 1 --out out")),
        ("shear", words("shear set --nodes 7x7 --points 1 --out out")),
        ("bend", words("bend set --nodes 7x7 --points 1 --out out")),
        ("validate", words("validate set --material known/material.json --out out")),
        (
            "rig",
            words(
                "rig --fabric cotton-denim --sequences stretch-weft --nodes 7x7 --measured 5x5 --frames 3 --out out",
            ),
        ),
        ("import strip", strip),
        ("simulate", simulate),
        ("compare", words("compare set --nodes 3x3 --points 1 --out out")),
        ("study", words("study set --quick --topics noise --out out")),
    ]
}

/// The commands cheap enough for the quick suite.
fn affordable(extent: Extent) -> Vec<(&'static str, Vec<String>)> {
    let slow = ["compare", "study"];
    let chosen = |name: &str| extent == Extent::Full || !slow.contains(&name);
    writers().into_iter().filter(|(name, _)| chosen(name)).collect()
}

/// A folder with the small set, a fit of it in `known`, and a tensile machine's table.
fn workshop() -> tempfile::TempDir {
    let folder = small_set();
    let table = "branch,clamp_distance_m,force_N\n0,0.080,0\n0,0.084,0.2\n0,0.088,0.42\n0,0.092,0.68\n";
    fs::write(folder.path().join("strip.csv"), table).unwrap();
    let fitted =
        command(folder.path(), &["fit", "set", "--nodes", "7x7", "--points", "1", "--out", "known"]).output();
    assert!(fitted.unwrap().status.success());
    folder
}

fn command<S: AsRef<std::ffi::OsStr>>(within: &Path, arguments: &[S]) -> Command {
    let mut command = Command::new(PROGRAM);
    command.args(arguments).current_dir(within).stdin(Stdio::null());
    command
}

/// Two runs with one output folder: the second ends before it computes anything, and does no harm.
pub(crate) fn case_53(extent: Extent) -> Vec<Row> {
    let folder = workshop();
    let out = folder.path().join("out");
    let mut rows = Vec::new();
    for (name, arguments) in writers() {
        let mut row = Row::new(53, format!("{name} while another run writes there"));
        let claimed = OutputFolder::claim(&out).unwrap();
        let refused = command(folder.path(), &arguments).output().unwrap();
        let said = String::from_utf8_lossy(&refused.stderr);
        let expected = "error: out folder: found another run that writes there, expected one run at a time";
        row.holds(refused.status.code() == Some(3) && said.starts_with(expected) && !out.exists(), || {
            format!("{:?}: {said}", refused.status)
        });
        drop(claimed);
        if affordable(extent).iter().any(|(affordable, _)| *affordable == name) {
            let after = command(folder.path(), &arguments).output().unwrap();
            let hidden = names(folder.path()).iter().any(|name| name.starts_with('.'));
            row.holds(matches!(after.status.code(), Some(0 | 4)) && out.exists() && !hidden, || {
                format!("then: {after:?}")
            });
            fs::remove_dir_all(&out).unwrap();
        }
        rows.push(row);
    }
    rows
}

/// Output is identical for any number of threads.
pub(crate) fn case_54(extent: Extent) -> Vec<Row> {
    let folder = small_set();
    let denim = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/cotton-denim");
    let mut sets = vec![("a small set, 7x7 nodes", folder.path().join("set"), "7x7")];
    if extent == Extent::Full {
        sets.push(("cotton denim, 13x13 nodes", denim, "13x13"));
    }
    let run = |(name, set, nodes): (&str, std::path::PathBuf, &str)| {
        let mut row = Row::new(54, format!("fit of {name} on 1, 2 and 8 threads"));
        let results = ["1", "2", "8"].map(|threads| {
            let set = set.display().to_string();
            let fitted = command(
                folder.path(),
                &["fit", &set, "--nodes", nodes, "--threads", threads, "--out", threads],
            );
            let output = { fitted }.output().unwrap();
            let blank = |line: &&str| !line.contains(" equilibria, ") && !line.starts_with("Written to");
            let text = String::from_utf8(output.stdout).unwrap();
            (
                output.status.code(),
                text.lines().filter(blank).collect::<Vec<_>>().join("\n"),
                tree(&folder.path().join(threads)),
            )
        });
        for result in &results {
            row.holds(result.2.is_some() && *result == results[0], || "results differ".into());
        }
        row
    };
    sets.into_iter().map(run).collect()
}

/// Standard output or standard error closed or without a reader: the result is that of a normal run.
pub(crate) fn case_55(extent: Extent) -> Vec<Row> {
    let folder = workshop();
    let out = folder.path().join("out");
    let curves = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/curves");
    let weft = curves.join("weft.csv").display().to_string();
    let words =
        |text: &str| text.split_whitespace().map(|word| word.replace("WEFT", &weft)).collect::<Vec<_>>();
    let mut commands = affordable(extent);
    commands.extend([
        ("--help", words("--help")),
        ("--version", words("--version")),
        ("help of a command", words("fit --help")),
        ("check", words("check WEFT --repair out")),
        ("curve scale", words("curve scale WEFT --strain 2 --out out")),
        ("curve extend", words("curve extend WEFT --to 0.2 --out out")),
        ("fit --json", words("fit set --nodes 7x7 --points 1 --json --out out")),
        ("fit --verbose", words("fit set --nodes 7x7 --points 1 --verbose --out out")),
    ]);
    let result = || {
        let found = tree(&out).or_else(|| Some([("file".into(), fs::read(&out).ok()?)].into()));
        let _ = fs::remove_dir_all(&out).or_else(|_| fs::remove_file(&out));
        found
    };
    let mut rows = Vec::new();
    for (name, arguments) in commands {
        let whole = command(folder.path(), &arguments).output().unwrap();
        let expected = (whole.status.code(), result());
        for (stream, close) in [("output", ">&-"), ("error", "2>&-")] {
            let mut row = Row::new(55, format!("{name}, standard {stream} closed or without a reader"));
            let mut shell = Command::new("sh");
            shell.args(["-c", &format!("exec \"$0\" \"$@\" {close}"), PROGRAM]).args(&arguments);
            let closed = shell.current_dir(folder.path()).stdin(Stdio::null()).output().unwrap();
            row.holds(
                is_calm(&closed.stderr)
                    && closed.status.code() == expected.0
                    && is_same(name, result(), &expected.1),
                || format!("closed: {closed:?}"),
            );
            let (reader, writer) = std::io::pipe().unwrap();
            drop(reader);
            let mut run = command(folder.path(), &arguments);
            let run = if stream == "output" {
                run.stdout(writer).stderr(Stdio::piped())
            } else {
                run.stderr(writer).stdout(Stdio::piped())
            };
            let broken = run.spawn().unwrap().wait_with_output().unwrap();
            row.holds(
                is_calm(&broken.stderr)
                    && broken.status.code() == expected.0
                    && is_same(name, result(), &expected.1),
                || format!("without a reader: {broken:?}"),
            );
            rows.push(row);
        }
    }
    rows
}

/// True if files and bytes are the same; of a study, which contains wall times, only the files.
fn is_same(name: &str, found: Option<Tree>, expected: &Option<Tree>) -> bool {
    let files = |tree: &Option<Tree>| tree.as_ref().map(|tree| tree.keys().cloned().collect::<Vec<_>>());
    match name == "study" {
        true => files(&found) == files(expected),
        false => found == *expected,
    }
}

fn is_calm(said: &[u8]) -> bool {
    !String::from_utf8_lossy(said).contains("panicked")
}
