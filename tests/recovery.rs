//! Simulate known curves, add noise, fit, compare.

use cloth_fit::rig::{KnownFabric, Rig};
use cloth_fit::stage::stretch::fit;
use cloth_fit::stage::{Settings, Watch};
use cloth_sim::material::{Component, Model};
use std::path::Path;

#[test]
fn denim() {
    let text = include_str!("../fixtures/fabrics/cotton-denim.toml");
    let fabric = KnownFabric::parse(Path::new("cotton-denim.toml"), text).unwrap();
    for noise in [false, true] {
        let set = Rig { noise, ..Rig::default() }.measure(&fabric).unwrap();
        for model in Model::ALL {
            for component in [Component::StretchWeft, Component::StretchWarp] {
                let settings = Settings { model, ..Settings::default() };
                let report = fit(&set, component, &settings, &mut Watch::default()).unwrap().unwrap();
                println!(
                    "{model} {component} noise {noise}: {:?} {:?}",
                    report.curve.curve.stiffnesses(),
                    report.curve.visited
                );
                for level in &report.levels {
                    println!(
                        "   {} points rms {:.3e} {} iterations {}",
                        level.points,
                        level.rms,
                        level.iterations.len(),
                        level.status
                    );
                }
                println!(
                    "   {:?} {:?} {:.3} s; {}",
                    report.scatter, report.counters, report.seconds, report.growth
                );
                for s in &report.sequences {
                    println!(
                        "   {} frames {} rest {} planar {} nodes {:?} rms {:.3e} of {:.3} pos {:?} hyst {:?}",
                        s.name,
                        s.frames,
                        s.at_rest,
                        s.planar,
                        s.nodes,
                        s.force_rms,
                        s.force_largest,
                        s.position_rms,
                        s.hysteresis
                    );
                }
                if model == Model::Stvk {
                    let truth = fabric.curves().unwrap();
                    let truth = truth.get(component).unwrap();
                    let (mut e, mut t, mut inside) = (0.0, 0.0, 0);
                    for s in &report.curve.samples {
                        e += (s.stress - truth.stress(s.strain)).powi(2);
                        t += truth.stress(s.strain).powi(2);
                        if let Some([l, h]) = s.band {
                            if truth.stress(s.strain) >= l && truth.stress(s.strain) <= h {
                                inside += 1;
                            }
                        }
                    }
                    println!("   error {:.4} %, inside {inside}", 100.0 * (e / t).sqrt());
                }
            }
        }
    }
}
