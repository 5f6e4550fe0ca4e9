//! `fabric.toml` of a set.

#![no_main]

use cloth_data::frame::MeasurementSet;
use cloth_data::io::{read_fabric, write_set};
use fit_cloth_fuzz::{Sample, answer};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static SAMPLE: LazyLock<Sample> = LazyLock::new(Sample::default);

fuzz_target!(|bytes: &[u8]| {
    SAMPLE.put("fabric.toml", bytes);
    let Some(fabric) = answer(read_fabric(&SAMPLE.path("")), bytes) else { return };
    let numbers =
        [Some(fabric.width_m), Some(fabric.height_m), Some(fabric.areal_density_kg_m2), fabric.thickness_m];
    assert!(numbers.into_iter().flatten().all(|number| number > 0.0 && number <= 10.0));
    let back = SAMPLE.path("back");
    let set = MeasurementSet { fabric, sequences: Vec::new() };
    write_set(&back, &set).expect("what was read can be written");
    assert_eq!(read_fabric(&back).expect("what was written can be read"), set.fabric);
});
