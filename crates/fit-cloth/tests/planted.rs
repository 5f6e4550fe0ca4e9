//! Foreign files planted beside an output, or in its place, are reported and left alone.
//!
//! Goal: no link in a work folder is followed, no pipe is waited for, and only the run's own files are removed; exit
//! code 1 or 3, victims unchanged. Specimen: every command that writes, on a small set.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

#[allow(dead_code, reason = "other tests need the rest")]
mod support;

use cloth_data::io::write_set;
use std::fs::{self, Permissions};
use std::io::Read;
use std::os::unix::fs::{PermissionsExt, chown, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Timeout: a run that waits for a pipe would never end.
const PATIENCE: Duration = Duration::from_secs(120);

/// The commands that write a folder `out`.
const WRITERS: [&str; 7] = [
    "fit set --nodes 7x7 --points 1 --out out",
    "stretch set --nodes 7x7 --points 1 --out out",
    "compare set --nodes 3x3 --points 1 --out out",
    "validate set --material known/material.json --out out",
    "rig --fabric cotton-denim --sequences stretch-weft --nodes 7x7 --measured 5x5 --frames 3 --out out",
    "simulate scene.toml --material cotton.toml --rest --out out",
    "import strip strip.csv --set out --name knit --areal-density-kg-m2 0.3 --direction weft --gauge-m 0.08 \
     --width-m 0.04 --separation clamp_distance_m --force force_N",
];

/// A planted file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Plant {
    LinkToFile,
    LinkToFolder,
    LinkToNothing,
    SecondName,
    Pipe,
    Folder,
    File,
}

use Plant::{File, Folder, LinkToFile, LinkToFolder, LinkToNothing, Pipe, SecondName};

/// Paths in the work folder, and the plants that must be refused there.
const PLANTS: [(&str, &[Plant]); 8] = [
    (".out.work", &[LinkToFile, LinkToFolder, LinkToNothing, Pipe, File]),
    (".out.work/lock", &[LinkToFile, LinkToFolder, LinkToNothing, SecondName, Pipe, Folder]),
    (".out.work/journal", &[LinkToFile, LinkToFolder, LinkToNothing, SecondName, Pipe, Folder]),
    (".out.work/new", &[LinkToFile, LinkToFolder, LinkToNothing, Pipe, File]),
    (".out.work/old", &[LinkToFile, LinkToFolder, LinkToNothing, Pipe, File]),
    (".out.work/new/material.json", &[LinkToFile, LinkToFolder, LinkToNothing, Pipe]),
    (".out.work/new/plots/shear.svg", &[LinkToFile, LinkToFolder, LinkToNothing, Pipe]),
    (".out.work/old/curves", &[LinkToFile, LinkToFolder, LinkToNothing, Pipe]),
];

/// A folder with a small set, a fit of it in `known`, a scene, a table, and victim files.
struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures");
        for (from, to) in [("scenes/hang.toml", "scene.toml"), ("materials/cotton.toml", "cotton.toml")] {
            fs::copy(fixtures.join(from), bench.path(to)).unwrap();
        }
        let table = "branch,clamp_distance_m,force_N\n0,0.080,0\n0,0.084,0.2\n0,0.088,0.42\n0,0.092,0.68\n";
        fs::write(bench.path("strip.csv"), table).unwrap();
        write_set(&bench.path("set"), &support::full_set()).unwrap();
        let (status, said) = bench.run("fit set --nodes 7x7 --points 1 --out known");
        assert!(status.success(), "{said}");
        fs::create_dir(bench.path("victims")).unwrap();
        fs::write(bench.path("victims/letter"), "dear").unwrap();
        fs::write(bench.path("victim"), "mine").unwrap();
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Runs the program; returns its exit status and standard error.
    fn run(&self, arguments: &str) -> (ExitStatus, String) {
        let mut child = Command::new(env!("CARGO_BIN_EXE_fit-cloth"))
            .args(arguments.split_whitespace())
            .current_dir(self.0.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        let status = loop {
            match child.try_wait().unwrap() {
                Some(status) => break status,
                None if begun.elapsed() > PATIENCE => {
                    child.kill().unwrap();
                    break child.wait().unwrap();
                }
                None => std::thread::sleep(Duration::from_millis(2)),
            }
        };
        let mut said = String::new();
        child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        (status, said)
    }

    fn plant(&self, plant: Plant, at: &str) {
        let at = self.path(at);
        fs::create_dir_all(at.parent().unwrap()).unwrap();
        match plant {
            LinkToFile => symlink(self.path("victim"), at).unwrap(),
            LinkToFolder => symlink(self.path("victims"), at).unwrap(),
            LinkToNothing => symlink(self.path("nowhere"), at).unwrap(),
            SecondName => fs::hard_link(self.path("victim"), at).unwrap(),
            Pipe => assert!(Command::new("mkfifo").arg(at).status().unwrap().success()),
            Folder => fs::create_dir(at).unwrap(),
            File => fs::write(at, "a file").unwrap(),
        }
    }

    /// Asserts that the run is refused, naming the plant, and that the victims are unchanged.
    fn refuses(&self, arguments: &str, named: &str) {
        let (status, said) = self.run(arguments);
        assert!(matches!(status.code(), Some(1 | 3)), "{arguments}: {status:?}: {said}");
        assert!(said.contains(named), "{arguments}: {named}: {said}");
        let read = |name: &str| fs::read_to_string(self.path(name)).unwrap();
        assert_eq!([read("victim"), read("victims/letter")], ["mine", "dear"], "{arguments}: {named}");
        assert_eq!(fs::read_dir(self.path("victims")).unwrap().count(), 1, "{arguments}: {named}");
        assert!(!self.path("nowhere").exists() && !self.path("out").exists(), "{arguments}: {named}");
    }

    fn clear(&self, name: &str) {
        let path = self.path(name);
        if path.is_dir() && !path.is_symlink() {
            fs::remove_dir_all(path).unwrap();
        } else {
            fs::remove_file(path).unwrap();
        }
    }
}

