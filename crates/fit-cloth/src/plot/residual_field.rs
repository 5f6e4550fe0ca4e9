//! Position residuals of a frame, node by node, magnified.

use super::drawing::Drawn;
use super::palette::{GREY, MEASURED};
use super::picture::{self, ArrowScale, Picture};
use super::sheet::Sheet;
use super::view::View;
use cloth_data::frame::Sequence;
use cloth_fit::stage::report::SequenceReport;
use nalgebra::Vector3;
use plotters::style::Color;

/// Width of the figure, in pixels.
const WIDTH: f64 = 1080.0;
/// Magnification of the residuals.
const TIMES: f64 = 5.0;

/// # Errors
/// No frame with a shape.
pub(super) fn draw(title: &str, sequence: &Sequence, found: &SequenceReport) -> Drawn<String> {
    let sheet = Sheet::farthest(&found.shapes).ok_or("no frame")?;
    let rms = sheet.rms.ok_or("no shape")?;
    let table = sequence.table.as_ref();
    let view = View::against(&sheet.mesh, table, sequence.gravity);
    let vectors = sheet.mesh.positions.iter().zip(&sheet.measured);
    let vectors = vectors.filter(|(_, seen)| seen.iter().all(|c| c.is_finite()));
    let vectors: Vec<[Vector3<f64>; 2]> = vectors.map(|(at, seen)| [*at, at + TIMES * (seen - at)]).collect();
    let largest =
        vectors.iter().map(|[at, to]| 1e3 / TIMES * (to - at).norm()).fold(f64::MIN_POSITIVE, f64::max);
    let style = MEASURED.stroke_width(2);
    let all = sheet.mesh.len();
    let mut caption = format!("measured − simulated ×{TIMES}, rms {:.3} mm", 1e3 * rms);
    if vectors.len() < all {
        caption += &format!(", {} of {all} nodes seen", vectors.len());
    }
    if found.multi_stable.contains(&sheet.frame) {
        caption += ", one of several equilibria";
    }
    // The table in side view.
    let edge = table.map(|table| {
        let [from, _, _, to] = sheet.table_top(table);
        [from, to]
    });
    let picture = Picture {
        title: caption,
        view,
        points: sheet
            .mesh
            .positions
            .iter()
            .chain(vectors.iter().flatten())
            .chain(edge.iter().flatten())
            .copied()
            .collect(),
        paint: Box::new(|painter| {
            edge.iter().for_each(|edge| painter.line(edge, GREY.stroke_width(6)));
            sheet.lines().for_each(|line| painter.line(&line, GREY.mix(0.5).stroke_width(1)));
            vectors.iter().for_each(|&[from, to]| painter.arrow(from, to, style));
        }),
    };
    let arrows = ArrowScale { metres: 1e-3 * TIMES, unit: "mm", style, name: "residual", largest };
    picture::draw(&sheet.titled(title, found.kind), WIDTH, &[picture], Some(arrows))
}
