//! Judgement of curves: against their measurements, against tests that no fit saw, against each other; and their repair.

pub mod compare;
pub mod prediction;
pub mod repair;
pub mod validation;
pub mod verdict;
