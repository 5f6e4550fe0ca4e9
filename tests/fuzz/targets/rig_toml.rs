//! A fabric of the virtual rig.

#![no_main]

use cloth_data::rig::KnownFabric;
use fit_cloth_fuzz::{answer, evaluate};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Some(fabric) = answer(KnownFabric::parse("fabric.toml".as_ref(), text), bytes) else { return };
    let curves = fabric.curves().expect("what was read has curves");
    assert_eq!(curves.components().count(), 6);
    for component in curves.components() {
        curves.get(component).into_iter().for_each(evaluate);
    }
});
