//! Cases 28 to 31: motion with steps too long or too short, over many steps, and with overflow.

use crate::balance::larger;
use crate::property::for_all;
use crate::table::{Extent, Row};
use cloth_sim::cloth::Cloth;
use cloth_sim::dynamics::{Damping, Integrator, LinearSolver, Motion, Newton, Settings, Status, stable_step};
use cloth_sim::equilibrium::{self, Solver, Tolerance};
use cloth_sim::error::Error;
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::Diagonals;
use cloth_sim::samples::{self, GRAVITY, SIDE, Sample};
use nalgebra::Vector3;

/// A horizontal square held at two corners, flat but for a micrometre.
fn hung(model: Model, nodes: usize, stiffness: f64) -> Sample {
    let curves = samples::fabric(model, [500.0 * stiffness, 50.0 * stiffness, 1e-6 * stiffness]).unwrap();
    let mut sample = Sample::at_rest(samples::square(nodes, Diagonals::Alternating).unwrap(), model, curves);
    sample.gravity = Vector3::new(0.0, 0.0, -GRAVITY);
    sample.hold(|p| (p.y > 0.999 * SIDE && (p.x == 0.0 || p.x > 0.999 * SIDE)).then_some(0));
    sample.perturb(1e-6);
    sample
}

fn in_motion(sample: &Sample) -> Cloth {
    let components: Vec<Component> = sample.curves.components().collect();
    Cloth::in_motion(&sample.problem(&components, &[])).unwrap()
}

fn runge_kutta(step: f64, damping: Damping) -> Settings {
    Settings { step, integrator: Integrator::RungeKutta, damping, wind: None }
}

/// Runge–Kutta 1 % beyond its step limit is refused, and the message states the limit; 10 % below it, the energy of
/// small motions does not grow. (Weight that stretches the cloth lowers the limit.)
pub(crate) fn case_28(extent: Extent) -> Vec<Row> {
    let dampings = [
        ("undamped", Damping::default()),
        ("damped by mass", Damping { mass: 3.0, stiffness: 0.0 }),
        ("damped by stiffness", Damping { mass: 0.0, stiffness: 1e-3 }),
    ];
    let rows = Model::ALL.into_iter().flat_map(|model| dampings.map(|damping| (model, damping)));
    rows.map(|(model, (name, damping))| {
        let row = Row::new(28, format!("{model}, {name}"));
        let inputs = (-3.0..9.0, 3..6usize, 1.01..100.0);
        for_all(row, extent.runs(3, 100), inputs, |row, (decade, nodes, times): (f64, usize, f64)| {
            let mut sample = hung(model, nodes, 10f64.powf(decade));
            sample.gravity = Vector3::zeros();
            let cloth = in_motion(&sample);
            let limit = stable_step(&cloth, &sample.curves, &sample.start, &damping);
            let motion = |share: f64| {
                let settings = runge_kutta(share * limit, damping);
                Motion::new(&cloth, &sample.curves, sample.start.clone(), &settings)
            };
            let refused = motion(times).err();
            let just_beyond = motion(1.01).is_err();
            let said =
                refused.as_ref().is_some_and(|error| error.to_string().contains(&format!("{limit:.3e}")));
            let named = refused == Some(Error::UnstableStep { step: times * limit, limit });
            let mut kept = motion(0.9).unwrap();
            let start = kept.energies().total();
            let done = (0..200).all(|_| kept.step().status == Status::Done);
            let found = kept.energies();
            let scale = found.kinetic.max(found.elastic).max(found.weight.abs());
            let gained = found.total() - start > 1e-3 * scale;
            row.holds(just_beyond && said && named && done && !gained, || {
                format!("× 1e{decade:.2}, {nodes} nodes, {times:.3}: {refused:?}, limit {limit:e}, {found:?}")
            })
        })
    })
    .collect()
}

/// Implicit Euler at any step size: energy never exceeds that at the start. Gains in single steps are counted.
pub(crate) fn case_29(extent: Extent) -> Vec<Row> {
    let steps = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0];
    let rows = Model::ALL.into_iter().flat_map(|model| steps.map(|step| (model, step)));
    rows.map(|(model, step)| {
        let row = Row::measured(29, format!("{model}, h = {step:e} s"), "gain of energy", 1e-6);
        let counted = std::cell::Cell::new([0; 3]);
        let inputs = (-3.0..6.0, 4..7usize);
        let mut row = for_all(row, extent.runs(1, 8), inputs, |row, (decade, nodes): (f64, usize)| {
            let sample = hung(model, nodes, 10f64.powf(decade));
            let settings = Settings { step, ..Settings::default() };
            let gains = Gains::of(&sample, &settings, extent.runs(50, 1_000));
            let [single, unsolved, all] = counted.get();
            counted.set([single + gains.single, unsolved + gains.unsolved, all + gains.steps]);
            row.iterations = row.iterations.max(gains.iterations);
            row.measure(gains.largest, || format!("× 1e{decade:.2}, {nodes} nodes, {gains:?}"))
        });
        let [single, unsolved, all] = counted.get();
        row.condition += &format!("; of {all} steps {single} gain, {unsolved} are said not to be solved");
        row
    })
    .collect()
}

#[derive(Debug, Default)]
struct Gains {
    /// Total energy above the initial one, over the largest kinetic, elastic or weight energy so far.
    largest: f64,
    /// Steps that gained energy by more than rounding.
    single: u32,
    /// Steps reported as not solved to the tolerance.
    unsolved: u32,
    steps: u32,
    iterations: usize,
}

