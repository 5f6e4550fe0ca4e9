//! Figures of a fit, as SVG: `plots/*.svg`.

mod chart;
mod forces;
mod stress;

use cloth_fit::error::{Error, Result};
use cloth_fit::incremental::FitReport;
use cloth_fit::store::write_file;
use plotters::style::RGBColor;
use std::path::Path;

const MODEL: RGBColor = RGBColor(31, 90, 160);
const LOADING: RGBColor = RGBColor(200, 80, 30);
const UNLOADING: RGBColor = RGBColor(120, 120, 120);

/// Writes a fit's figures into a result folder: every observed curve, and every kind of test on which forces were
/// measured.
///
/// # Errors
/// What the operating system refuses.
pub fn write_plots(folder: &Path, report: &FitReport) -> Result<()> {
    let plots = folder.join("plots");
    std::fs::create_dir_all(&plots).map_err(|source| Error::io(&plots, source))?;
    for stage in report.last_stages().filter(|stage| stage.curve.observed) {
        // Drawing into memory cannot fail but for a figure of a curve without extent; then there is none.
        if let Ok(figure) = stress::draw(stage) {
            let what = if stage.components[0].is_bending() { "moment" } else { "stress" };
            write_file(&plots.join(format!("{}-{what}.svg", stage.components[0])), figure.as_bytes())?;
        }
    }
    let sequences = report.sequences();
    let mut kinds: Vec<_> = sequences.iter().map(|(_, sequence)| sequence.kind).collect();
    kinds.sort();
    kinds.dedup();
    for kind in kinds {
        let shown: Vec<_> = sequences.iter().map(|(_, s)| *s).filter(|s| s.kind == kind).collect();
        if let Ok(figure) = forces::draw(&format!("{kind}, {}", report.model), kind, &shown) {
            write_file(&plots.join(format!("{kind}-force.svg")), figure.as_bytes())?;
        }
    }
    Ok(())
}
