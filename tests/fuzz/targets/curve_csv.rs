//! A curve as a table: stress over strain, or moment over curvature.

#![no_main]

use cloth_data::curve_file::CurveFile;
use cloth_sim::material::{Component, Compression, Model};
use fit_cloth_fuzz::{Sample, answer, evaluate};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static SAMPLE: LazyLock<Sample> = LazyLock::new(Sample::default);

fuzz_target!(|bytes: &[u8]| {
    let path = SAMPLE.put("curve.csv", bytes);
    let Some(file) = answer(CurveFile::read(&path), bytes) else { return };
    let text = file.to_csv();
    let back =
        CurveFile::read(&SAMPLE.put("back.csv", text.as_bytes())).expect("what was written can be read");
    assert_eq!((back.measure, back.to_csv()), (file.measure, text));
    for (component, model, compression) in [
        (Component::StretchWeft, Model::STVK, Compression::ZeroStrain),
        (Component::StretchWarp, Model::SOFT_CONSTRAINT, Compression::None),
        (Component::Shear, Model::SPRINGS, Compression::ZeroStrain),
        (Component::BendDiagonal, Model::STVK, Compression::ZeroStrain),
    ] {
        let negative = model.negative_strain(component, compression);
        let Some(curve) = answer(file.curve(component, model, negative), bytes) else { continue };
        evaluate(&curve);
        // A table written from the curve reads back as that curve, up to rounding.
        let again = SAMPLE.put("again.csv", file.with_points(&curve).to_csv().as_bytes());
        let again = CurveFile::read(&again).expect("what was written can be read");
        let again = again.curve(component, model, negative).expect("its own points make a curve");
        assert_eq!(again.len(), curve.len());
    }
});
