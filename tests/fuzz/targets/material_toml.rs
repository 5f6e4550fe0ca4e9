//! A material written by hand; it may name a table beside it.

#![no_main]

use cloth_fit::material::Material;
use fit_cloth_fuzz::{Sample, answer, evaluate};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static SAMPLE: LazyLock<Sample> = LazyLock::new(|| {
    let sample = Sample::default();
    sample.put("a.csv", b"strain,stress_n_per_m\n0,0\n0.1,3\n0.2,6\n");
    sample.put("b.csv", b"curvature_per_m,moment_n\n0,0\n10,3e-4\n");
    sample
});

fuzz_target!(|bytes: &[u8]| {
    let path = SAMPLE.put("cloth.toml", bytes);
    let Some(material) = answer(Material::read(&path), bytes) else { return };
    assert!(!material.name.is_empty() && material.areal_density > 0.0 && material.areal_density <= 10.0);
    for component in material.curves.components() {
        material.curves.get(component).into_iter().for_each(evaluate);
    }
    let compression = material.compression;
    assert_eq!(material.clone().with_compression(compression).expect("the same rule"), material);
});
