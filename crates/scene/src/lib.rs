//! Scenes of cloth: a sheet of a material, what holds it and the air around it, let down to rest or followed in time.
//!
//! ```text
//! SCENE.toml ──▶ Scene ─┐
//!                       ├──▶ to rest, or in motion ──▶ Simulation ──▶ simulation.json, mesh.obj, frames, energies.csv
//! material   ──▶ curves ┘                                  └──▶ droop, drape
//! ```
//!
//! | Module | Role |
//! |---|---|
//! | [`scene`] | a scene's file, read and checked, and the cloth that it makes of a material |
//! | [`simulation`] | the scene simulated |
//! | [`droop`], [`drape`] | what is measured of its last shape |
//! | [`result`] | the folder that a simulation is written into |
//!
//! # Example
//!
//! A sheet that hangs from two corners comes to rest and droops:
//!
//! ```
//! use cloth_fit::material::Material;
//! use cloth_scene::scene::Scene;
//! use cloth_scene::simulation::to_rest;
//! # use std::path::Path;
//! # let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures");
//!
//! let scene = Scene::read(&fixtures.join("scenes/hang.toml"))?;
//! let material = Material::read(&fixtures.join("materials/cotton.toml"))?;
//! let simulation = to_rest(&scene, &material, &mut |_steps| ())?;
//! assert!(simulation.converged());
//! # Ok::<(), cloth_data::error::Error>(())
//! ```

pub mod drape;
pub mod droop;
pub mod result;
pub mod scene;
pub mod simulation;
