//! Newton steps and factorisations per equilibrium.
//!
//! ```text
//!  ▐▔▔╲      cantilever, stiffness 1.5 times off; stretched sheet; picture frame that buckles
//!      ╲     goal    the counts that make a fit fast
//!            passes  cantilever ≤ 8 steps, also with stretch : bending = 1e9; stretch warm ≤ 2 factorisations;
//!                    into the buckle ≤ 30
//! ```

use cloth_sim::cloth::Cloth;
use cloth_sim::equilibrium::{Equilibrium, Settings, Solver};
use cloth_sim::material::{Component, Curves, Model};
use cloth_sim::samples::{self, Sample};

/// Solves with one component `factor` times as stiff, then from there with the true curves.
fn warm(sample: &Sample, components: &[Component], factor: f64) -> Equilibrium {
    let cloth: Cloth = sample.cloth().expect("the sample is valid");
    let mut solver = Solver::new(&cloth);
    let mut other: Curves = sample.curves.clone();
    for &component in components {
        let curve = sample.curves.get(component).expect("the sample has the component");
        let stiffnesses = curve.stiffnesses().iter().map(|k| factor * k).collect();
        other.set(component, curve.with_stiffnesses(stiffnesses).expect("as many stiffnesses"));
    }
    let mut x = sample.start.clone();
    let before = solver.solve(&other, &mut x, &Settings::default());
    assert!(before.converged(), "{before:?}");
    let found = solver.solve(&sample.curves, &mut x, &Settings::default());
    assert!(found.converged(), "{found:?}");
    found
}

const BENDING: [Component; 3] = [Component::BendWeft, Component::BendWarp, Component::BendDiagonal];

#[test]
fn a_cantilever_takes_few_steps_however_stiff_its_membrane() {
    for model in [Model::STVK, Model::SOFT_CONSTRAINT] {
        for stretch in [500.0, 1e4] {
            let sample = samples::cantilever(model, 13, stretch).unwrap();
            let found = warm(&sample, &BENDING, 1.5);
            println!(
                "{model}, {stretch} N/m: {} steps, {} factorisations",
                found.iterations, found.factorisations
            );
            assert!(found.iterations <= 8, "{model}, {stretch}: {found:?}");
        }
    }
}

#[test]
fn a_cantilever_falls_from_flat_with_stretch_a_billion_times_bending() {
    for model in [Model::STVK, Model::SOFT_CONSTRAINT] {
        let sample = samples::cantilever(model, 13, 1e4).unwrap();
        let cloth = sample.cloth().unwrap();
        let mut x = sample.start.clone();
        let found = Solver::new(&cloth).solve(&sample.curves, &mut x, &Settings::default());
        println!("{model}: {} steps, {} factorisations", found.iterations, found.factorisations);
        assert!(found.converged() && found.iterations <= 60, "{model}: {found:?}");
    }
}

#[test]
fn a_picture_frame_buckles() {
    for model in Model::ALL {
        let sample = samples::picture_frame(model, 13, 0.2).unwrap();
        let cloth = sample.cloth().unwrap();
        let mut x = sample.start.clone();
        let found = Solver::new(&cloth).solve(&sample.curves, &mut x, &Settings::default());
        println!("{model}: {} steps, {} factorisations", found.iterations, found.factorisations);
        assert!(found.converged(), "{model}: {found:?}");
        assert!(x.iter().skip(2).step_by(3).any(|z| z.abs() > 1e-4), "{model}: it stayed flat");
        let warm = warm(&sample, &[Component::Shear], 0.9);
        println!("{model}: warm {} steps, {} factorisations", warm.iterations, warm.factorisations);
        assert!(warm.iterations <= 10, "{model}: {warm:?}");
    }
}

/// With clamped matrices alone, far too stiff along the buckle, up to 62 factorisations are needed.
#[test]
fn a_sheet_does_not_creep_into_its_buckle() {
    for angle in [0.05, 0.1, 0.2] {
        let sample = samples::picture_frame(Model::STVK, 25, angle).unwrap();
        let found = warm(&sample, &[Component::Shear], 1.0 / 1.5);
        println!("{angle} rad: {} steps, {} factorisations", found.iterations, found.factorisations);
        assert!(found.factorisations <= 30, "{angle}: {found:?}");
    }
}

#[test]
fn a_warm_stretched_sheet_takes_two_factorisations() {
    for model in Model::ALL {
        let (mut sample, _) =
            samples::strip(model, cloth_sim::mesh::Diagonals::Forward, 300.0, 1.04).unwrap();
        // A rotated bar makes the state depend on the ratio of the stiffnesses.
        sample.place(|p| p + nalgebra::Vector3::new(0.4 * p.x * p.y, -0.1 * p.x * p.y, 0.0));
        let found = warm(&sample, &[Component::StretchWeft], 0.9);
        println!("{model}: {} steps, {} factorisations", found.iterations, found.factorisations);
        assert!(found.factorisations <= 2, "{model}: {found:?}");
    }
}
