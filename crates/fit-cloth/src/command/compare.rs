//! `fit-cloth compare`: fits all models in four variants to one measurement set and ranks them.

use super::journal::{program, recalled};
use super::kinds::{has_any, nothing};
use crate::failure::Failure;
use crate::options::{CurveFlags, SetFlags};
use crate::outcome::Outcome;
use crate::page::{Fit, Frames, Page};
use crate::printing::{Printing, print_result, warn};
use crate::progress::Progress;
use crate::text;
use clap::Args;
use cloth_data::store::write_file;
use cloth_fit::incremental::Stage;
use cloth_fit::judge::compare::{self, Comparison, Entry, Row};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::io::Write;

const EXAMPLE: &str = "\
Example:
  fit-cloth compare fixtures/cotton-denim --nodes 9x9 --out out/compared
  fit-cloth compare fixtures/cotton-denim --nodes 9x9 --leave-one-out --out out/left-out

Writes compare.csv and compare.json, best first, and report.html with all models on the same plots. The ranking is by the
residual on sequences of kind complex-shear and corner-pull, which no fit uses; else by that on sequences left out one at
a time; else by that of the fit.
An interrupted run resumes after the last finished model and variant.";

/// `fit-cloth compare`.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXAMPLE)]
pub struct CompareOptions {
    /// Set, output folder, grid, threads.
    #[command(flatten)]
    pub on: SetFlags,
    /// Control points and constraints.
    #[command(flatten)]
    pub how: CurveFlags,
    /// Leave out each sequence in turn, if others observe its curves, and predict it
    #[arg(long)]
    pub leave_one_out: bool,
    /// Write no report.html and no report.json
    #[arg(long)]
    pub no_report: bool,
}

/// The stored result of a contestant: its row of the comparison and its part of the page.
#[derive(Serialize, Deserialize)]
struct Shown {
    row: Row,
    fit: Option<Fit>,
}

/// Fits, predicts and ranks all contestants.
///
/// # Errors
/// Bad input; a set that no model can fit; an output folder that is not a previous result; I/O errors.
pub fn run(
    options: &CompareOptions,
    printing: Printing,
    output: &mut impl Write,
) -> Result<Outcome, Failure> {
    let (set, out) = options.on.open("-compare")?;
    let kinds: Vec<_> = Stage::ALL.iter().flat_map(|stage| stage.kinds()).collect();
    if !has_any(&set, &kinds) {
        return Err(nothing(&options.on.set, &set, &kinds).into());
    }
    let contestants = compare::contestants(&options.how.settings(&options.on));
    let key =
        (program(), "compare", options.leave_one_out, options.no_report, format!("{contestants:?}"), &set);
    let name = |entry: &Shown| format!("{}, {}", entry.row.model, entry.row.variant);
    let mut finished: Vec<Shown> = recalled(out.recall(&key)?, printing, name);
    let mut refused = None;
    for settings in contestants {
        if finished
            .iter()
            .any(|Shown { row, .. }| (row.model, row.variant) == (settings.model, settings.variant))
        {
            continue;
        }
        let name = format!("{}, {}", settings.model, settings.variant);
        let progress = Progress::new(&name, !printing.quiet);
        let entry = compare::run(&set, &settings, options.leave_one_out, &mut progress.watch());
        progress.finish();
        finished.push(match entry {
            Ok(Entry { row, report, validation }) => {
                let fit = || {
                    let fit = Fit::new(&set, &report, validation.as_ref(), Frames::LeftOut);
                    fit.for_mesh(settings.for_mesh)
                };
                let shown = Shown { row, fit: (!options.no_report).then(fit) };
                out.keep(&shown)?;
                shown
            }
            Err(error) => {
                warn(printing, &format!("{name}: {error}"));
                let row = Row::failed(&settings, &error);
                refused.get_or_insert(error);
                Shown { row, fit: None }
            }
        });
    }
    let (rows, fits): (Vec<Row>, Vec<Option<Fit>>) =
        finished.into_iter().map(|Shown { row, fit }| (row, fit)).unzip();
    let fits: Vec<Fit> = fits.into_iter().flatten().collect();
    // A set that no contestant can fit is bad input.
    if let Some(error) = refused.filter(|_| rows.iter().all(|row| row.failure.is_some())) {
        return Err(error.into());
    }
    let comparison = Comparison::new(rows);
    let json = comparison.to_json();
    out.replace(|temporary| {
        write_file(&temporary.join("compare.csv"), comparison.to_csv().as_bytes())?;
        write_file(&temporary.join("compare.json"), json.as_bytes())?;
        match fits.is_empty() {
            true => Ok(()),
            false => Page::new(&set.fabric.name, fits, Some(text::ranking(&comparison))).write(temporary),
        }
    })?;
    let text = format!("{}\nWritten to {}", text::comparison(&comparison), out.path().display());
    print_result(printing, output, &text, &serde_json::from_str(&json).unwrap_or(Value::Null))?;
    Ok(if comparison.rows.iter().all(|row| row.converged) { Outcome::Done } else { Outcome::NotConverged })
}
