//! A strip pulled along weft: closed forms, for every split of the grid and on the bias.
//!
//! ```text
//!  clip 0 ▌▔▔▔▔▔▔▔▔▐ clip 1 →    goal    the clip's force per width is the nominal stress
//!         ▌▁▁▁▁▁▁▁▁▐                     λσ((λ²−1)/2) StVK, σ(λ−1) soft constraints and springs
//!                                passes  1e-12 relative; every component's area covers the cloth once
//! ```

use cloth_sim::cloth::{Cloth, ForceScale};
use cloth_sim::element::HessianKind;
use cloth_sim::equilibrium::{Settings, Solver, Tolerance};
use cloth_sim::material::{Component, Model};
use cloth_sim::membrane::ring_one;
use cloth_sim::mesh::Diagonals;
use cloth_sim::samples::{self, SIDE, Sample};
use nalgebra::{DMatrix, Rotation2, Vector2, Vector3};

const SPLITS: [Diagonals; 3] = [Diagonals::Forward, Diagonals::Backward, Diagonals::Alternating];

#[test]
fn the_clips_pull_with_the_nominal_stress() {
    for model in Model::ALL {
        for diagonals in SPLITS {
            for stretch in [1.01, 1.05, 1.3] {
                let (mut sample, force) = samples::strip(model, diagonals, 250.0, stretch).unwrap();
                let cloth = sample.cloth().unwrap();
                let mut solver = Solver::new(&cloth);
                let exact = solver.solve(&sample.curves, &mut sample.start, &Settings::default());
                assert!(exact.converged() && exact.iterations == 0, "{model}: {exact:?}");
                let forces = solver.clip_forces();
                assert!((forces[1].x - force).abs() < 1e-12 * force, "{model}: {} {force}", forces[1].x);
                assert!((forces[0] + forces[1]).norm() < 1e-12 * force);
                // Border rows carry half the width of a cell.
                let rows: Vec<f64> = sample
                    .held
                    .iter()
                    .filter(|held| held.clip == Some(1))
                    .map(|held| solver.gradient()[3 * held.node] / (force / 5.0))
                    .collect();
                let [first, inner @ .., last] = &rows[..] else { panic!("{rows:?}") };
                if model == Model::SPRINGS {
                    let off = |row: &f64, share: f64| (row - share).abs() > 1e-12;
                    assert!(!off(first, 0.5) && !off(last, 0.5) && !inner.iter().any(|row| off(row, 1.0)));
                }
                // The same state from a perturbed one.
                sample.perturb(3e-4);
                let settings = Settings { tolerance: Tolerance::Relative(1e-9), ..Settings::default() };
                let found = solver.solve(&sample.curves, &mut sample.start, &settings);
                assert!(found.converged() && found.iterations <= 3, "{model}: {found:?}");
                assert!((solver.clip_forces()[1].x - force).abs() < 1e-8 * force);
            }
        }
    }
}

#[test]
fn springs_are_classed_by_their_direction_and_share_the_cloth() {
    let straight = samples::square(9, Diagonals::Forward).unwrap();
    let bias = samples::cut_on_the_bias(straight.clone(), std::f64::consts::FRAC_PI_4);
    let slight = samples::cut_on_the_bias(straight.clone(), 0.2);
    for (mesh, along_weft) in [(straight, [1, 0]), (slight, [1, 0]), (bias, [-1, 1])] {
        let all = [Component::StretchWeft, Component::StretchWarp, Component::Shear];
        let springs = ring_one(&mesh, &all).unwrap();
        for component in all {
            let of = springs.iter().filter(|spring| spring.component == component);
            let area: f64 = of.map(|spring| spring.area).sum();
            assert!((area - SIDE * SIDE).abs() < 1e-15, "{component}: {area}");
        }
        // Grid step of a weft spring, in either direction.
        let weft = springs.iter().find(|spring| spring.component == Component::StretchWeft).unwrap();
        let place = |node: usize| [(node % 9) as isize, (node / 9) as isize];
        let ([c0, r0], [c1, r1]) = (place(weft.nodes[0]), place(weft.nodes[1]));
        assert!([c1 - c0, r1 - r0] == along_weft || [c0 - c1, r0 - r1] == along_weft);
        // A problem without shear has no shear springs.
        assert!(ring_one(&mesh, &all[..2]).unwrap().iter().all(|spring| spring.component.is_stretch()));
    }
}

