//! From measured fabric to stress-strain curves.

pub mod error;
pub mod frame;
pub mod io;
pub mod replica;
pub mod specimen;
pub mod store;
pub mod strip;
