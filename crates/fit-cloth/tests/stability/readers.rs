//! Every kind of input file, a valid one of each, and the refusal of damaged ones.

use crate::support::full_set;
use cloth_data::curve_file::CurveFile;
use cloth_data::error::{Error, Result};
use cloth_data::frame::{MeasurementSet, Noise, Phase};
use cloth_data::io::{ShapeFormat, read_fabric, read_sequence, write_set, write_shapes};
use cloth_data::rig::KnownFabric;
use cloth_data::strip::{
    Conversion, Direction, Extension, ForceTable, StripTest, read_force_table, read_strip,
};
use cloth_fit::material::Material;
use cloth_fit::material::file::MaterialFile;
use cloth_scene::scene::Scene;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;

/// Syntax of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// Comma-separated values.
    Table,
    /// `key = value`.
    Toml,
    /// Wavefront OBJ.
    Obj,
    /// PLY, as text.
    Ply,
    /// JSON.
    Json,
    /// A NumPy array.
    Array,
}

/// A kind of file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reader {
    /// Path in [`Place`].
    pub(crate) file: &'static str,
    pub(crate) form: Form,
    /// Reads it from a folder and returns the parsed content as text.
    read: fn(&Path) -> Result<String>,
    /// The command that reads it, which would write into `out`.
    command: &'static [&'static str],
}

const STRETCH: &[&str] = &["stretch", "set", "--nodes", "5x5", "--out", "out"];
const SIMULATE: &[&str] = &["simulate", "scene.toml", "--material", "cloth.toml", "--rest", "--out", "out"];

fn shown<T: std::fmt::Debug>(read: Result<T>) -> Result<String> {
    read.map(|value| format!("{value:?}"))
}

fn scene(path: &Path) -> Result<String> {
    let scene = Scene::read(path)?;
    Ok(format!("{:?} {:?} {:?} {:?}", scene.mesh, scene.gravity, scene.held, (&scene.start, scene.dynamics)))
}

const fn in_set(file: &'static str, form: Form, read: fn(&Path) -> Result<String>) -> Reader {
    Reader { file, form, read, command: STRETCH }
}

/// All kinds of file.
pub(crate) const READERS: [Reader; 20] = [
    in_set("set/fabric.toml", Form::Toml, |at| shown(read_fabric(&at.join("set")))),
    in_set("set/stretch-weft/test.toml", Form::Toml, |at| shown(read_sequence(&at.join("set/stretch-weft")))),
    in_set("set/stretch-weft/mesh.obj", Form::Obj, |at| shown(read_sequence(&at.join("set/stretch-weft")))),
    in_set("set/stretch-weft/clips.csv", Form::Table, |at| {
        shown(read_sequence(&at.join("set/stretch-weft")))
    }),
    in_set("set/stretch-weft/forces.csv", Form::Table, |at| {
        shown(read_sequence(&at.join("set/stretch-weft")))
    }),
    in_set("set/stretch-weft/frames.csv", Form::Table, |at| {
        shown(read_sequence(&at.join("set/stretch-weft")))
    }),
    in_set("set/bend-weft/test.toml", Form::Toml, |at| shown(read_sequence(&at.join("set/bend-weft")))),
    in_set("set/bend-weft/positions.npy", Form::Array, |at| shown(read_sequence(&at.join("set/bend-weft")))),
    in_set("set/complex-shear/frames/0001.obj", Form::Obj, |at| {
        shown(read_sequence(&at.join("set/complex-shear")))
    }),
    in_set("set/complex-shear/frames/0002.ply", Form::Ply, |at| {
        shown(read_sequence(&at.join("set/complex-shear")))
    }),
    Reader {
        file: "weft.csv",
        form: Form::Table,
        read: |at| {
            let file = CurveFile::read(&at.join("weft.csv"))?;
            Ok(format!("{:?}", (&file.strains, &file.stresses, &file.stiffnesses, &file.band)))
        },
        command: &["check", "weft.csv", "--repair", "out"],
    },
    Reader {
        file: "bend.csv",
        form: Form::Table,
        read: |at| {
            let file = CurveFile::read(&at.join("bend.csv"))?;
            Ok(format!("{:?}", (&file.strains, &file.stresses, &file.stiffnesses)))
        },
        command: &["curve", "scale", "bend.csv", "--stress", "2", "--out", "out"],
    },
    Reader {
        file: "material.json",
        form: Form::Json,
        read: |at| shown(MaterialFile::read(&at.join("material.json"))),
        command: &["check", "material.json", "--repair", "out"],
    },
    Reader {
        file: "cloth.toml",
        form: Form::Toml,
        read: |at| shown(Material::read(&at.join("cloth.toml"))),
        command: SIMULATE,
    },
    Reader {
        file: "shear.csv",
        form: Form::Table,
        read: |at| shown(Material::read(&at.join("cloth.toml"))),
        command: SIMULATE,
    },
    Reader {
        file: "known.toml",
        form: Form::Toml,
        read: |at| shown(KnownFabric::read(&at.join("known.toml"))),
        command: &[
            "rig",
            "--fabric",
            "known.toml",
            "--nodes",
            "9x9",
            "--measured",
            "5x5",
            "--frames",
            "1",
            "--sequences",
            "stretch-weft",
            "--out",
            "out",
        ],
    },
    Reader {
        file: "scene.toml",
        form: Form::Toml,
        read: |at| scene(&at.join("scene.toml")),
        command: SIMULATE,
    },
    Reader {
        file: "sheet.obj",
        form: Form::Obj,
        read: |at| scene(&at.join("own.toml")),
        command: &["simulate", "own.toml", "--material", "cloth.toml", "--rest", "--out", "out"],
    },
    Reader {
        file: "strip.csv",
        form: Form::Table,
        read: |at| {
            let separation = Extension::Separation("clamp_distance_m".into());
            shown(read_strip(
                &at.join("strip.csv"),
                &StripTest::new(Direction::Weft, 0.08, 0.04, separation, "force_N".into()),
            ))
        },
        command: &[
            "import",
            "strip",
            "strip.csv",
            "--set",
            "out",
            "--name",
            "knit",
            "--areal-density-kg-m2",
            "0.3",
            "--direction",
            "weft",
            "--gauge-m",
            "0.08",
            "--width-m",
            "0.04",
            "--separation",
            "clamp_distance_m",
            "--force",
            "force_N",
        ],
    },
    Reader {
        file: "pull.csv",
        form: Form::Table,
        read: |at| {
            let extension = Extension::Displacement("travel_mm".into());
            let (force, conversion) = ("load_N".into(), Conversion::Green);
            let test = ForceTable { width: 0.05, gauge: Some(0.2), extension, force, rows: None, conversion };
            read_force_table(&at.join("pull.csv"), &test)
                .map(|file| format!("{:?}", (&file.strains, &file.stresses)))
        },
        command: &[
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
            "out",
        ],
    },
];

