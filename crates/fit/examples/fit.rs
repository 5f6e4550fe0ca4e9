//! Fits the stretch curves of a built-in fabric and prints them: `cargo run -p cloth-fit --example fit`.
#![allow(clippy::print_stdout)]

use cloth_data::error::Result;
use cloth_data::rig::{KnownFabric, Rig};
use cloth_fit::incremental::{Stage, fit};
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::{Settings, Watch};

fn main() -> Result<()> {
    let rig = Rig { nodes: [13, 13], measured: [13, 13], ..Rig::default() };
    let set = rig.measure(&KnownFabric::named("cotton-denim")?)?;
    let settings = Settings { nodes: Some([7, 7]), ..Settings::default() };
    let report = fit(&set, &[Stage::Stretch], &Knowledge::default(), &settings, &mut Watch::default())?;
    for component in report.curves().components() {
        let points = report.curves().get(component).map(|curve| (curve.strains(), curve.stiffnesses()));
        println!("{component}: strain, stiffness N/m {points:?}");
    }
    Ok(())
}

#[test]
fn runs() {
    main().expect("a built-in fabric");
}
