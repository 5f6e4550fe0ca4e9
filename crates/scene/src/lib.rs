//! Scenes of cloth: a sheet of a material with its holds and the surrounding air, simulated to rest or in time.
//!
//! ```text
//! SCENE.toml ──▶ Scene ─┐
//!                       ├──▶ to rest, or in motion ──▶ Simulation ──▶ simulation.json, mesh.obj, frames, energies.csv
//! material   ──▶ curves ┘                                  └──▶ droop, drape
//! ```
//!
//! | Module | Role |
//! |---|---|
//! | [`scene`] | reads and validates a scene file; builds the cloth for a material |
//! | [`simulation`] | simulates a scene |
//! | [`droop`], [`drape`] | measurements of the final shape |
//! | [`result`] | writes the result folder of a simulation |
//!
//! # Example
//!
//! A sheet hanging from two corners comes to rest and droops:
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

/// Runs the README's example, too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
