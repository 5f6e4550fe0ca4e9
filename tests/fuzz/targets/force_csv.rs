//! A table of force over elongation, as a curve.

#![no_main]

use cloth_data::strip::{Conversion, Extension, ForceTable, read_force_table};
use fit_cloth_fuzz::{Sample, answer, columns};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static SAMPLE: LazyLock<Sample> = LazyLock::new(Sample::default);

fuzz_target!(|bytes: &[u8]| {
    let Some([extension, force]) = columns(bytes) else { return };
    let path = SAMPLE.put("force.csv", bytes);
    for (extension, conversion) in [
        (Extension::Separation(extension.clone()), Conversion::Green),
        (Extension::Displacement(extension.clone()), Conversion::Engineering),
        (Extension::Strain(extension), Conversion::Shear { tension: 100.0 }),
    ] {
        let (width, gauge) = (0.04, Some(0.08));
        let table = ForceTable { width, gauge, extension, force: force.clone(), rows: None, conversion };
        let Some(curve) = answer(read_force_table(&path, &table), bytes) else { continue };
        assert!(curve.strains.iter().chain(&curve.stresses).all(|number| number.is_finite()), "{curve:?}");
    }
});
