//! `fit-cloth rig`: a known fabric into a measurement set.

use super::{Outcome, tell};
use crate::failure::Failure;
use crate::options::{Telling, parse_nodes};
use crate::progress::Progress;
use clap::Args;
use cloth_fit::error::Error;
use cloth_fit::io::write_set;
use cloth_fit::rig::{KnownFabric, Rig};
use serde_json::json;
use std::io::Write;
use std::path::{Path, PathBuf};

const EXAMPLE: &str = "\
Example:
  fit-cloth rig --fabric cotton-denim --out out/denim
  fit-cloth rig --fabric fixtures/fabrics/cotton-denim.toml --frames 40 --seed 7 --out out/denim

The set can be fitted at once: fit-cloth stretch out/denim";

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
    /// The measurement set to write; an existing set is replaced
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
