//! Runs stopped by a fault: at any call to the file system or any allocation.

use crate::support::full_set;
use cloth_data::io::write_set;
use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// The program.
pub(crate) const PROGRAM: &str = env!("CARGO_BIN_EXE_fit-cloth");

/// The files of a folder by path, including empty folders.
pub(crate) type Tree = BTreeMap<PathBuf, Vec<u8>>;

/// Contents of a folder; `None` if it does not exist. Wall times, which differ between runs, are blanked.
pub(crate) fn tree(folder: &Path) -> Option<Tree> {
    let mut tree = Tree::new();
    for entry in fs::read_dir(folder).ok()? {
        let entry = entry.unwrap();
        let name = PathBuf::from(entry.file_name());
        match tree_of_entry(&entry.path()) {
            Ok(bytes) => drop(tree.insert(name, bytes)),
            Err(inner) => {
                tree.insert(name.clone(), Vec::new());
                tree.extend(inner.into_iter().map(|(path, bytes)| (name.join(path), bytes)));
            }
        }
    }
    Some(tree)
}

fn tree_of_entry(path: &Path) -> Result<Vec<u8>, Tree> {
    if path.is_dir() {
        return Err(tree(path).unwrap());
    }
    let bytes = fs::read(path).unwrap();
    let ending = path.extension().unwrap_or_default();
    Ok(match std::str::from_utf8(&bytes) {
        Ok(text) if ending == "csv" => without_column(text, "seconds").into_bytes(),
        Ok(text) if ending == "json" || ending == "html" => {
            without_ranked_times(&without_key(text, "\"seconds\":")).into_bytes()
        }
        _ => bytes,
    })
}

fn without_column(table: &str, name: &str) -> String {
    let column = table.lines().next().unwrap_or_default().split(',').position(|field| field == name);
    let Some(column) = column else { return table.into() };
    let blanked = |line: &str| {
        let mut fields: Vec<&str> = line.split(',').collect();
        fields[column] = "";
        fields.join(",")
    };
    table.lines().map(blanked).collect::<Vec<_>>().join("\n")
}

fn without_key(json: &str, key: &str) -> String {
    json.lines().filter(|line| !line.trim_start().starts_with(key)).collect::<Vec<_>>().join("\n")
}

/// A page's ranking shows the seconds of every row to one digit, which differ under load.
fn without_ranked_times(text: &str) -> String {
    let Some((before, ranking)) = text.split_once("\"ranking\":{") else { return text.into() };
    let is_time = |cell: &str| {
        let parts = cell.split_once('.');
        parts.is_some_and(|(whole, tenth)| {
            tenth.len() == 1 && whole.bytes().chain(tenth.bytes()).all(|b| b.is_ascii_digit())
        })
    };
    let cells = ranking.split('"').map(|cell| if is_time(cell) { "" } else { cell });
    [before, &cells.collect::<Vec<_>>().join("\"")].join("\"ranking\":{")
}

/// Sorted names in a folder.
pub(crate) fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// A folder with a small set in `set`.
pub(crate) fn small_set() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write_set(&folder.path().join("set"), &full_set()).unwrap();
    folder
}

/// Kinds of fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fault {
    /// The disk is full from this call on.
    Full,
    /// The disk is full for this call only.
    Once,
    /// SIGKILL instead of a call.
    Kill,
    /// SIGKILL after half of a write.
    Half,
    /// SIGINT at a call.
    Interrupt,
    /// SIGINT at an allocation.
    Allocate,
}

impl Fault {
    fn name(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::Once => "once",
            Self::Kill => "kill",
            Self::Half => "half",
            Self::Interrupt => "interrupt",
            Self::Allocate => "allocate",
        }
    }

    /// True if the fault applies to a call of this name.
    pub(crate) fn strikes(self, call: &str) -> bool {
        let needs_space = ["create", "write", "fsync", "mkdir"].contains(&call);
        match self {
            Self::Full => needs_space,
            Self::Once => needs_space || ["rename", "exchange"].contains(&call),
            Self::Half => call == "write",
            Self::Kill | Self::Interrupt => true,
            Self::Allocate => false,
        }
    }
}

/// The output folder before the stopped run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Before {
    /// No folder.
    Nothing,
    /// An older result.
    Older,
}

/// A run and its calls.
pub(crate) struct Run {
    pub(crate) output: Output,
    /// Name and path of every call.
    pub(crate) calls: Vec<(String, String)>,
    pub(crate) allocations: usize,
}

impl Run {
    pub(crate) fn said(&self) -> String {
        String::from_utf8_lossy(&self.output.stderr).into_owned()
    }

    pub(crate) fn code(&self) -> Option<i32> {
        self.output.status.code()
    }

    pub(crate) fn signal(&self) -> Option<i32> {
        self.output.status.signal()
    }