const WEFT: &str = "strain,stiffness_n_per_m,stress_n_per_m,stress_low_n_per_m,stress_high_n_per_m\n\
                    0,100,0,0,0\n0.05,100,5,4.5,5.5\n0.1,125,12.5,12,13\n0.2,150,30,28,32\n";
const BEND: &str = "curvature_per_m,moment_n\n0,0\n10,1e-4\n20,2.2e-4\n";
const SHEAR: &str = "strain,stress_n_per_m\n0,0\n0.1,3\n0.2,6.5\n";
const PULL: &str = "travel_mm,load_N\n0,0\n20,10\n40,30\n60,65\n";
const STRIP: &str = "branch,clamp_distance_m,force_N\n0,0.08,0\n0,0.084,0.2\n0,0.088,0.4\n1,0.08,0\n";
const CLOTH: &str = "# By hand.\nname = \"cloth\"\nareal_density_kg_m2 = 0.2\nmodel = \"stvk\"\n\n\
                     [curves.stretch-weft]\nstiffness_n_per_m = 800\n\n\
                     [curves.stretch-warp]\nstrain = [0.0, 0.02, 0.05]\nstiffness_n_per_m = [600.0, 700.0, 900.0]\n\n\
                     [curves.shear]\nfile = \"shear.csv\"\n\n\
                     [curves.bend-weft]\nrigidity_n_m = 3e-5\n\n\
                     [curves.bend-warp]\ncurvature_per_m = [0.0, 20.0]\nrigidity_n_m = [3e-5, 2.5e-5]\n";
const SCENE: &str = "name = \"scene\"\ngravity_m_s2 = [0.0, 0.0, -9.81]\nduration_s = 0.02\nstep_s = 0.01\n\
                     frames_per_s = 50\n\n[sheet]\norigin_m = [0.0, 0.1, 0.2]\nweft = [1.0, 0.0, 0.0]\n\
                     grid = { width_m = 0.2, height_m = 0.1, nodes = [4, 3] }\n\n\
                     [[held]]\nedge = \"left\"\n\n[[held]]\nbox = { low_m = [0.19, 0.0], high_m = [0.21, 0.1] }\n\n\
                     [start]\nperturbation_m = 1e-3\n\n\
                     [wind]\nvelocity_m_s = [5.0, 1.0, 0.0]\ngust_m_s = [1.0, 0.0, 0.0]\ngust_period_s = 1.1\n\
                     air_density_kg_m3 = 1.2\nnormal_drag = 1.1\ntangential_drag = 0.02\n\n\
                     [damping]\nmass_per_s = 0.1\nstiffness_s = 1e-3\n\n[solver]\ntolerance = 1e-6\n";
