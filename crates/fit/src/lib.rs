//! From measured fabric to stress-strain curves.

pub mod error;
pub mod frame;
pub mod gap;
pub mod gauss_newton;
pub mod io;
pub mod least_squares;
pub mod material_file;
pub mod refine;
pub mod replica;
pub mod report;
pub mod result;
pub mod rig;
pub mod simulation;
pub mod specimen;
pub mod stage;
pub mod store;
pub mod strip;
mod summary;
pub mod uncertainty;
