//! Simulation of a scene: in motion, or directly to rest.

use crate::drape::{Drape, drape};
use crate::droop::{Droop, droop};
use crate::scene::{Scene, ShapeMeasure};
use cloth_data::error::Result;
use cloth_fit::material::Material;
use cloth_fit::stage::interventions::Interventions;
use cloth_sim::cloth::{Cloth, ForceScale};
use cloth_sim::descent::{self, Descent, descend};
use cloth_sim::dynamics::{self, Energies, Motion, Step};
use cloth_sim::equilibrium::Remedies;
use cloth_sim::material::Component;
use nalgebra::Vector3;
use std::time::{Duration, Instant};

/// A recorded shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Time since the start, s; `None` for the shape at rest.
    pub time: Option<f64>,
    /// Positions relative to the scene's [`origin`](Scene::origin), m.
    pub positions: Vec<Vector3<f64>>,
}

/// A step of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Energies after the step.
    pub energies: Energies,
    /// Outcome of the step; `None` for the start.
    pub step: Option<Step>,
}

/// End of a simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// Descent to rest, successful or not.
    Rest(Descent),
    /// Motion, for its full duration or less.
    Motion {
        /// Steps taken.
        steps: usize,
        /// Steps whose equation was not solved to the tolerance.
        not_converged: usize,
        /// Number of the step, from 1, that led to non-finite numbers.
        stopped: Option<usize>,
    },
}

/// Result of a simulation.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    /// Components that stored energy.
    pub components: Vec<Component>,
    /// Recorded shapes, the start first.
    pub frames: Vec<Frame>,
    /// Every step of a motion, the start first; empty for a shape at rest.
    pub rows: Vec<Row>,
    /// End of the simulation.
    pub end: End,
    /// Numerical interventions, and the share of the final shape strained beyond its curves.
    pub interventions: Interventions,
    /// Force of each hold on the sheet at rest, N; empty for a motion.
    pub holds: Vec<Vector3<f64>>,
    /// Droop at the end, if the scene measures it.
    pub droop: Option<Droop>,
    /// Drape at the end, if the scene measures it.
    pub drape: Option<Drape>,
    /// Wall-clock time.
    pub elapsed: Duration,
}

impl Simulation {
    /// True if the simulation reached its goal: rest, or the full duration with every step converged.
    pub fn converged(&self) -> bool {
        match self.end {
            End::Rest(descent) => descent.equilibrium.converged(),
            End::Motion { not_converged, stopped, .. } => not_converged == 0 && stopped.is_none(),
        }
    }

    /// The final shape.
    pub fn last(&self) -> &[Vector3<f64>] {
        self.frames.last().map_or(&[], |frame| &frame.positions)
    }
}

/// Lets the scene's sheet descend to rest.
///
/// * `watch` — receives the number of steps taken
///
/// # Errors
/// A sheet that nothing holds, a component that the material lacks, or another error of the mechanics.
pub fn to_rest(scene: &Scene, material: &Material, watch: &mut dyn FnMut(usize)) -> Result<Simulation> {
    let clock = Instant::now();
    let components = scene.components(material)?;
    let cloth = scene.cloth(material, &components, true)?;
    let curves = material.curves.only(&components);
    let mut x = cloth.state(&scene.start);
    let settings = descent::Settings::default();
    let descent = descend(&cloth, &curves, &mut x, &settings, &mut |step, _| watch(step))
        .map_err(|defect| scene.explain(defect))?;
    let (mut gradient, mut scale) = (vec![0.0; x.len()], ForceScale::new(cloth.points()));
    cloth.gradient(&curves, &x, &mut gradient, &mut scale);
    let frames = vec![
        Frame { time: Some(0.0), positions: points(&scene.start) },
        Frame { time: None, positions: points(&x[..scene.start.len()]) },
    ];
    let holds = cloth.clip_forces(&gradient);
    measured(
        scene,
        Simulation {
            components,
            frames,
            rows: Vec::new(),
            end: End::Rest(descent),
            interventions: interventions(&cloth, material, descent.remedies, &x),
            holds,
            droop: None,
            drape: None,
            elapsed: clock.elapsed(),
        },
    )
}

