//! What each part that a scene can leave out saves, and which error it causes to leave it out.
//!
//! A scene is balanced with the part and without it, all frames of a test at the fabric's own curves. What concerns the fit
//! rather than a scene is read off the fits of the study.

mod ablated;
mod of_fits;
mod of_scenes;

pub use ablated::Ablated;
pub(crate) use of_fits::of_fits;
pub(crate) use of_scenes::of_scenes;
