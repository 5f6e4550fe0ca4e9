//! `frames/0000.ply`: one shape of four vertices.

#![no_main]

use fit_cloth_fuzz::Sample;
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static SAMPLE: LazyLock<Sample> = LazyLock::new(|| {
    let sample = Sample::default();
    std::fs::remove_file(sample.path("bent/positions.npy")).expect("shapes in files instead");
    std::fs::create_dir(sample.path("bent/frames")).expect("a new folder");
    sample
});

fuzz_target!(|bytes: &[u8]| {
    SAMPLE.put("bent/frames/0000.ply", bytes);
    SAMPLE.read("bent", bytes);
});
