//! Stress against strain, or moment against curvature, with its 95 % band and control points; below, the distribution
//! of strain over the sheet.

use super::chart::{Axes, Chart, figure_over};
use super::drawing::Drawn;
use super::palette::{GREEN, GREY, MODEL};
use crate::shown::curve_labels;
use cloth_fit::stage::report::{CurveRow, Histogram, StageReport};
use plotters::style::Color;
use std::ops::Range;

/// Only every so many samples are drawn: a line through close pixels is not smooth.
const EVERY: usize = 4;
/// A band is cut off at this multiple of the curve's stress range beyond that range.
const FARTHEST: f64 = 1.0;
/// Unvisited parts below this share of the range are not shaded.
const LEAST: f64 = 5e-3;

/// A curve in the units of its figure.
struct Plotted<'r> {
    samples: Vec<CurveRow>,
    points: Vec<CurveRow>,
    /// The strains between which the curve was observed.
    seen: [f64; 2],
    histogram: &'r Histogram,
    /// Extents of strain and stress.
    extents: [Range<f64>; 2],
    /// True if the band is cut off.
    is_cut: bool,
}

/// # Errors
/// A curve without extent.
pub(super) fn draw(stage: &StageReport) -> Drawn<String> {
    let component = stage.components[0];
    let [x, y] = curve_labels(stage.model, component);
    // Moments are small: shown in mN.
    let (y, unit, seen) = match component.is_bending() {
        true => (y.replace("[N]", "[mN]"), 1e3, "curvatures of all frames"),
        false => (y, 1.0, "strains of all frames"),
    };
    let plotted = Plotted::new(stage, unit);
    let tallest = 110.0 * plotted.histogram.shares.iter().fold(0.0, |m: f64, share| m.max(*share));
    let shares = 0.0..if tallest > 0.0 { tallest } else { 1.0 };
    let [strains, stresses] = plotted.extents.clone();
    let title = format!("{}, {}", stage.name(), stage.model);
    let axes = Axes { title: &title, x: (&x, strains), y: (&y, stresses.clone()) };
    figure_over(
        axes,
        |chart| {
            plotted.shade(chart, &stresses, "not visited");
            plotted.curve(chart);
        },
        ("share of the sheet [%]", shares.clone()),
        |chart| {
            plotted.shade(chart, &shares, "");
            plotted.bars(chart, seen);
        },
    )
}

impl<'r> Plotted<'r> {
    fn new(stage: &'r StageReport, unit: f64) -> Self {
        let in_unit = |sample: &CurveRow| CurveRow {
            stress: unit * sample.stress,
            band: sample.band.map(|band| band.map(|side| unit * side)),
            ..*sample
        };
        let all = &stage.curve.samples;
        let kept = all.iter().enumerate().filter(|(i, _)| i % EVERY == 0 || i + 1 == all.len());
        let mut samples: Vec<CurveRow> = kept.map(|(_, sample)| in_unit(sample)).collect();
        let points: Vec<CurveRow> = stage.curve.points.iter().map(in_unit).collect();
        let range = |value: fn(&CurveRow) -> f64| {
            let values = samples.iter().chain(&points).map(value);
            values.fold([0.0, 0.0], |[low, high]: [f64; 2], value| [low.min(value), high.max(value)])
        };
        let [strains, stresses] = [range(|s| s.strain), range(|s| s.stress)];
        // The band of a poorly known curve may be very wide.
        let most = FARTHEST * (stresses[1] - stresses[0]);
        let side = |sample: &CurveRow, side: usize| sample.band.map_or(0.0, |band| band[side]);
        let [low, high] = [
            samples.iter().map(|s| side(s, 0)).fold(stresses[0], f64::min),
            samples.iter().map(|s| side(s, 1)).fold(stresses[1], f64::max),
        ];
        let [lowest, highest] = [low.max(stresses[0] - most), high.min(stresses[1] + most)];
        samples.iter_mut().filter_map(|sample| sample.band.as_mut()).for_each(|band| {
            *band = band.map(|side| side.clamp(lowest, highest));
        });
        let space = 0.05 * (highest - lowest);
        let extents = [
            strains[0]..strains[1] + 0.03 * (strains[1] - strains[0]),
            if lowest < 0.0 { lowest - space } else { 0.0 }..highest + space,
        ];
        let is_cut = low < lowest || high > highest;
        Self { samples, points, seen: stage.curve.seen, histogram: &stage.curve.histogram, extents, is_cut }
    }

    /// Shades the range from rest to the last control point where it was not visited, on either side.
    fn shade(&self, chart: &mut Chart, heights: &Range<f64>, label: &str) {
        let last = self.points.iter().map(|point| point.strain).fold(0.0, f64::max);
        let [first_seen, last_seen] = self.seen;
        let (low, high) = (heights.start, heights.end);
        let unseen = [[0.0, first_seen], [last_seen, last]].into_iter();
        let areas: Vec<_> = unseen
            .filter(|[from, to]| to - from > LEAST * last)
            .map(|[from, to]| vec![(from, low), (to, low), (to, high), (from, high)])
            .collect();
        chart.areas(areas, GREY.mix(0.16), label);
    }

    fn curve(&self, chart: &mut Chart) {
        let sides = || self.samples.iter().filter_map(|s| s.band.map(|band| (s.strain, band)));
        let above = sides().map(|(strain, [_, high])| (strain, high));
        let below = sides().collect::<Vec<_>>().into_iter().rev().map(|(strain, [low, _])| (strain, low));
        let outline: Vec<_> = above.chain(below).collect();
        let label = if self.is_cut { "95 % band, cut off" } else { "95 % band" };
        chart.areas((!outline.is_empty()).then_some(outline), MODEL.mix(0.22), label);
        let place = |sample: &CurveRow| (sample.strain, sample.stress);
        let slack = LEAST * (self.seen[1] - self.seen[0]);
        let [first, last] = [self.seen[0] - slack, self.seen[1] + slack];
        let before = self.samples.iter().filter(|sample| sample.strain < first);
        let within = || self.samples.iter().filter(|sample| sample.strain >= first);
        let beyond = self.points.iter().filter(|point| point.strain > last);
        let before: Vec<_> = before.chain(within().next()).map(place).collect();
        let beyond: Vec<_> = self.samples.last().into_iter().chain(beyond).map(place).collect();
        let unseen = [before, beyond].into_iter().filter(|unseen| unseen.len() > 1);
        for (unseen, label) in unseen.zip(["fit, extrapolated", ""]) {
            chart.dashes(unseen, MODEL.stroke_width(3), label);
        }
        chart.paths([within().map(place).collect()], MODEL.stroke_width(4), "fit");
        chart.dots(self.points.iter().map(place), (8, MODEL.filled()), "control points");
    }

    fn bars(&self, chart: &mut Chart, label: &str) {
        let Histogram { range: [from, to], shares } = self.histogram;
        let wide = (to - from) / shares.len().max(1) as f64;
        let shown = shares.iter().enumerate().filter(|(_, share)| **share > 0.0);
        let bars = shown.map(|(index, share)| {
            let [left, right] = [index, index + 1].map(|i| from + wide * i as f64);
            vec![(left, 0.0), (right, 0.0), (right, 100.0 * share), (left, 100.0 * share)]
        });
        chart.areas(bars, GREEN.mix(0.7), label);
    }
}
