//! Measured fabric as data and as files.
//!
//! | module | role |
//! |---|---|
//! | [`frame`] | what was measured: set, sequence, frame |
//! | [`io`], [`store`] | sets as folders; outputs that are written whole or not at all |
//! | [`strip`], [`rig`] | a tensile machine's table; a known cloth, measured by simulation |
//! | [`rectangle`], [`locator`] | a specimen at rest, and where a point lies in it |
//! | [`measure`] | a frame summed up in one figure |
//! | [`inspection`], [`notice`] | where a measurement contradicts itself, before anything is simulated |
//! | [`curve_file`], [`curve_edit`], [`points`] | a curve as a table; curves made wider, stronger, longer; control points by hand |
//! | [`error`] | what is wrong with an input, and where |

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
