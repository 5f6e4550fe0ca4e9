//! Fits stress–strain curves to measurements of fabric.
//!
//! # The problem
//!
//! A sample is stretched, sheared and bent; every frame records its clips or table, the forces on them, and usually
//! its shape. A fit finds the control values k of a stiffness curve for which the simulated cloth, in equilibrium
//! between the same clips or on the same table, reproduces the measurement:
//!
//! ```text
//! minimise over k    Σ_frames |F_c(x, k) − F̃_c|²/σ_F²                     stretch, shear: forces on the clips
//!                    Σ_frames |x(k) − x̃|²/σ_x²                            bending: places of the free nodes
//! subject to         ∇E(x, k) = 0 at the free nodes of every frame         equilibrium
//!                    dσ/dε ≥ κ for every strain                            a curve that is stable to simulate
//! ```
//!
//! The curves are fitted one at a time, with the others known: stretch, then shear, then bending, then shear and
//! bending again.
//!
//! Source: Miguel et al. 2012, eq. 6 and §5.2. Differences, and all other equations: docs/model.md.
//!
//! # Modules
//!
//! | module | role |
//! |---|---|
//! | [`cloth_data`] | measurements, and contradictions within them |
//! | [`twin`] | a simulated replica of each sequence: grid, cloth, clips or table, frames |
//! | [`equilibria`] | equilibria of all frames, residuals, sensitivities |
//! | [`optimise`] | linearised step under constraints, outer loop, outliers, uncertainty |
//! | [`stage`], [`incremental`] | the fit of one curve, from set to report; all stages in order |
//! | [`judge`] | verdict on a curve; validation; comparison of models; repair of unstable curves |
//! | [`material`] | material for a simulation, fitted or written by hand |
//! | [`result`] | result files |
//!
//! # Example
//!
//! The virtual rig measures a known cloth; the fit recovers its curves and writes them to a file.
//!
//! ```
//! use cloth_data::frame::Kind;
//! use cloth_fit::incremental::{self, Stage};
//! use cloth_fit::stage::knowledge::Knowledge;
//! use cloth_fit::material::file::MaterialFile;
//! use cloth_data::rig::{KnownFabric, Rig};
//! use cloth_fit::stage::{Settings, Watch};
//! use cloth_sim::material::Component;
//!
//! let fabric = KnownFabric::named("cotton-denim")?;
//! let sequences = vec![Kind::StretchWeft, Kind::StretchWarp];
//! let set = Rig { sequences, nodes: [13, 13], measured: [5, 5], ..Rig::default() }.measure(&fabric)?;
//!
//! // All stages; those without a sequence in the set are skipped.
//! let settings = Settings { nodes: Some([7, 7]), ..Settings::default() };
//! let report = incremental::fit(&set, &Stage::ALL, &Knowledge::default(), &settings, &mut Watch::default())?;
//! assert!(report.converged() && report.stages.len() == 2);
//!
//! let truth = fabric.curves()?;
//! for weft_or_warp in [Component::StretchWeft, Component::StretchWarp] {
//!     let [fitted, known] = [report.curves(), &truth].map(|curves| curves.get(weft_or_warp).expect("it was pulled"));
//!     assert!((fitted.stress(0.035) / known.stress(0.035) - 1.0).abs() < 0.02);
//! }
//! let file = MaterialFile::new(&set, &settings, &report, None);
//! assert!(file.to_json().contains("stiffness_n_per_m") && file.curves()? == *report.curves());
//! # Ok::<(), cloth_data::error::Error>(())
//! ```

pub mod equilibria;
pub mod incremental;
pub mod judge;
pub mod material;
pub mod optimise;
pub mod result;
pub mod stage;
pub mod twin;

/// Runs the README's example, too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
