//! Cost of a whole fit: `cargo bench -p cloth-fit`, on idle cores; `-- small` skips the finer grids.
//!
//! Six sequences of 50 frames of a known denim with instrument noise, up to five control points, six curves. Prints
//! wall time and factorisations per stage, on one thread and on all; the same for the published method; the parameter
//! Jacobian by sensitivities and by finite differences.
#![allow(clippy::print_stdout)]

use cloth_data::frame::{Kind, MeasurementSet};
use cloth_data::rig::{KnownFabric, Rig};
use cloth_fit::incremental::{self, FitReport, Stage};
use cloth_fit::material::file::MaterialFile;
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::report::StageReport;
use cloth_fit::stage::{Plan, Settings, Watch, bend, shear, stretch};
use cloth_fit::twin::replica::Replica;
use cloth_sim::cloth::{Cloth, ForceScale};
use cloth_sim::element::HessianKind;
use cloth_sim::equilibrium::{self, Solver, Tolerance};
use cloth_sim::material::{Component, Curves, Model};
use std::time::Instant;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

fn main() -> Result<()> {
    let small = std::env::args().any(|argument| argument == "small");
    let set = measured()?;
    let cores = rayon::current_num_threads();
    for nodes in if small { vec![25] } else { vec![25, 51, 101] } {
        let settings = Settings { nodes: Some([nodes; 2]), ..Settings::default() };
        let (report, seconds) = fit(&set, &settings, cores)?;
        stages(&set, &settings, &report, cores)?;
        let (alone, seconds_alone) = fit(&set, &settings, 1)?;
        let [all, one] =
            [&report, &alone].map(|report| MaterialFile::new(&set, &settings, report, None).to_json());
        println!(
            "{nodes}x{nodes}: {seconds:.2} s on {cores} threads, {seconds_alone:.2} s on one ({:.2} times); files {}; \
             most memory so far {}\n",
            seconds_alone / seconds,
            if all == one { "identical" } else { "DIFFER" },
            memory()
        );
        if nodes == 25 {
            jacobian(&set, &settings, &report)?;
        }
    }
    against_published(&set, &Settings { nodes: Some([25; 2]), ..Settings::default() }, cores)
}

/// The published method and ours on every fifth frame: the published one takes minutes even then.
fn against_published(set: &MeasurementSet, settings: &Settings, cores: usize) -> Result<()> {
    let mut thin = set.clone();
    for sequence in &mut thin.sequences {
        let frames = sequence.frames.iter().step_by(5);
        sequence.frames = frames.cloned().collect();
    }
    let published = settings.clone().as_published();
    let (ours, seconds) = fit(&thin, settings, cores)?;
    let (theirs, seconds_published) = fit(&thin, &published, cores)?;
    stages(&thin, settings, &ours, cores)?;
    stages(&thin, &published, &theirs, cores)?;
    println!(
        "every fifth frame: {seconds:.2} s, as published {seconds_published:.2} s ({:.1} times)",
        seconds_published / seconds
    );
    compare(&ours, &theirs);
    Ok(())
}

/// Six sequences of about 50 frames each.
fn measured() -> Result<MeasurementSet> {
    let fabric = KnownFabric::named("cotton-denim")?;
    let rig = Rig { seed: 2012, measured: [25, 25], ..Rig::default() };
    let pulled = vec![Kind::StretchWeft, Kind::StretchWarp, Kind::Shear];
    let bent = vec![Kind::BendWeft, Kind::BendWarp, Kind::BendBias];
    let mut set = Rig { sequences: pulled, frames: 25, ..rig.clone() }.measure(&fabric)?;
    set.sequences.extend(Rig { sequences: bent, frames: 50, ..rig }.measure(&fabric)?.sequences);
    Ok(set)
}

/// Fits everything on the given number of threads; returns the report and the seconds taken.
fn fit(set: &MeasurementSet, settings: &Settings, threads: usize) -> Result<(FitReport, f64)> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let clock = Instant::now();
    let report = pool.install(|| {
        incremental::fit(set, &Stage::ALL, &Knowledge::default(), settings, &mut Watch::default())
    })?;
    Ok((report, clock.elapsed().as_secs_f64()))
}

