//! Measures a built-in fabric on the virtual rig, and prints what the inspection notices after a wrong unit:
//! `cargo run -p cloth-data --example inspect`.
#![allow(clippy::print_stdout)]

use cloth_data::error::Result;
use cloth_data::frame::Kind;
use cloth_data::inspection::inspect;
use cloth_data::rig::{KnownFabric, Rig};

fn main() -> Result<()> {
    let rig = Rig {
        sequences: vec![Kind::StretchWeft],
        nodes: [9, 9],
        measured: [9, 9],
        frames: 6,
        ..Rig::default()
    };
    let mut set = rig.measure(&KnownFabric::named("cotton-denim")?)?;
    // Forces in millinewtons.
    set.sequences[0].frames.iter_mut().flat_map(|frame| &mut frame.cords).for_each(|cord| cord.force *= 1e3);
    for notice in inspect(&set).notices {
        println!("{notice}");
    }
    Ok(())
}

#[test]
fn runs() {
    main().expect("a built-in fabric");
}
