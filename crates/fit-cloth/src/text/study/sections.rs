//! The sections of a study.

use super::section::Section;
use super::{equilibria, fits, noise, parts};
use cloth_study::study::Study;

/// All sections in order; topics that were not run are omitted.
pub fn sections(study: &Study) -> Vec<Section> {
    let all = [
        equilibria::meshes(study),
        equilibria::tolerances(study),
        fits::fits(study),
        fits::stages(study),
        noise::noise(study),
        parts::parts(study),
    ];
    all.into_iter().filter(|section| !section.rows.is_empty()).collect()
}