const OWN: &str = "name = \"own\"\ngravity_m_s2 = [0.0, 0.0, -9.81]\n[sheet]\nmesh = { file = \"sheet.obj\" }\n\
                   [[held]]\nedge = \"left\"\n";
const MATERIAL: &str = r#"{
  "schema": "fit-cloth/material/2",
  "model": "stvk",
  "compression": "zero-strain",
  "fabric": {
    "name": "f",
    "width_m": 0.1,
    "height_m": 0.1,
    "areal_density_kg_m2": 0.2
  },
  "curves": {
    "stretch-weft": {
      "observed": true,
      "control_points": [
        {
          "strain": 0.0,
          "stiffness_n_per_m": 100.0,
          "deviation_n_per_m": 3.5
        },
        {
          "strain": 0.1,
          "stiffness_n_per_m": 150.0
        }
      ],
      "visited_strain": [
        0.0,
        0.05
      ],
      "rank": 2,
      "noise_n": 0.003
    },
    "shear": {
      "observed": false
    }
  },
  "residuals": [
    {
      "sequence": "stretch-weft",
      "kind": "stretch-weft",
      "frames": 5,
      "rms_force_n": 0.004
    }
  ],
  "provenance": {
    "program": "fit-cloth",
    "constraints": "stable",
    "nodes": {
      "stretch-weft": [
        25,
        25
      ]
    }
  }
}
"#;

/// A set with every kind of file: shapes as OBJ and PLY, forces with points, frames with times.
fn set() -> MeasurementSet {
    let mut set = full_set();
    let weft = set.sequences.iter_mut().find(|sequence| sequence.name == "stretch-weft").unwrap();
    weft.noise = Some(Noise { position_m: Some(7.5e-5), force_n: Some(3e-3), clip_m: None });
    weft.force_direction = Some(Vector3::new(0.6, 0.8, 0.0));
    for (index, frame) in weft.frames.iter_mut().enumerate() {
        frame.time = Some(2.0 * index as f64);
        frame.cycle = Some(0);
        frame.phase = Some(Phase::Loading);
        frame.cords.iter_mut().for_each(|cord| cord.point = Some(Vector3::new(0.1, 0.2, 0.3)));
    }
    set
}

/// All files with their contents, generated once.
static FILES: LazyLock<BTreeMap<PathBuf, Vec<u8>>> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let set = set();
    write_set(&at.join("set"), &set).unwrap();
    let shear = set.sequences.iter().find(|sequence| sequence.name == "complex-shear").unwrap();
    let shapes = vec![shear.mesh.positions.clone(); shear.frames.len()];
    for format in [ShapeFormat::Ply, ShapeFormat::Obj] {
        write_shapes(&at.join("set/complex-shear"), &shear.mesh, &shapes, format).unwrap();
    }
    let frames = at.join("set/complex-shear/frames");
    for index in 0..shapes.len() {
        let other = if index == 2 { "obj" } else { "ply" };
        fs::remove_file(frames.join(format!("{index:04}.{other}"))).unwrap();
    }
    fs::copy(at.join("set/bend-weft/mesh.obj"), at.join("sheet.obj")).unwrap();
    let known = include_str!("../../../../fixtures/fabrics/cotton-denim.toml");
    for (name, text) in [
        ("weft.csv", WEFT),
        ("bend.csv", BEND),
        ("shear.csv", SHEAR),
        ("pull.csv", PULL),
        ("strip.csv", STRIP),
        ("cloth.toml", CLOTH),
        ("scene.toml", SCENE),
        ("own.toml", OWN),
        ("material.json", MATERIAL),
        ("known.toml", known),
    ] {
        fs::write(at.join(name), text).unwrap();
    }
    contents(at)
});

/// Every file below a folder; only the name of irregular files and of files too large to compare.
pub(crate) fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(at) = folders.pop() {
        for entry in fs::read_dir(&at).unwrap() {
            let path = entry.unwrap().path();
            let about = fs::symlink_metadata(&path).unwrap();
            if about.is_dir() {
                folders.push(path);
                continue;
            }
            let readable = about.is_file() && about.len() < 1 << 24;
            let bytes = if readable { fs::read(&path).unwrap_or_default() } else { Vec::new() };
            found.insert(path.strip_prefix(folder).unwrap().to_path_buf(), bytes);
        }
    }
    found
}