/// Prints a table of the stages.
fn stages(set: &MeasurementSet, settings: &Settings, report: &FitReport, cores: usize) -> Result<()> {
    println!(
        "{:<14}{:>5}{:>12}{:>12}{:>16}{:>10}{:>9}{:>12}{:>13}",
        "stage",
        "pass",
        "equilibria",
        "iterations",
        "factorisations",
        "each",
        "seconds",
        "factor [ms]",
        "wall/factors"
    );
    for stage in &report.stages {
        let counters = stage.counters;
        let factor = factor_seconds(set, settings, stage, report.curves())?;
        println!(
            "{:<14}{:>5}{:>12}{:>12}{:>16}{:>10.2}{:>9.2}{:>12.3}{:>13.2}",
            stage.name(),
            stage.pass,
            counters.equilibria,
            counters.iterations,
            counters.factorisations,
            counters.factorisations as f64 / counters.equilibria as f64,
            stage.seconds,
            1e3 * factor,
            stage.seconds * cores as f64 / (counters.factorisations as f64 * factor)
        );
    }
    Ok(())
}

fn plan(stage: &StageReport) -> Plan {
    match stage.components[0] {
        Component::StretchWeft | Component::StretchWarp => stretch::plan(&stage.components),
        Component::Shear => shear::plan(stage.pass),
        _ => bend::plan(&stage.components, stage.pass),
    }
}

/// Curves for the equilibria of a stage.
fn curves(plan: &Plan, known: &Curves) -> Curves {
    // An unobserved curve borrows another one of its kind: only the time counts here.
    let any = |component: Component| {
        known
            .components()
            .find(|other| other.is_bending() == component.is_bending())
            .and_then(|c| known.get(c))
    };
    let curve =
        |&component: &Component| Some((component, known.get(component).or_else(|| any(component))?.clone()));
    plan.components.iter().filter_map(curve).collect()
}

/// Time of one factorisation of a stage's last cloth, s.
fn factor_seconds(
    set: &MeasurementSet,
    settings: &Settings,
    stage: &StageReport,
    known: &Curves,
) -> Result<f64> {
    let plan = plan(stage);
    let replicas = plan.replicas(set, settings)?;
    let Some((replica, frame)) = replicas.first().and_then(|r| Some((r, r.frames.get(r.frames.len() / 2)?)))
    else {
        return Ok(f64::NAN);
    };
    let (cloth, curves) = (replica.cloth(frame), curves(&plan, known));
    let mut solver = Solver::new(cloth);
    let mut x = frame.start.clone();
    let settings = equilibrium::Settings::default();
    if !solver.solve(&curves, &mut x, &settings).converged() {
        return Ok(f64::NAN);
    }
    let again = fastest(|| assert_eq!(solver.solve(&curves, &mut x, &settings).factorisations, 1));
    Ok(again - assembly_seconds(cloth, &curves, &x))
}

/// Time of one gradient and one Hessian, s.
fn assembly_seconds(cloth: &Cloth, curves: &Curves, x: &[f64]) -> f64 {
    let (mut gradient, mut values) = (vec![0.0; x.len()], Vec::new());
    let mut scale = ForceScale::new(cloth.points());
    fastest(|| {
        cloth.gradient(curves, x, &mut gradient, &mut scale);
        cloth.hessian(curves, x, HessianKind::Full, &mut values);
    })
}

