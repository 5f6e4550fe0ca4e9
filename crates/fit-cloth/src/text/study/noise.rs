//! Curve error against noise.

use super::digits::{digits, percent};
use super::section::{Section, header};
use cloth_study::level::{Level, levels};
use cloth_study::study::Study;

pub(super) fn noise(study: &Study) -> Section {
    let row = |level: &Level| {
        vec![
            level.test.clone(),
            level.noise.to_string(),
            format!("{}/{}", level.seeds, level.seeds + level.failed),
            percent(Some(level.error)),
            percent(level.floor),
            level.floor.map_or("-".into(), |floor| digits(level.error / floor)),
        ]
    };
    Section {
        title: "Curve error against noise".into(),
        words: "The floor is the Cramér–Rao bound: no unbiased estimate of the control points can do better. On the fit's own mesh, with a curve that it can represent, noise is the only error, and the ratio is that of the estimator; constraints may take it below 1 where the noise is large. On a finer mesh, with the fabric's curve, mesh and control points add errors: where the ratio grows, less noise no longer helps.".into(),
        header: header(&["curve", "noise", "seeds", "error", "floor", "error / floor"]),
        rows: levels(study).iter().map(row).collect(),
        plot: Some("noise"),
    }
}
