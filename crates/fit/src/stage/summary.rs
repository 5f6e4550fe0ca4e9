//! Builds the report of a stage.

use super::average::Finer;
use super::growth::Growth;
use super::report::{CurveReport, CurveRow, ForceRow, Histogram, Hysteresis, SequenceReport};
use super::shapes::Shapes;
use crate::equilibria::{Equilibria, Settled, Unknown};
use crate::optimise::uncertainty::{Covariance, Source};
use cloth_data::frame::Phase;
use cloth_sim::bending::Rolled;
use cloth_sim::curve::StiffnessCurve;
use nalgebra::DVector;
use std::collections::BTreeMap;

/// The curve with its bands, over the strains of the simulation's equilibria.
pub(crate) fn curve_report(
    simulation: &Equilibria<'_>,
    unknown: Unknown,
    growth: Growth,
    covariance: &Covariance,
    observed: bool,
) -> CurveReport {
    let Growth { outcome, domain, average, .. } = growth;
    let visited @ [low, high] = simulation.visited(&unknown);
    // A curve starts at rest, even if the observed part starts later.
    let range = [low.min(0.0), high];
    let slack = &domain.rows * &outcome.point - &domain.bounds;
    let rolled = rolled(simulation, &unknown);
    let strains = simulation.strains(&unknown);
    let curve = unknown.curve;
    let last = curve.strains()[curve.len() - 1];
    let finer = average.and_then(|average| average.finer);
    let rows = Rows { curve: &curve, covariance, finer: finer.as_ref(), rolled };
    let seen = visited.map(|strain| rows.place(strain));
    let mut samples = rows.over(range);
    samples.iter_mut().filter(|sample| sample.strain < seen[0]).for_each(|sample| sample.band = None);
    let band = rows.parts(&samples);
    CurveReport {
        observed,
        band,
        points: curve.strains().iter().map(|&strain| rows.at(rows.place(strain))).collect(),
        samples,
        histogram: rows.histogram(range, &strains),
        deviations: covariance.standard_deviations(),
        half_bands: covariance.half_bands(),
        rank: covariance.rank,
        unseen: (0..curve.len()).filter(|&i| covariance.unseen.row(i).norm() > 1e-6).collect(),
        correlations: covariance.correlations(),
        active_constraints: slack.iter().filter(|s| s.abs() <= 1e-9 * outcome.point.amax()).count(),
        visited,
        seen,
        share_visited: if last > 0.0 { ((high - low.max(0.0)) / last).min(1.0) } else { 1.0 },
        curve,
    }
}

/// Relation of the fitted bending elements to a rolled sheet; `None` for stretch and shear.
fn rolled(simulation: &Equilibria<'_>, unknown: &Unknown) -> Option<Rolled> {
    let component = *unknown.components.first()?;
    simulation.settled().find_map(|s| s.replica.cloth(s.frame).bending()?.rolled(component))
}

/// Number of rows of a curve file.
const SAMPLES: usize = 201;

/// Number of bins of a histogram.
const BINS: usize = 40;

/// A curve in the units of its file: over strain, or over curvature.
struct Rows<'a> {
    curve: &'a StiffnessCurve,
    covariance: &'a Covariance,
    /// The curve with twice as many segments.
    finer: Option<&'a Finer>,
    rolled: Option<Rolled>,
}

/// Derivatives of the stress by the control values.
fn weights(curve: &StiffnessCurve, strain: f64) -> DVector<f64> {
    let mut weights = vec![0.0; curve.len()];
    curve.weights(strain, &mut weights);
    DVector::from_vec(weights)
}