/// The parameter Jacobian of a buckled picture frame, from the equilibrium's own factorisation and from new
/// equilibria.
fn jacobian(set: &MeasurementSet, settings: &Settings, report: &FitReport) -> Result<()> {
    let plan = shear::plan(2);
    let replicas = plan.replicas(set, settings)?;
    let replica: &Replica = &replicas[0];
    let frame = &replica.frames[replica.frames.len() / 3];
    let (cloth, curves) = (replica.cloth(frame), curves(&plan, report.curves()));
    let tight = equilibrium::Settings { tolerance: Tolerance::Relative(1e-10), ..Default::default() };
    let mut solver = Solver::new(cloth);
    let mut x = frame.start.clone();
    let found = solver.solve(&curves, &mut x, &tight);
    assert!(found.converged(), "{}", found.status);
    let Some(curve) = curves.get(Component::Shear).cloned() else { return Ok(()) };
    let points = curve.len();
    let (mut columns, mut slopes) = (Vec::new(), vec![0.0; points * cloth.unknowns()]);
    let own = fastest(|| {
        cloth.parameter_gradient(&curves, Component::Shear, &x, &mut columns);
        for (column, slope) in columns.chunks_exact(x.len()).zip(slopes.chunks_exact_mut(cloth.unknowns())) {
            cloth.collect(column, slope);
            slope.iter_mut().for_each(|force| *force = -*force);
        }
        solver.solve_linear(&mut slopes);
    });
    let mut differences = vec![0.0; slopes.len()];
    let by_differences = fastest(|| {
        for (point, slope) in differences.chunks_exact_mut(cloth.unknowns()).enumerate() {
            let step = 1e-4 * curve.stiffnesses()[point];
            let mut sides = [1.0, -1.0].map(|sign| {
                let mut stiffnesses = curve.stiffnesses().to_vec();
                stiffnesses[point] += sign * step;
                let mut curves = curves.clone();
                let moved = curve.with_stiffnesses(stiffnesses).expect("a stiffness that stays positive");
                curves.set(Component::Shear, moved);
                let mut x = x.clone();
                assert!(solver.solve(&curves, &mut x, &tight).converged());
                x
            });
            let [above, below] = &mut sides;
            for (slope, &coordinate) in slope.iter_mut().zip(cloth.unknown_coordinates()) {
                *slope = (above[coordinate] - below[coordinate]) / (2.0 * step);
            }
        }
    });
    let largest = slopes.iter().fold(0.0, |largest: f64, slope| largest.max(slope.abs()));
    let apart = slopes.iter().zip(&differences).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
    println!(
        "parameter Jacobian of one frame, {points} control points: {:.2} ms by sensitivities, {:.1} ms by central \
         differences ({:.0} times); they differ by {:.1e} of the largest\n",
        1e3 * own,
        1e3 * by_differences,
        by_differences / own,
        apart / largest
    );
    Ok(())
}

/// Prints the distance of the published method's curves from ours, in half-widths of our bands.
fn compare(ours: &FitReport, theirs: &FitReport) {
    println!("{:<14}{:>24}{:>22}", "curve", "largest difference", "in half bands");
    for component in Model::STVK.components() {
        let (Some(stage), Some(other)) = (ours.stage(component), theirs.curves().get(component)) else {
            continue;
        };
        let largest = stage.curve.samples.last().map_or(0.0, |sample| sample.stress);
        let own = &stage.curve.curve;
        // Bending: a hinge's strain is three times the curvature in the file.
        let unit =
            if component.is_bending() { cloth_sim::strain_measure::HINGE_STRAIN_PER_CURVATURE } else { 1.0 };
        let (mut apart, mut bands): (f64, f64) = (0.0, 0.0);
        for sample in &stage.curve.samples {
            let strain = unit * sample.strain;
            let difference = (other.stress(strain) - own.stress(strain)).abs();
            apart = apart.max(difference / largest);
            if let Some([low, high]) = sample.band.filter(|[low, high]| high > low) {
                bands = bands.max(difference / (0.5 * (high - low)));
            }
        }
        println!("{:<14}{:>22.2} %{:>22.1}", component.to_string(), 100.0 * apart, bands);
    }
    println!();
}

/// The fastest of several runs, s: on a shared machine the slower ones measure the load.
fn fastest(mut task: impl FnMut()) -> f64 {
    let mut once = || {
        let clock = Instant::now();
        task();
        clock.elapsed().as_secs_f64()
    };
    let first = once();
    let repeats = ((0.2 / first) as usize).clamp(3, 200);
    (0..repeats).map(|_| once()).fold(first, f64::min)
}

/// Peak memory, as Linux reports it.
fn memory() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.map_or("unknown".into(), |value| value.trim().to_string())
}
