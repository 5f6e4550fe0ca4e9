//! From measured fabric to stress-strain curves.

pub mod error;
pub mod frame;
pub mod gauss_newton;
pub mod least_squares;