impl Rows<'_> {
    /// Equidistant rows over a range of strains.
    fn over(&self, range: [f64; 2]) -> Vec<CurveRow> {
        let [low, high] = range.map(|strain| self.place(strain));
        (0..SAMPLES).map(|i| self.at(low + (high - low) * i as f64 / (SAMPLES - 1) as f64)).collect()
    }

    /// Distribution of strains within a range.
    ///
    /// * `strains` — strains, each with its area
    fn histogram(&self, range: [f64; 2], strains: &[[f64; 2]]) -> Histogram {
        let range @ [low, high] = range.map(|strain| self.place(strain));
        let all: f64 = strains.iter().map(|[_, area]| area).sum();
        let mut shares = vec![0.0; BINS];
        for [strain, area] in strains {
            let bin = (BINS as f64 * (self.place(*strain) - low) / (high - low)).floor();
            // Non-finite strains are in no bin either.
            if (0.0..BINS as f64).contains(&bin) {
                shares[bin as usize] += area / all;
            }
        }
        Histogram { range, shares }
    }

    /// The strain, or its curvature.
    fn place(&self, strain: f64) -> f64 {
        self.rolled.map_or(strain, |rolled| rolled.curvature(strain))
    }

    fn weights(&self, strain: f64) -> DVector<f64> {
        weights(self.curve, strain)
    }

    /// Distance to the finer curve beyond what noise makes, at most half a segment away: what the control points may not
    /// follow. (The difference of two curves, one within the other, varies by the difference of their variances.)
    fn beyond(&self, strain: f64) -> f64 {
        let Some(Finer { curve, covariance, .. }) = self.finer else { return 0.0 };
        let last = self.curve.strains()[self.curve.len() - 1];
        let segment = last / (self.curve.len() - 1) as f64;
        let at = |place: f64| {
            let fine = weights(curve, place);
            let own = self.covariance.noise(&self.weights(place));
            let chance = ((fine.transpose() * covariance * &fine)[0] - own).max(0.0);
            ((curve.stress(place) - self.curve.stress(place)).powi(2) - chance).max(0.0).sqrt()
        };
        let around = (-4..=4).map(|i| (strain.abs() + 0.125 * f64::from(i) * segment).clamp(0.0, last));
        around.map(at).fold(0.0, f64::max)
    }

    /// The band by source where it is widest.
    fn parts(&self, samples: &[CurveRow]) -> BTreeMap<Source, f64> {
        let half = |row: &CurveRow| row.band.map_or(0.0, |[low, high]| high - low);
        let Some(widest) = samples.iter().max_by(|a, b| half(a).total_cmp(&half(b))) else {
            return BTreeMap::new();
        };
        let strain = self.rolled.map_or(widest.strain, |rolled| rolled.strain(widest.strain));
        let lever = self.rolled.map_or(1.0, |rolled| rolled.lever(widest.strain));
        let mut parts = self.covariance.half_bands_by_source(&self.weights(strain));
        if self.finer.is_some() && !parts.is_empty() {
            parts.insert(Source::Curve, self.beyond(strain));
        }
        parts.values_mut().for_each(|half| *half *= lever);
        parts.retain(|_, half| *half > 0.0);
        parts
    }

    fn at(&self, place: f64) -> CurveRow {
        let (curve, rolled) = (self.curve, self.rolled);
        let strain = rolled.map_or(place, |rolled| rolled.strain(place));
        let lever = rolled.map_or(1.0, |rolled| rolled.lever(place));
        let stress = lever * curve.stress(strain);
        let half =
            self.covariance.half_band(&self.weights(strain)).map(|half| half.hypot(self.beyond(strain)));
        // Stress has the sign of strain: the part of the band beyond zero is impossible.
        let band = half.map(|half| {
            let [low, high] = [stress - lever * half, stress + lever * half];
            if strain >= 0.0 { [low.max(0.0), high] } else { [low, high.min(0.0)] }
        });
        let stiffness = match rolled {
            None | Some(Rolled::Hinges) if place == 0.0 => {
                curve.stiffness(0.0) * rolled.map_or(1.0, |rolled| rolled.strain(1.0))
            }
            // Ring-2 springs do not resist the first bend.
            Some(Rolled::Springs { .. }) if place == 0.0 => 0.0,
            _ => stress / place,
        };
        CurveRow { strain: place, stiffness, stress, band }
    }
}

