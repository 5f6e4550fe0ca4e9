//! `study.csv`, `ablation.csv`, and the output of `--json`.

use crate::ablation::Ablated;
use crate::run::Run;
use crate::spent::Spent;
use crate::study::Study;
use cloth_sim::equilibrium::Tolerance;
use serde_json::{Map, Value, json};

const RUN_COLUMNS: &str = "part,test,model,solver,nodes,points,frames,noise,tolerance,seed,error_force,error_position_mm,\
error_curve,floor,seconds,equilibria,iterations,factorisations,peak_memory_mib,order,failed,status\n";

const ABLATION_COLUMNS: &str = "part,scene,by_default,seconds_with,seconds_without,saving,factorisations_with,\
factorisations_without,error_force,error_position_mm,error_curve,status_with,status_without\n";

/// Text of `study.csv`: one row per run, with empty cells for missing values.
pub fn study_csv(study: &Study) -> String {
    let rows = study.runs.iter().map(|run| run_cells(run).join(",") + "\n");
    std::iter::once(RUN_COLUMNS.to_string()).chain(rows).collect()
}

/// Text of `ablation.csv`.
pub fn ablation_csv(study: &Study) -> String {
    let rows = study.ablation.iter().map(|row| ablation_cells(row).join(",") + "\n");
    std::iter::once(ABLATION_COLUMNS.to_string()).chain(rows).collect()
}

/// Both tables as lists of objects, keyed by column name.
pub fn study_json(study: &Study) -> Value {
    let runs: Vec<Value> = study.runs.iter().map(|run| object(RUN_COLUMNS, run_cells(run))).collect();
    let ablation: Vec<Value> =
        study.ablation.iter().map(|row| object(ABLATION_COLUMNS, ablation_cells(row))).collect();
    json!({ "fabric": study.fabric, "reference": study.reference, "runs": runs, "ablation": ablation })
}

/// Numbers as numbers, empty cells as null, everything else as text.
fn object(columns: &str, cells: Vec<String>) -> Value {
    let value = |cell: String| match (cell.parse::<f64>(), cell.parse::<bool>()) {
        _ if cell.is_empty() => Value::Null,
        _ if cell.parse::<u64>().is_ok() => json!(cell.parse::<u64>().unwrap_or_default()),
        (Ok(number), _) => json!(number),
        (_, Ok(truth)) => json!(truth),
        _ => Value::String(cell.trim_matches('"').replace("\"\"", "\"")),
    };
    let names = columns.trim_end().split(',').map(str::to_string);
    Value::Object(names.zip(cells.into_iter().map(value)).collect::<Map<_, _>>())
}

fn run_cells(run: &Run) -> Vec<String> {
    let Spent { seconds, counters, peak_memory_mib } = run.spent;
    vec![
        run.part.to_string(),
        text(&run.test),
        run.model.to_string(),
        run.solver.to_string(),
        run.nodes.to_string(),
        whole(run.points),
        run.frames.to_string(),
        number(run.noise),
        tolerance(run.tolerance),
        whole(run.seed),
        number(run.error_force),
        number(run.error_position_mm),
        number(run.error_curve),
        number(run.floor),
        format!("{seconds:.6}"),
        counters.equilibria.to_string(),
        counters.iterations.to_string(),
        counters.factorisations.to_string(),
        peak_memory_mib.map(|memory| format!("{memory:.1}")).unwrap_or_default(),
        run.order.map(|order| format!("{order:.3}")).unwrap_or_default(),
        run.failed().to_string(),
        text(&run.ending.to_string()),
    ]
}

fn ablation_cells(row: &Ablated) -> Vec<String> {
    vec![
        text(&row.part),
        text(&row.scene),
        row.by_default.to_string(),
        format!("{:.6}", row.with.seconds),
        format!("{:.6}", row.without.seconds),
        format!("{:.3}", row.saving()),
        row.with.counters.factorisations.to_string(),
        row.without.counters.factorisations.to_string(),
        number(row.error_force),
        number(row.error_position_mm),
        number(row.error_curve),
        text(&row.ending[0].to_string()),
        text(&row.ending[1].to_string()),
    ]
}

/// A tolerance as written in the tables: `relative 1e-6`, or `absolute 1e-5 N`.
pub fn tolerance(tolerance: Tolerance) -> String {
    match tolerance {
        Tolerance::Relative(share) => format!("relative {share:e}"),
        Tolerance::Absolute(force) => format!("absolute {force:e} N"),
    }
}

fn text(value: &str) -> String {
    match value.contains([',', '"', '\n']) {
        true => format!("\"{}\"", value.replace('"', "\"\"")),
        false => value.into(),
    }
}

/// Five digits, more than the accuracy of any time or error here; empty for `None`.
fn number(value: Option<f64>) -> String {
    value.filter(|value| value.is_finite()).map(|value| format!("{value:.4e}")).unwrap_or_default()
}

fn whole(value: Option<impl ToString>) -> String {
    value.map(|value| value.to_string()).unwrap_or_default()
}
