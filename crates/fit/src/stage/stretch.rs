//! Stretch: one curve for weft or warp, from the clip forces of the strips pulled along it.
//!
//! Shear and bending are left out. The curve across keeps a constant stiffness: without Poisson coupling it does not
//! matter. Loading and unloading are fitted alike, so the curve runs through the mean of the hysteresis band.
//!
//! Source: Miguel et al. 2012, §5.2.

use crate::error::{Error, Result};
use crate::frame::{Kind, MeasurementSet, Phase};
use crate::gap;
use crate::gauss_newton::{Domain, Evaluation, Iteration, Options, Outcome, Residuals, minimise};
use crate::replica::Replica;
use crate::report::{CurveReport, ForceRow, Hysteresis, Level, Sample, SequenceReport, StageReport};
use crate::simulation::Simulation;
use crate::specimen::Specimen;
use crate::uncertainty::{Covariance, Scatter};
use cloth_sim::curve::{StiffnessCurve, equidistant, stability_rows};
use cloth_sim::equilibrium;
use cloth_sim::material::{Component, Compression, Curves, Model};
use cloth_sim::mesh::Diagonals;
use nalgebra::{DMatrix, DVector};
use std::time::Instant;

/// What keeps a curve physical.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Constraints {
    /// dσ/dε above a thousandth of the largest secant stiffness everywhere.
    #[default]
    Stable,
    /// Control values not negative: the published rule.
    ControlPoints,
}

/// How a stretch curve is fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// The cloth model; default StVK.
    pub model: Model,
    /// Columns and rows of the simulation's grid; default as many cells as 25×25 nodes have, near square.
    pub nodes: Option<[usize; 2]>,
    /// How its cells are split; default '/'.
    pub diagonals: Diagonals,
    /// Most control points; default 5.
    pub points: usize,
    /// What keeps the curve physical; default stable.
    pub constraints: Constraints,
    /// Compression; default with the stiffness at zero strain.
    pub compression: Compression,
    /// How equilibria are found.
    pub equilibrium: equilibrium::Settings,
    /// More control points must lower the residual by this share; default 1 %, as published.
    pub growth_gain: f64,
    /// The outer loop.
    pub outer: Options,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            model: Model::Stvk,
            nodes: None,
            diagonals: Diagonals::Forward,
            points: 5,
            constraints: Constraints::Stable,
            compression: Compression::ZeroStrain,
            equilibrium: equilibrium::Settings::default(),
            growth_gain: 0.01,
            // A share of 1e-6 of the sum of squares is far below any noise.
            outer: Options { gain_tolerance: 1e-6, max_iterations: 50, ..Options::default() },
        }
    }
}

impl Settings {
    /// Names the setting that cannot be.
    ///
    /// # Errors
    /// No control point, or more than 50; fewer than 2 nodes a side or more than 1000.
    pub fn validate(&self) -> Result<()> {
        let setting = |field, found: String, expected: &str| Err(Error::Setting { field, found, expected: expected.into() });
        if !(1..=50).contains(&self.points) {
            return setting("points", self.points.to_string(), "1 to 50 control points");
        }
        match self.nodes {
            Some(nodes) if nodes.iter().any(|side| !(3..=1000).contains(side)) => {
                setting("nodes", format!("{}x{}", nodes[0], nodes[1]), "3 to 1000 nodes a side")
            }
            _ => Ok(()),
        }
    }
}

/// What happens during a fit, for whoever watches.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// A level of the curve's growth begins.
    Level {
        /// The component.
        component: Component,
        /// Control points.
        points: usize,
    },
    /// A step was tried.
    Iteration {
        /// The step.
        iteration: &'a Iteration,
        /// Root mean square residual.
        rms: f64,
        /// Factorisations so far.
        factorisations: usize,
        /// Seconds so far.
        seconds: f64,
    },
}

