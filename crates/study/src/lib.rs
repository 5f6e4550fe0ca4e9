//! Studies of error against run time, and of the savings and errors from leaving out parts of a scene.
//!
//! ```text
//! known fabric ──▶ scenes on refined meshes ──▶ error and cost of an equilibrium               [equilibria]
//! measured set ──▶ fits: nodes, models, solvers, points, frames ──▶ error and cost of a fit   [fits]
//! known fabric ──▶ increasing noise ──▶ error of a curve, and its Cramér–Rao bound            [noise]
//!              ──▶ scenes with and without a part ──▶ savings and error                       [ablation]
//! ```
//!
//! Runs are timed one at a time; within a run, frames are solved in parallel, as in a fit. A failed run is recorded as
//! a row.
//!
//! | Module | Role |
//! |---|---|
//! | [`subject`] | the subject: a measurement set, and the known fabric if there is one |
//! | [`extent`] | the extent of a study |
//! | [`study`] | the whole study, from subject to rows |
//! | [`run`], [`spent`], [`ablation`] | a row: a run with its error and cost; a part with its savings |
//! | [`solver`] | the default method, and the published one |
//! | [`level`], [`pareto`] | summaries: averages over seeds, the Pareto front of error and time |
//! | [`table`] | writes the rows to files |
//! | [`progress`] | receives the progress of a study |
//!
//! # Example
//!
//! Without a measurement set, the virtual rig measures one:
//!
//! ```
//! use cloth_study::extent::Extent;
//! use cloth_study::subject::Subject;
//!
//! let extent = Extent { rig_nodes: 7, ..Extent::quick() };
//! let subject = Subject::built_in(&extent)?;
//! assert!(subject.is_known && subject.set.sequences.len() == 6);
//! # Ok::<(), cloth_data::error::Error>(())
//! ```

pub mod ablation;
mod equilibria;
pub mod extent;
mod fits;
pub mod level;
mod mean;
mod memory;
mod noise;
mod own_mesh;
pub mod pareto;
mod physical;
pub mod progress;
pub mod run;
mod scene;
pub mod solver;
pub mod spent;
pub mod study;
pub mod subject;
pub mod table;

/// Runs the README's example, too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
