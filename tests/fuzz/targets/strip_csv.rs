//! A tensile machine's table of a strip, with extension and force in the first two columns.

#![no_main]

use cloth_data::strip::{Direction, Extension, StripTest, read_strip};
use fit_cloth_fuzz::{Sample, answer, columns};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static SAMPLE: LazyLock<Sample> = LazyLock::new(Sample::default);

fuzz_target!(|bytes: &[u8]| {
    let Some([extension, force]) = columns(bytes) else { return };
    let path = SAMPLE.put("strip.csv", bytes);
    for (direction, extension) in [
        (Direction::Weft, Extension::Separation(extension.clone())),
        (Direction::Warp, Extension::Displacement(extension.clone())),
        (Direction::Bias, Extension::Strain(extension)),
    ] {
        let test = StripTest::new(direction, 0.08, 0.04, extension, force.clone());
        let Some(mut strip) = answer(read_strip(&path, &test), bytes) else { continue };
        strip.inspect(Some(0.3));
        SAMPLE.comes_back(strip.sequence);
    }
});