/// The component that a kind of test stretches along, if it is a test of stretch.
pub fn component_of(kind: Kind) -> Option<Component> {
    match kind {
        Kind::StretchWeft => Some(Component::StretchWeft),
        Kind::StretchWarp => Some(Component::StretchWarp),
        _ => None,
    }
}

/// Fits one component on all sequences of a set that stretch along it; `None` if there are none.
///
/// # Errors
/// Bad settings; sequences that no replica can be made of; no frame with an equilibrium.
pub fn fit(
    set: &MeasurementSet,
    component: Component,
    settings: &Settings,
    observe: &mut dyn FnMut(Event<'_>),
) -> Result<Option<StageReport>> {
    settings.validate()?;
    let clock = Instant::now();
    let replicas = replicas(set, component, settings)?;
    if replicas.is_empty() {
        return Ok(None);
    }
    let negative = settings.model.negative_strain(component, settings.compression);
    let constant = |stiffness: f64, negative| StiffnessCurve::constant(stiffness, negative).map_err(mechanics(component));
    // Without any simulation: the range of strain on the blended shapes, a constant stiffness, and the largest one.
    let range = blended_range(&replicas, component);
    let free = |points| Domain::everywhere(points);
    let unit = constant(1.0, negative)?;
    let mean = gap::start(&replicas, component, &unit, &Curves::default(), &free(1))[0].max(f64::MIN_POSITIVE);
    let across = match component {
        Component::StretchWeft => Component::StretchWarp,
        _ => Component::StretchWeft,
    };
    let known = Curves::from_iter([(across, constant(mean, settings.model.negative_strain(across, settings.compression))?)]);
    let fine = StiffnessCurve::new(equidistant(settings.points, range), vec![mean; settings.points], negative)
        .map_err(mechanics(component))?;
    let positive = domain(&fine, Constraints::ControlPoints, 0.0).map_err(mechanics(component))?;
    let largest = gap::start(&replicas, component, &fine, &known, &positive).amax().max(mean);
    let lowest_tangent = 1e-3 * largest;

    let mut simulation =
        Simulation::new(&replicas, component, constant(mean, negative)?, known, settings.equilibrium);
    if simulation.frames().next().is_none() {
        let sequences: Vec<&str> = replicas.iter().map(|replica| &replica.name[..]).collect();
        return Err(Error::Geometry {
            sequence: sequences.join(", "),
            found: "no frame with an equilibrium".into(),
            expected: "clips that stretch the specimen".into(),
        });
    }
    let mut levels: Vec<Level> = Vec::new();
    let mut best: Option<(StiffnessCurve, Outcome, Domain)> = None;
    let growth = loop {
        let points = best.as_ref().map_or(1, |(curve, ..)| next_points(curve.len(), settings.points));
        let curve = match &best {
            None => simulation.curve().clone(),
            Some((curve, ..)) => {
                curve.resampled(points, simulation.visited()[1].max(f64::MIN_POSITIVE)).map_err(mechanics(component))?
            }
        };
        observe(Event::Level { component, points });
        simulation.set_curve(curve.clone());
        let domain = domain(&curve, settings.constraints, lowest_tangent).map_err(mechanics(component))?;
        let start = DVector::from_column_slice(curve.stiffnesses());
        let measurements: usize = simulation.measurements();
        let spent = simulation.counters().factorisations;
        let mut tried = 0;
        let mut watch = |iteration: &Iteration| {
            tried += 1;
            let rms = (iteration.sum_of_squares / measurements as f64).sqrt();
            observe(Event::Iteration { iteration, rms, factorisations: spent, seconds: clock.elapsed().as_secs_f64() });
        };
        let outcome = match minimise(&mut simulation, &start, &domain, &settings.outer, &mut watch) {
            Ok(outcome) => outcome,
            Err(never) => match never {},
        };
        let rms = (outcome.sum_of_squares / measurements as f64).sqrt();
        let status = outcome.status.to_string();
        levels.push(Level { points, rms, status, iterations: outcome.iterations.clone() });
        let curve = curve.with_stiffnesses(outcome.point.iter().copied().collect()).map_err(mechanics(component))?;
        if let Some((_, before, _)) = &best {
            let before = (before.sum_of_squares / measurements as f64).sqrt();
            if !(rms < (1.0 - settings.growth_gain) * before) {
                break format!(
                    "{points} control points lowered the residual by less than {:.0} %",
                    100.0 * settings.growth_gain
                );
            }
        }
        best = Some((curve, outcome, domain));
        if points >= settings.points {
            break format!("all {points} control points are in use");
        }
    };
    let Some((curve, outcome, domain)) = best else { unreachable!("the first level is always kept") };
    let converged = outcome.status.converged();
    // The states of the last trial may be those of a step that was rejected.
    simulation.set_curve(curve.clone());
    let scales = simulation.scales();
    let forces = match simulation.evaluate(&outcome.point, true) {
        Ok(Evaluation::Values { .. }) | Ok(Evaluation::Failed { .. }) => simulation.forces(),
        Err(never) => match never {},
    };
    let rank = Covariance::rank_of(&outcome.jacobian);
    let known_noise = simulation.noise_is_known().then_some(1.0);
    let scatter =
        Scatter::new(&outcome.residual, &outcome.jacobian, rank, &simulation.tracks(), known_noise);
    let covariance = Covariance::new(&outcome.jacobian, &scatter);
    let visited = simulation.visited();
    let visited = [visited[0].min(0.0), visited[1]];
    let slack = &domain.rows * &outcome.point - &domain.bounds;
    let active_constraints = slack.iter().filter(|&&s| s.abs() <= 1e-9 * outcome.point.amax()).count();
    let curve = CurveReport {
        component,
        samples: samples(&curve, visited, &covariance),
        deviations: covariance.standard_deviations(),
        rank,
        unseen: (0..curve.len()).filter(|&i| covariance.unseen.row(i).norm() > 1e-6).collect(),
        correlated: covariance.correlated(),
        active_constraints,
        visited,
        curve,
    };
    let sequences = sequence_reports(set, &simulation, &forces);
    // In newtons, where all sequences have the same noise; else in multiples of it.
    let unit = scales.iter().sum::<f64>() / scales.len() as f64;
    let scatter = Scatter {
        noise: scatter.noise * unit,
        residual: scatter.residual * unit,
        misfit: scatter.misfit * unit,
        ..scatter
    };
    Ok(Some(StageReport {
        component,
        model: settings.model,
        curve,
        scatter,
        sequences,
        dropped: simulation.dropped().to_vec(),
        levels,
        growth,
        converged,
        counters: simulation.counters(),
        seconds: clock.elapsed().as_secs_f64(),
    }))
}

/// Simulates all sequences that stretch along a component with a known curve: how well they are predicted.
///
/// # Errors
/// As [`fit`].
pub fn predict(
    set: &MeasurementSet,
    component: Component,
    curve: &StiffnessCurve,
    settings: &Settings,
) -> Result<Vec<SequenceReport>> {
    settings.validate()?;
    let replicas = replicas(set, component, settings)?;
    let across = match component {
        Component::StretchWeft => Component::StretchWarp,
        _ => Component::StretchWeft,
    };
    let negative = settings.model.negative_strain(across, settings.compression);
    let mean = curve.stiffnesses().iter().sum::<f64>() / curve.len() as f64;
    let known = Curves::from_iter([(across, StiffnessCurve::constant(mean, negative).map_err(mechanics(component))?)]);
    let mut simulation = Simulation::new(&replicas, component, curve.clone(), known, settings.equilibrium);
    let forces = simulation.forces();
    Ok(sequence_reports(set, &simulation, &forces))
}

fn mechanics(component: Component) -> impl Fn(cloth_sim::error::Error) -> Error {
    move |source| Error::Mechanics { context: component.to_string(), source }
}

fn replicas(set: &MeasurementSet, component: Component, settings: &Settings) -> Result<Vec<Replica>> {
    let parts = [Component::StretchWeft, Component::StretchWarp];
    set.sequences
        .iter()
        .filter(|sequence| component_of(sequence.kind) == Some(component))
        .map(|sequence| {
            let specimen = Specimen::new(sequence, settings.nodes, settings.diagonals)?;
            Replica::new(sequence, specimen, settings.model, &parts, set.fabric.areal_density_kg_m2)
        })
        .collect()
}

/// The largest strain on the blended shapes of all frames.
fn blended_range(replicas: &[Replica], component: Component) -> f64 {
    replicas
        .iter()
        .flat_map(|replica| replica.frames.iter().map(move |frame| (replica, frame)))
        .flat_map(|(replica, frame)| replica.cloth.strains(component, &frame.start))
        .fold(f64::MIN_POSITIVE, |largest, [strain, _]| largest.max(strain))
}

/// One, two, three, five, nine …: every segment is halved, up to the most that is wanted.
fn next_points(points: usize, most: usize) -> usize {
    if points == 1 { 2 } else { 2 * points - 1 }.min(most)
}

/// The constraints of a curve, and smoothness where data see nothing.
fn domain(curve: &StiffnessCurve, constraints: Constraints, lowest: f64) -> cloth_sim::error::Result<Domain> {
    let points = curve.len();
    let (rows, lowest) = match constraints {
        Constraints::Stable => (stability_rows(curve.strains())?, lowest),
        Constraints::ControlPoints => (DMatrix::identity(points, points), 0.0),
    };
    let second_difference = |i: usize, j: usize| match j.wrapping_sub(i) {
        0 | 2 => 1.0,
        1 => -2.0,
        _ => 0.0,
    };
    let roughness = match points {
        1 => None,
        2 => Some(DMatrix::from_row_slice(1, 2, &[1.0, -1.0])),
        _ => Some(DMatrix::from_fn(points - 2, points, second_difference)),
    };
    Ok(Domain { bounds: DVector::from_element(rows.nrows(), lowest), rows, roughness })
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

fn sequence_reports(set: &MeasurementSet, simulation: &Simulation<'_>, forces: &[Vec<f64>]) -> Vec<SequenceReport> {
    let mut reports: Vec<SequenceReport> = Vec::new();
    let mut sums: Vec<[f64; 4]> = Vec::new();
    let mut positions: Vec<(f64, usize)> = Vec::new();
    for ((replica, frame, x), simulated) in simulation.frames().zip(forces) {
        let at = reports.iter().position(|report| report.name == replica.name).unwrap_or_else(|| {
            let kind = set.sequences.iter().find(|s| s.name == replica.name).map_or(Kind::StretchWeft, |s| s.kind);
            let grid = &replica.specimen.grid;
            reports.push(SequenceReport {
                name: replica.name.clone(),
                kind,
                frames: 0,
                at_rest: replica.frames_at_rest,
                planar: replica.planar,
                nodes: [grid.columns, grid.rows],
                force_rms: 0.0,
                force_largest: 0.0,
                position_rms: None,
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
            let [product, square] = match frame.phase {
                Phase::Unloading => [down, down_square],
                _ => [up, up_square],
            };
            *product += component.measured * simulated;
            *square += simulated * simulated;
            report.force_largest = report.force_largest.max(component.measured.abs());
            report.forces.push(ForceRow {
                frame: frame.index,
                clip: component.clip,
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
    for ((report, [up, up_square, down, down_square]), (square, count)) in reports.iter_mut().zip(sums).zip(positions) {
        let squares: f64 = report.forces.iter().map(|row| (row.measured - row.simulated).powi(2)).sum();
        report.force_rms = (squares / report.forces.len() as f64).sqrt();
        report.position_rms = (count > 0).then(|| (square / count as f64).sqrt());
        if up_square > 0.0 && down_square > 0.0 {
            report.hysteresis = Some(Hysteresis { loading: up / up_square, unloading: down / down_square });
        }
    }
    reports
}
