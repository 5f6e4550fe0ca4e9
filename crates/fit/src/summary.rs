//! Turns what a stage left behind into its report.

use crate::frame::Phase;
use crate::refine::Growth;
use crate::report::{CurveReport, ForceRow, Hysteresis, Sample, SequenceReport};
use crate::simulation::Simulation;
use crate::uncertainty::Covariance;
use cloth_sim::curve::StiffnessCurve;
use nalgebra::DVector;

/// The curve with its bands, over the strains that the simulation's equilibria visit.
pub(crate) fn curve_report(
    simulation: &Simulation<'_>,
    growth: Growth,
    covariance: &Covariance,
) -> CurveReport {
    let Growth { curve, outcome, domain, .. } = growth;
    let [low, high] = simulation.visited();
    let visited = [low.min(0.0), high];
    let slack = &domain.rows * &outcome.point - &domain.bounds;
    CurveReport {
        component: simulation.component(),
        samples: samples(&curve, visited, covariance),
        deviations: covariance.standard_deviations(),
        half_bands: covariance.half_bands(),
        rank: covariance.rank,
        unseen: (0..curve.len()).filter(|&i| covariance.unseen.row(i).norm() > 1e-6).collect(),
        correlated: covariance.correlated(),
        active_constraints: slack.iter().filter(|s| s.abs() <= 1e-9 * outcome.point.amax()).count(),
        visited,
        curve,
    }
}

/// Rows of a curve file.
const SAMPLES: usize = 201;

fn samples(curve: &StiffnessCurve, [low, high]: [f64; 2], covariance: &Covariance) -> Vec<Sample> {
    let mut weights = vec![0.0; curve.len()];
    (0..SAMPLES)
        .map(|i| {
            let strain = low + (high - low) * i as f64 / (SAMPLES - 1) as f64;
            let stress = curve.stress(strain);
            curve.weights(strain, &mut weights);
            let half = covariance.half_band(&DVector::from_column_slice(&weights));
            // Stress has the sign of strain: what lies beyond zero is not possible.
            let band = half.map(|half| {
                let [low, high] = [stress - half, stress + half];
                if strain >= 0.0 { [low.max(0.0), high] } else { [low, high.min(0.0)] }
            });
            Sample { strain, stiffness: curve.stiffness(strain), stress, band }
        })
        .collect()
}

/// How every sequence was met.
///
/// * `forces` — simulated along the measured components of every frame, N
pub(crate) fn sequence_reports(simulation: &Simulation<'_>, forces: &[Vec<f64>]) -> Vec<SequenceReport> {
    let mut reports: Vec<SequenceReport> = Vec::new();
    let mut sums: Vec<[f64; 4]> = Vec::new();
    let mut positions: Vec<(f64, usize)> = Vec::new();
    for ((replica, frame, x), simulated) in simulation.frames().zip(forces) {
        let at = reports.iter().position(|report| report.name == replica.name).unwrap_or_else(|| {
            let grid = &replica.specimen.grid;
            reports.push(SequenceReport {
                name: replica.name.clone(),
                kind: replica.kind,
                frames: 0,
                at_rest: replica.frames_at_rest,
                planar: replica.planar,
                nodes: [grid.columns, grid.rows],
                force_rms: 0.0,
                force_largest: 0.0,
                position_rms: None,
                outliers: Vec::new(),
                hysteresis: None,
                forces: Vec::new(),
            });
            sums.push([0.0; 4]);
            positions.push((0.0, 0));
            reports.len() - 1
        });
        let report = &mut reports[at];
        report.frames += 1;
        for (component, &cloth) in frame.forces.iter().zip(simulated) {
            // The simulated cord force: what the cloth pulls with, less the clip's weight.
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
                direction: component.direction,
                extension: frame.extension,
                measured: component.measured,
                simulated,
            });
        }
        for (observed, x) in frame.observed.iter().flat_map(|o| o.chunks_exact(3).zip(x.chunks_exact(3))) {
            let square: f64 = observed.iter().zip(x).map(|(o, x)| (o - x) * (o - x)).sum();
            if square.is_finite() {
                positions[at].0 += square;
                positions[at].1 += 1;
            }
        }
    }
    for ((report, [up, up_square, down, down_square]), (square, count)) in
        reports.iter_mut().zip(sums).zip(positions)
    {
        let squares: f64 = report.forces.iter().map(|row| (row.measured - row.simulated).powi(2)).sum();
        report.force_rms = (squares / report.forces.len() as f64).sqrt();
        report.outliers = outliers(&report.forces);
        report.position_rms = (count > 0).then(|| (square / count as f64).sqrt());
        if up_square > 0.0 && down_square > 0.0 {
            report.hysteresis = Some(Hysteresis { loading: up / up_square, unloading: down / down_square });
        }
    }
    reports
}

/// Frames whose residual stands out from its neighbours' of the same clip and direction: by more than a fiftieth of the
/// largest force, and by more than six times the robust standard deviation of such differences (Hampel 1974). A smooth
/// misfit, shared by neighbours, is none. The farthest first: it drags the fit, and others with it.
fn outliers(rows: &[ForceRow]) -> Vec<usize> {
    let largest = rows.iter().map(|row| row.measured.abs()).fold(0.0, f64::max);
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let mut frames = Vec::new();
    let mut first: Vec<&ForceRow> = Vec::new();
    for row in rows {
        if first.iter().any(|seen| seen.clip == row.clip && seen.direction == row.direction) {
            continue;
        }
        first.push(row);
        let track: Vec<&ForceRow> =
            rows.iter().filter(|other| other.clip == row.clip && other.direction == row.direction).collect();
        let residual: Vec<f64> = track.iter().map(|row| row.measured - row.simulated).collect();
        let apart: Vec<f64> = (0..residual.len())
            .map(|i| {
                let around = i.saturating_sub(2)..(i + 3).min(residual.len());
                (residual[i] - median(residual[around].to_vec())).abs()
            })
            .collect();
        let limit = (6.0 * 1.4826 * median(apart.clone())).max(0.02 * largest);
        frames.extend(track.iter().map(|row| row.frame).zip(apart).filter(|(_, apart)| *apart > limit));
    }
    frames.sort_by(|(_, a), (_, b): &(usize, f64)| b.total_cmp(a));
    let mut found: Vec<usize> = Vec::new();
    for (frame, _) in frames {
        if !found.contains(&frame) {
            found.push(frame);
        }
    }
    found
}
