//! Curve error against noise of a built-in fabric, on coarse grids: `cargo run --release -p cloth-study --example quick`.
#![allow(clippy::print_stdout)]

use cloth_data::error::Result;
use cloth_fit::equilibria::Meter;
use cloth_study::extent::{Extent, Topic};
use cloth_study::progress::Progress;
use cloth_study::study;
use cloth_study::subject::Subject;
use cloth_study::table::study_csv;
use std::sync::Arc;

struct Silent;

impl Progress for Silent {
    fn note(&self, _: &str) {}

    fn meter(&self) -> Arc<Meter> {
        Arc::default()
    }
}

fn main() -> Result<()> {
    let coarse = Extent { noises: vec![1.0], seeds: 1, noise_nodes: 13, rig_nodes: 25, ..Extent::quick() };
    let extent = Extent { topics: vec![Topic::Noise], ..coarse };
    let subject = Subject::built_in(&extent)?;
    println!("{}", study_csv(&study::run(&subject, &extent, &Silent)?));
    Ok(())
}

#[test]
fn runs() {
    main().expect("a built-in fabric");
}
