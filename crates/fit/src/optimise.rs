//! Nonlinear least squares under constraints, and how sure its result is.

pub mod gauss_newton;
pub mod least_squares;
pub mod robust;
pub mod uncertainty;
