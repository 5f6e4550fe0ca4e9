//! Tests across the crates.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod architecture;
mod bending;
mod closed_form;
mod contradiction;
mod coverage;
mod droop;
mod faults;
mod free_corners;
mod metamorphic;
mod outliers;
mod published;
mod recovery;
mod repair;
mod rig;
mod shear;
mod sheet;
mod starts;
mod strip_faults;
mod trusted;
mod unknowns;
mod whole;