/// Weft runs along the cells' diagonals; stretched along it, every model stores ½ k (strain)² per area.
#[test]
fn on_the_bias_the_yarns_still_carry_their_own_stretch() {
    let angle = std::f64::consts::FRAC_PI_4;
    let turn = Rotation2::new(angle);
    for model in Model::ALL {
        let mesh = samples::cut_on_the_bias(samples::square(6, Diagonals::Forward).unwrap(), angle);
        let curves = samples::linear_curves(model, &[(Component::StretchWeft, 100.0)]).unwrap();
        let mut sample = Sample::at_rest(mesh, model, curves);
        sample.hold(|p| (p.x == 0.0).then_some(0));
        sample.place(|p| {
            let material = turn * p.xy();
            let stretched = turn.inverse() * Vector2::new(1.1 * material.x, material.y);
            Vector3::new(stretched.x, stretched.y, 0.0)
        });
        let strain = if model == Model::STVK { 0.105 } else { 0.1 };
        let energy = 0.5 * 100.0 * strain * strain * SIDE * SIDE;
        let found = sample.cloth().unwrap().energy(&sample.curves, &sample.start);
        assert!((found - energy).abs() < 1e-12 * energy, "{model}: {found} {energy}");
    }
}

/// At rest both triangle models have the same stiffness matrix. Springs agree in stretch; in shear their diagonals
/// strain by half the angle, each over half of the cloth, and store a quarter of the energy.
#[test]
fn models_agree_for_small_strains() {
    let matrix = |model| {
        let curves = samples::fabric(model, [300.0, 40.0, 1e-5]).unwrap();
        let mut sample = Sample::at_rest(samples::square(5, Diagonals::Alternating).unwrap(), model, curves);
        sample.hold(|p| (p.x == 0.0).then_some(0));
        let cloth: Cloth = sample.cloth().unwrap();
        let mut values = Vec::new();
        cloth.hessian(&sample.curves, &sample.start, HessianKind::Full, &mut values);
        let size = cloth.unknowns();
        DMatrix::from_fn(size, size, |i, j| cloth.entry(i, j).map_or(0.0, |place| values[place]))
    };
    let (stvk, soft) = (matrix(Model::STVK), matrix(Model::SOFT_CONSTRAINT));
    assert!((&stvk - &soft).amax() < 1e-12 * stvk.amax());
    let energy = |model, component, map: fn(Vector3<f64>) -> Vector3<f64>| {
        let curves = samples::linear_curves(model, &[(component, 300.0)]).unwrap();
        let mut sample = Sample::at_rest(samples::square(5, Diagonals::Backward).unwrap(), model, curves);
        sample.hold(|p| (p.x == 0.0).then_some(0));
        sample.place(map);
        let cloth = sample.cloth().unwrap();
        let (mut gradient, mut scale) = (vec![0.0; sample.start.len()], ForceScale::new(cloth.points()));
        cloth.gradient(&sample.curves, &sample.start, &mut gradient, &mut scale)
    };
    let stretch: fn(Vector3<f64>) -> Vector3<f64> = |p| Vector3::new(1.0001 * p.x, p.y, 0.0);
    let shear: fn(Vector3<f64>) -> Vector3<f64> = |p| Vector3::new(p.x + 1e-4 * p.y, p.y, 0.0);
    let ratio = |component, map, model| energy(model, component, map) / energy(Model::STVK, component, map);
    for model in [Model::SOFT_CONSTRAINT, Model::SPRINGS] {
        assert!((ratio(Component::StretchWeft, stretch, model) - 1.0).abs() < 2e-4);
    }
    assert!((ratio(Component::Shear, shear, Model::SOFT_CONSTRAINT) - 1.0).abs() < 1e-4);
    assert!((ratio(Component::Shear, shear, Model::SPRINGS) - 0.25).abs() < 1e-4);
}
