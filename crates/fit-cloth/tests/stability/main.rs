//! The stability suite: what can go wrong, case by case, and what must happen then. The list and the last full run stand in
//! docs/stability.md.
//!
//! ```text
//! cargo test -p fit-cloth --test stability                                            every case, few runs
//! cargo test -p fit-cloth --test stability --release -- --ignored --nocapture         every case, all runs, the table
//! ```

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test that cannot be set up has failed")]

mod files;
mod fits;
mod inputs;
mod measured;
mod misfits;
mod property;
mod readers;
mod solver;
mod structure;
#[path = "../support/mod.rs"]
mod support;
mod table;
mod tokens;

use table::{Extent, HEADER, Row, assert_green};

/// A test a case, and all of them in order.
macro_rules! cases {
    ($($name:ident => $rows:path,)*) => {
        $(#[test]
        fn $name() {
            assert_green(&$rows(Extent::Quick));
        })*

        /// The rows of every case, in order.
        const CASES: &[(&str, fn(Extent) -> Vec<Row>)] = &[$((stringify!($name), $rows),)*];
    };
}

cases! {
    case_18_millimetres_for_metres => inputs::case_18,
    case_32_what_no_frame_sees => fits::case_32,
    case_33_one_frame_and_identical_frames => fits::case_33,
    case_34_columns_far_apart => solver::case_34,
    case_35_almost_solved => solver::case_35,
    case_36_outliers => misfits::case_36,
    case_37_truth_on_a_bound => fits::case_37,
    case_38_twenty_starts => fits::case_38,
    case_39_buckled_frames => misfits::case_39,
    case_40_wrong_models => misfits::case_40,
    case_41_marks_and_line_endings => inputs::case_41,
    case_42_other_encodings => inputs::case_42,
    case_43_semicolons_and_decimal_commas => inputs::case_43,
    case_44_what_is_no_number => inputs::case_44,
    case_45_ragged_tables => structure::case_45,
    case_46_units_missing => structure::case_46,
    case_47_faces_of_obj => structure::case_47,
    case_48_json => structure::case_48,
    case_49_what_is_no_file => files::case_49,
}

#[test]
#[ignore = "full counts: many minutes"]
fn full_run() {
    println!("{HEADER}");
    let mut all = Vec::new();
    for (_, case) in CASES {
        let rows = case(Extent::Full);
        rows.iter().for_each(|row| println!("{row}"));
        all.extend(rows);
    }
    let runs: u64 = all.iter().map(|row| row.runs).sum();
    println!("\n{} distinct cases, {runs} runs", all.len());
    assert_green(&all);
}
