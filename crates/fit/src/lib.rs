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
//! | [`frame`] | what was measured: set, sequence, frame |
//! | [`io`], [`strip`], [`rig`] | where it comes from: files, a tensile machine's table, a known cloth |
//! | [`inspection`] | where a measurement contradicts itself, before anything is simulated |
//! | [`curve_file`], [`curve_edit`] | a curve as a table; curves made wider, stronger, longer |
//! | [`check`], [`repair`] | what would spoil a simulation, and the nearest curve that does not |
//! | [`specimen`], [`replica`] | a simulation grid over the specimen; its cloth, what holds it, its frames |
//! | [`gap`] | a start without any simulation |
//! | [`simulation`] | equilibria of all frames, residuals, sensitivities |
//! | [`least_squares`], [`gauss_newton`] | one linearised step under constraints; the outer loop |
//! | [`robust`] | residuals of outliers, bent |
//! | [`refine`] | a curve grows control points |
//! | [`uncertainty`], [`knowledge`] | noise, misfit, bands; what one stage does not know, carried on to the next |
//! | [`stage`], [`incremental`] | one curve, from set to report; all of them in order |
//! | [`prediction`], [`compare`] | tests that a fit did not see; models and variants side by side |
//! | [`measure`], [`validation`] | a frame summed up in one figure; motions and samples that no fit saw |
//! | [`material`] | what a simulation must know of a fabric, from a fit or from hand
//! | [`interventions`] | what was clamped, extrapolated, left out or tried again on the way, counted |
//! | [`shapes`] | every frame's shape, simulated beside seen, to look at |
//! | [`verdict`] | how far to trust a curve: green, amber, red |
//! | [`report`], [`material_file`], [`result`], [`store`] | what was found, as data and as files |
//! | [`error`] | what is wrong with an input, and where |
//!
//! # Example
//!
//! A known cloth is measured on the virtual rig; its curves come back and go into a file.
//!
//! ```
//! use cloth_fit::frame::Kind;
//! use cloth_fit::incremental::{self, Stage};
//! use cloth_fit::knowledge::Knowledge;
//! use cloth_fit::material_file::MaterialFile;
//! use cloth_fit::rig::{KnownFabric, Rig};
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
//! # Ok::<(), cloth_fit::error::Error>(())
//! ```

mod boundary;
pub mod check;
pub mod compare;
pub mod curve_edit;
pub mod curve_file;
pub mod error;
pub mod frame;
pub mod gap;
pub mod gauss_newton;
pub mod incremental;
pub mod inspection;
pub mod interventions;
pub mod io;
pub mod knowledge;
pub mod least_squares;
mod locator;
pub mod material;
pub mod material_file;
pub mod measure;
mod placement;
pub mod prediction;
pub mod refine;
pub mod repair;
pub mod replica;
pub mod report;
pub mod result;
pub mod rig;
pub mod robust;
pub mod shapes;
pub mod simulation;
pub mod specimen;
pub mod stage;
pub mod store;
pub mod strip;
mod summary;
pub mod uncertainty;
pub mod validation;
pub mod verdict;
