//! A scene simulated: in motion, or straight to rest.

use crate::drape::{Drape, drape};
use crate::droop::{Droop, droop};
use crate::scene::{Measure, Scene};
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

/// A shape that is kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// s since the start; `None` for the shape at rest, which takes no time.
    pub time: Option<f64>,
    /// From the scene's [`origin`](Scene::origin), m.
    pub positions: Vec<Vector3<f64>>,
}

/// A step of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// s.
    pub time: f64,
    /// After the step.
    pub energies: Energies,
    /// How it went; `None` for the start.
    pub step: Option<Step>,
}

/// How a simulation ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// At rest, or short of it.
    Rest(Descent),
    /// After its duration, or before.
    Motion {
        /// Steps taken.
        steps: usize,
        /// Steps whose equation was not solved to the tolerance.
        not_converged: usize,
        /// The step, from 1, that led to numbers that are not finite.
        stopped: Option<usize>,
    },
}

/// What came of a scene.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    /// Components that stored energy.
    pub components: Vec<Component>,
    /// The shapes kept, the start first.
    pub frames: Vec<Frame>,
    /// Every step of a motion, the start first; nothing of a shape at rest.
    pub rows: Vec<Row>,
    /// How it ended.
    pub end: End,
    /// What helped its solves along, and how much of the last shape lies beyond its curves.
    pub interventions: Interventions,
    /// The force that each hold exerts on the sheet at rest, N; nothing of a motion.
    pub holds: Vec<Vector3<f64>>,
    /// How far the sheet hangs down at the end, where the scene asks for it.
    pub droop: Option<Droop>,
    /// The shadow of the drape at the end, where the scene asks for it.
    pub drape: Option<Drape>,
    /// Wall time.
    pub elapsed: Duration,
}

impl Simulation {
    /// All that was asked for was reached.
    pub fn converged(&self) -> bool {
        match self.end {
            End::Rest(descent) => descent.equilibrium.converged(),
            End::Motion { not_converged, stopped, .. } => not_converged == 0 && stopped.is_none(),
        }
    }

    /// The last shape.
    pub fn last(&self) -> &[Vector3<f64>] {
        self.frames.last().map_or(&[], |frame| &frame.positions)
    }
}

/// Lets the scene's sheet down to rest.
///
/// * `watch` — is told how many steps were taken
///
/// # Errors
/// A sheet that nothing holds, a component that the material lacks, or what the mechanics refuses.
pub fn to_rest(scene: &Scene, material: &Material, watch: &mut dyn FnMut(usize)) -> Result<Simulation> {
    let clock = Instant::now();
    let components = scene.components(material)?;
    let cloth = scene.cloth(material, &components, true)?;
    let mut x = scene.start.clone();
    let settings = descent::Settings::default();
    let descent = descend(&cloth, &material.curves, &mut x, &settings, &mut |step, _| watch(step))
        .map_err(|defect| scene.explain(defect))?;
    let (mut gradient, mut scale) = (vec![0.0; x.len()], ForceScale::new(cloth.nodes()));
    cloth.gradient(&material.curves, &x, &mut gradient, &mut scale);
    let frames = vec![
        Frame { time: Some(0.0), positions: points(&scene.start) },
        Frame { time: None, positions: points(&x) },
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

/// Follows the scene's sheet in time; one that leads to numbers that are not finite stops at its last good state.
///
/// * `duration` — s
/// * `watch` — is told how many steps were taken, and of how many
///
/// # Errors
/// A component that the material lacks, a step beyond its limit, or what else the mechanics refuses.
pub fn in_motion(
    scene: &Scene,
    material: &Material,
    duration: f64,
    watch: &mut dyn FnMut(usize, usize),
) -> Result<Simulation> {
    let clock = Instant::now();
    let components = scene.components(material)?;
    let cloth: Cloth = scene.cloth(material, &components, false)?;
    let mut motion = Motion::new(&cloth, &material.curves, scene.start.clone(), &scene.dynamics)
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
            frames.push(Frame { time: Some(motion.time()), positions: points(motion.positions()) });
        }
        watch(number, steps);
    }
    let taken = rows.len() - 1;
    // The last good state is kept, wherever it stopped.
    if stopped.is_some() && frames.last().is_some_and(|frame| frame.time != Some(motion.time())) {
        frames.push(Frame { time: Some(motion.time()), positions: points(motion.positions()) });
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

/// * `x` — the last shape
fn interventions(cloth: &Cloth, material: &Material, remedies: Remedies, x: &[f64]) -> Interventions {
    let share = |component| (component, cloth.extrapolated(&material.curves, component, x));
    let shares = material.curves.components().map(share);
    Interventions {
        share_extrapolated: shares.filter(|(_, share)| *share > 0.0).collect(),
        ..Interventions::from(remedies)
    }
}

/// The same with what the scene measures of its last shape.
fn measured(scene: &Scene, simulation: Simulation) -> Result<Simulation> {
    let positions = simulation.last();
    let down = scene.gravity.try_normalize(0.0);
    let asked = |measure| scene.measure == Some(measure);
    if scene.measure.is_some() && down.is_none() {
        return Err(scene.invalid(
            "measure",
            "no gravity",
            "gravity_m_s2 above zero: droop and drape are downwards",
        ));
    }
    let down = down.unwrap_or(-Vector3::z());
    let held: Vec<usize> = scene.held.iter().map(|held| held.node).collect();
    let droop = asked(Measure::Droop).then(|| droop(&scene.mesh, positions, &held, down));
    let drape = scene
        .support
        .filter(|_| asked(Measure::DrapeCoefficient))
        .map(|support| drape(&scene.mesh, positions, &held, support.centre, down));
    Ok(Simulation { droop, drape, ..simulation })
}

fn points(x: &[f64]) -> Vec<Vector3<f64>> {
    x.chunks_exact(3).map(Vector3::from_column_slice).collect()
}
