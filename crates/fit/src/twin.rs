//! Simulated counterparts of measured sequences.

mod lines;
mod placement;
pub mod replica;
pub mod specimen;

pub(crate) use placement::in_place;
