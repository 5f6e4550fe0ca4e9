//! Shapes of a simulated sheet, side by side.

use super::drawing::Drawn;
use super::painter::Painter;
use super::picture::{self, Picture};
use super::view::View;
use cloth_scene::scene::{Circle, Scene, ShapeMeasure};
use cloth_scene::simulation::{End, Frame, Simulation};
use nalgebra::Vector3;

/// Width of a panel, in pixels.
const WIDTH: f64 = 560.0;

/// Shapes at the start, a third, two thirds and the end; for a drape, the last from the side and from above.
pub(super) fn draw(scene: &Scene, simulation: &Simulation) -> Drawn<String> {
    let support = scene.support.filter(|_| scene.measure == Some(ShapeMeasure::DrapeCoefficient));
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
        // The flat disc at the start shows nothing.
        panels.remove(0);
        panels.extend(simulation.frames.last().map(|last| ("from above".into(), view.above(), last)));
    }
    let pictures: Vec<Picture<'_>> = panels
        .into_iter()
        .map(|(title, view, frame)| Picture {
            title,
            view,
            points: seen(scene, support, &view, frame),
            paint: Box::new(move |painter| sheet(painter, scene, support, &view, &frame.positions)),
        })
        .collect();
    picture::draw("", WIDTH, &pictures, None)
}

/// Points that must be visible in a picture.
fn seen(scene: &Scene, support: Option<Circle>, view: &View, frame: &Frame) -> Vec<Vector3<f64>> {
    let mut points = frame.positions.clone();
    if let Some(circle) = support {
        let [head, foot] = stand(scene, circle, view, &frame.positions);
        points.push(foot);
        if view.is_from_above() {
            let flat = flat_radius(scene, circle);
            points.extend(view.level().into_iter().flat_map(|side| [head + flat * side, head - flat * side]));
        }
    }
    points
}

/// Paints one panel.
fn sheet(
    painter: &mut Painter<'_>,
    scene: &Scene,
    support: Option<Circle>,
    view: &View,
    positions: &[Vector3<f64>],
) {
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
}

/// Top and foot of a support; the foot is slightly below the sheet's lowest point.
fn stand(scene: &Scene, circle: Circle, view: &View, positions: &[Vector3<f64>]) -> [Vector3<f64>; 2] {
    let held = scene.held.iter().map(|held| positions[held.node]);
    let head = held.sum::<Vector3<f64>>() / scene.held.len().max(1) as f64;
    let lowest = positions.iter().map(|p| (head - p).dot(&view.upright)).fold(0.0, f64::max);
    [head, head - (lowest + 0.5 * circle.radius) * view.upright]
}

/// Radius of the flat sheet around the centre of a support.
fn flat_radius(scene: &Scene, circle: Circle) -> f64 {
    scene.mesh.material.iter().map(|m| (m - circle.centre).norm()).fold(0.0, f64::max)
}

/// Indices of the first frame, those at a third and two thirds, and the last.
fn chosen(frames: usize) -> Vec<usize> {
    let last = frames.saturating_sub(1);
    let mut chosen = vec![0, last / 3, 2 * last / 3, last];
    chosen.dedup();
    chosen
}

fn title(frame: &Frame) -> String {
    frame.time.map_or("at rest".into(), |time| format!("{time:.2} s"))
}
