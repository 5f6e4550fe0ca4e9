//! Figures of a study.

mod bars;
mod convergence;
mod error_time;
mod extent;
mod noise;
mod parts;
mod stages;
mod style;

use super::drawing::Drawn;
use cloth_sim::material::Model;
use cloth_study::study::Study;

/// All figures with their names.
pub(super) fn figures(study: &Study) -> Vec<(String, Drawn<String>)> {
    let mut figures = vec![
        ("error-time".to_string(), error_time::of_fits(study)),
        ("noise".into(), noise::draw(study)),
        ("stages".into(), stages::draw(study)),
        ("parts".into(), parts::draw(study)),
    ];
    for scene in convergence::scenes(study) {
        let name = format!("error-time-{}", scene.replace(' ', "-"));
        figures.push((name, error_time::of_scene(study, &scene)));
    }
    for model in Model::ALL {
        let name = if model == Model::STVK { "convergence".into() } else { format!("convergence-{model}") };
        figures.push((name, convergence::draw(study, model)));
    }
    figures
}
