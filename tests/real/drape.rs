//! Cusick's drape test of real fabrics.
//!
//! ```text
//!     ┌─────────┐      source  Cusick 1968; bending and density of fabrics, Feng, Huang, Xu and Wang 2022
//!   ╱─┤ 0.18 m  ├─╲    goal    the drape coefficient falls as bending gets softer, and depends little on the mesh
//!  ╱  └─────────┘  ╲   data    fabrics618_bending/, the mean B1 of three directions; membrane 1000 N/m, shear 50 N/m
//!      0.30 m          passes  3 points between meshes of 20 and 40 rings, where the coarse one can fold at all
//! ```
//!
//! The folds of a fabric are a few lengths (B/ρg)^⅓ wide. A mesh with cells longer than half of that cannot fold:
//! such a fabric is flagged, with both values.

use cloth_fit::material::Material;
use cloth_scene::drape::Drape;
use cloth_scene::scene::Scene;
use cloth_scene::simulation::{Simulation, to_rest};
use fit_cloth_tests::rows;
use std::path::Path;

/// Rows of the source's table, from the stiffest to the softest.
const FABRICS: [&str; 4] = ["4", "399", "72", "500"];

const GRAVITY: f64 = 9.81;

/// The drape of a fabric: rigidity N·m, density kg/m².
fn drape(rigidity: f64, density: f64, rings: usize) -> (Drape, Simulation) {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures/scenes/drape.toml");
    let coarse = std::fs::read_to_string(fixture).unwrap();
    let rings = coarse
        .replace("rings = 20, kept_ring = 12", &format!("rings = {rings}, kept_ring = {}", rings * 3 / 5));
    let bend =
        ["weft", "warp", "diagonal"].map(|name| format!("bend-{name} = {{ rigidity_n_m = {rigidity:e} }}\n"));
    let membrane = "[curves]\nstretch-weft = { stiffness_n_per_m = 1000 }\nstretch-warp = { stiffness_n_per_m = 1000 }\n\
                    shear = { stiffness_n_per_m = 50 }\n";
    let head = format!("name = \"fabric\"\nareal_density_kg_m2 = {density}\nmodel = \"stvk\"\n");
    let material = write("fabric.toml", head + membrane + &bend.concat());
    let scene = Scene::read(&write("drape.toml", rings)).unwrap();
    let simulation = to_rest(&scene, &Material::read(&material).unwrap(), &mut |_| {}).unwrap();
    (simulation.drape.unwrap(), simulation)
}

#[test]
fn the_drape_coefficient_falls_with_the_rigidity_and_depends_little_on_the_mesh() {
    let table = rows("fabrics618_bending/fabrics.csv");
    let found = FABRICS.map(|name| {
        let row = table.iter().find(|row| row[0] == name).unwrap();
        let [density, warp, weft, diagonal] = [2, 3, 4, 5].map(|i| row[i].parse::<f64>().unwrap());
        let rigidity = (warp + weft + diagonal) / 3.0;
        let length = (rigidity / (density * GRAVITY)).cbrt();
        let [coarse, fine] = [20, 40].map(|rings| drape(rigidity, density, rings));
        assert!(coarse.1.converged() && fine.1.converged(), "{name}");
        let [coarse, fine] = [coarse.0, fine.0];
        let flagged = length < 2.0 * 0.15 / 20.0;
        println!(
            "fabric {name}: (B/ρg)^⅓ {:.1} mm, drape coefficient {:.2} % ({} folds), on half the mesh size {:.2} % ({} folds){}",
            1e3 * length,
            100.0 * coarse.coefficient,
            coarse.folds,
            100.0 * fine.coefficient,
            fine.folds,
            if flagged { ", flagged: its folds are too narrow for the coarse mesh" } else { "" }
        );
        assert!(flagged || (fine.coefficient - coarse.coefficient).abs() < 0.03, "{name}: {coarse:?} {fine:?}");
        assert!(fine.coefficient_error < 1e-3, "{fine:?}");
        (length, fine.coefficient, flagged)
    });
    assert!(found.windows(2).all(|pair| pair[1].0 < pair[0].0 && pair[1].1 < pair[0].1), "{found:?}");
    assert_eq!(found.map(|(.., flagged)| flagged), [false, false, false, true]);
}
