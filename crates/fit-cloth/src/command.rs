//! The commands, one file each.

pub mod check;
pub mod compare;
pub mod curve;
pub mod fit;
pub mod goal;
pub mod import;
mod journal;
mod kinds;
pub mod report;
pub mod rig;
pub mod simulate;
pub mod study;
pub mod validate;
