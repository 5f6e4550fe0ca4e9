//! `test.toml` of a pulled strip and of a bent one.

#![no_main]

use fit_cloth_fuzz::Sample;
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static SAMPLE: LazyLock<Sample> = LazyLock::new(|| {
    let sample = Sample::default();
    sample.link("pulled/test.toml", "bent/test.toml");
    sample
});

fuzz_target!(|bytes: &[u8]| {
    SAMPLE.put("pulled/test.toml", bytes);
    SAMPLE.read("pulled", bytes);
    SAMPLE.read("bent", bytes);
});
