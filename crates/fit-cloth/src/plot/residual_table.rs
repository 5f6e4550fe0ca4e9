//! Residuals of every sequence, as a table with bars.

use super::drawing::{Area, Drawn};
use super::palette::{GREY, MODEL};
use super::writing::{self, INK, TEXT, TITLE};
use cloth_fit::incremental::FitReport;
use cloth_fit::stage::report::SequenceReport;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

const MARGIN: i32 = 28;
const ROW: i32 = 56;
/// Bottom of the title and of the column headings.
const TOP: i32 = 2 * MARGIN + TITLE;
const HEAD: i32 = TOP + 80;
/// Length of the longest bar, and the room for text beyond it.
const BAR: i32 = 240;
const BEYOND: i32 = 120;
/// Space between columns, and widths of the columns of frames and forces.
const SPACE: i32 = 40;
const FRAMES: i32 = 110;
const FORCE: i32 = 170;

/// # Errors
/// No sequence.
pub(super) fn draw(report: &FitReport) -> Drawn<String> {
    let sequences: Vec<&SequenceReport> =
        report.sequences().into_iter().map(|(_, sequence)| sequence).collect();
    let names = sequences.iter().map(|s| writing::width(&s.name, TEXT)).max().ok_or("no sequences")?;
    let names = names.max(writing::width("sequence", TEXT));
    // Right ends of number columns, left ends of bar columns.
    let frames = MARGIN + names + SPACE + FRAMES;
    let force = frames + FORCE;
    let share = force + SPACE;
    let position = share + BAR + BEYOND + SPACE;
    let size = (position + BAR + BEYOND + MARGIN, HEAD + ROW * sequences.len() as i32 + MARGIN);
    let shares = |s: &SequenceReport| Some(100.0 * s.force_rms? / s.force_largest).filter(|v| v.is_finite());
    let positions = |s: &SequenceReport| s.position_rms.map(|rms| 1e3 * rms);
    let largest = |value: &dyn Fn(&SequenceReport) -> Option<f64>| {
        sequences.iter().filter_map(|s| value(s)).fold(f64::MIN_POSITIVE, f64::max)
    };
    let [most, farthest] = [largest(&shares), largest(&positions)];
    let mut figure = String::new();
    {
        let area = SVGBackend::with_string(&mut figure, (size.0 as u32, size.1 as u32)).into_drawing_area();
        area.fill(&WHITE)?;
        let title = format!("Residuals, {}", report.model);
        writing::write(&area, &title, (MARGIN, MARGIN + TITLE / 2), (TITLE, HPos::Left, INK))?;
        let heads = [
            ("sequence", "", MARGIN, HPos::Left),
            ("frames", "", frames, HPos::Right),
            ("rms force", "[N]", force, HPos::Right),
            ("rms force", "[% of largest]", share, HPos::Left),
            ("rms position", "[mm]", position, HPos::Left),
        ];
        for (name, unit, x, place) in heads {
            let lines = if unit.is_empty() { ["", name] } else { [name, unit] };
            for (line, text) in lines.into_iter().enumerate().filter(|(_, text)| !text.is_empty()) {
                writing::write(&area, text, (x, TOP + 12 + 34 * line as i32), (TEXT, place, INK))?;
            }
        }
        let rule = |y: i32, width: u32| {
            PathElement::new([(MARGIN, y), (size.0 - MARGIN, y)], GREY.stroke_width(width))
        };
        area.draw(&rule(HEAD - 8, 2))?;
        for (row, sequence) in sequences.iter().enumerate() {
            let y = HEAD + ROW * row as i32 + ROW / 2 - 4;
            let write =
                |text: &str, x: i32, place: HPos| writing::write(&area, text, (x, y), (TEXT, place, INK));
            write(&sequence.name, MARGIN, HPos::Left)?;
            write(&sequence.frames.to_string(), frames, HPos::Right)?;
            write(&sequence.force_rms.map_or("–".into(), |rms| format!("{rms:.4}")), force, HPos::Right)?;
            bar(&area, (share, y), shares(sequence).map(|v| (v / most, format!("{v:.2}"))))?;
            bar(&area, (position, y), positions(sequence).map(|v| (v / farthest, format!("{v:.3}"))))?;
            area.draw(&rule(HEAD + ROW * (row as i32 + 1) - 8, 1))?;
        }
        area.present()?;
    }
    Ok(figure.replace(" opacity=\"1\"", ""))
}

/// Draws a bar, as a share of the longest, and its number; a dash if nothing was measured.
fn bar(area: &Area<'_>, (x, y): (i32, i32), value: Option<(f64, String)>) -> Drawn<()> {
    let (length, text) = match &value {
        Some((share, text)) => ((share * f64::from(BAR)).round() as i32, &text[..]),
        None => (0, "–"),
    };
    if length > 0 {
        area.draw(&Rectangle::new([(x, y - 15), (x + length, y + 15)], MODEL.filled()))?;
    }
    let from = if value.is_some() { x + length + 12 } else { x };
    writing::write(area, text, (from, y), (TEXT, HPos::Left, INK))
}
