//! `frames.csv`: time, cycle and phase of two frames.

#![no_main]

use fit_cloth_fuzz::Sample;
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static SAMPLE: LazyLock<Sample> = LazyLock::new(Sample::default);

fuzz_target!(|bytes: &[u8]| {
    SAMPLE.put("pulled/frames.csv", bytes);
    SAMPLE.read("pulled", bytes);
});
