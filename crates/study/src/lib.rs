//! Error against run time, and what each part that a scene can leave out saves and costs.
//!
//! ```text
//! known fabric ──▶ scenes on finer and finer meshes ──▶ error and cost of an equilibrium      [equilibria]
//! measured set ──▶ fits: nodes, models, solvers, points, frames ──▶ error and cost of a fit   [fits]
//! known fabric ──▶ more and more noise ──▶ error of a curve beside the least there can be     [noise]
//!              ──▶ scenes with and without a part ──▶ what it saves, what it costs            [ablation]
//! ```
//!
//! Runs are timed one at a time; within a run frames are solved in parallel, as in a fit. A run that fails is a row that
//! says so.
//!
//! | Module | Role |
//! |---|---|
//! | [`subject`], [`fabrics`] | what is studied: a measurement set, and the truth behind it where that is known |
//! | [`extent`] | how much is run |
//! | [`study`] | all of it, from subject to rows |
//! | [`run`], [`spent`], [`ablation`] | a row: a run with its error and its cost; a part with what it saves |
//! | [`solver`] | the program's own method, and the published one |
//! | [`level`], [`pareto`] | what rows come to: averages over seeds, the runs that no other beats |
//! | [`table`] | the rows as files |
//! | [`progress`] | who is told how far a study is |
//!
//! # Example
//!
//! The studied set is measured on the virtual rig, where none is given:
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
pub mod fabrics;
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