/// A refusal: `file:line field: found …, expected …`.
#[derive(Debug)]
pub(crate) struct Refusal {
    pub(crate) line: Option<usize>,
    pub(crate) field: String,
    pub(crate) found: String,
    pub(crate) expected: String,
}

/// A folder with every kind of file.
pub(crate) struct Place(tempfile::TempDir);

impl Place {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, bytes) in &*FILES {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, bytes).unwrap();
        }
        Self(folder)
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    /// Runs the program in the folder.
    pub(crate) fn run(&self, arguments: &[&str]) -> Output {
        // A command that waits for a pipe must not block the suite: 124 is not an expected exit code.
        let mut command = Command::new("timeout");
        command.args(["100", env!("CARGO_BIN_EXE_fit-cloth")]).args(arguments);
        command.current_dir(self.path()).stdin(Stdio::null()).output().unwrap()
    }

    /// Checks for exit code 3, one line on standard error that begins with `start`, an empty standard output and
    /// nothing written.
    pub(crate) fn refuses(&self, arguments: &[&str], start: &str) -> std::result::Result<(), String> {
        let before = contents(self.path());
        let output = self.run(arguments);
        let [told, error] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
        let start = format!("error: {start}");
        let complaint = match output.status.code() {
            Some(3) if !error.starts_with(&start) => format!("instead of {start}"),
            Some(3) if error.lines().count() != 1 => "more than a line".into(),
            Some(3) if !(error.contains(": found ") && error.contains(", expected ")) => {
                "no found, expected".into()
            }
            Some(3) if !told.is_empty() => format!("told {told}"),
            Some(3) if contents(self.path()) != before => "something was written".into(),
            Some(3) => return Ok(()),
            code => format!("exit code {code:?}"),
        };
        Err(format!("{}: {complaint}: {error}", arguments.join(" ")))
    }
}

impl Reader {
    pub(crate) fn bytes(&self) -> &'static [u8] {
        &FILES[Path::new(self.file)]
    }

    /// Text of the valid file; empty for an array.
    pub(crate) fn text(&self) -> &'static str {
        std::str::from_utf8(self.bytes()).unwrap_or_default()
    }

    /// Reads the file as it is in the folder.
    pub(crate) fn read(&self, place: &Place) -> Result<String> {
        (self.read)(place.path())
    }

    /// Reads other contents, then restores the valid ones.
    pub(crate) fn read_of(&self, place: &Place, bytes: &[u8]) -> Result<String> {
        let path = place.path().join(self.file);
        fs::write(&path, bytes).unwrap();
        let read = self.read(place);
        fs::write(&path, self.bytes()).unwrap();
        read
    }

    /// The refusal of other contents, or an error describing what happened instead.
    pub(crate) fn refusal(&self, place: &Place, bytes: &[u8]) -> std::result::Result<Refusal, String> {
        match self.read_of(place, bytes) {
            Err(Error::Input { path, line, field, found, expected }) if path.ends_with(self.file) => {
                Ok(Refusal { line, field, found, expected })
            }
            Err(other) => Err(format!("another error: {other}")),
            Ok(_) => Err("read in spite of it".into()),
        }
    }

    /// Runs the program on the damaged file and checks for exit code 3, file and line in the message, and nothing
    /// written.
    ///
    /// * `line` — `None` if the damage has no line
    pub(crate) fn program_refuses(
        &self,
        place: &Place,
        bytes: &[u8],
        line: Option<usize>,
    ) -> std::result::Result<(), String> {
        let path = place.path().join(self.file);
        fs::write(&path, bytes).unwrap();
        let line = line.map(|line| format!(":{line}")).unwrap_or_default();
        let outcome = place.refuses(self.command, &format!("{}{line} ", self.file));
        fs::write(&path, self.bytes()).unwrap();
        outcome
    }

    /// The command that reads it; see [`Place::run`].
    pub(crate) fn command(&self) -> &'static [&'static str] {
        self.command
    }
}

/// The readers of the given forms.
pub(crate) fn readers(forms: &[Form]) -> impl Iterator<Item = &'static Reader> {
    READERS.iter().filter(|reader| forms.contains(&reader.form))
}

/// All forms except arrays.
pub(crate) const TEXTS: [Form; 5] = [Form::Table, Form::Toml, Form::Obj, Form::Ply, Form::Json];
