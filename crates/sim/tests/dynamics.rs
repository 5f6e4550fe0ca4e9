//! Cloth in motion, against closed forms and other step sizes.

#![allow(clippy::unwrap_used)]

use cloth_sim::cloth::Cloth;
use cloth_sim::dynamics::{
    Damping, Integrator, LinearSolver, Motion, Newton, Settings, Status, Wind, stable_step,
};
use cloth_sim::element::HessianKind;
use cloth_sim::error::Error;
use cloth_sim::load::{Free, Guided, Held};
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::{Diagonals, Mesh};
use cloth_sim::samples::{self, GRAVITY, SIDE, Sample};
use nalgebra::{DMatrix, Vector2, Vector3};

const DIRECT: Integrator =
    Integrator::ImplicitEuler { newton: Newton::Converged { tolerance: 1e-6 }, linear: LinearSolver::Direct };

/// Settings of the integrator with a tolerance of 1e-10.
fn exact(linear: LinearSolver) -> Integrator {
    Integrator::ImplicitEuler { newton: Newton::Converged { tolerance: 1e-10 }, linear }
}

/// A horizontal square hanging from two corners, at rest.
fn hung(model: Model, nodes: usize, stiffness: f64) -> Sample {
    let curves = samples::fabric(model, [500.0 * stiffness, 50.0 * stiffness, 1e-6 * stiffness]).unwrap();
    let mesh = samples::square(nodes, Diagonals::Alternating).unwrap();
    let mut sample = Sample::at_rest(mesh, model, curves);
    sample.gravity = Vector3::new(0.0, 0.0, -GRAVITY);
    sample.hold(|p| (p.y > 0.999 * SIDE && (p.x == 0.0 || p.x > 0.999 * SIDE)).then_some(0));
    sample.perturb(1e-6);
    sample
}

/// A cloth that may be free.
fn in_motion(sample: &Sample) -> Cloth {
    let components: Vec<Component> = sample.curves.components().collect();
    Cloth::in_motion(&sample.problem(&components, &[])).unwrap()
}

