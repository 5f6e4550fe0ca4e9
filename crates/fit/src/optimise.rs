//! Nonlinear least squares under constraints, and the uncertainty of its result.

pub mod gauss_newton;
pub mod least_squares;
pub mod robust;
pub mod uncertainty;