    /// Records written to the journal, including its key.
    pub(crate) fn records(&self) -> usize {
        self.calls.iter().filter(|(name, path)| name == "write" && path.ends_with("/journal")).count()
    }
}

/// A command on the small set that writes `out`, and its fault injection.
pub(crate) struct Bench {
    folder: TempDir,
    arguments: Vec<&'static str>,
    no_exchange: bool,
    /// Exit code of an undisturbed run: 4 if a contestant of a comparison does not converge.
    pub(crate) code: Option<i32>,
    older: Tree,
    /// Result of an undisturbed run.
    pub(crate) newer: Tree,
    /// Number of stages or rows that an undisturbed run finishes.
    pub(crate) stages: usize,
}

impl Bench {
    /// A fit of all stages.
    pub(crate) fn new() -> Self {
        Self::of(&["fit", "set", "--nodes", "7x7", "--threads", "1", "--out", "out"])
    }

    /// A command that writes `out`.
    pub(crate) fn of(arguments: &[&'static str]) -> Self {
        let folder = small_set();
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/stability/fault.c");
        let shim = folder.path().join("fault.so");
        let built = Command::new("cc").args(["-shared", "-fPIC", "-o"]).arg(&shim).arg(source).status();
        assert!(
            built.is_ok_and(|status| status.success()),
            "cc, which links the program too, builds the faults"
        );
        let mut bench = Self {
            folder,
            arguments: arguments.to_vec(),
            no_exchange: false,
            code: None,
            older: Tree::new(),
            newer: Tree::new(),
            stages: 0,
        };
        let older = bench.run(&["stretch", "set", "--nodes", "7x7", "--points", "1", "--out", "older"], None);
        assert!(older.output.status.success(), "{}", older.said());
        bench.older = tree(&bench.path("older")).unwrap();
        let newer = bench.fit(Before::Nothing, None);
        bench.code = newer.code();
        assert!(matches!(bench.code, Some(0 | 4)), "{}", newer.said());
        bench.newer = tree(&bench.path("out")).unwrap();
        bench.stages = newer.records() - 1;
        bench
    }

    /// As above on a system that cannot swap two folders in one step.
    pub(crate) fn without_exchange(self) -> Self {
        Self { no_exchange: true, ..self }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs the command from the given state of the output folder, with a fault at a call or allocation.
    pub(crate) fn fit(&self, before: Before, fault: Option<(Fault, usize)>) -> Run {
        let (out, work) = (self.path("out"), self.path(".out.work"));
        [&out, &work]
            .iter()
            .filter(|folder| folder.exists())
            .for_each(|folder| fs::remove_dir_all(folder).unwrap());
        if before == Before::Older {
            copy(&self.path("older"), &out);
        }
        self.again(fault)
    }

    /// Runs the command again in the folder as it is.
    pub(crate) fn again(&self, fault: Option<(Fault, usize)>) -> Run {
        self.run(&self.arguments, fault)
    }

    fn run(&self, arguments: &[&str], fault: Option<(Fault, usize)>) -> Run {
        let log = self.path("log");
        let _ = fs::remove_file(&log);
        let mut command = Command::new(PROGRAM);
        command.args(arguments).current_dir(self.folder.path()).stdin(Stdio::null());
        command.env("LD_PRELOAD", self.path("fault.so")).env("FAULT_LOG", &log);
        if let Some((fault, at)) = fault {
            command.env("FAULT_MODE", fault.name()).env("FAULT_AT", at.to_string());
        }
        if self.no_exchange {
            command.env("FAULT_NO_EXCHANGE", "1");
        }
        let output = command.output().unwrap();
        let mut run = Run { output, calls: Vec::new(), allocations: 0 };
        for line in fs::read_to_string(&log).unwrap().lines() {
            let [number, name, path] = line.splitn(3, ' ').collect::<Vec<_>>()[..] else { panic!("{line}") };
            match name {
                "allocations" => run.allocations = number.parse().unwrap(),
                _ => run.calls.push((name.into(), path.into())),
            }
        }
        run
    }

    /// Current contents of the output folder.
    pub(crate) fn now(&self) -> Option<Tree> {
        tree(&self.path("out"))
    }

    /// Contents of the output folder before the run.
    pub(crate) fn then(&self, before: Before) -> Option<Tree> {
        (before == Before::Older).then(|| self.older.clone())
    }

    /// Names left beside the output folder.
    pub(crate) fn leftovers(&self) -> Vec<String> {
        let known = ["fault.so", "log", "older", "out", "set"];
        names(self.folder.path()).into_iter().filter(|name| !known.contains(&&name[..])).collect()
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for name in names(from) {
        let [from, to] = [from, to].map(|folder| folder.join(&name));
        if from.is_dir() {
            copy(&from, &to)
        } else {
            let _bytes = fs::copy(from, to).unwrap();
        }
    }
}
