//! Case 49: inputs that are not readable files, and outputs that would destroy an input.

use crate::readers::{Place, READERS, Reader, contents};
use crate::table::{Extent, Row};
use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, chown, symlink};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, Stdio};

/// Replaces a file by something else.
type Change = fn(&Path);

pub(crate) fn case_49(_: Extent) -> Vec<Row> {
    let changes: [(&str, &str, Change); 7] = [
        ("nothing there", "file: found nothing", |path| fs::remove_file(path).unwrap()),
        ("an empty file", "file: found an empty file", |path| fs::write(path, "").unwrap()),
        ("blank lines only", "", |path| fs::write(path, "\n \n\r\n").unwrap()),
        ("3 GiB", "file: found 3221225472 bytes", |path| {
            // A sparse file, which takes no disk space.
            fs::File::options().write(true).open(path).unwrap().set_len(3 << 30).unwrap();
        }),
        ("a folder", "file: found a folder", |path| {
            fs::remove_file(path).unwrap();
            fs::create_dir(path).unwrap();
        }),
        ("a pipe", "file: found a pipe, socket or device", |path| {
            fs::remove_file(path).unwrap();
            assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
        }),
        ("a device", "file: found a pipe, socket or device", |path| {
            fs::remove_file(path).unwrap();
            symlink("/dev/zero", path).unwrap();
        }),
    ];
    let mut rows: Vec<Row> = changes
        .into_iter()
        .map(|(name, found, change)| {
            let mut row = Row::new(49, format!("{name}: every file of every command"));
            // Some files of a test are optional, and so is a bending test in a set.
            let optional = |reader: &&Reader| {
                ["forces.csv", "frames.csv", "positions.npy"].iter().any(|file| reader.file.ends_with(file))
            };
            for reader in READERS.iter().filter(|reader| name != "nothing there" || !optional(reader)) {
                let place = Place::new();
                change(&place.path().join(reader.file));
                let outcome = place.refuses(reader.command(), &start(reader, name, found));
                row.holds(outcome.is_ok(), || outcome.err().unwrap_or_default());
            }
            row
        })
        .collect();
    rows.push(no_permission());
    rows.extend(outputs_that_are_inputs());
    rows
}

/// Beginning of the message.
fn start(reader: &Reader, name: &str, found: &str) -> String {
    match (reader.file, name) {
        ("set/complex-shear/frames/0001.obj", "nothing there") => {
            "set/complex-shear/frames/0002.ply file: found frame 2, expected frame 1".into()
        }
        ("set/complex-shear/frames/0002.ply", "nothing there") => {
            "set/complex-shear/frames/0003.obj file: found frame 3, expected frame 2".into()
        }
        ("known.toml", "nothing there") => "known.toml --fabric: found no such file".into(),
        (file, "blank lines only") => file.into(),
        (file, _) => format!("{file} {found}"),
    }
}

/// A file that the user may not read. If the suite runs as root, the program runs as another user.
fn no_permission() -> Row {
    let place = Place::new();
    let closed = |reader: &Reader| {
        let path = place.path().join(reader.file);
        fs::set_permissions(&path, Permissions::from_mode(0o000)).unwrap();
        path
    };
    let root = fs::read(closed(&READERS[0])).is_ok();
    let as_whom = if root { ", as another user than root" } else { "" };
    let mut row = Row::new(49, format!("no permission: every file of every command{as_whom}"));
    let program = place.path().join("program");
    fs::copy(env!("CARGO_BIN_EXE_fit-cloth"), &program).unwrap();
    for (name, mode) in [(".", 0o755), ("program", 0o755)] {
        fs::set_permissions(place.path().join(name), Permissions::from_mode(mode)).unwrap();
    }
    for name in contents(place.path()).keys() {
        if root {
            chown(place.path().join(name), Some(NOBODY), None).unwrap();
        }
    }
    for reader in &READERS {
        let path = closed(reader);
        let mut command = Command::new(&program);
        if root {
            command.uid(NOBODY);
        }
        let output =
            command.args(reader.command()).current_dir(place.path()).stdin(Stdio::null()).output().unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        let start = format!("error: {} file: found no permission to read it", reader.file);
        row.holds(output.status.code() == Some(3) && error.starts_with(&start), || {
            format!("{:?} {error} instead of {start}", output.status.code())
        });
        fs::set_permissions(&path, Permissions::from_mode(0o644)).unwrap();
    }
    row
}

