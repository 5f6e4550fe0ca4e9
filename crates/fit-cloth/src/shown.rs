//! Data of curves and sequences shared by the page and the figures.

mod clip_force;
mod curve_axes;
mod extension;
mod place;
mod profile;
mod pull;

pub(crate) use clip_force::{ClipForce, clip_forces};
pub(crate) use curve_axes::curve_labels;
pub(crate) use extension::extension;
pub(crate) use place::vector;
pub(crate) use profile::{Profile, profiles};
pub(crate) use pull::pulled_rows;
