//! Run time of a fit by stage: a bar per model and solver.

use super::bars::{self, Bar};
use crate::plot::drawing::Drawn;
use crate::plot::palette::{BLUE, GREEN, PINK, VERMILLION};
use cloth_sim::material::Model;
use cloth_study::run::Part;
use cloth_study::solver::Solver;
use cloth_study::study::Study;
use plotters::style::RGBColor;

/// Name and colour of a kind of stage, and the test for its stages.
type Kind = (&'static str, RGBColor, fn(&str) -> bool);

const KINDS: [Kind; 4] = [
    ("stretch", BLUE, |stage| stage.starts_with("stretch")),
    ("shear", VERMILLION, |stage| stage == "shear"),
    ("bending", GREEN, |stage| stage.starts_with("bend") && !stage.ends_with("again")),
    ("shear and bending again", PINK, |stage| stage.ends_with("again")),
];

/// Draws the fits on the finest grid.
///
/// # Errors
/// No fit.
pub(super) fn draw(study: &Study) -> Drawn<String> {
    let nodes = study.finest_fit().ok_or("no fits")?;
    let mut bars = Vec::new();
    for model in Model::ALL {
        for solver in Solver::ALL {
            let own = || {
                study
                    .part(Part::Stage)
                    .filter(move |run| run.model == model && run.solver == solver && run.nodes == nodes)
            };
            // Fits with fewer points or frames may use the same grid: the first one is the default.
            let mut seen: Vec<&str> = Vec::new();
            let mut pieces = KINDS.map(|(_, colour, _)| (0.0, colour));
            for run in own() {
                if seen.contains(&&run.test[..]) {
                    break;
                }
                seen.push(&run.test);
                for (piece, (_, _, is)) in pieces.iter_mut().zip(KINDS) {
                    piece.0 += if is(&run.test) { run.spent.seconds } else { 0.0 };
                }
            }
            let total: f64 = pieces.iter().map(|(seconds, _)| seconds).sum();
            if total > 0.0 {
                let (name, note) = (format!("{model}, {solver}"), format!("{total:.1} s"));
                bars.push(Bar { name, pieces: pieces.to_vec(), note });
            }
        }
    }
    let longest = bars.iter().map(|bar| bar.pieces.iter().map(|(s, _)| s).sum()).fold(0.0, f64::max);
    let legend = KINDS.map(|(name, colour, _)| (name, colour));
    let title = format!("Where the time of a fit goes, {nodes}x{nodes} nodes");
    bars::draw(&title, ("wall time [s]", 0.0..1.2 * longest), &legend, &bars)
}
