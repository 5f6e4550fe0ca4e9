//! Shapes of a sheet side by side: shaded triangles, the farthest drawn first, without perspective.

mod painter;
mod view;

use super::chart::Drawn;
use crate::scene::{Circle, Measure, Scene};
use crate::simulation::{End, Frame, Simulation};
use nalgebra::Vector3;
use painter::{Painter, Panel};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use view::View;

/// Width of a panel and what its height is between, in pixels: twice what they are shown at.
const WIDTH: f64 = 560.0;
const HEIGHTS: [f64; 2] = [360.0, 760.0];
/// Around the sheet in a panel.
const MARGIN: f64 = 36.0;
/// Above the panels for their titles, below for the scale.
const TITLE: f64 = 64.0;
const FOOT: f64 = 76.0;

const PAPER: RGBColor = RGBColor(248, 248, 248);
const TEXT: RGBColor = RGBColor(60, 60, 60);

/// Shapes of the start, a third, two thirds and the end; of a drape that at rest, from the side and from above.
pub(super) fn draw(scene: &Scene, simulation: &Simulation) -> Drawn<String> {
    let support = scene.support.filter(|_| scene.measure == Some(Measure::DrapeCoefficient));
    let view = View::of(&scene.mesh, scene.gravity);
    let mut panels: Vec<(String, View, &Frame)> = match simulation.end {
        End::Rest(_) => simulation.frames.iter().map(|frame| (title(frame), view, frame)).collect(),
        End::Motion { .. } => chosen(simulation.frames.len())
            .into_iter()
            .map(|index| &simulation.frames[index])
            .map(|frame| (title(frame), view, frame))
            .collect(),
    };
    if support.is_some() {
        // A flat disc shows nothing.
        panels.remove(0);
        panels.extend(simulation.frames.last().map(|last| ("from above".into(), view.above(), last)));
    }
    let seen = panels.iter().map(|(_, view, frame)| {
        let mut points = frame.positions.clone();
        if let Some(circle) = support {
            let [head, foot] = stand(scene, circle, view, &frame.positions);
            points.push(foot);
            if view.is_from_above() {
                let flat = flat_radius(scene, circle);
                points.extend(
                    view.level().into_iter().flat_map(|side| [head + flat * side, head - flat * side]),
                );
            }
        }
        view.extent(&points)
    });
    let seen: Vec<_> = seen.collect();
    let size = |axis: usize| seen.iter().map(|[low, high]| high[axis] - low[axis]).fold(0.0, f64::max);
    let inner = WIDTH - 2.0 * MARGIN;
    let height = (inner * size(1) / size(0) + 2.0 * MARGIN).clamp(HEIGHTS[0], HEIGHTS[1]);
    let scale = (inner / size(0)).min((height - 2.0 * MARGIN) / size(1));
    if !(scale > 0.0 && scale.is_finite()) {
        return Err("a sheet without extent".into());
    }
    let mut figure = String::new();
    {
        let total = [WIDTH * panels.len() as f64, TITLE + height + FOOT].map(|length| length.ceil() as u32);
        let area = SVGBackend::with_string(&mut figure, total.into()).into_drawing_area();
        area.fill(&PAPER)?;
        for (index, ((title, view, frame), [low, high])) in panels.iter().zip(seen).enumerate() {
            let left = WIDTH * index as f64;
            let middle = [left + 0.5 * WIDTH, TITLE + 0.5 * height];
            let panel = Panel { scale, middle, centre: [0, 1].map(|axis| 0.5 * (low[axis] + high[axis])) };
            let style = ("sans-serif", 30).into_font().color(&TEXT).pos(Pos::new(HPos::Center, VPos::Center));
            area.draw(&Text::new(title.clone(), [middle[0], 0.5 * TITLE].map(|c| c as i32).into(), style))?;
            sheet(scene, support, view, panel, &frame.positions).draw(&area)?;
        }
        scale_bar(&area, scale, TITLE + height + 0.5 * FOOT)?;
        area.present()?;
    }
    // Opaque is what is drawn anyway; of thousands of faces that is a sixth of the file.
    Ok(figure.replace(" opacity=\"1\"", ""))
}

/// Everything in a panel.
fn sheet<'s>(
    scene: &'s Scene,
    support: Option<Circle>,
    view: &'s View,
    panel: Panel,
    positions: &'s [Vector3<f64>],
) -> Painter<'s> {
    let mut painter = Painter::new(view, panel);
    match support {
        Some(circle) => {
            let [centre, foot] = stand(scene, circle, view, positions);
            if view.is_from_above() {
                painter.disc(centre, flat_radius(scene, circle));
                painter.ring(centre, circle.radius);
            } else {
                painter.cylinder(centre, circle.radius, foot);
            }
        }
        None => scene.held.iter().for_each(|held| painter.pin(positions[held.node])),
    }
    painter.cloth(&scene.mesh, positions);
    painter
}

/// Head and foot of a support: it stands a little lower than the sheet hangs.
fn stand(scene: &Scene, circle: Circle, view: &View, positions: &[Vector3<f64>]) -> [Vector3<f64>; 2] {
    let held = scene.held.iter().map(|held| positions[held.node]);
    let head = held.sum::<Vector3<f64>>() / scene.held.len().max(1) as f64;
    let lowest = positions.iter().map(|p| (head - p).dot(&view.upright)).fold(0.0, f64::max);
    [head, head - (lowest + 0.5 * circle.radius) * view.upright]
}

/// How far the sheet reaches from a support's middle when it lies flat.
fn flat_radius(scene: &Scene, circle: Circle) -> f64 {
    scene.mesh.material.iter().map(|m| (m - circle.centre).norm()).fold(0.0, f64::max)
}

/// The first, those at a third and two thirds, the last.
fn chosen(frames: usize) -> Vec<usize> {
    let last = frames.saturating_sub(1);
    let mut chosen = vec![0, last / 3, 2 * last / 3, last];
    chosen.dedup();
    chosen
}

fn title(frame: &Frame) -> String {
    frame.time.map_or("at rest".into(), |time| format!("{time:.2} s"))
}

/// A length of 1, 2 or 5 of some unit, about a quarter of a panel.
fn scale_bar<B: DrawingBackend>(
    area: &DrawingArea<B, plotters::coord::Shift>,
    scale: f64,
    y: f64,
) -> Drawn<()>
where
    B::ErrorType: 'static,
{
    let about = 0.3 * WIDTH / scale;
    let decade = 10f64.powf(about.log10().floor());
    let length =
        [5.0, 2.0, 1.0].into_iter().map(|n| n * decade).find(|length| *length <= about).unwrap_or(decade);
    let name = if length < 1.0 { format!("{:.0} mm", 1e3 * length) } else { format!("{length} m") };
    let [from, to] = [MARGIN, MARGIN + length * scale].map(|x| x.round() as i32);
    let y = y as i32;
    let line = |points: Vec<(i32, i32)>| PathElement::new(points, TEXT.stroke_width(3));
    area.draw(&line(vec![(from, y), (to, y)]))?;
    for x in [from, to] {
        area.draw(&line(vec![(x, y - 8), (x, y + 8)]))?;
    }
    let style = ("sans-serif", 28).into_font().color(&TEXT).pos(Pos::new(HPos::Left, VPos::Center));
    area.draw(&Text::new(name, (to + 16, y), style))?;
    Ok(())
}
