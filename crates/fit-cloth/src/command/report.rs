//! `fit-cloth report`: rewrites the page of a result folder.

use crate::failure::Failure;
use crate::outcome::Outcome;
use crate::output::whole;
use crate::page::Page;
use crate::printing::{Printing, print_result};
use clap::Args;
use serde_json::json;
use std::io::Write;
use std::path::PathBuf;

const EXAMPLE: &str = "\
Example:
  fit-cloth fit fixtures/cotton-denim --out out/fit
  fit-cloth report out/fit

Rewrites report.html from the report.json beside it, for instance after an update of the program. Every fit and comparison
writes both, unless --no-report is given.";

/// `fit-cloth report`.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXAMPLE)]
pub struct ReportOptions {
    /// The result folder of a fit or a comparison
    pub dir: PathBuf,
}

/// Rewrites the page.
///
/// # Errors
/// A folder without valid page data; I/O errors.
pub fn run(options: &ReportOptions, printing: Printing, output: &mut impl Write) -> Result<Outcome, Failure> {
    let page = Page::read(&options.dir)?;
    let path = whole(|| page.write_again(&options.dir))?;
    print_result(printing, output, &format!("Written to {}", path.display()), &json!({ "page": path }))?;
    Ok(Outcome::Done)
}
