//! `fit-cloth import strip`: converts a tensile machine's table into a sequence.

use super::selection::{ExtensionOptions, column, rows};
use crate::failure::{Failure, with_option};
use crate::outcome::Outcome;
use crate::output::whole;
use crate::printing::{Printing, note_lines_above, print_result, warn};
use crate::text;
use clap::{Args, ValueEnum};
use cloth_data::error::Error;
use cloth_data::frame::Sequence;
use cloth_data::io::read_fabric;
use cloth_data::strip::{
    Added, Column, Direction, FabricFields, FreeLength, Strip, StripTest, add_to_set, read_strip,
};
use nalgebra::Isometry3;
use serde_json::json;
use std::fs;
use std::io::Write;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

const EXAMPLE: &str = "\
COLUMN is the exact name in the header. The unit is the end of that name (travel_mm, Load (N), Strain [%]) or \
follows a colon (load:N); a column without a unit is an error. Lengths: m, mm, cm, in. \
Forces: N, kN, cN, mN, gf, kgf, lbf. Strains: 1, %.

The strip is assumed straight and free at the gauge length, where the load cell reads 0. If the table contradicts this, a \
warning names the option that corrects it: --free-length-m, --preload or --zero. The compliance of the machine cannot be \
told from the table; give it with --compliance-m-per-n.

Example:
  fit-cloth import strip weft.csv --set cotton-knit --name cotton-knit \\
    --areal-density-kg-m2 0.3 --direction weft --gauge-m 0.08 --width-m 0.04 \\
    --separation clamp_distance_m --force force_N --branches 0,2 \\
    --compliance-m-per-n 2e-5";

/// `fit-cloth import strip`.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXAMPLE, allow_negative_numbers = true)]
pub struct StripOptions {
    /// The table: comma-separated values with a header
    pub file: PathBuf,
    /// Folder of the measurement set; created if missing
    #[arg(long)]
    pub set: PathBuf,
    /// Name of the sequence [default: stretch-weft, -warp or -bias]
    #[arg(long)]
    pub sequence: Option<String>,
    /// Replace a sequence of that name
    #[arg(long)]
    pub replace: bool,
    /// Name of the fabric; required for a new set
    #[arg(long)]
    pub name: Option<String>,
    /// Mass per area; required for a new set
    #[arg(long, value_name = "KG_M2")]
    pub areal_density_kg_m2: Option<f64>,
    /// Thickness of the fabric
    #[arg(long, value_name = "M")]
    pub thickness_m: Option<f64>,
    /// Direction of the pull
    #[arg(long)]
    pub direction: StripDirection,
    /// Clamp distance at displacement 0, at which the strip is straight and free
    #[arg(long, value_name = "M")]
    pub gauge_m: f64,
    /// Clamp distance at which the strip is straight and free, if it was mounted slack or under tension
    #[arg(long, value_name = "M", conflicts_with = "preload")]
    pub free_length_m: Option<f64>,
    /// Find the free length: extrapolate the first loading to zero force, from where it reaches this force
    #[arg(long, value_name = "N")]
    pub preload: Option<f64>,
    /// Width of the strip
    #[arg(long, value_name = "M")]
    pub width_m: f64,
    /// Extension of the strip.
    #[command(flatten)]
    pub extension: ExtensionOptions,
    /// Column of the load cell's reading, positive in tension
    #[arg(long, value_name = "COLUMN[:UNIT]", value_parser = column)]
    pub force: Column,
    /// Reading of the unloaded load cell, subtracted from every force
    #[arg(long, value_name = "N", default_value_t = 0.0, allow_hyphen_values = true)]
    pub zero: f64,
    /// Compliance of machine and clamps; their elongation is subtracted from the extension
    #[arg(long, value_name = "M_PER_N", default_value_t = 0.0, allow_hyphen_values = true)]
    pub compliance_m_per_n: f64,
    /// Column of the branch numbers [default: branch, if present; else a branch ends where the extension
    /// reverses by more than 2 % of its range]
    #[arg(long, value_name = "COLUMN")]
    pub branch_column: Option<String>,
    /// Branches to use, separated by commas [default: all]
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',')]
    pub branches: Option<Vec<usize>>,
    /// Rows to use, such as 3-90 or 3-, both ends included; 1 is the first below the header [default: all]
    #[arg(long, value_name = "FIRST-LAST", value_parser = rows)]
    pub rows: Option<RangeInclusive<usize>>,
    /// Use every COUNT-th row of a branch
    #[arg(long, value_name = "COUNT", default_value_t = 1)]
    pub every: usize,
    /// Standard deviation of the load cell
    #[arg(long, value_name = "N")]
    pub force_noise_n: Option<f64>,
}

/// Direction of the pull.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum StripDirection {
    /// Along the weft yarns
    Weft,
    /// Along the warp yarns
    Warp,
    /// At 45° to both
    Bias,
}

