//! A captured frame beside its equilibrium, with the clip forces.

use super::drawing::Drawn;
use super::palette::{MEASURED, MODEL};
use super::picture::{self, ArrowScale, Picture};
use super::sheet::Sheet;
use super::view::View;
use super::writing::INK;
use crate::shown::{ClipForce, clip_forces};
use cloth_data::frame::Sequence;
use cloth_fit::stage::report::SequenceReport;
use nalgebra::Vector3;
use plotters::style::{Color, RGBColor};

/// Width of a panel, in pixels.
const WIDTH: f64 = 620.0;
/// Length of the largest force, as a share of the sheet's diagonal.
const LONGEST: f64 = 0.22;
/// Width of arrows, in pixels.
const ARROW: u32 = 5;

/// # Errors
/// No frame.
pub(super) fn draw(title: &str, sequence: &Sequence, found: &SequenceReport) -> Drawn<String> {
    let sheet = Sheet::farthest(&found.shapes).ok_or("no frame")?;
    let view = View::beside(&sheet.mesh, sequence.table.as_ref(), sequence.gravity);
    let forces = clip_forces(sequence, found, sheet.frame);
    let size = |force: &[f64; 3]| Vector3::from(*force).norm();
    let largest = forces.iter().flat_map(|f| [size(&f.measured), size(&f.simulated)]).fold(0.0, f64::max);
    let diagonal = sheet.grid.width.hypot(sheet.grid.height);
    let metres = (largest > 0.0).then(|| LONGEST * diagonal / largest);
    let ends = |force: fn(&ClipForce) -> [f64; 3]| -> Vec<[Vector3<f64>; 2]> {
        let end = |clip: &ClipForce| {
            let at = Vector3::from(clip.at);
            Some([at, at + metres? * Vector3::from(force(clip))])
        };
        forces.iter().filter_map(end).collect()
    };
    let several = found.multi_stable.contains(&sheet.frame);
    let equilibrium = if several { "equilibrium, one of several" } else { "equilibrium" };
    let sides = [
        ("captured", &sheet.measured, ends(|clip| clip.measured), MEASURED),
        (equilibrium, &sheet.mesh.positions, ends(|clip| clip.simulated), MODEL),
    ];
    let picture = |(name, positions, arrows, colour): (&str, &'_ Vec<Vector3<f64>>, Vec<_>, RGBColor)| {
        let positions = positions.clone();
        let name = if positions.is_empty() { "captured without a shape" } else { name };
        let table = sequence.table.as_ref().map(|table| sheet.table_top(table));
        let points = positions.iter().chain(arrows.iter().flatten()).chain(table.iter().flatten());
        let mesh = &sheet.mesh;
        Picture {
            title: name.to_string(),
            view,
            points: points.copied().collect(),
            paint: Box::new(move |painter| {
                if let Some(corners) = &table {
                    painter.floor(corners);
                }
                if !positions.is_empty() {
                    painter.cloth(mesh, &positions);
                }
                arrows
                    .iter()
                    .for_each(|&[from, to]: &[_; 2]| painter.arrow(from, to, colour.stroke_width(ARROW)));
            }),
        }
    };
    let pictures = sides.map(picture);
    let arrows = metres.map(|metres| ArrowScale {
        metres,
        unit: "N",
        style: INK.stroke_width(ARROW),
        name: "force on a clip",
        largest,
    });
    picture::draw(&sheet.titled(title, found.kind), WIDTH, &pictures, arrows)
}
