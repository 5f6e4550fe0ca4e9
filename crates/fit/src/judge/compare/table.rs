//! `compare.csv`.

use super::distance::Distance;
use super::row::Row;
use cloth_sim::material::Component;

const COLUMNS: &str = "model,variant,parameters,missing,\
fit_relative,fit_rms_force_n,fit_rms_position_m,fit_frames_dropped,\
validation_relative,validation_rms_force_n,validation_rms_position_m,validation_frames_dropped,\
leave_one_out_relative,equilibria,factorisations,seconds,converged,failure\n";

pub(super) fn csv(rows: &[Row]) -> String {
    let rows = rows.iter().map(|row| cells(row).join(",") + "\n");
    std::iter::once(COLUMNS.to_string()).chain(rows).collect()
}

fn cells(row: &Row) -> Vec<String> {
    let mut cells =
        vec![row.model.to_string(), row.variant.to_string(), row.parameters.to_string(), names(&row.missing)];
    cells.extend(distance(Some(row.fit)));
    cells.extend(distance(row.validation));
    cells.extend([
        number(row.leave_one_out),
        row.equilibria.to_string(),
        row.factorisations.to_string(),
        format!("{:.3}", row.seconds),
        row.converged.to_string(),
        row.failure.as_deref().map(quoted).unwrap_or_default(),
    ]);
    cells
}

fn distance(distance: Option<Distance>) -> [String; 4] {
    let figure = |of: fn(Distance) -> Option<f64>| number(distance.and_then(of));
    [
        figure(|distance| distance.relative),
        figure(|distance| distance.rms_force_n),
        figure(|distance| distance.rms_position_m),
        distance.map(|distance| distance.dropped.to_string()).unwrap_or_default(),
    ]
}

fn number(value: Option<f64>) -> String {
    value.map(|value| value.to_string()).unwrap_or_default()
}

fn names(components: &[Component]) -> String {
    components.iter().map(|component| component.to_string()).collect::<Vec<_>>().join(" ")
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}
