//! Fits and the run time of their stages.

use super::digits::{digits, percent, short};
use super::section::{Section, header};
use cloth_sim::material::Model;
use cloth_study::pareto::front;
use cloth_study::run::{Part, Run};
use cloth_study::solver::Solver;
use cloth_study::study::Study;

pub(super) fn fits(study: &Study) -> Section {
    let done: Vec<[f64; 2]> = study.part(Part::Fit).filter_map(point).collect();
    let best = front(&done);
    let row = |run: &Run| {
        vec![
            run.model.to_string(),
            run.solver.to_string(),
            run.nodes.to_string(),
            run.points.map_or("-".into(), |points| points.to_string()),
            run.frames.to_string(),
            percent(run.error_curve),
            percent(run.error_force),
            short(run.error_position_mm),
            digits(run.spent.seconds),
            run.spent.counters.equilibria.to_string(),
            run.spent.counters.factorisations.to_string(),
            run.spent.peak_memory_mib.map_or("-".into(), |memory| format!("{memory:.0}")),
            if point(run).is_some_and(|point| best.contains(&point)) { "yes" } else { "" }.into(),
            run.ending.to_string(),
        ]
    };
    Section {
        title: "Fits: error against run time".into(),
        words: format!(
            "Curve error: root mean square error of force or moment per width over the observed range, as a share of the largest there, against {}; of a fit, the root mean square over all curves. Residuals are those of the measurements. The front holds the fits that no other beats in both error and time.",
            study.reference
        ),
        header: header(&[
            "model",
            "solver",
            "nodes",
            "points",
            "frames",
            "curve error",
            "force residual",
            "position residual, mm",
            "seconds",
            "equilibria",
            "factorisations",
            "peak memory, MiB",
            "on the front",
            "status",
        ]),
        rows: study.part(Part::Fit).map(row).collect(),
        plot: Some("error-time"),
    }
}

/// Seconds and curve error of a fit that did not fail.
fn point(run: &Run) -> Option<[f64; 2]> {
    (!run.failed()).then_some([run.spent.seconds, run.error_curve?])
}

pub(super) fn stages(study: &Study) -> Section {
    let most = study.finest_fit().unwrap_or(0);
    let of = |solver| {
        study
            .part(Part::Stage)
            .filter(move |run| run.solver == solver && run.model == Model::STVK && run.nodes == most)
    };
    let mut names: Vec<&str> =
        of(Solver::Default).chain(of(Solver::AsPublished)).map(|run| &run.test[..]).collect();
    let mut seen = Vec::new();
    names.retain(|name| {
        !seen.contains(name) && {
            seen.push(name);
            true
        }
    });
    let row = |name: &&str| {
        let mut cells = vec![name.to_string()];
        for solver in Solver::ALL {
            let run = of(solver).find(|run| run.test == **name);
            let cost = |cell: fn(&Run) -> String| run.map_or("-".into(), cell);
            cells.push(cost(|run| digits(run.spent.seconds)));
            cells.push(cost(|run| run.spent.counters.factorisations.to_string()));
            cells.push(cost(|run| percent(run.error_curve)));
        }
        cells
    };
    Section {
        title: format!("Where the time goes: stvk on {most}x{most} nodes"),
        words: "Seconds, factorisations and curve error of each stage, in running order.".into(),
        header: header(&[
            "stage",
            "default, s",
            "factorisations",
            "error",
            "as published, s",
            "factorisations",
            "error",
        ]),
        rows: names.iter().map(row).collect(),
        plot: Some("stages"),
    }
}
