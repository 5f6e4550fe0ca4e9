//! `fit-cloth rig`: measures a known fabric on a virtual rig.

use crate::failure::Failure;
use crate::options::{parse_kind, parse_nodes};
use crate::outcome::Outcome;
use crate::output::Output;
use crate::printing::{Printing, print_result};
use crate::progress::Progress;
use clap::Args;
use cloth_data::error::Error;
use cloth_data::frame::Kind;
use cloth_data::io::{fill_set, read_fabric};
use cloth_data::rig::{KINDS, KnownFabric, Rig};
use serde_json::json;
use std::io::Write;
use std::path::{Path, PathBuf};

const EXAMPLE: &str = "\
Example:
  fit-cloth rig --fabric cotton-denim --out sets/denim
  fit-cloth rig --fabric wool-cotton --sequences stretch-weft,shear --cord-hysteresis --out sets/wool
  fit-cloth rig --fabric fixtures/fabrics/cotton-denim.toml --frames 40 --seed 7 --out sets/denim

To fit the set: fit-cloth stretch sets/denim";

/// `fit-cloth rig`.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXAMPLE)]
pub struct RigOptions {
    /// A built-in fabric (cotton-denim, cotton-satin, rayon-spandex-knit, wool-cotton), or a file like
    /// fixtures/fabrics/cotton-denim.toml
    #[arg(long)]
    pub fabric: String,
    /// Folder of the measurement set to write; a previous set of the rig there is replaced
    #[arg(long)]
    pub out: PathBuf,
    /// Tests to simulate [default: all]: bend-bias, bend-warp, bend-weft, complex-shear, corner-pull, shear,
    /// stretch-warp, stretch-weft
    #[arg(long, value_delimiter = ',', value_parser = parse_test, hide_default_value = true,
        default_values_t = KINDS)]
    pub sequences: Vec<Kind>,
    /// Sample of the fabric: 1 is the fabric itself; in any other, each curve is scaled in stiffness
    #[arg(long, default_value_t = 1)]
    pub sample: usize,
    /// Nodes of the simulation grid, columns x rows: finer than a fit's
    #[arg(long, default_value = "61x61", value_parser = parse_nodes)]
    pub nodes: [usize; 2],
    /// Vertices of the measured mesh, columns x rows
    #[arg(long, default_value = "100x100", value_parser = parse_nodes)]
    pub measured: [usize; 2],
    /// Frames per loading, and per unloading
    #[arg(long, default_value_t = 12)]
    pub frames: usize,
    /// Cycles of loading and unloading
    #[arg(long, default_value_t = 1)]
    pub cycles: usize,
    /// Omit instrument noise (0.075 mm on vertices, 3 mN on force components)
    #[arg(long)]
    pub no_noise: bool,
    /// Add noise to clip poses, too
    #[arg(long, conflicts_with = "no_noise")]
    pub clip_noise: bool,
    /// Add friction of the cords: forces 0.05 N larger on loading, smaller on unloading
    #[arg(long)]
    pub cord_hysteresis: bool,
    /// Add the fabric's own hysteresis: forces on loading are its loading_ratio times those on unloading
    #[arg(long)]
    pub fabric_hysteresis: bool,
    /// Seed of the noise
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// Measures the fabric and writes the set.
///
/// # Errors
/// An invalid fabric or setting; I/O errors.
pub fn run(options: &RigOptions, printing: Printing, output: &mut impl Write) -> Result<Outcome, Failure> {
    let fabric = known_fabric(&options.fabric)?;
    let rig = Rig {
        sequences: options.sequences.clone(),
        sample: options.sample,
        nodes: options.nodes,
        measured: options.measured,
        frames: options.frames,
        cycles: options.cycles,
        noise: !options.no_noise,
        clip_noise: options.clip_noise,
        cord_hysteresis: options.cord_hysteresis,
        fabric_hysteresis: options.fabric_hysteresis,
        seed: options.seed,
        ..Rig::default()
    };
    refuse_measured(&options.out)?;
    let out = Output::claim(&options.out)?;
    let progress = Progress::new(&format!("measuring {}", fabric.name), !printing.quiet);
    let set = rig.measure(&fabric);
    progress.finish();
    let set = set?;
    out.replace(|temporary| fill_set(temporary, &options.out, &set))?;
    let frames: usize = set.sequences.iter().map(|sequence| sequence.frames.len()).sum();
    let names: Vec<&str> = set.sequences.iter().map(|sequence| &sequence.name[..]).collect();
    let text = format!("{frames} frames of {} in {}", names.join(", "), options.out.display());
    let json = json!({ "set": options.out, "fabric": set.fabric.name, "sequences": names, "frames": frames });
    print_result(printing, output, &text, &json)?;
    Ok(Outcome::Done)
}

/// Refuses a folder with anything but a set written by the rig: real measurements and other files are never replaced.
fn refuse_measured(folder: &Path) -> Result<(), Failure> {
    let entries: Vec<String> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| !name.starts_with('.'))
        .collect();
    let known = |name: &String| name == "fabric.toml" || parse_test(name).is_ok();
    let from_rig = || {
        read_fabric(folder)
            .is_ok_and(|fabric| fabric.source.is_some_and(|source| source.starts_with("virtual rig")))
    };
    if entries.is_empty() || entries.iter().all(known) && from_rig() {
        return Ok(());
    }
    let expected = "a new or empty folder, or a set that the rig wrote, which is replaced";
    Err(Error::input(folder, None, "--out", "a folder with other things in it", expected).into())
}

/// Parses the name of a test that the rig can simulate.
fn parse_test(name: &str) -> Result<Kind, String> {
    parse_kind(name, &KINDS)
}

fn known_fabric(name: &str) -> Result<KnownFabric, Failure> {
    if KnownFabric::names().any(|known| known == name) {
        return Ok(KnownFabric::named(name)?);
    }
    let path = Path::new(name);
    if !path.exists() {
        let names = KnownFabric::names().collect::<Vec<_>>().join(", ");
        let expected = format!("a known fabric ({names}) or a fabric file");
        return Err(Error::input(path, None, "--fabric", "no such file", expected).into());
    }
    Ok(KnownFabric::read(path)?)
}
