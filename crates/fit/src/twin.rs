//! The simulated twin of a measured sequence.

mod placement;
pub mod replica;
pub mod specimen;

pub(crate) use placement::in_place;
