//! The tables of a result folder.

use crate::incremental::FitReport;
use crate::stage::report::{CurveRow, SequenceReport, StageReport};
use cloth_data::curve_file::{ENGINEERING, columns, engineering};
use std::fmt::Write;

/// The table of a curve, 201 rows. Band cells are empty where the data do not see the curve; without any band the
/// columns are omitted. Curves over Green strain also list engineering strain and nominal stress.
pub(super) fn curve_table(stage: &StageReport) -> String {
    let curve = &stage.curve;
    let banded = curve.samples.iter().any(|sample| sample.band.is_some());
    let measure = stage.model.strain_measure(stage.components[0]);
    let beside = |sample: &CurveRow| engineering(measure, sample.strain, sample.stress);
    let engineering = curve.samples.iter().all(|sample| beside(sample).is_some());
    let columns = columns(Some(measure));
    let mut table = columns[..if banded { 5 } else { 3 }].join(",");
    if engineering {
        table = [&table, ENGINEERING[0], ENGINEERING[1]].join(",");
    }
    table.push('\n');
    for sample @ CurveRow { strain, stiffness, stress, band } in &curve.samples {
        let _ = write!(table, "{strain},{stiffness},{stress}");
        if banded {
            let [low, high] = [0, 1].map(|side| cell(band.map(|band| band[side])));
            let _ = write!(table, ",{low},{high}");
        }
        if let Some([strain, stress]) = beside(sample).filter(|_| engineering) {
            let _ = write!(table, ",{strain},{stress}");
        }
        table.push('\n');
    }
    table
}

/// One row per sequence; cells without a measurement are empty.
pub(super) fn residual_table(report: &FitReport) -> String {
    let mut table = String::from(
        "sequence,kind,rms_force_n,largest_force_n,rms_position_m,frames,frames_left_out,iterations,seconds\n",
    );
    for (stage, sequence) in report.sequences() {
        let iterations: usize = stage.levels.iter().map(|level| level.iterations.len()).sum();
        let _ = writeln!(
            table,
            "{},{},{},{},{},{},{},{iterations},{:.3}",
            sequence.name,
            sequence.kind,
            cell(sequence.force_rms),
            cell(sequence.force_rms.map(|_| sequence.force_largest)),
            cell(sequence.position_rms),
            sequence.frames,
            stage.left_out(sequence),
            stage.seconds
        );
    }
    table
}

/// A number, or an empty cell.
pub(super) fn cell(value: Option<f64>) -> String {
    value.map(|value| value.to_string()).unwrap_or_default()
}

/// Every measured force component (its direction x, y, z in the specimen's frame) with its simulated value, for
/// plots.
pub(super) fn force_table<'r>(sequences: impl Iterator<Item = &'r SequenceReport>) -> String {
    let mut table = String::from("sequence,frame,clip,x,y,z,extension,measured_n,simulated_n\n");
    for sequence in sequences {
        for row in &sequence.forces {
            let _ = writeln!(
                table,
                "{},{},{},{},{},{},{},{},{}",
                sequence.name,
                row.frame,
                row.clip,
                row.direction.x,
                row.direction.y,
                row.direction.z,
                row.extension,
                row.measured,
                row.simulated
            );
        }
    }
    table
}