/// Positions after a time.
fn after(sample: &Sample, settings: &Settings, time: f64) -> Vec<f64> {
    let cloth = in_motion(sample);
    let mut motion = Motion::new(&cloth, &sample.curves, sample.start.clone(), settings).unwrap();
    for _ in 0..(time / settings.step).round() as usize {
        assert_eq!(motion.step().status, Status::Done);
    }
    motion.positions().to_vec()
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn free_cloth_falls_as_a_stone() {
    let mut sample = hung(Model::STVK, 5, 1.0);
    sample.held.clear();
    sample.start = Sample::at_rest(sample.mesh.clone(), sample.model, sample.curves.clone()).start;
    let h = 0.01;
    for (integrator, steps, fallen) in [
        // Implicit Euler: ½ g h² n (n + 1).
        (DIRECT, 20, 0.5 * GRAVITY * h * h * 20.0 * 21.0),
        (Integrator::RungeKutta, 20_000, 0.5 * GRAVITY * 0.2 * 0.2),
    ] {
        let step = 0.2 / f64::from(steps);
        let moved = after(&sample, &Settings { step, integrator, ..Settings::default() }, 0.2);
        for (now, before) in moved.chunks_exact(3).zip(sample.start.chunks_exact(3)) {
            assert!((before[2] - now[2] - fallen).abs() < 1e-12, "{}", before[2] - now[2]);
            assert!(apart(&now[..2], &before[..2]) < 1e-12);
        }
    }
}

#[test]
fn steps_so_short_that_rounding_hides_the_weight_still_add_up() {
    let mut sample = hung(Model::STVK, 4, 1.0);
    sample.held.clear();
    sample.start = Sample::at_rest(sample.mesh.clone(), sample.model, sample.curves.clone()).start;
    let cloth = in_motion(&sample);
    let settings = Settings { step: 1e-8, ..Settings::default() };
    let mut motion = Motion::new(&cloth, &sample.curves, sample.start.clone(), &settings).unwrap();
    (0..100).for_each(|_| assert_eq!(motion.step().status, Status::Done));
    assert!((motion.greatest_speed() / (GRAVITY * 1e-6) - 1.0).abs() < 0.01, "{:e}", motion.greatest_speed());
}

#[test]
fn the_integrators_have_their_orders() {
    // Soft constraints are smooth in compression, too.
    let mut sample = hung(Model::SOFT_CONSTRAINT, 4, 0.02);
    sample.perturb(2e-3);
    let run = |integrator, step| after(&sample, &Settings { step, integrator, ..Settings::default() }, 0.02);
    let reference = run(Integrator::RungeKutta, 0.02 / 3200.0);
    for (integrator, coarse, order) in
        [(exact(LinearSolver::Direct), 0.02 / 400.0, 1.0), (Integrator::RungeKutta, 0.02 / 100.0, 4.0)]
    {
        let errors =
            [coarse, 0.5 * coarse, 0.25 * coarse].map(|step| apart(&run(integrator, step), &reference));
        for pair in errors.windows(2) {
            let found = (pair[0] / pair[1]).log2();
            assert!((found - order).abs() < 0.1, "order {found}, not {order}: {errors:?}");
        }
    }
}

#[test]
fn undamped_cloth_never_has_more_energy_than_at_the_start() {
    for model in [Model::STVK, Model::SPRINGS] {
        for stiffness in [1e-2, 1.0, 1e2, 1e4] {
            let sample = hung(model, 6, stiffness);
            let cloth = in_motion(&sample);
            for step in [1e-6, 1e-4, 1e-2, 1.0] {
                let settings = Settings { step, ..Settings::default() };
                let mut motion =
                    Motion::new(&cloth, &sample.curves, sample.start.clone(), &settings).unwrap();
                let start = motion.energies();
                let mut scale = 0.0f64;
                let mut gains = 0;
                for number in 0..1000 {
                    let before = motion.energies().total();
                    let _ = motion.step();
                    let now = motion.energies();
                    gains += usize::from(now.total() > before + 1e-9 * scale);
                    scale = scale.max(now.kinetic).max(now.elastic).max((now.weight - start.weight).abs());
                    let gain = now.total() - start.total();
                    let what = format!("{model}, stiffness × {stiffness:e}, h = {step:e} s, step {number}");
                    assert!(gain <= 1e-6 * scale, "{what}: {:.1e} of {scale:.1e} J gained", gain);
                }
                println!("{model} × {stiffness:e}, h = {step:e} s: {gains} single gains of energy");
            }
        }
    }
}

#[test]
fn the_account_of_energy_closes_as_steps_get_shorter() {
    let sample = hung(Model::STVK, 5, 0.01);
    let cloth = in_motion(&sample);
    let wind = Some(Wind { velocity: Vector3::new(0.0, 1.0, 3.0), ..Wind::default() });
    let damping = Damping { mass: 5.0, stiffness: 1e-3 };
    let lost = |integrator, step| {
        let settings = Settings { step, integrator, damping, wind };
        let mut motion = Motion::new(&cloth, &sample.curves, sample.start.clone(), &settings).unwrap();
        (0..(0.05 / step).round() as usize).for_each(|_| assert_eq!(motion.step().status, Status::Done));
        let found = motion.energies();
        assert!(found.damping > 0.0 && found.wind != 0.0);
        (found.numerical.abs(), found.damping)
    };
    let (coarse, _) = lost(DIRECT, 1e-3);
    let (fine, _) = lost(DIRECT, 2.5e-4);
    assert!(fine < 0.35 * coarse, "{coarse} {fine}");
    let (explicit, damping) = lost(Integrator::RungeKutta, 1e-5);
    assert!(explicit < 1e-6 * damping, "{explicit:e} of {damping:e} J");
}

#[test]
fn runge_kutta_is_stable_up_to_its_limit_and_refused_beyond() {
    let sample = hung(Model::STVK, 5, 1.0);
    let cloth = in_motion(&sample);
    for damping in [Damping::default(), Damping { mass: 2.0, stiffness: 1e-3 }] {
        let limit = stable_step(&cloth, &sample.curves, &sample.start, &damping);
        let settings = |share: f64| Settings {
            step: share * limit,
            integrator: Integrator::RungeKutta,
            damping,
            ..Settings::default()
        };
        let start = || sample.start.clone();
        let mut motion = Motion::new(&cloth, &sample.curves, start(), &settings(0.9)).unwrap();
        for _ in 0..10_000 {
            assert_eq!(motion.step().status, Status::Done);
        }
        // The integrator loses energy but gains none.
        let found = motion.energies();
        assert!(found.numerical >= -1e-4 * found.weight.abs(), "{found:?}");
        let refused = Motion::new(&cloth, &sample.curves, start(), &settings(1.01)).err();
        assert_eq!(refused, Some(Error::UnstableStep { step: 1.01 * limit, limit }));
    }
}

#[test]
fn the_limit_of_runge_kutta_is_that_of_the_fastest_mode() {
    let sample = hung(Model::STVK, 5, 1.0);
    let cloth = in_motion(&sample);
    let rest = Sample::at_rest(sample.mesh.clone(), sample.model, sample.curves.clone()).start;
    let mut values = Vec::new();
    cloth.hessian(&sample.curves, &rest, HessianKind::Full, &mut values);
    let mass = |unknown: usize| cloth.masses()[cloth.unknown_coordinates()[unknown] / 3];
    let size = cloth.unknowns();
    let scaled = DMatrix::from_fn(size, size, |i, j| {
        cloth.entry(i, j).map_or(0.0, |place| values[place]) / (mass(i) * mass(j)).sqrt()
    });
    let fastest = scaled.symmetric_eigenvalues().max().sqrt();
    let limit = stable_step(&cloth, &sample.curves, &rest, &Damping::default());
    assert!((limit * fastest / 8f64.sqrt() - 0.99).abs() < 1e-3, "{}", limit * fastest);
}

#[test]
fn conjugate_gradients_and_factorisation_agree() {
    let sample = hung(Model::STVK, 9, 1.0);
    let settings = |linear| Settings { integrator: exact(linear), ..Settings::default() };
    let gradients = LinearSolver::ConjugateGradient { tolerance: 1e-13, max_iterations: 20_000 };
    let [direct, iterative] =
        [LinearSolver::Direct, gradients].map(|linear| after(&sample, &settings(linear), 0.3));
    assert!(apart(&direct, &sample.start) > 0.02);
    assert!(apart(&direct, &iterative) <= 1e-8 * SIDE, "{:e}", apart(&direct, &iterative));
}

#[test]
fn a_single_linearisation_is_near_the_solution_of_short_steps() {
    let sample = hung(Model::STVK, 6, 0.1);
    let single = Integrator::ImplicitEuler { newton: Newton::Single, linear: LinearSolver::Direct };
    let difference = |step| {
        let run = |integrator| after(&sample, &Settings { step, integrator, ..Settings::default() }, 0.04);
        apart(&run(single), &run(DIRECT))
    };
    let [coarse, fine] = [1e-3, 2.5e-4].map(difference);
    assert!(fine < 0.3 * coarse && coarse < 0.01 * SIDE, "{coarse:e} {fine:e}");
}

#[test]
fn guided_nodes_keep_to_their_directions() {
    let mut sample = hung(Model::STVK, 6, 1.0);
    let corners: Vec<usize> = sample.held.drain(..).map(|held| held.node).collect();
    let slope = Vector3::new(0.3, 0.2, -0.5);
    for (free, normals) in [
        (Free::Plane(slope), vec![slope]),
        (Free::Line(slope), vec![Vector3::new(0.2, -0.3, 0.0), Vector3::new(0.5, 0.0, 0.3)]),
        (Free::Nowhere, vec![Vector3::x(), Vector3::y(), Vector3::z()]),
    ] {
        sample.guided = corners.iter().map(|&node| Guided { node, free }).collect();
        let gradients = LinearSolver::ConjugateGradient { tolerance: 1e-13, max_iterations: 20_000 };
        let wind = Some(Wind { velocity: Vector3::new(1.0, 2.0, 0.0), ..Wind::default() });
        let damping = Damping { mass: 1.0, stiffness: 1e-4 };
        let run = |integrator, step| after(&sample, &Settings { step, integrator, damping, wind }, 0.05);
        let direct = run(exact(LinearSolver::Direct), 1e-3);
        assert!(apart(&direct, &run(exact(gradients), 1e-3)) < 1e-9);
        for moved in [direct, run(Integrator::RungeKutta, 1e-5)] {
            for &node in &corners {
                let at = |x: &[f64]| Vector3::from_column_slice(&x[3 * node..3 * node + 3]);
                let way = at(&moved) - at(&sample.start);
                assert!(normals.iter().all(|normal| way.dot(normal).abs() < 1e-12), "{free:?}: {way}");
                assert_eq!(way.norm() > 1e-3, free != Free::Nowhere, "{free:?}: {way}");
            }
        }
    }
    // A node guided in no direction behaves like a held one.
    let guided = after(&sample, &Settings::default(), 0.1);
    sample.held = corners.iter().map(|&node| Held { node, clip: None }).collect();
    sample.guided.clear();
    assert!(apart(&guided, &after(&sample, &Settings::default(), 0.1)) < 1e-9);
}

#[test]
fn damping_has_the_rate_that_its_law_says() {
    // A planar triangle of unit height, clamped along its base: one mode along the base, of stiffness A k/H².
    let curves = samples::linear_curves(Model::STVK, &[(Component::StretchWeft, 100.0)]).unwrap();
    let positions = [[0.0, -0.5], [1.0, 0.0], [0.0, 0.5]].map(|[x, y]| Vector3::new(x, y, 0.0));
    let material: Vec<Vector2<f64>> = positions.iter().map(|p| p.xy()).collect();
    let mesh = Mesh::new(positions.to_vec(), material, vec![[0, 1, 2]]).unwrap();
    let mut sample = Sample::at_rest(mesh, Model::STVK, curves);
    sample.planar = true;
    sample.hold(|p| (p.x == 0.0).then_some(0));
    sample.place(|p| Vector3::new(1.000_001 * p.x, p.y, 0.0));
    let cloth = in_motion(&sample);
    let frequency = (3.0 * 100.0f64 / samples::AREAL_DENSITY).sqrt();
    for damping in [Damping { mass: 2.0, stiffness: 0.0 }, Damping { mass: 0.0, stiffness: 2e-3 }] {
        let share = 0.5 * (damping.mass / frequency + damping.stiffness * frequency);
        let damped = frequency * (1.0 - share * share).sqrt();
        for (integrator, steps, allowed) in [(Integrator::RungeKutta, 400, 1e-3), (DIRECT, 4000, 5e-3)] {
            let step = std::f64::consts::TAU / damped / f64::from(steps);
            let settings = Settings { step, integrator, damping, wind: None };
            let mut motion = Motion::new(&cloth, &sample.curves, sample.start.clone(), &settings).unwrap();
            (0..10 * steps).for_each(|_| assert_eq!(motion.step().status, Status::Done));
            // After whole periods the displacement has decayed by exp(−ζωt); implicit Euler adds ωh/2 to ζ.
            let own = if integrator == DIRECT { 0.5 * frequency * step } else { 0.0 };
            let left = (motion.positions()[3] - 1.0) / 1e-6;
            let expected = (-(share + own) * frequency * motion.time()).exp();
            assert!((left / expected - 1.0).abs() < allowed, "{left} {expected}");
        }
    }
}

#[test]
fn a_falling_sheet_comes_to_the_speed_of_its_drag() {
    let mut sample = hung(Model::STVK, 4, 1.0);
    sample.held.clear();
    sample.start = Sample::at_rest(sample.mesh.clone(), sample.model, sample.curves.clone()).start;
    let cloth = in_motion(&sample);
    let wind = Wind::default();
    let settings = Settings { wind: Some(wind), ..Settings::default() };
    let mut motion = Motion::new(&cloth, &sample.curves, sample.start.clone(), &settings).unwrap();
    (0..500).for_each(|_| assert_eq!(motion.step().status, Status::Done));
    let expected = (2.0 * samples::AREAL_DENSITY * GRAVITY / (wind.density * wind.normal_drag)).sqrt();
    assert!((motion.greatest_speed() / expected - 1.0).abs() < 1e-6, "{}", motion.greatest_speed());
    // In steady fall, the air dissipates the work of the weight.
    let before = motion.energies();
    (0..100).for_each(|_| assert_eq!(motion.step().status, Status::Done));
    let after = motion.energies();
    assert!(
        ((after.wind - before.wind) / (after.weight - before.weight) - 1.0).abs() < 1e-6,
        "{before:?} {after:?}"
    );
}

#[test]
fn misuse_is_refused() {
    let sample = hung(Model::STVK, 4, 1.0);
    let cloth = in_motion(&sample);
    let refused =
        |settings: Settings| Motion::new(&cloth, &sample.curves, sample.start.clone(), &settings).is_err();
    assert!(!refused(Settings::default()));
    assert!(refused(Settings { step: 0.0, ..Settings::default() }));
    assert!(refused(Settings { step: f64::NAN, ..Settings::default() }));
    assert!(refused(Settings { damping: Damping { mass: -1.0, stiffness: 0.0 }, ..Settings::default() }));
    let wind = Some(Wind { density: f64::NAN, ..Wind::default() });
    assert!(refused(Settings { wind, ..Settings::default() }));
    let mut start = sample.start.clone();
    start[7] = f64::NAN;
    let found = Motion::new(&cloth, &sample.curves, start, &Settings::default()).err();
    assert_eq!(found, Some(Error::NotFinite { what: "positions", vertex: 2 }));
    let weightless = Sample { areal_density: 0.0, ..sample.clone() };
    let cloth = in_motion(&weightless);
    assert!(Motion::new(&cloth, &sample.curves, sample.start.clone(), &Settings::default()).is_err());
    // Statics still requires every part to be held.
    let mut free = sample.clone();
    free.held.clear();
    assert!(matches!(free.cloth(), Err(Error::Unpinned { free: 6, .. })));
    free.guided = vec![Guided { node: 0, free: Free::Line(Vector3::x()) }];
    assert!(free.cloth().is_err());
    free.guided.push(Guided { node: 5, free: Free::Plane(Vector3::x()) });
    assert!(free.cloth().is_ok());
    free.guided.push(Guided { node: 5, free: Free::Nowhere });
    assert!(matches!(free.cloth(), Err(Error::InvalidValue { field: "guided", .. })));
}

/// Soft cloth stretches under its weight until it is too stiff for a step that was stable at the start. The integrator
/// reports this in the first steps that gain energy, long before numbers become non-finite.
#[test]
fn an_explicit_integrator_that_makes_energy_says_so() {
    let mut sample = samples::hanging_sheet(Model::STVK, 7).unwrap();
    sample.curves = samples::fabric(Model::STVK, [0.5, 0.05, 1e-9]).unwrap();
    let cloth = sample.cloth().unwrap();
    let limit = stable_step(&cloth, &sample.curves, &sample.start, &Damping::default());
    let run = |share: f64| {
        let step = share * limit;
        let settings = Settings { step, integrator: Integrator::RungeKutta, ..Settings::default() };
        let mut motion = Motion::new(&cloth, &sample.curves, sample.start.clone(), &settings).unwrap();
        let steps = (0.5 / step) as usize;
        let first = (0..steps).position(|_| motion.step().status != Status::Done);
        (first, motion.energies())
    };
    let (told, energies) = run(0.95);
    let (sound, calm) = run(0.1);
    println!(
        "told in step {told:?} at {:.1e} J; a tenth of it: {sound:?} at {:.1e} J",
        energies.kinetic, calm.kinetic
    );
    assert!(told.is_some() && energies.kinetic < 1.0, "{told:?} {energies:?}");
    assert_eq!(sound, None);
}
