//! The stability suite: what can go wrong, case by case, and what must happen then. The list and the last full run stand in
//! docs/stability.md.
//!
//! ```text
//! cargo test -p fit-cloth --test stability                                            every case, few runs
//! cargo test -p fit-cloth --test stability --release -- --ignored --nocapture         every case, all runs, the table
//! ```

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test that cannot be set up has failed")]

#[cfg(target_os = "linux")]
mod fault;
#[cfg(target_os = "linux")]
mod interruption;
mod property;
#[cfg(target_os = "linux")]
mod surroundings;
mod table;

use table::{Extent, HEADER, Row, assert_green};

/// A test a case, and all of them in order.
macro_rules! cases {
    ($($(#[$only:meta])? $name:ident => $rows:path,)*) => {
        $($(#[$only])?
        #[test]
        fn $name() {
            assert_green(&$rows(Extent::Quick));
        })*

        /// The rows of every case, in order.
        const CASES: &[(&str, fn(Extent) -> Vec<Row>)] = &[$($(#[$only])? (stringify!($name), $rows),)*];
    };
}

cases! {
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
