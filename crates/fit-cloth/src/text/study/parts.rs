//! Savings and costs of each part.

use super::digits::{digits, percent, short};
use super::section::{Section, header};
use cloth_study::ablation::Ablated;
use cloth_study::run::Ending;
use cloth_study::study::Study;

pub(super) fn parts(study: &Study) -> Section {
    let row = |row: &Ablated| {
        let status = match &row.ending {
            [_, Ending::Failed(why)] => format!("without: {why}"),
            [Ending::Failed(why), _] => format!("with: {why}"),
            endings if endings.contains(&Ending::SeveralEquilibria) => "several equilibria".into(),
            _ => String::new(),
        };
        vec![
            row.part.clone(),
            row.scene.clone(),
            if row.by_default { "in" } else { "out" }.into(),
            digits(row.with.seconds),
            digits(row.without.seconds),
            format!("{:.0} %", 100.0 * row.saving()),
            row.with.counters.factorisations.to_string(),
            row.without.counters.factorisations.to_string(),
            percent(row.error_force),
            short(row.error_position_mm),
            percent(row.error_curve),
            status,
        ]
    };
    Section {
        title: "What each part saves and costs".into(),
        words: "Runs with and without each part: the time that leaving it out saves, and the change of forces, positions or curves. Parts that a fit leaves out by default are added for the comparison.".into(),
        header: header(&[
            "part",
            "where",
            "by default",
            "with, s",
            "without, s",
            "saves",
            "factorisations with",
            "without",
            "force",
            "places, mm",
            "curves",
            "status",
        ]),
        rows: study.ablation.iter().map(row).collect(),
        plot: Some("parts"),
    }
}
