//! Profiles of a sheet over a table's edge in every frame, measured on top of simulated.

use super::chart::{Axes, figure_to_scale};
use super::drawing::Drawn;
use super::palette::{GREY, MEASURED, MODEL};
use crate::shown::Profile;
use plotters::style::Color;

/// # Errors
/// No profile.
pub(super) fn draw(title: &str, profiles: &[Profile]) -> Drawn<String> {
    let [measured, simulated] = [
        profiles.iter().flat_map(|profile| pieces(&profile.measured)).collect::<Vec<_>>(),
        profiles.iter().flat_map(|profile| pieces(&profile.simulated)).collect(),
    ];
    let points = || measured.iter().chain(&simulated).flatten();
    if points().next().is_none() {
        return Err("no profiles".into());
    }
    let bound = |axis: fn(&(f64, f64)) -> f64, rule: fn(f64, f64) -> f64| points().map(axis).fold(0.0, rule);
    let [left, right] = [bound(|p| p.0, f64::min), bound(|p| p.0, f64::max)];
    let [low, high] = [bound(|p| p.1, f64::min), bound(|p| p.1, f64::max)];
    let space = 0.05 * (right - left).max(high - low);
    let thick = 0.6 * space;
    let axes = Axes {
        title,
        x: ("beyond the edge [mm]", left - space..right + space),
        y: ("above the table [mm]", low - space..high + space),
    };
    figure_to_scale(axes, |chart| {
        let table = vec![(left, 0.0), (0.0, 0.0), (0.0, -thick), (left, -thick)];
        chart.areas([table], GREY.mix(0.35), "table");
        chart.paths(simulated.clone(), MODEL.stroke_width(8), "model");
        chart.paths(measured.clone(), MEASURED.stroke_width(2), "measured");
    })
}

/// Pieces of a profile, mm, split where no node was observed.
fn pieces(profile: &[[Option<f64>; 2]]) -> impl Iterator<Item = Vec<(f64, f64)>> + '_ {
    let place = |point: &[Option<f64>; 2]| Some((1e3 * point[0]?, 1e3 * point[1]?));
    let pieces = profile.split(move |point| place(point).is_none());
    pieces
        .map(move |piece| piece.iter().filter_map(place).collect())
        .filter(|piece: &Vec<_>| !piece.is_empty())
}