#[test]
fn what_is_planted_in_a_work_folder_is_named_and_its_victims_are_untouched() {
    let bench = Bench::new();
    for command in WRITERS {
        for (at, plants) in PLANTS {
            for &plant in plants {
                bench.plant(plant, at);
                bench.refuses(command, at);
                let planted = fs::symlink_metadata(bench.path(at)).unwrap();
                let is_link = matches!(plant, LinkToFile | LinkToFolder | LinkToNothing);
                assert_eq!(planted.is_symlink(), is_link, "{command}: {plant:?} at {at}");
                bench.clear(".out.work");
            }
        }
        // Without the plant the run succeeds; not tried for comparisons, which take longest.
        if !command.starts_with("compare") {
            let (status, said) = bench.run(command);
            assert!(status.success() && bench.path("out").is_dir(), "{command}: {said}");
            assert!(!bench.path(".out.work").exists());
            bench.clear("out");
        }
    }
}

#[test]
fn a_work_folder_that_others_own_or_may_write_is_not_used() {
    let bench = Bench::new();
    let work = bench.path(".out.work");
    for command in WRITERS {
        fs::create_dir(&work).unwrap();
        fs::set_permissions(&work, Permissions::from_mode(0o777)).unwrap();
        bench.refuses(command, ".out.work work folder: found a folder that others may write");
        fs::set_permissions(&work, Permissions::from_mode(0o755)).unwrap();
        // Only root can change the owner of a folder.
        if chown(&work, Some(65534), None).is_ok() {
            bench.refuses(command, ".out.work work folder: found a folder of another user");
        }
        bench.clear(".out.work");
    }
}

#[test]
fn a_run_works_where_nobody_else_can_enter() {
    let folder = tempfile::tempdir().unwrap();
    let claimed = cloth_data::store::OutputFolder::claim(&folder.path().join("out")).unwrap();
    let mode = fs::metadata(claimed.work()).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o700);
}

#[test]
fn a_file_is_not_written_into_what_is_none() {
    let bench = Bench::new();
    let scale = "curve scale known/curves/stretch-weft.csv --stress 2 --out out.csv";
    for plant in [LinkToFolder, LinkToNothing, Pipe, Folder] {
        bench.plant(plant, "out.csv");
        bench.refuses(scale, "out.csv");
        bench.clear("out.csv");
    }
    // A command that writes a file ignores a work folder of that name.
    bench.plant(LinkToFolder, ".out.csv.work");
    assert!(bench.run(scale).0.success());
    bench.clear("out.csv");
    // The path given by the user may be a link.
    bench.plant(LinkToFile, "out.csv");
    assert!(bench.run(scale).0.success() && bench.path("out.csv").is_symlink());
    assert!(fs::read_to_string(bench.path("victim")).unwrap().starts_with("green_strain,"));
}

#[test]
fn a_page_is_not_written_into_what_is_no_page() {
    let bench = Bench::new();
    for plant in [LinkToFile, LinkToFolder, LinkToNothing, Pipe, Folder] {
        bench.clear("known/report.html");
        bench.plant(plant, "known/report.html");
        bench.refuses("report known", "known/report.html");
    }
    for plant in [Pipe, Folder] {
        bench.clear("known/report.json");
        bench.plant(plant, "known/report.json");
        bench.refuses("report known", "report.json");
    }
}
