//! Cloth mechanics.

pub mod bending;
pub mod cloth;
pub mod curve;
pub mod element;
pub mod equilibrium;
pub mod error;
pub mod finite_difference;
mod linear;
pub mod load;
pub mod material;
pub mod membrane;
pub mod mesh;
