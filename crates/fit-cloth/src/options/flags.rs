//! Flags of the commands that fit or read a measurement set.

use super::choice::{CompressionChoice, ConstraintChoice, ModelChoice, ModelsChoice, VariantChoice};
use crate::failure::Failure;
use crate::output::Output;
use clap::Args;
use cloth_data::error::Error;
use cloth_data::frame::{Kind, MeasurementSet};
use cloth_data::io::read_set;
use cloth_fit::result::check_output;
use cloth_fit::stage::Settings;
use cloth_sim::material::Model;
use std::path::{Path, PathBuf};

/// A stable curve, and the options that lead to one.
pub(crate) const STABLE: &str =
    "a stable curve (`fit-cloth check --repair` makes one; --allow-unstable takes it as it is)";

/// Flags of every command that reads a measurement set.
#[derive(Debug, Clone, Args)]
pub struct SetFlags {
    /// Folder of the measurement set
    pub set: PathBuf,
    /// Output folder; a previous result there is replaced [default: out/ and the set's name; compare and validate
    /// append -compare and -validation]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Nodes of the simulation grid, columns x rows [default: as many cells as 25x25 nodes have, near square; off a table 48 or more cells along the overhang]
    #[arg(long, value_parser = parse_nodes)]
    pub nodes: Option<[usize; 2]>,
    /// Number of threads, 1 to 1024; results do not depend on it [default: one per core]
    #[arg(long)]
    pub threads: Option<usize>,
}

/// Flags that control how curves are fitted.
#[derive(Debug, Clone, Args)]
pub struct CurveFlags {
    /// Maximum number of control points of a curve
    #[arg(long, default_value_t = 5)]
    pub points: usize,
    /// Constraint on curves: stable everywhere, or only no negative control values
    #[arg(long, value_enum, default_value_t = ConstraintChoice::Stable)]
    pub constraints: ConstraintChoice,
    /// Weft and warp under compression: stiffness as at zero strain, or tension only
    #[arg(long, value_enum, default_value_t = CompressionChoice::ZeroStrain)]
    pub compression: CompressionChoice,
    /// Downweight residuals above LIMIT times the noise; --robust alone means 3
    #[arg(long, value_name = "LIMIT", num_args = 0..=1, require_equals = true, default_missing_value = "3")]
    pub robust: Option<f64>,
}

/// Flags of the fit commands.
#[derive(Debug, Clone, Args)]
pub struct FitFlags {
    /// Set, output folder, grid, threads.
    #[command(flatten)]
    pub on: SetFlags,
    /// Control points and constraints.
    #[command(flatten)]
    pub how: CurveFlags,
    /// Cloth model
    #[arg(long, value_enum, default_value_t = ModelsChoice::One(ModelChoice(Model::STVK)))]
    pub model: ModelsChoice,
    /// Model variant: nonlinear or constant stiffness; weft and warp separate or shared
    #[arg(long, value_enum, default_value_t = VariantChoice::Orthotropic)]
    pub variant: VariantChoice,
    /// Use the method of Miguel et al. 2012 as published, for comparison: slower, and bending comes out too stiff
    #[arg(long, conflicts_with_all = ["constraints", "robust"])]
    pub as_published: bool,
    /// Curves for the mesh of a simulator whose cells have sides of MM millimetres [default: for the continuum, with the error of the grid corrected]
    #[arg(long, value_name = "MM", value_parser = parse_side, conflicts_with_all = ["nodes", "as_published"])]
    pub for_mesh: Option<f64>,
    /// A material.json whose curves are taken as exact and not fitted, except those that the command is named after
    #[arg(long, value_name = "FILE")]
    pub known: Option<PathBuf>,
    /// Write no report.html and no report.json
    #[arg(long)]
    pub no_report: bool,
    /// Accept unstable curves in --known, such as those of --constraints control-points
    #[arg(long, requires = "known")]
    pub allow_unstable: bool,
}

impl SetFlags {
    /// Reads the set and claims the folder to write into.
    ///
    /// * `suffix` — appended to the default folder name, so that one command does not replace another's result
    ///
    /// # Errors
    /// A bad set; an output folder that is no previous result or that another run writes; a thread count outside 1 to
    /// 1024.
    pub fn open(&self, suffix: &str) -> Result<(MeasurementSet, Output), Failure> {
        let folder = self.output_folder(suffix);
        use_threads(self.threads)?;
        check_output(&folder, "--out")?;
        self.refuse_inside(&folder)?;
        let set = read_set(&self.set)?;
        Ok((set, Output::claim(&folder)?))
    }

