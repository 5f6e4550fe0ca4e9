//! Figures of a fit, as SVG: `plots/*.svg`.

mod forces;
mod stress;

use cloth_fit::error::{Error, Result};
use cloth_fit::report::StageReport;
use cloth_fit::store::write_file;
use plotters::style::RGBColor;
use std::path::Path;

/// Size of a figure: twice what it is shown at, since lines are drawn through whole pixels.
const SIZE: (u32, u32) = (1280, 840);

const MODEL: RGBColor = RGBColor(31, 90, 160);
const LOADING: RGBColor = RGBColor(200, 80, 30);
const UNLOADING: RGBColor = RGBColor(120, 120, 120);

/// Writes a stage's figures into a result folder.
///
/// # Errors
/// What the operating system refuses.
pub fn write_plots(folder: &Path, stages: &[StageReport]) -> Result<()> {
    let plots = folder.join("plots");
    std::fs::create_dir_all(&plots).map_err(|source| Error::io(&plots, source))?;
    for stage in stages {
        let name = |what: &str| plots.join(format!("{}-{what}.svg", stage.components[0]));
        // Drawing into memory cannot fail but for a figure of a curve without extent; then there is none.
        if let Ok(figure) = stress::draw(stage) {
            write_file(&name("stress"), figure.as_bytes())?;
        }
        if let Ok(figure) = forces::draw(stage) {
            write_file(&name("force"), figure.as_bytes())?;
        }
    }
    Ok(())
}

type Drawing = std::result::Result<String, Box<dyn std::error::Error>>;
