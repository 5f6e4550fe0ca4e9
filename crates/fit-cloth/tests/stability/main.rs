//! The stability suite: everything that can go wrong, case by case, and the required behaviour. The list and the last
//! full run are in docs/stability.md.
//!
//! ```text
//! cargo test -p fit-cloth --test stability                                            every case, few runs
//! cargo test -p fit-cloth --test stability full_run -- --ignored --nocapture          every case, all runs, the table
//! CASE=case_22 cargo test …                                                           one of them
//! ```

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test that cannot be set up has failed")]

mod balance;
#[allow(dead_code, reason = "other figures need the rest")]
#[path = "../../src/plot/chart.rs"]
mod chart;
mod collapse;
mod convergence;
mod curves;
mod derivatives;
#[path = "../../src/plot/drawing.rs"]
mod drawing;
mod elements;
mod equilibria;
#[cfg(target_os = "linux")]
mod fault;
mod files;
mod fits;
mod inputs;
#[cfg(target_os = "linux")]
mod interruption;
mod measured;
mod meshes;
mod misfits;
mod motion;
mod property;
mod readers;
#[path = "../../src/plot/series.rs"]
mod series;
mod sheets;
mod solver;
mod stiff;
mod stretched;
mod structure;
#[path = "../support/mod.rs"]
mod support;
#[cfg(target_os = "linux")]
mod surroundings;
mod table;
mod tokens;
#[path = "../../src/plot/writing.rs"]
mod writing;

use table::{Extent, HEADER, Row, SUMMARY, assert_green, summary};

/// A test per case, and the list of all cases.
macro_rules! cases {
    ($($(#[$only:meta])? $name:ident => $rows:path,)*) => {
        $($(#[$only])?
        #[test]
        fn $name() {
            assert_green(&$rows(Extent::Quick));
        })*

        /// The functions that return the rows of every case, in order.
        const CASES: &[(&str, fn(Extent) -> Vec<Row>)] = &[$($(#[$only])? (stringify!($name), $rows),)*];
    };
}

cases! {
    case_01_negative_stiffness_between_points => curves::case_01,
    case_02_falling_tangent => curves::case_02,
    case_03_strain_far_past_the_last_point => stretched::case_03,
    case_04_one_point_all_zero_six_decades => stretched::case_04,
    case_05_bad_knots => curves::case_05,
    case_06_strong_compression => elements::case_06,
    case_07_no_length => collapse::case_07,
    case_08_hinge_angle => collapse::case_08,
    case_09_collapsed_wing => collapse::case_09,
    case_10_slender_cells => elements::case_10,
    case_11_derivatives => derivatives::case_11,
    case_12_rigid_motion => elements::case_12,
    case_13_bad_vertices => meshes::case_13,
    case_14_no_area => meshes::case_14,
    case_15_three_faces_at_an_edge => meshes::case_15,
    case_16_mixed_winding => meshes::case_16,
    case_17_bad_material_coordinates => meshes::case_17,
    case_18_millimetres => sheets::case_18,
    case_18_millimetres_for_metres => inputs::case_18,
    case_19_parts_that_nothing_holds => sheets::case_19,
    case_20_nothing_held => equilibria::case_20,
    case_21_flat_in_compression => equilibria::case_21,
    case_22_stiff_against_soft => stiff::case_22,
    case_23_springs_at_flat => equilibria::case_23,
    case_24_clips_that_jump => equilibria::case_24,
    case_25_strong_gravity => stiff::case_25,
    case_26_no_load => equilibria::case_26,
    case_27_iteration_cap => equilibria::case_27,
    case_28_runge_kutta_beyond_its_limit => motion::case_28,
    case_29_energy_of_implicit_euler => motion::case_29,
    case_30_not_finite_in_mid_run => motion::case_30,
    case_31_at_rest_for_long => motion::case_31,
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
    #[cfg(target_os = "linux")] case_50_interrupted_at_any_moment => interruption::case_50,
    #[cfg(target_os = "linux")] case_51_killed_at_every_write => interruption::case_51,
    #[cfg(target_os = "linux")] case_52_disk_full_at_every_write => interruption::case_52,
    #[cfg(target_os = "linux")] case_53_two_runs_on_one_folder => surroundings::case_53,
    #[cfg(target_os = "linux")] case_54_any_number_of_threads => surroundings::case_54,
    #[cfg(target_os = "linux")] case_55_nobody_reads_the_output => surroundings::case_55,
}

#[test]
#[ignore = "full counts: many minutes"]
fn full_run() {
    println!("{HEADER}");
    let (mut all, mut summaries) = (Vec::new(), vec![SUMMARY.to_string()]);
    let wanted = std::env::var("CASE").unwrap_or_default();
    for (name, case) in CASES.iter().filter(|(name, _)| name.contains(&wanted)) {
        let rows = case(Extent::Full);
        rows.iter().for_each(|row| println!("{row}"));
        summaries.push(summary(name, &rows));
        all.extend(rows);
    }
    let runs: u64 = all.iter().map(|row| row.runs).sum();
    println!("\n{}\n\n{} distinct cases, {runs} runs", summaries.join("\n"), all.len());
    assert_green(&all);
}

#[test]
#[ignore = "some minutes, and it writes the figures of docs/stability"]
fn convergence_over_the_stiffness_ratio() {
    println!("{}", convergence::report());
}