/// The reports of all sequences.
///
/// * `forces` — simulated forces along the measured components of every frame, N
pub(crate) fn sequence_reports(simulation: &Equilibria<'_>, forces: &[Vec<f64>]) -> Vec<SequenceReport> {
    let mut reports: Vec<SequenceReport> = Vec::new();
    let mut sums: Vec<[f64; 4]> = Vec::new();
    let mut positions: Vec<(f64, usize)> = Vec::new();
    // Frames, each with the distance of its shape, and with its rise by the slope at a table's edge.
    let [mut shapes, mut rises]: [Vec<Vec<(usize, f64)>>; 2] = Default::default();
    for (settled, simulated) in simulation.settled().zip(forces) {
        let Settled { replica, frame, x, edge, multi_stable, correction } = settled;
        let at = reports.iter().position(|report| report.name == replica.name).unwrap_or_else(|| {
            let grid = &replica.specimen.grid;
            reports.push(SequenceReport {
                name: replica.name.clone(),
                kind: replica.kind,
                frames: 0,
                skipped: replica.skipped.clone(),
                planar: replica.planar,
                nodes: [grid.columns, grid.rows],
                force_rms: None,
                force_largest: 0.0,
                extension: 0.0,
                position_rms: None,
                outliers: Vec::new(),
                multi_stable: Vec::new(),
                hysteresis: None,
                forces: Vec::new(),
                shapes: Shapes::of(replica),
            });
            sums.push([0.0; 4]);
            positions.push((0.0, 0));
            shapes.push(Vec::new());
            rises.push(Vec::new());
            reports.len() - 1
        });
        let report = &mut reports[at];
        report.frames += 1;
        report.extension = report.extension.max(frame.extension);
        report.shapes.push(&settled);
        if multi_stable {
            report.multi_stable.push(frame.index);
        }
        for (component, &cloth) in frame.forces.iter().zip(simulated) {
            // The simulated cord force: the pull of the cloth less the clip's weight.
            let simulated = cloth + component.measured - component.force;
            let [up, up_square, down, down_square] = &mut sums[at];
            let branch = match frame.phase {
                Phase::Loading => Some([up, up_square]),
                Phase::Unloading => Some([down, down_square]),
                Phase::Hold => None,
            };
            if let Some([product, square]) = branch {
                *product += component.measured * simulated;
                *square += simulated * simulated;
            }
            report.force_largest = report.force_largest.max(component.measured.abs());
            report.forces.push(ForceRow {
                frame: frame.index,
                phase: frame.phase,
                clip: component.clip,
                number: component.number,
                direction: component.direction,
                world: replica.specimen.frame.rotation.inverse() * component.direction,
                extension: frame.extension,
                measured: component.measured,
                simulated,
            });
        }
        // If a frame has several equilibria, the distance to one of them means nothing (Miguel et al. 2012, §6).
        let compared = frame.points.iter().enumerate().filter(|_| !multi_stable);
        let (mut squares, mut seen) = (0.0, 0);
        let axes = frame.compared_axes();
        for (index, point) in compared {
            let off = |(number, &axis): (usize, &usize)| {
                let of_grid = correction.get(axes.len() * index + number).unwrap_or(&0.0);
                (point.position[axis] - point.placed(x, edge, axis) - of_grid).powi(2)
            };
            squares += axes.iter().enumerate().map(off).sum::<f64>();
            seen += 1;
        }
        positions[at].0 += squares;
        positions[at].1 += seen;
        if seen > 0 {
            shapes[at].push((frame.index, (squares / seen as f64).sqrt()));
        }
        if let Some(edge) = edge {
            rises[at].push((frame.index, edge.slope * frame.extension));
        }
    }
    for ((((report, [up, up_square, down, down_square]), (square, seen)), shapes), rises) in
        reports.iter_mut().zip(sums).zip(positions).zip(shapes).zip(rises)
    {
        let squares: f64 = report.forces.iter().map(|row| (row.measured - row.simulated).powi(2)).sum();
        let count = report.forces.len();
        report.force_rms = (count > 0).then(|| (squares / count as f64).sqrt());
        report.outliers = match count {
            0 => shape_outliers([&shapes, &rises], report.extension),
            _ => force_outliers(&report.forces),
        };
        report.position_rms = (seen > 0).then(|| (square / seen as f64).sqrt());
        if up_square > 0.0 && down_square > 0.0 {
            report.hysteresis = Some(Hysteresis { loading: up / up_square, unloading: down / down_square });
        }
    }
    reports
}

/// Frames whose force residual stands out from its neighbours' of the same clip and direction: by more than a
/// fiftieth of the largest force, and by the limit of [`standing_out`].
fn force_outliers(rows: &[ForceRow]) -> Vec<usize> {
    let largest = rows.iter().map(|row| row.measured.abs()).fold(0.0, f64::max);
    let mut tracks: BTreeMap<(usize, usize), Vec<(usize, f64)>> = BTreeMap::new();
    for row in rows {
        let track = tracks.entry((row.clip, row.number)).or_default();
        track.push((row.frame, row.measured - row.simulated));
    }
    farthest_first(tracks.values().flat_map(|track| standing_out(track, 0.02 * largest)).collect())
}

/// Frames whose shape is farther from the simulated one than its neighbours are, or leaves the table at another angle, by
/// more than a fiftieth of the largest overhang, and by the limit of [`standing_out`].
///
/// * `tracks` — frames with the root mean square distance of their points, and with their rise, m
fn shape_outliers(tracks: [&[(usize, f64)]; 2], overhang: f64) -> Vec<usize> {
    farthest_first(tracks.into_iter().flat_map(|track| standing_out(track, 0.02 * overhang)).collect())
}

/// Frames whose residual differs from the median of its neighbours by more than `least`, and by more than six robust
/// standard deviations of such differences (Hampel 1974); with the difference. A smooth misfit, shared by neighbours,
/// does not stand out.
fn standing_out(track: &[(usize, f64)], least: f64) -> Vec<(usize, f64)> {
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    let residual: Vec<f64> = track.iter().map(|(_, residual)| *residual).collect();
    let apart: Vec<f64> = (0..residual.len())
        .map(|i| {
            let around = i.saturating_sub(2)..(i + 3).min(residual.len());
            (residual[i] - median(residual[around].to_vec())).abs()
        })
        .collect();
    let limit = (6.0 * 1.4826 * median(apart.clone())).max(least);
    track.iter().map(|(frame, _)| *frame).zip(apart).filter(|(_, apart)| *apart > limit).collect()
}

/// Each frame once, the largest difference first: it distorts the fit and thereby other residuals.
fn farthest_first(mut frames: Vec<(usize, f64)>) -> Vec<usize> {
    frames.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    let mut found: Vec<usize> = Vec::new();
    for (frame, _) in frames {
        if !found.contains(&frame) {
            found.push(frame);
        }
    }
    found
}
