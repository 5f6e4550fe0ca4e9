use cloth_fit::frame::Kind;
use cloth_fit::incremental::{Stage, fit};
use cloth_fit::knowledge::Knowledge;
use cloth_fit::stage::{Settings, Variant, Watch};
use fit_cloth_tests::cantilever::{Cantilever, GRAVITY, between_rows};
fn main() {
    let gamma: f64 = std::env::args().nth(1).unwrap().parse().unwrap();
    let truth = 0.2 * GRAVITY * 0.085f64.powi(3) / gamma;
    let overhangs = between_rows(12..=20);
    let moment = |k: f64| truth * k;
    let set = Cantilever {
        kind: Kind::BendWeft,
        areal_density: 0.2,
        moment: &moment,
        overhangs: &overhangs,
        measured: [100, 100],
        noise: std::env::args().nth(2).map(|s| s.parse().unwrap()),
    }
    .measure();
    for s in &set.sequences {
        println!("{} frames {}", s.name, s.frames.len());
    }
    let settings = Settings { variant: Variant::Linear, ..Settings::default() };
    let plan = cloth_fit::stage::bend::plan(&[cloth_sim::material::Component::BendWeft], 1);
    let replicas = plan.replicas(&set, &settings).unwrap();
    for r in &replicas {
        println!("rest {} cloths {} planar {}", r.frames_at_rest, r.cloths.len(), r.planar);
        for f in &r.frames {
            println!(
                "frame {} ext {:.4} unknowns {} peirce {:?} truth {truth:.3e}",
                f.index,
                f.extension,
                r.cloth(f).unknowns(),
                r.peirce(f)
            );
        }
    }
    {
        use cloth_sim::curve::*;
        use cloth_sim::equilibrium::*;
        use cloth_sim::material::*;
        let mut curves = Curves::default();
        for c in Component::ALL {
            let k = if c.is_stretch() {
                2000.0
            } else if c.is_bending() {
                truth / 3.0
            } else {
                200.0
            };
            curves.set(
                c,
                StiffnessCurve::constant(k, Model::Stvk.negative_strain(c, Compression::ZeroStrain)).unwrap(),
            );
        }
        let r = &replicas[0];
        println!("held spread {} spread {:?}", r.held_spread, &r.spread[..6]);
        for f in &r.frames {
            let mut solver = Solver::new(r.cloth(f));
            let mut x = f.start.clone();
            let e = solver.solve(&curves, &mut x, &cloth_sim::equilibrium::Settings::default());
            print!("{} {:?} {}: ", f.index, e.status, e.iterations);
            let o = f.observed.as_ref().unwrap();
            let g = r.specimen.grid;
            for c in 0..25 {
                let m =
                    |v: &[f64], i: usize| (0..25).map(|row| v[3 * g.node(c, row) + i]).sum::<f64>() / 25.0;
                print!("{:.3},{:.3} ", 1e3 * (m(&x, 0) - m(o, 0)), 1e3 * (m(&x, 2) - m(o, 2)));
            }
            println!();
        }
    }
    let report = fit(&set, &[Stage::Bend], &Knowledge::default(), &settings, &mut Watch::default()).unwrap();
    for s in &report.stages {
        println!(
            "{} conv {} {:?} basis {:?} dropped {:?}\n {:?} {:?}",
            s.name(),
            s.converged,
            s.counters,
            s.basis,
            s.dropped,
            s.curve.curve.stiffnesses(),
            s.scatter
        );
        println!(
            "observed {} visited {:?} rms {:?} multi {:?}",
            s.curve.observed, s.curve.visited, s.sequences[0].position_rms, s.sequences[0].multi_stable
        );
        for l in &s.levels {
            println!("{} {:.3e} {} {:?}", l.points, l.rms, l.status, l.iterations);
        }
    }
}
