//! The result folder of a validation: `validation.json`, `validation.csv`, `measures.csv`, `forces.csv`.

use super::tables::{cell, force_table};
use crate::judge::validation::{MeasureRow, Validated, Validation};
use crate::material::file::{MaterialFile, ResidualEntry};
use crate::stage::Variant;
use crate::stage::interventions::Interventions;
use cloth_data::error::Result;
use cloth_data::frame::MeasurementSet;
use cloth_data::io::schema::Schema;
use cloth_data::kind::Summary;
use cloth_data::notice::Notice;
use cloth_data::store::write_file;
use cloth_sim::material::{Component, Model};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// The version of the format of `validation.json`.
/// The file format. Version 2: notices may carry remedies.
const SCHEMA: Schema = Schema::new("validation", &[|_| ()]);

/// `validation.json`.
#[derive(Serialize)]
struct File<'a> {
    schema: String,
    program: &'static str,
    model: Model,
    variant: Variant,
    /// Fabric of the curves, and fabric of the measurements.
    curves_of: &'a str,
    measured_on: &'a str,
    #[serde(skip_serializing_if = "<[Component]>::is_empty")]
    assumed: &'a [Component],
    sequences: Vec<Entry<'a>>,
    without_equilibrium: Vec<Dropped<'a>>,
    #[serde(skip_serializing_if = "<[Notice]>::is_empty")]
    notices: &'a [Notice],
    equilibria: usize,
    factorisations: usize,
    #[serde(skip_serializing_if = "Interventions::none")]
    interventions: &'a Interventions,
}

#[derive(Serialize)]
struct Entry<'a> {
    #[serde(flatten)]
    residual: ResidualEntry,
    frames_left_out: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    measure: Option<Whole<'a>>,
}

#[derive(Serialize)]
struct Whole<'a> {
    name: Summary,
    unit: &'static str,
    rms: Option<f64>,
    share_of_range: Option<f64>,
    rows: &'a [MeasureRow],
}

#[derive(Serialize)]
struct Dropped<'a> {
    sequence: &'a str,
    frame: usize,
    why: String,
}

/// Writes a validation into an existing folder; returns the text of `validation.json`.
///
/// # Errors
/// Errors of the file system.
pub fn write_validation(
    folder: &Path,
    set: &MeasurementSet,
    material: &MaterialFile,
    validation: &Validation,
) -> Result<String> {
    let json = json(set, material, validation);
    let forces = force_table(validation.sequences.iter().map(|sequence| &sequence.report));
    let [sequences, measures] = [sequence_table(validation), measure_table(validation)];
    write_file(&folder.join("validation.csv"), sequences.as_bytes())?;
    write_file(&folder.join("measures.csv"), measures.as_bytes())?;
    write_file(&folder.join("forces.csv"), forces.as_bytes())?;
    write_file(&folder.join("validation.json"), json.as_bytes())?;
    Ok(json)
}

fn json(set: &MeasurementSet, material: &MaterialFile, validation: &Validation) -> String {
    let prediction = &validation.prediction;
    let dropped = prediction.dropped.iter();
    let file = File {
        schema: SCHEMA.id(),
        program: concat!("fit-cloth ", env!("CARGO_PKG_VERSION")),
        model: material.model,
        variant: material.variant,
        curves_of: &material.fabric.name,
        measured_on: &set.fabric.name,
        assumed: &prediction.assumed,
        sequences: validation.sequences.iter().map(|sequence| entry(validation, sequence)).collect(),
        without_equilibrium: dropped
            .map(|d| Dropped { sequence: &d.sequence, frame: d.frame, why: d.status.to_string() })
            .collect(),
        notices: &prediction.notices,
        equilibria: prediction.counters.equilibria,
        factorisations: prediction.counters.factorisations,
        interventions: &prediction.interventions,
    };
    // Strings and finite numbers only: serialisation cannot fail.
    serde_json::to_string_pretty(&file).map(|text| text + "\n").unwrap_or_default()
}

fn entry<'a>(validation: &Validation, sequence: &'a Validated) -> Entry<'a> {
    Entry {
        residual: ResidualEntry::new(&sequence.report, &validation.prediction.dropped),
        frames_left_out: validation.left_out(&sequence.report),
        measure: sequence.measure.as_ref().map(|(measure, rows)| Whole {
            name: *measure,
            unit: measure.unit(),
            rms: sequence.measure_rms(),
            share_of_range: sequence.measure_share(),
            rows,
        }),
    }
}

/// One row per sequence, those without an equilibrium last; cells without a measurement are empty.
fn sequence_table(validation: &Validation) -> String {
    let mut table = String::from(
        "sequence,kind,frames,frames_left_out,frames_multi_stable,rms_force_n,largest_force_n,rms_position_m,\
         measure,unit,rms_measure,share_of_range\n",
    );
    for sequence in &validation.sequences {
        let report = &sequence.report;
        let (name, unit) =
            sequence.measure.as_ref().map_or_else(Default::default, |(m, _)| (key(*m), m.unit()));
        let _ = writeln!(
            table,
            "{},{},{},{},{},{},{},{},{name},{unit},{},{}",
            report.name,
            report.kind,
            report.frames,
            validation.left_out(report),
            report.multi_stable.len(),
            cell(report.force_rms),
            cell(report.force_rms.map(|_| report.force_largest)),
            cell(report.position_rms),
            cell(sequence.measure_rms()),
            cell(sequence.measure_share()),
        );
    }
    for (name, frames) in validation.lost() {
        let _ = writeln!(table, "{name},,0,{frames},0,,,,,,,");
    }
    table
}

/// The aggregate measure of every frame, measured and simulated.
fn measure_table(validation: &Validation) -> String {
    let mut table = String::from("sequence,frame,extension,measure,unit,measured,simulated,multi_stable\n");
    for sequence in &validation.sequences {
        let Some((measure, rows)) = &sequence.measure else { continue };
        let (name, unit) = (key(*measure), measure.unit());
        for MeasureRow { frame, extension, measured, simulated, multi_stable } in rows {
            let _ = writeln!(
                table,
                "{},{frame},{extension},{name},{unit},{measured},{simulated},{multi_stable}",
                sequence.report.name
            );
        }
    }
    table
}

/// A measure's name in JSON.
fn key(measure: Summary) -> String {
    measure.to_string().replace(' ', "-")
}
