//! Cloth mechanics.

pub mod error;
pub mod mesh;