    fn output_folder(&self, suffix: &str) -> PathBuf {
        self.out.clone().unwrap_or_else(|| {
            let name = self.set.canonicalize().ok().and_then(|path| Some(path.file_name()?.to_os_string()));
            let mut name = name.unwrap_or_else(|| "fit".into());
            name.push(suffix);
            PathBuf::from("out").join(name)
        })
    }

    /// Refuses an output folder that is the measurement set or contains it: the result would destroy the set.
    fn refuse_inside(&self, folder: &Path) -> Result<(), Failure> {
        if is_inside(folder, &self.set) {
            let (found, expected) = (folder.display().to_string(), "a folder outside the measurement set");
            return Err(Error::input(&self.set, None, "--out", found, expected).into());
        }
        Ok(())
    }
}

impl CurveFlags {
    /// The settings of a fit; model and variant are the default's.
    pub fn settings(&self, on: &SetFlags) -> Settings {
        Settings {
            nodes: on.nodes,
            points: self.points,
            constraints: self.constraints.into(),
            compression: self.compression.into(),
            robust: self.robust,
            ..Settings::default()
        }
    }
}

impl FitFlags {
    /// The settings of one model's fit.
    pub fn settings(&self, model: Model) -> Settings {
        let settings = Settings {
            model,
            variant: self.variant.into(),
            for_mesh: self.for_mesh.map(|side| 1e-3 * side),
            ..self.how.settings(&self.on)
        };
        if self.as_published { settings.as_published() } else { settings }
    }
}

/// Limits the threads of the whole program.
///
/// # Errors
/// Rejects thread counts outside 1 to 1024.
pub(crate) fn use_threads(threads: Option<usize>) -> Result<(), Failure> {
    let Some(threads) = threads else { return Ok(()) };
    let refused = |found: String| Error::Setting { field: "threads", found, expected: "1 to 1024".into() };
    if !(1..=1024).contains(&threads) {
        return Err(refused(threads.to_string()).into());
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    pool.map_err(|error| refused(error.to_string()).into())
}

/// Refuses an input file that the result would replace.
///
/// # Errors
/// A file inside the output folder.
pub(crate) fn refuse_within(flag: &str, path: &Path, folder: &Path) -> Result<(), Failure> {
    if is_inside(path, folder) {
        let found = format!("a file in {}, which will be replaced", folder.display());
        return Err(Error::input(path, None, flag, found, "another --out").into());
    }
    Ok(())
}

/// True if `path` is `folder` or inside it; existing links are followed.
fn is_inside(path: &Path, folder: &Path) -> bool {
    matches!((resolved(path), resolved(folder)), (Some(path), Some(folder)) if path.starts_with(&folder))
}

/// Resolves links and dots in the existing part of a path.
fn resolved(path: &Path) -> Option<PathBuf> {
    let path = std::path::absolute(path).ok()?;
    path.ancestors().find_map(|ancestor| {
        let real = ancestor.canonicalize().ok()?;
        Some(real.join(path.strip_prefix(ancestor).ok()?))
    })
}

/// Parses the name of a kind of test, out of those allowed.
///
/// # Errors
/// Any other name.
pub fn parse_kind(name: &str, among: &[Kind]) -> Result<Kind, String> {
    let names = || among.iter().map(|kind| kind.to_string()).collect::<Vec<_>>().join(", ");
    let found = among.iter().find(|kind| kind.to_string() == name);
    found.copied().ok_or_else(|| format!("{name}: expected one of {}", names()))
}

/// Parses the side of a cell, mm.
///
/// # Errors
/// No number from 0.01 to 1000.
fn parse_side(text: &str) -> Result<f64, String> {
    let side = text.parse().ok().filter(|side| (0.01..=1e3).contains(side));
    side.ok_or_else(|| format!("{text}: expected millimetres from 0.01 to 1000, as in 5"))
}

/// Parses columns and rows, as in 25x25.
///
/// # Errors
/// Text of any other form.
pub fn parse_nodes(text: &str) -> Result<[usize; 2], String> {
    let sides = text.split_once('x').and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
    sides.ok_or_else(|| format!("{text}: expected columns and rows, as in 25x25"))
}
