//! From measured fabric to stress–strain curves.
//!
//! # The problem
//!
//! A sample is stretched, sheared and bent; what holds it, the forces on that, and mostly its shape are measured in every
//! frame. Wanted are the control values k of a stiffness curve for which the simulated cloth, in equilibrium between the
//! same clips or on the same table, behaves alike:
//!
//! ```text
//! minimise over k    Σ_frames |F_c(x, k) − F̃_c|²/σ_F²                     stretch, shear: forces on the clips
//!                    Σ_frames |x(k) − x̃|²/σ_x²                            bending: places of the free nodes
//! subject to         ∇E(x, k) = 0 at the free nodes of every frame         equilibrium
//!                    dσ/dε ≥ κ for every strain                            a curve that is stable to simulate
//! ```
//!
//! One curve at a time, the others known: stretch, then shear, then bending, then shear and bending once more.
//!
//! Source: Miguel et al. 2012, eq. 6 and §5.2. What differs, and every other equation: docs/model.md.
//!
//! # From measurement to curve
//!
//! | module | role |
//! |---|---|
//! | [`cloth_data`] | what was measured, and where it contradicts itself |
//! | [`twin`] | a simulated replica of each sequence: grid, cloth, what holds it, its frames |
//! | [`equilibria`] | equilibria of all frames, residuals, sensitivities |
//! | [`optimise`] | a linearised step under constraints, the outer loop, outliers, uncertainty |
//! | [`stage`], [`incremental`] | one curve, from set to report; all of them in order |
//! | [`judge`] | how far to trust a curve; tests that no fit saw; models side by side; what would spoil a simulation |
//! | [`material`] | what a simulation must know of a fabric, from a fit or from hand |
//! | [`result`] | what was found, as files |
//!
//! # Example
//!
//! A known cloth is measured on the virtual rig; its curves come back and go into a file.
//!
//! ```
//! use cloth_data::frame::Kind;
//! use cloth_fit::incremental::{self, Stage};
//! use cloth_fit::stage::knowledge::Knowledge;
//! use cloth_fit::material::file::MaterialFile;
//! use cloth_data::rig::{KnownFabric, Rig};
//! use cloth_fit::stage::{Settings, Watch};
//! use cloth_sim::material::Component;
//! # let text = include_str!("../../../fixtures/fabrics/cotton-denim.toml");
//!
//! let fabric = KnownFabric::parse("cotton-denim.toml".as_ref(), text)?;
//! let sequences = vec![Kind::StretchWeft, Kind::StretchWarp];
//! let set = Rig { sequences, nodes: [13, 13], measured: [5, 5], ..Rig::default() }.measure(&fabric)?;
//!
//! // All stages: those that the set does not show are passed over.
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
