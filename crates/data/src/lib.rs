//! Measured fabric data: types, files and checks.
//!
//! | module | role |
//! |---|---|
//! | [`kind`], [`frame`] | kinds of test; measured data: set, sequence, frame |
//! | [`io`], [`store`] | sets as folders; atomic output |
//! | [`strip`], [`rig`] | import of tensile tables; simulated measurements of known fabrics |
//! | [`rectangle`], [`locator`] | the specimen at rest; location of points in it |
//! | [`measure`] | scalar summaries of a frame |
//! | [`inspection`], [`notice`] | contradictions within a measurement, found before simulation |
//! | [`curve_file`], [`curve_edit`], [`points`] | curve tables; edits of curves; control points in TOML |
//! | [`error`] | errors with the place of the fault |

mod branch;
pub mod curve_edit;
pub mod curve_file;
pub mod error;
pub mod frame;
pub mod inspection;
pub mod io;
pub mod kind;
pub mod locator;
pub mod measure;
pub mod notice;
pub mod points;
pub mod rectangle;
pub mod rig;
pub mod store;
pub mod strip;

/// Runs the README's example, too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