impl Gains {
    fn of(sample: &Sample, settings: &Settings, steps: u32) -> Self {
        let cloth = in_motion(sample);
        let mut motion = Motion::new(&cloth, &sample.curves, sample.start.clone(), settings).unwrap();
        let start = motion.energies();
        let mut gains = Self { steps, ..Self::default() };
        let mut scale = f64::MIN_POSITIVE;
        for _ in 0..steps {
            let before = motion.energies().total();
            let step = motion.step();
            gains.iterations = gains.iterations.max(step.newton_iterations);
            if step.status == Status::NotFinite {
                gains.largest = f64::NAN;
                break;
            }
            gains.unsolved += u32::from(step.status == Status::NotConverged);
            let now = motion.energies();
            gains.single += u32::from(now.total() > before + 1e-9 * scale);
            scale = scale.max(now.kinetic).max(now.elastic).max((now.weight - start.weight).abs());
            gains.largest = larger(gains.largest, (now.total() - start.total()) / scale);
        }
        gains
    }
}

/// Non-finite numbers during a run: the step is reported, and the last good state is kept.
pub(crate) fn case_30(extent: Extent) -> Vec<Row> {
    Model::ALL
        .map(|model| {
            let row = Row::new(30, format!("{model}, thrown so fast that Runge–Kutta breaks"));
            let inputs = (3.0..150.0, -2.0..2.0, 3..6usize);
            for_all(row, extent.runs(10, 1_000), inputs, |row, (speed, decade, nodes): (f64, f64, usize)| {
                let sample = hung(model, nodes, 10f64.powf(decade));
                breaks(row, &sample, 10f64.powf(speed))
            })
        })
        .into()
}

fn breaks(row: &mut Row, sample: &Sample, speed: f64) -> bool {
    let cloth = in_motion(sample);
    let damping = Damping::default();
    let limit = stable_step(&cloth, &sample.curves, &sample.start, &damping);
    // Alternating velocities at neighbouring nodes.
    let thrown = |i: usize| if (i / 3).is_multiple_of(2) { speed } else { -speed };
    let velocities = (0..sample.start.len()).map(thrown).collect();
    let settings = runge_kutta(0.9 * limit, damping);
    let start = sample.start.clone();
    let mut motion = Motion::with_velocities(&cloth, &sample.curves, start, velocities, &settings).unwrap();
    let mut good = (0, motion.time(), motion.positions().to_vec(), motion.energies());
    for number in 1..=2_000 {
        if motion.step().status != Status::NotFinite {
            good = (number, motion.time(), motion.positions().to_vec(), motion.energies());
            continue;
        }
        let (steps, time, positions, energies) = good;
        let finite = motion.positions().iter().chain(motion.velocities()).all(|value| value.is_finite());
        let kept = motion.positions() == positions && motion.time() == time && motion.energies() == energies;
        // The time agrees with the step number; trying again changes nothing.
        let counted = (time / settings.step).round() as usize == steps && number == steps + 1;
        let again = motion.step().status == Status::NotFinite && motion.positions() == positions;
        return row.holds(finite && kept && counted && again, || format!("{speed:e} m/s, step {number}"));
    }
    // At a low speed it stays finite, which is all that is required.
    let finite = motion.positions().iter().all(|value| value.is_finite());
    row.holds(finite, || format!("{speed:e} m/s: not finite, not said"))
}

/// At rest for a million steps: the cloth does not drift.
pub(crate) fn case_31(extent: Extent) -> Vec<Row> {
    let [many, fewer] = [1_000_000, 100_000].map(|full| extent.runs(500, full));
    let implicit = |newton, linear| Integrator::ImplicitEuler { newton, linear };
    let gradients = LinearSolver::ConjugateGradient { tolerance: 1e-10, max_iterations: 1_000 };
    let newton = Newton::default();
    let integrators = [
        ("implicit Euler", implicit(newton, LinearSolver::Direct), many),
        ("Runge–Kutta", Integrator::RungeKutta, many),
        ("implicit Euler by conjugate gradients", implicit(newton, gradients), fewer),
        ("implicit Euler linearised once", implicit(Newton::Single, LinearSolver::Direct), fewer),
    ];
    let rows = integrators.into_iter().flat_map(|of| Model::ALL.map(|model| (model, of)));
    rows.map(|(model, (name, integrator, steps))| {
        let mut row = Row::measured(31, format!("{model}, {name}, {steps} steps"), "drift, m", 1e-9);
        let found = drift(model, integrator, steps);
        row.measure(found.unwrap_or(f64::NAN), || format!("{found:?} m"));
        row
    })
    .collect()
}

/// Largest displacement of a node after so many steps; `None` if a step fails.
fn drift(model: Model, integrator: Integrator, steps: u32) -> Option<f64> {
    let mut sample = samples::hanging_sheet(model, 3).unwrap();
    let cloth = sample.cloth().unwrap();
    let exact =
        equilibrium::Settings { tolerance: Tolerance::Relative(1e-12), ..equilibrium::Settings::default() };
    let found = Solver::new(&cloth).solve(&sample.curves, &mut sample.start, &exact);
    if !found.converged() {
        return None;
    }
    let limit = stable_step(&cloth, &sample.curves, &sample.start, &Damping::default());
    let step = if integrator == Integrator::RungeKutta { 0.5 * limit } else { 0.01 };
    let settings = Settings { step, integrator, ..Settings::default() };
    let mut motion = Motion::new(&cloth, &sample.curves, sample.start.clone(), &settings).unwrap();
    for _ in 0..steps {
        if motion.step().status != Status::Done {
            return None;
        }
    }
    let moved = motion.positions().iter().zip(&sample.start).map(|(now, before)| (now - before).abs());
    Some(moved.fold(0.0, larger))
}
