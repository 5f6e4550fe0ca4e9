//! A sheet of hand-written material hanging from two corners: `cargo run -p cloth-scene --example hang`.
#![allow(clippy::print_stdout)]

use cloth_data::error::Result;
use cloth_fit::material::Material;
use cloth_scene::scene::Scene;
use cloth_scene::simulation::to_rest;
use std::path::Path;

fn main() -> Result<()> {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures");
    let scene = Scene::read(&fixtures.join("scenes/hang.toml"))?;
    let material = Material::read(&fixtures.join("materials/cotton.toml"))?;
    let simulation = to_rest(&scene, &material, &mut |_steps| ())?;
    println!("at rest: {}", simulation.converged());
    Ok(())
}

#[test]
fn runs() {
    main().expect("files of the repository");
}