/// Imports a tensile machine's table.
///
/// # Errors
/// A bad table, set or option; I/O errors.
pub fn run(options: &StripOptions, printing: Printing, output: &mut impl Write) -> Result<Outcome, Failure> {
    let test = strip_test(options);
    let mut strip = read_strip(&options.file, &test).map_err(by_option)?;
    note_lines_above(printing, &options.file, &test.columns())?;
    let place = options.set.join(&strip.sequence.name);
    refuse_replacing(&options.file, &place)?;
    let sample = FabricFields {
        name: options.name.clone(),
        areal_density: options.areal_density_kg_m2,
        thickness: options.thickness_m,
    };
    let known = || read_fabric(&options.set).ok().map(|fabric| fabric.areal_density_kg_m2);
    let notices = strip.inspect(sample.areal_density.or_else(known));
    let added =
        whole(|| add_to_set(&options.set, &sample, &strip.sequence, options.replace)).map_err(by_option)?;
    for notice in &notices {
        warn(printing, &text::notice(notice));
    }
    let forces = forces(&strip.sequence);
    let (rows, branches) = (strip.rows(), strip.branches());
    let [strain, force] = [strains(&strip), forces.clone()].map(range);
    let first_force = forces.first().copied().unwrap_or_default();
    let done = match added {
        Added::NewSet => "first sequence of a new set",
        Added::NewSequence => "new sequence of the set",
        Added::Replaced => "replaced the sequence of that name",
    };
    let text = format!(
        "{}: {} {}, strain {:.4} to {:.4}, force {:.4} to {:.4} N\n\
         rows {} to {}, {} {}; free length {:.2} mm, first force {:.4} N\n{done}: {}",
        strip.sequence.kind,
        rows.len(),
        if rows.len() == 1 { "row" } else { "rows" },
        strain[0],
        strain[1],
        force[0],
        force[1],
        rows[0],
        rows[rows.len() - 1],
        if branches.len() == 1 { "branch" } else { "branches" },
        branches.iter().map(usize::to_string).collect::<Vec<_>>().join(", "),
        1e3 * strip.free_length,
        first_force,
        place.display()
    );
    let json = json!({
        "set": options.set.display().to_string(),
        "sequence": strip.sequence.name,
        "kind": strip.sequence.kind.to_string(),
        "new_set": added == Added::NewSet,
        "replaced": added == Added::Replaced,
        "rows": rows.len(),
        "first_row": rows.first(),
        "last_row": rows.last(),
        "branches": branches,
        "strain": strain,
        "force_n": force,
        "first_force_n": first_force,
        "free_length_m": strip.free_length,
        "notices": notices,
    });
    print_result(printing, output, &text, &json)?;
    Ok(Outcome::Done)
}

fn strip_test(options: &StripOptions) -> StripTest {
    let direction = match options.direction {
        StripDirection::Weft => Direction::Weft,
        StripDirection::Warp => Direction::Warp,
        StripDirection::Bias => Direction::Bias,
    };
    let free_length = match (options.free_length_m, options.preload) {
        (Some(length), _) => FreeLength::Length(length),
        (None, Some(force)) => FreeLength::Preload(force),
        (None, None) => FreeLength::Gauge,
    };
    let extension = options.extension.chosen();
    let defaults =
        StripTest::new(direction, options.gauge_m, options.width_m, extension, options.force.clone());
    StripTest {
        name: options.sequence.clone().unwrap_or(defaults.name),
        branch_column: options.branch_column.clone(),
        branches: options.branches.clone(),
        rows: options.rows.clone(),
        every: options.every,
        force_noise: options.force_noise_n,
        free_length,
        zero: options.zero,
        compliance: options.compliance_m_per_n,
        ..defaults
    }
}

/// Appends the option that resolves an error in reading the table or adding the sequence.
fn by_option(error: Error) -> Error {
    let option = match &error {
        Error::Input { line: None, field, .. } => match field.as_str() {
            "name" => "--name",
            "areal_density_kg_m2" => "--areal-density-kg-m2",
            "thickness_m" => "--thickness-m",
            "sequence" => "--sequence, --replace",
            "folder" | "work folder" => "--set",
            _ => return error,
        },
        Error::Setting { field, .. } => match *field {
            "gauge" => "--gauge-m",
            "width" => "--width-m",
            "free_length" => "--free-length-m",
            "preload" => "--preload",
            "zero" => "--zero",
            "compliance" => "--compliance-m-per-n",
            "every" => "--every",
            "branches" => "--branches",
            "force_noise" => "--force-noise-n",
            _ => return error,
        },
        _ => return error,
    };
    with_option(error, option)
}

/// Refuses a table inside the folder that would be replaced.
fn refuse_replacing(file: &Path, place: &Path) -> Result<(), Error> {
    let (Ok(whole), Ok(replaced)) = (fs::canonicalize(file), fs::canonicalize(place)) else { return Ok(()) };
    if whole.starts_with(replaced) {
        let found = format!("a table within {}, which would be replaced", place.display());
        return Err(Error::input(file, None, "file", found, "a table elsewhere, or another --sequence"));
    }
    Ok(())
}

/// Strain of every row.
fn strains(Strip { sequence, free_length, .. }: &Strip) -> Vec<f64> {
    let pull = sequence.force_direction.unwrap_or_default();
    let shift = |pose: &Isometry3<f64>| pose.translation.vector.dot(&pull);
    let poses = sequence.frames.iter().skip(1).filter_map(|frame| frame.poses.last());
    poses.map(|pose| shift(pose) / free_length).collect()
}

/// Force of every row along the pull, N.
fn forces(sequence: &Sequence) -> Vec<f64> {
    let pull = sequence.force_direction.unwrap_or_default();
    sequence.frames.iter().flat_map(|frame| &frame.cords).map(|cord| cord.force.dot(&pull)).collect()
}

fn range(values: Vec<f64>) -> [f64; 2] {
    let ends =
        values.into_iter().fold([f64::MAX, f64::MIN], |[low, high], value| [low.min(value), high.max(value)]);
    // A value that rounds to zero is printed without a sign.
    ends.map(|end| if end.abs() < 5e-5 { 0.0 } else { end })
}
