//! The arguments of the program, and the flags that its commands share.

use crate::command::import::Import;
use crate::command::rig::RigOptions;
use crate::command::stretch::StretchOptions;
use crate::failure::Failure;
use clap::{Args, Parser, Subcommand, ValueEnum};
use cloth_fit::error::Error;
use cloth_fit::stage::{Constraints, Settings};
use cloth_sim::material::{Compression, Model};
use std::path::PathBuf;

/// Fits stress-strain curves of cloth to measurements and writes them for simulators.
#[derive(Debug, Clone, Parser)]
#[command(name = "fit-cloth", version, arg_required_else_help = true)]
pub struct Options {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// How to tell of it.
    #[command(flatten)]
    pub telling: Telling,
}

/// What to do.
#[derive(Debug, Clone, Subcommand)]
#[expect(clippy::large_enum_variant, reason = "there is one of them in a run")]
pub enum Command {
    /// Turn a laboratory's table into a sequence of a measurement set
    Import(Import),
    /// Measure a known cloth on a virtual rig: a measurement set to try a fit on
    Rig(RigOptions),
    /// Fit weft and warp stretch curves
    Stretch(StretchOptions),
}

/// How results are told; every command has these flags.
#[derive(Debug, Clone, Copy, Default, Args)]
#[command(next_help_heading = "Output")]
pub struct Telling {
    /// Print the result as one JSON object
    #[arg(long, global = true)]
    pub json: bool,
    /// Print nothing but errors, and what --json asks for
    #[arg(short, long, global = true)]
    pub quiet: bool,
}

/// What every fit can be told.
#[derive(Debug, Clone, Args)]
pub struct FitFlags {
    /// The measurement set
    pub set: PathBuf,
    /// Where to write; a former result there is replaced [default: out/ and the set's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// The cloth model
    #[arg(long, value_enum, default_value_t = ModelChoice::Stvk)]
    pub model: ModelChoice,
    /// Columns and rows of the simulation [default: as many cells as 25x25 nodes have, near square]
    #[arg(long, value_parser = parse_nodes)]
    pub nodes: Option<[usize; 2]>,
    /// Most control points of a curve
    #[arg(long, default_value_t = 5)]
    pub points: usize,
    /// What keeps a curve physical: stable everywhere, or only control points that are not negative
    #[arg(long, value_enum, default_value_t = ConstraintChoice::Stable)]
    pub constraints: ConstraintChoice,
    /// What weft and warp do under compression: push back as at zero strain, or bear tension only
    #[arg(long, value_enum, default_value_t = CompressionChoice::ZeroStrain)]
    pub compression: CompressionChoice,
    /// Threads; the result is the same on any number [default: one a core]
    #[arg(long)]
    pub threads: Option<usize>,
}

/// One model, or all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ModelChoice {
    /// Diagonalised StVK, discrete shells
    Stvk,
    /// Soft constraints, discrete shells
    SoftConstraint,
    /// Springs
    Springs,
    /// One after the other
    All,
}

impl ModelChoice {
    /// The models chosen.
    pub fn models(self) -> Vec<Model> {
        match self {
            Self::Stvk => vec![Model::Stvk],
            Self::SoftConstraint => vec![Model::SoftConstraint],
            Self::Springs => vec![Model::Springs],
            Self::All => Model::ALL.to_vec(),
        }
    }
}

/// What keeps a curve physical.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ConstraintChoice {
    /// Stress grows with strain everywhere
    Stable,
    /// Control values are not negative: the published rule
    ControlPoints,
}

/// What weft and warp do under compression.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum CompressionChoice {
    /// Push back with the stiffness at zero strain
    ZeroStrain,
    /// Bear tension only
    None,
}

impl FitFlags {
    /// The folder to write into.
    pub fn output_folder(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| {
            let name = self.set.canonicalize().ok().and_then(|path| Some(path.file_name()?.to_os_string()));
            PathBuf::from("out").join(name.unwrap_or_else(|| "fit".into()))
        })
    }

    /// The settings of one model's fit.
    pub fn settings(&self, model: Model) -> Settings {
        let constraints = match self.constraints {
            ConstraintChoice::Stable => Constraints::Stable,
            ConstraintChoice::ControlPoints => Constraints::ControlPoints,
        };
        let compression = match self.compression {
            CompressionChoice::ZeroStrain => Compression::ZeroStrain,
            CompressionChoice::None => Compression::None,
        };
        Settings {
            model,
            nodes: self.nodes,
            points: self.points,
            constraints,
            compression,
            ..Settings::default()
        }
    }

    /// Limits the threads of the whole program.
    ///
    /// # Errors
    /// No thread, or a pool that cannot be made.
    pub fn use_threads(&self) -> Result<(), Failure> {
        let Some(threads) = self.threads else { return Ok(()) };
        let refused =
            |found: String| Error::Setting { field: "threads", found, expected: "1 to 1024".into() };
        if !(1..=1024).contains(&threads) {
            return Err(refused(threads.to_string()).into());
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
        pool.map_err(|error| refused(error.to_string()).into())
    }
}

/// Columns and rows, as in 25x25.
///
/// # Errors
/// Text of another form.
pub fn parse_nodes(text: &str) -> Result<[usize; 2], String> {
    let sides = text.split_once('x').and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
    sides.ok_or_else(|| format!("{text}: expected columns and rows, as in 25x25"))
}
