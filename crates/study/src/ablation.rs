//! Ablation: savings and error from leaving out a part of a scene or fit.
//!
//! Each scene is solved with and without the part, in all frames of a test, with the fabric's own curves. Parts of the
//! fit are evaluated from the fits of the study.

mod ablated;
mod of_fits;
mod of_scenes;

pub use ablated::Ablated;
pub(crate) use of_fits::of_fits;
pub(crate) use of_scenes::of_scenes;