/// The user nobody.
const NOBODY: u32 = 65534;

fn outputs_that_are_inputs() -> Vec<Row> {
    // Beside the files: a previous result whose files are inputs, and links.
    let prepare = |place: &Place| {
        let at = place.path();
        symlink("weft.csv", at.join("link.csv")).unwrap();
        symlink("set", at.join("link")).unwrap();
        fs::create_dir(at.join("result")).unwrap();
        for name in ["material.json", "scene.toml", "cloth.toml"] {
            fs::copy(at.join(name), at.join("result").join(name)).unwrap();
        }
    };
    let commands: [(&str, &[&[&str]]); 9] = [
        (
            "the repaired curve",
            &[
                &["check", "weft.csv", "--repair", "weft.csv"],
                &["check", "weft.csv", "--repair", "./set/../weft.csv"],
                &["check", "weft.csv", "--repair", "link.csv"],
                &["check", "link.csv", "--repair", "weft.csv"],
                &["check", "material.json", "--repair", "material.json"],
            ],
        ),
        (
            "the edited curve",
            &[
                &["curve", "scale", "weft.csv", "--stress", "2", "--out", "weft.csv"],
                &["curve", "scale", "link.csv", "--stress", "2", "--out", "weft.csv"],
                &["curve", "extend", "weft.csv", "--to", "0.5", "--out", "weft.csv"],
            ],
        ),
        (
            "the imported table",
            &[&[
                "import",
                "table",
                "pull.csv",
                "--width-m",
                "0.05",
                "--gauge-m",
                "0.2",
                "--force",
                "load_N",
                "--displacement",
                "travel_mm",
                "--measure",
                "green",
                "--out",
                "pull.csv",
            ]],
        ),
        (
            "the set of an imported strip",
            &[&[
                "import",
                "strip",
                "set/stretch-weft/frames.csv",
                "--set",
                "set",
                "--direction",
                "weft",
                "--gauge-m",
                "0.08",
                "--width-m",
                "0.04",
                "--separation",
                "time_s:m",
                "--force",
                "cycle:N",
                "--rows",
                "5-",
                "--replace",
            ]],
        ),
        (
            "the result of a fit",
            &[
                &["stretch", "set", "--out", "set"],
                &["stretch", "set", "--out", "link"],
                &["stretch", "set", "--out", "set/stretch-weft"],
                &["stretch", "set", "--out", "set/new"],
                &["stretch", "set", "--out", "."],
                &["stretch", "link", "--out", "set"],
                &["bend", "set", "--known", "result/material.json", "--out", "result"],
                &["compare", "set", "--out", "set"],
            ],
        ),
        (
            "the result of a validation",
            &[
                &["validate", "set", "--material", "material.json", "--out", "set"],
                &["validate", "set", "--material", "result/material.json", "--out", "result"],
            ],
        ),
        (
            "the result of a simulation",
            &[
                &["simulate", "result/scene.toml", "--material", "cloth.toml", "--rest", "--out", "result"],
                &[
                    "simulate",
                    "scene.toml",
                    "--material",
                    "result/material.json",
                    "--rest",
                    "--out",
                    "result",
                ],
                &["simulate", "scene.toml", "--material", "cloth.toml", "--rest", "--out", "."],
            ],
        ),
        (
            "the set of the rig",
            &[
                &["rig", "--fabric", "known.toml", "--out", "set"],
                &["rig", "--fabric", "known.toml", "--out", "."],
            ],
        ),
        (
            "a file where a folder is written, a folder where a file is",
            &[
                &["stretch", "set", "--out", "weft.csv"],
                &["check", "weft.csv", "--repair", "set"],
                &["simulate", "scene.toml", "--material", "cloth.toml", "--rest", "--out", "weft.csv"],
            ],
        ),
    ];
    commands
        .into_iter()
        .map(|(what, commands)| {
            let mut row = Row::new(49, format!("output = input: {what}"));
            for arguments in commands {
                let place = Place::new();
                prepare(&place);
                let outcome = place.refuses(arguments, "");
                row.holds(outcome.is_ok(), || outcome.err().unwrap_or_default());
            }
            row
        })
        .collect()
}
