//! scratch
use cloth_fit::incremental::{Stage, fit};
use cloth_fit::knowledge::Knowledge;
use cloth_fit::rig::{KnownFabric, Rig};
use cloth_fit::stage::{Settings, Watch};
use cloth_sim::material::{Component, Model};
use fit_cloth_tests::stress_error;
use std::path::Path;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let name = &args[1];
    let noise = args[2] == "noise";
    let nodes: usize = args[3].parse().unwrap();
    let model = match args.get(4).map(|s| &s[..]) {
        Some("soft") => Model::SoftConstraint,
        Some("springs") => Model::Springs,
        _ => Model::Stvk,
    };
    let text = std::fs::read_to_string(format!("fixtures/fabrics/{name}.toml")).unwrap();
    let fabric = KnownFabric::parse(Path::new(name), &text).unwrap();
    let clock = std::time::Instant::now();
    use cloth_fit::frame::Kind::*;
    let rig = Rig {
        nodes: [nodes, nodes],
        measured: [100, 100],
        noise,
        cord_hysteresis: noise,
        frames: 12,
        sequences: vec![StretchWeft, StretchWarp, Shear, BendWeft, BendWarp, BendBias, ComplexShear, CornerPull],
        ..Rig::default()
    };
    let set = rig.measure(&fabric).unwrap();
    println!("rig {:.1} s", clock.elapsed().as_secs_f64());
    let clock = std::time::Instant::now();
    let report = fit(
        &set,
        &Stage::ALL,
        &Knowledge::default(),
        &Settings { model, ..Settings::default() },
        &mut Watch::default(),
    )
    .unwrap();
    println!("fit {:.1} s", clock.elapsed().as_secs_f64());
    let truth = fabric.curves().unwrap();
    for s in &report.stages {
        let c = s.components[0];
        let known = truth.get(c).unwrap();
        let law = |x: f64| if c.is_bending() { known.stress(3.0 * x) } else { known.stress(x) };
        println!(
            "{:13} pass {} conv {} obs {} points {} error {:6.2} %  noise {:.2e} misfit {:.2e} visited {:.4}..{:.4} k {:?} drop {} fact {} eq {} {:.2} s multi {:?} force {:?} pos {:?} planar {}",
            s.name(),
            s.pass,
            s.converged,
            s.curve.observed,
            s.curve.curve.len(),
            100.0 * stress_error(&s.curve.samples, &law),
            s.scatter.noise,
            s.scatter.misfit,
            s.curve.visited[0],
            s.curve.visited[1],
            s.curve.curve.stiffnesses().iter().map(|k| format!("{k:.3e}")).collect::<Vec<_>>(),
            s.dropped.len(),
            s.counters.factorisations,
            s.counters.equilibria,
            s.seconds,
            s.sequences[0].multi_stable.len(),
            s.sequences[0].force_rms,
            s.sequences[0].position_rms,
            s.sequences[0].planar
        );
        for l in &s.levels {
            println!(
                "     {} points rms {:.3e} {} iterations: {}",
                l.points,
                l.rms,
                l.iterations.len(),
                l.status
            );
        }
        let _ = Component::ALL;
    }
    let clock = std::time::Instant::now();
    let v = cloth_fit::validation::validate(&set, &[ComplexShear, CornerPull], report.curves(), &Settings { model, ..Settings::default() }).unwrap();
    println!("validation {:.1} s {:?} dropped {:?}", clock.elapsed().as_secs_f64(), v.prediction.counters, v.prediction.dropped);
    for s in &v.sequences { println!("{} share {:?} multi {:?} pos {:?} force {:?}", s.report.name, s.measure_share(), s.report.multi_stable, s.report.position_rms, s.report.force_rms);
       for r in &s.measure.as_ref().unwrap().1 { println!("    {} {:.4} {:.5} {:.5} {}", r.frame, r.extension, r.measured, r.simulated, r.multi_stable); } }
}
