//! Patch test: a uniform state of an irregular mesh is an equilibrium, and the solver finds it.
//!
//! ```text
//!   ┌──┬───┬─┐  affine map   goal    strains uniform, no force inside, wherever the nodes lie
//!   │ ╱╲ ╱ ╲ │  ───────────  mesh    7×7, inner nodes moved at random (springs: the regular grid, both diagonals)
//!   └──┴─┴───┘  into space   passes  strains 1e-13, inner forces 1e-12 of an element's; found again to 1e-9 m
//! ```

use cloth_sim::cloth::ForceScale;
use cloth_sim::equilibrium::{Settings, Solver, Tolerance};
use cloth_sim::material::{Component, Model};
use cloth_sim::samples;
use nalgebra::{Matrix3x2, Rotation3, Vector3};

/// Stretched, sheared and rotated out of the plane.
fn map() -> Matrix3x2<f64> {
    let flat = Matrix3x2::new(1.06, 0.05, 0.03, 1.02, 0.0, 0.0);
    Rotation3::new(Vector3::new(0.7, -1.2, 0.4)) * flat
}

#[test]
fn strains_are_uniform_and_nothing_pulls_inside() {
    for model in Model::ALL {
        let sample = samples::patch(model, map()).unwrap();
        let cloth = sample.cloth().unwrap();
        for component in sample.curves.components() {
            let strains = cloth.strains(component, &sample.start);
            let low = strains.iter().fold(f64::MAX, |low, s| low.min(s[0]));
            let high = strains.iter().fold(f64::MIN, |high, s| high.max(s[0]));
            // The two diagonals of springs differ in sign.
            if !(model == Model::SPRINGS && component == Component::Shear) {
                assert!(high - low < 1e-13, "{model}, {component}: {low} to {high}");
            }
            let area: f64 = strains.iter().map(|s| s[1]).sum();
            assert!((area - samples::SIDE * samples::SIDE).abs() < 1e-15, "{model}, {component}: {area}");
        }
        let mut gradient = vec![0.0; sample.start.len()];
        let mut scale = ForceScale::new(cloth.points());
        let _ = cloth.gradient(&sample.curves, &sample.start, &mut gradient, &mut scale);
        let largest = scale.magnitude.iter().fold(0.0, |a: f64, &b| a.max(b));
        for &coordinate in cloth.unknown_coordinates() {
            assert!(gradient[coordinate].abs() <= 1e-12 * largest, "{model}: {:e}", gradient[coordinate]);
        }
        // All forces act on the border, and they are in balance.
        assert!(cloth.clip_forces(&gradient)[0].norm() <= 1e-12 * largest);
    }
}

#[test]
fn the_uniform_state_is_found_from_a_disturbed_one() {
    for model in Model::ALL {
        let exact = samples::patch(model, map()).unwrap();
        let mut sample = exact.clone();
        sample.perturb(1e-3);
        let cloth = sample.cloth().unwrap();
        let settings = Settings { tolerance: Tolerance::Relative(1e-9), ..Settings::default() };
        let found = Solver::new(&cloth).solve(&sample.curves, &mut sample.start, &settings);
        assert!(found.converged(), "{model}: {found:?}");
        assert!(found.factorisations <= 6, "{model}: {found:?}");
        let error = sample.start.iter().zip(&exact.start).fold(0.0, |e: f64, (a, b)| e.max((a - b).abs()));
        assert!(error < 1e-9, "{model}: {error:e}");
    }
}
