//! Judges curves against their measurements, against tests outside the fit and against each other; repairs unstable
//! curves.

pub mod compare;
pub mod prediction;
pub mod repair;
pub mod validation;
pub mod verdict;