/// Simulates the scene's sheet in time; stops at the last good state if a step leads to non-finite numbers.
///
/// * `duration` — simulated time, s
/// * `watch` — receives the number of steps taken and the total
///
/// # Errors
/// A component that the material lacks, a step beyond the stability limit, or another error of the mechanics.
pub fn in_motion(
    scene: &Scene,
    material: &Material,
    duration: f64,
    watch: &mut dyn FnMut(usize, usize),
) -> Result<Simulation> {
    let clock = Instant::now();
    let components = scene.components(material)?;
    let cloth: Cloth = scene.cloth(material, &components, false)?;
    let curves = material.curves.only(&components);
    let mut motion = Motion::new(&cloth, &curves, cloth.state(&scene.start), &scene.dynamics)
        .map_err(|defect| scene.explain(defect))?;
    let step = scene.dynamics.step;
    let steps = (duration / step).round().max(1.0) as usize;
    let every = (1.0 / (scene.frames_per_second * step)).round().max(1.0) as usize;
    let mut frames = vec![Frame { time: Some(0.0), positions: points(&scene.start) }];
    let mut rows = vec![Row { time: 0.0, energies: motion.energies(), step: None }];
    let (mut not_converged, mut stopped, mut remedies) = (0, None, Remedies::default());
    for number in 1..=steps {
        let step = motion.step();
        remedies += step.remedies;
        if step.status == dynamics::Status::NotFinite {
            stopped = Some(number);
            break;
        }
        not_converged += usize::from(step.status == dynamics::Status::NotConverged);
        rows.push(Row { time: motion.time(), energies: motion.energies(), step: Some(step) });
        if number % every == 0 || number == steps {
            frames.push(Frame {
                time: Some(motion.time()),
                positions: points(&motion.positions()[..scene.start.len()]),
            });
        }
        watch(number, steps);
    }
    let taken = rows.len() - 1;
    // Always keep the last good state.
    if stopped.is_some() && frames.last().is_some_and(|frame| frame.time != Some(motion.time())) {
        frames.push(Frame {
            time: Some(motion.time()),
            positions: points(&motion.positions()[..scene.start.len()]),
        });
    }
    measured(
        scene,
        Simulation {
            components,
            frames,
            rows,
            end: End::Motion { steps: taken, not_converged, stopped },
            interventions: interventions(&cloth, material, remedies, motion.positions()),
            holds: Vec::new(),
            droop: None,
            drape: None,
            elapsed: clock.elapsed(),
        },
    )
}

/// * `x` — the final shape
fn interventions(cloth: &Cloth, material: &Material, remedies: Remedies, x: &[f64]) -> Interventions {
    let share = |component| (component, cloth.extrapolated(&material.curves, component, x));
    let shares = material.curves.components().map(share);
    Interventions {
        share_extrapolated: shares.filter(|(_, share)| *share > 0.0).collect(),
        ..Interventions::from(remedies)
    }
}

/// Adds what the scene measures of its final shape.
fn measured(scene: &Scene, simulation: Simulation) -> Result<Simulation> {
    let positions = simulation.last();
    let down = scene.gravity.try_normalize(0.0);
    let asked = |measure| scene.measure == Some(measure);
    if scene.measure.is_some() && down.is_none() {
        return Err(scene.invalid(
            "measure",
            "no gravity",
            "nonzero gravity_m_s2: droop and drape are measured along gravity",
        ));
    }
    let down = down.unwrap_or(-Vector3::z());
    let held: Vec<usize> = scene.held.iter().map(|held| held.node).collect();
    let droop = asked(ShapeMeasure::Droop).then(|| droop(&scene.mesh, positions, &held, down));
    let drape = scene
        .support
        .filter(|_| asked(ShapeMeasure::DrapeCoefficient))
        .map(|support| drape(&scene.mesh, positions, &held, support.centre, down));
    Ok(Simulation { droop, drape, ..simulation })
}

fn points(x: &[f64]) -> Vec<Vector3<f64>> {
    x.chunks_exact(3).map(Vector3::from_column_slice).collect()
}
