//! `fit-cloth rig`: a known fabric into a measurement set.

use super::{Outcome, tell};
use crate::failure::Failure;
use crate::options::{Telling, parse_nodes};
use crate::progress::Progress;
use clap::Args;
use cloth_fit::error::Error;
use cloth_fit::io::{read_fabric, write_set};
use cloth_fit::rig::{KnownFabric, Rig};
use serde_json::json;
use std::io::Write;
use std::path::{Path, PathBuf};

const EXAMPLE: &str = "\
Example:
  fit-cloth rig --fabric cotton-denim --out sets/denim
  fit-cloth rig --fabric fixtures/fabrics/cotton-denim.toml --frames 40 --seed 7 --out sets/denim

The set can be fitted at once: fit-cloth stretch sets/denim";

/// The fabrics that come with the program.
const KNOWN: [(&str, &str); 1] =
    [("cotton-denim", include_str!("../../../../fixtures/fabrics/cotton-denim.toml"))];

/// `fit-cloth rig`.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXAMPLE)]
pub struct RigOptions {
    /// A fabric that comes with the program (cotton-denim), or a file like fixtures/fabrics/cotton-denim.toml
    #[arg(long)]
    pub fabric: String,
    /// The measurement set to write; a set that the rig wrote there before is replaced
    #[arg(long)]
    pub out: PathBuf,
    /// Columns and rows of the simulation: finer than a fit's
    #[arg(long, default_value = "61x61", value_parser = parse_nodes)]
    pub nodes: [usize; 2],
    /// Columns and rows of the measured mesh
    #[arg(long, default_value = "21x21", value_parser = parse_nodes)]
    pub measured: [usize; 2],
    /// Frames of each pull, and of each release
    #[arg(long, default_value_t = 12)]
    pub frames: usize,
    /// Pulls
    #[arg(long, default_value_t = 1)]
    pub cycles: usize,
    /// Leave out the noise of the instruments (0.075 mm on vertices, 3 mN on force components)
    #[arg(long)]
    pub no_noise: bool,
    /// Noise on the clips' poses too
    #[arg(long, conflicts_with = "no_noise")]
    pub clip_noise: bool,
    /// Seed of the noise
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// Measures the fabric.
///
/// # Errors
/// A fabric or a setting that cannot be; what the operating system refuses.
pub fn run(options: &RigOptions, telling: Telling, output: &mut impl Write) -> Result<Outcome, Failure> {
    let fabric = known_fabric(&options.fabric)?;
    let rig = Rig {
        nodes: options.nodes,
        measured: options.measured,
        frames: options.frames,
        cycles: options.cycles,
        noise: !options.no_noise,
        clip_noise: options.clip_noise,
        seed: options.seed,
    };
    refuse_measured(&options.out)?;
    let progress = Progress::new(&format!("measuring {}", fabric.name), !telling.quiet);
    let set = rig.measure(&fabric)?;
    progress.finish();
    write_set(&options.out, &set)?;
    let frames: usize = set.sequences.iter().map(|sequence| sequence.frames.len()).sum();
    let names: Vec<&str> = set.sequences.iter().map(|sequence| &sequence.name[..]).collect();
    let text = format!("{frames} frames of {} in {}", names.join(" and "), options.out.display());
    let json = json!({ "set": options.out, "fabric": fabric.name, "sequences": names, "frames": frames });
    tell(telling, output, &text, &json)?;
    Ok(Outcome::Done)
}

/// Only what a rig wrote is replaced: never a set that somebody measured, or other files.
fn refuse_measured(folder: &Path) -> Result<(), Failure> {
    let entries: Vec<String> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| !name.starts_with('.'))
        .collect();
    let known = |name: &String| ["fabric.toml", "stretch-weft", "stretch-warp"].contains(&&name[..]);
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

fn known_fabric(name: &str) -> Result<KnownFabric, Failure> {
    if let Some((name, text)) = KNOWN.iter().find(|(known, _)| *known == name) {
        return Ok(KnownFabric::parse(Path::new(name), text)?);
    }
    let path = Path::new(name);
    let text = std::fs::read_to_string(path).map_err(|error| {
        let names: Vec<&str> = KNOWN.iter().map(|(name, _)| *name).collect();
        let expected = format!("a known fabric ({}) or a fabric file", names.join(", "));
        Failure::from(Error::input(path, None, "--fabric", error.to_string(), expected))
    })?;
    Ok(KnownFabric::parse(path, &text)?)
}
