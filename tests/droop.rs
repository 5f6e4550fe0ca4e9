//! Droop of a sheet hung from two corners: springs compared with continuum models.
//!
//! ```text
//!   o─────────o    source  Strohkorb 2019, figures 1 and 4: springs droop, a continuum hardly does
//!   │         │    goal    at equal stiffness along weft and warp and in shear, all models droop alike
//!   └──╲___╱──┘    sheet   0.5 m × 0.5 m, 25×25 nodes, 0.15 kg/m², no bending
//!      droop       passes  within 7 % of each other; a sheet twenty times stiffer droops a fifth as much at most
//! ```
//!
//! At a small shear γ both diagonal springs of a cell stretch by γ/2, and each represents half of the cloth: their
//! energy per area is k γ²/8, that of a continuum G γ²/2. Hence k = 4G.

use cloth_fit::material::Material;
use cloth_scene::scene::Scene;
use cloth_scene::simulation::to_rest;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::material::{Component, Compression, Model};
use std::path::Path;

/// Droop relative to the height of the sheet.
fn droop(scene: &Scene, model: Model, stretch: f64, shear: f64) -> f64 {
    let compression = Compression::ZeroStrain;
    let curve = |(component, stiffness): (Component, f64)| {
        let negative = model.negative_strain(component, compression);
        (component, StiffnessCurve::constant(stiffness, negative).unwrap())
    };
    let stiffnesses =
        [(Component::StretchWeft, stretch), (Component::StretchWarp, stretch), (Component::Shear, shear)];
    let curves = stiffnesses.into_iter().map(curve).collect();
    let material =
        Material { name: "sheet".into(), areal_density: 0.15, model, compression, curves, for_mesh: None };
    let simulation = to_rest(scene, &material, &mut |_| {}).unwrap();
    assert!(simulation.converged(), "{model}: {:?}", simulation.end);
    let weight = 0.15 * 0.25 * 9.81;
    let held: f64 = simulation.holds.iter().map(|force| force.z).sum();
    assert!((held / weight - 1.0).abs() < 1e-6, "{held} {weight}");
    simulation.droop.unwrap().share.unwrap()
}

#[test]
fn springs_droop_as_continua_do_where_they_are_as_stiff() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures/scenes/hang.toml");
    let scene = Scene::read(&path).unwrap();
    let table = [20.0, 400.0].map(|stretch| {
        let shear = stretch / 50.0;
        let found = [
            droop(&scene, Model::STVK, stretch, shear),
            droop(&scene, Model::SOFT_CONSTRAINT, stretch, shear),
            droop(&scene, Model::SPRINGS, stretch, 4.0 * shear),
        ];
        println!("{stretch} N/m: {found:.4?}");
        assert!(found.iter().all(|droop| (droop / found[0] - 1.0).abs() < 0.07), "{found:?}");
        // Diagonals with the shear stiffness of the continuum are too soft.
        assert!(droop(&scene, Model::SPRINGS, stretch, shear) > 1.3 * found[0]);
        found
    });
    for (soft, stiff) in table[0].iter().zip(table[1]) {
        assert!(*soft > 5.0 * stiff, "{table:?}");
    }
}
