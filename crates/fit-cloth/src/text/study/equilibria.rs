//! Equilibria on several meshes and with several tolerances.

use super::digits::{digits, percent, short};
use super::section::{Section, header};
use cloth_sim::material::Model;
use cloth_study::run::{Ending, Part, Run};
use cloth_study::solver::Solver;
use cloth_study::study::Study;
use cloth_study::table;

/// The equilibria with the default tolerance of their solver.
fn usual(study: &Study) -> impl Iterator<Item = &Run> {
    study.part(Part::Equilibrium).filter(|run| run.tolerance == run.solver.equilibrium().tolerance)
}

/// Scenes and models in the order of the runs.
fn ladders(study: &Study) -> Vec<(&str, Model)> {
    let mut found = Vec::new();
    for run in study.part(Part::Equilibrium) {
        if !found.contains(&(&run.test[..], run.model)) {
            found.push((&run.test[..], run.model));
        }
    }
    found
}

pub(super) fn meshes(study: &Study) -> Section {
    let mut meshes: Vec<usize> =
        usual(study).filter(|run| run.error_position_mm.is_some()).map(|run| run.nodes).collect();
    meshes.sort_unstable();
    meshes.dedup();
    let largest = meshes.last().copied().unwrap_or(0);
    let finest = usual(study).map(|run| run.nodes).max().unwrap_or(0);
    let row = |&(test, model): &(&str, Model)| {
        let run = |solver, nodes| {
            usual(study).find(|r| (&r.test[..], r.model, r.solver, r.nodes) == (test, model, solver, nodes))
        };
        let default = |nodes| run(Solver::Default, nodes);
        let orders: Vec<&Run> = usual(study)
            .filter(|r| r.test == test && r.model == model && r.solver == Solver::Default)
            .collect();
        let order = orders.iter().filter_map(|run| run.order).next_back();
        let cost = |run: Option<&Run>| match run {
            Some(run) if run.failed() => run.ending.to_string(),
            Some(run) => format!("{} s, {}", digits(run.spent.seconds), run.spent.counters.factorisations),
            None => "-".into(),
        };
        let several = orders.iter().any(|run| !run.failed() && run.ending != Ending::Converged);
        let mut cells = vec![test.to_string(), model.to_string(), short(order)];
        cells.extend(meshes.iter().map(|&nodes| short(default(nodes).and_then(|run| run.error_position_mm))));
        cells.push(percent(default(largest).and_then(|run| run.error_force)));
        cells.extend([cost(default(largest)), cost(run(Solver::AsPublished, largest))]);
        cells.push(if several { "yes" } else { "no" }.into());
        cells
    };
    let mut names = header(&["scene", "model", "order"]);
    names.extend(meshes.iter().map(|nodes| format!("mm at {nodes}")));
    names.push(format!("force at {largest}"));
    names.extend(
        ["default", "as published"].map(|solver| format!("{solver}, {largest}: time, factorisations")),
    );
    names.push("several equilibria".into());
    Section {
        title: "Equilibria on finer meshes".into(),
        words: format!(
            "Root mean square distance of the nodes that all meshes share, and largest difference of a force, from {finest}x{finest} nodes of the same model. The order follows from the differences between the finest three meshes: about 2 for the models on triangles, less where a corner is singular. Springs need not converge: their bending depends on the grid. A flat strip and a flat picture frame are omitted: they are homogeneous, so every mesh solves them exactly."
        ),
        header: names,
        rows: ladders(study).iter().map(row).collect(),
        plot: Some("convergence"),
    }
}

pub(super) fn tolerances(study: &Study) -> Section {
    let of_stvk = || study.part(Part::Equilibrium).filter(|run| run.model == Model::STVK);
    let tried =
        of_stvk().find(|run| run.tolerance != run.solver.equilibrium().tolerance).map(|run| run.nodes);
    let nodes = tried.unwrap_or(0);
    let mut scenes: Vec<&str> = of_stvk().map(|run| &run.test[..]).collect();
    scenes.dedup();
    let mut rows: Vec<(Solver, cloth_sim::equilibrium::Tolerance)> = Vec::new();
    for run in of_stvk().filter(|run| run.nodes == nodes) {
        if !rows.contains(&(run.solver, run.tolerance)) {
            rows.push((run.solver, run.tolerance));
        }
    }
    rows.sort_by_key(|(solver, tolerance)| (*solver != Solver::Default, table::tolerance(*tolerance)));
    let row = |&(solver, tolerance): &(Solver, _)| {
        let cell = |scene: &&str| {
            let run = of_stvk().find(|run| {
                run.test == **scene
                    && run.nodes == nodes
                    && run.solver == solver
                    && run.tolerance == tolerance
            });
            run.map_or("-".into(), |run| match run.failed() {
                true => run.ending.to_string(),
                false => {
                    format!("{} mm, {}", short(run.error_position_mm), run.spent.counters.factorisations)
                }
            })
        };
        let mut cells = vec![solver.to_string(), table::tolerance(tolerance)];
        cells.extend(scenes.iter().map(cell));
        cells
    };
    let mut names = header(&["solver", "tolerance"]);
    names.extend(scenes.iter().map(|scene| scene.to_string()));
    Section {
        title: format!("Tolerances of equilibria, stvk on {nodes}x{nodes} nodes"),
        words: "Error of the positions, and factorisations. A tolerance is tight enough where the error equals that of the mesh."
            .into(),
        header: names,
        rows: rows.iter().map(row).collect(),
        plot: None,
    }
}
