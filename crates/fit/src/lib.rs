//! From measured fabric to stress–strain curves.
//!
//! # The problem
//!
//! A sample is stretched by clips; their poses and the forces on them are measured in every frame. Wanted are the control
//! values k of a stiffness curve for which the simulated cloth, in equilibrium between the same clips, pulls alike:
//!
//! ```text
//! minimise over k    Σ_frames |F_c(x, k) − F̃_c|²/σ²
//! subject to         ∇E(x, k) = 0 at the free nodes of every frame         equilibrium
//!                    dσ/dε ≥ κ for every strain                            a curve that is stable to simulate
//! ```
//!
//! Source: Miguel et al. 2012, eq. 6. What differs, and every other equation: docs/model.md.
//!
//! # From measurement to curve
//!
//! | module | role |
//! |---|---|
//! | [`frame`] | what was measured: set, sequence, frame |
//! | [`io`], [`strip`], [`rig`] | where it comes from: files, a tensile machine's table, a known cloth |
//! | [`specimen`], [`replica`] | a simulation grid over the specimen; its cloth, clips and frames |
//! | [`gap`] | a start without any simulation |
//! | [`simulation`] | equilibria of all frames, residuals, sensitivities |
//! | [`least_squares`], [`gauss_newton`] | one linearised step under constraints; the outer loop |
//! | [`refine`] | a curve grows control points |
//! | [`uncertainty`] | noise, misfit, bands |
//! | [`stage`], [`incremental`] | one curve, from set to report; all of them in order |
//! | [`prediction`], [`compare`] | tests that a fit did not see; models and variants side by side |
//! | [`measure`], [`validation`] | a frame summed up; motions and samples that no fit saw |
//! | [`report`], [`material_file`], [`result`], [`store`] | what was found, as data and as files |
//!
//! # Example
//!
//! A known cloth is measured on the virtual rig and comes back from its forces.
//!
//! ```
//! use cloth_fit::frame::Kind;
//! use cloth_fit::rig::{KnownFabric, Rig};
//! use cloth_fit::stage::{Settings, Watch, stretch};
//! use cloth_sim::material::Component;
//! # let text = include_str!("../../../fixtures/fabrics/cotton-denim.toml");
//!
//! let fabric = KnownFabric::parse("cotton-denim.toml".as_ref(), text)?;
//! let sequences = vec![Kind::StretchWeft];
//! let set = Rig { sequences, nodes: [13, 13], measured: [5, 5], ..Rig::default() }.measure(&fabric)?;
//! let settings = Settings { nodes: Some([7, 7]), ..Settings::default() };
//! let weft = stretch::fit(&set, Component::StretchWeft, &settings, &mut Watch::default())?;
//! let weft = weft.expect("the rig pulls along weft");
//! assert!(weft.converged);
//!
//! let truth = fabric.curves()?;
//! let truth = truth.get(Component::StretchWeft).expect("denim has a weft");
//! let (fitted, known) = (weft.curve.curve.stress(0.04), truth.stress(0.04));
//! assert!((fitted / known - 1.0).abs() < 0.01);
//! # Ok::<(), cloth_fit::error::Error>(())
//! ```

mod boundary;
pub mod compare;
pub mod error;
pub mod frame;
pub mod gap;
pub mod gauss_newton;
pub mod incremental;
pub mod io;
pub mod knowledge;
pub mod least_squares;
pub mod material_file;
pub mod measure;
pub mod prediction;
pub mod refine;
pub mod replica;
pub mod report;
pub mod result;
pub mod rig;
pub mod robust;
pub mod simulation;
pub mod specimen;
pub mod stage;
pub mod store;
pub mod strip;
mod summary;
pub mod uncertainty;
pub mod validation;
