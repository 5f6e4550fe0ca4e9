//! `material.json` of a fit.

#![no_main]

use cloth_fit::material::check::check_material;
use cloth_fit::material::file::MaterialFile;
use fit_cloth_fuzz::{Sample, answer};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static SAMPLE: LazyLock<Sample> = LazyLock::new(Sample::default);

fuzz_target!(|bytes: &[u8]| {
    let path = SAMPLE.put("material.json", bytes);
    let Some(material) = answer(MaterialFile::read(&path), bytes) else { return };
    let curves = material.curves().expect("what was read has curves");
    for curve in curves.components().filter_map(|component| curves.get(component)) {
        fit_cloth_fuzz::evaluate(curve);
    }
    check_material(&material).expect("what has curves can be checked");
    let back = SAMPLE.put("back.json", material.to_json().as_bytes());
    assert_eq!(MaterialFile::read(&back).expect("what was written can be read"), material);
});
