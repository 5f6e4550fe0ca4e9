//! An OBJ file: as a rest mesh with and without its own `vt`, and as one shape of four vertices.

#![no_main]

use cloth_data::io::{ShapeFormat, YarnAxes, read_mesh, write_shapes};
use fit_cloth_fuzz::{Sample, answer, same};
use libfuzzer_sys::fuzz_target;
use nalgebra::Vector3;
use std::sync::LazyLock;

static SAMPLE: LazyLock<Sample> = LazyLock::new(|| {
    let sample = Sample::default();
    std::fs::remove_file(sample.path("bent/positions.npy")).expect("shapes in files instead");
    std::fs::create_dir(sample.path("bent/frames")).expect("a new folder");
    sample
});

fuzz_target!(|bytes: &[u8]| {
    let path = SAMPLE.put("bent/frames/0000.obj", bytes);
    for axes in [None, Some(YarnAxes { weft: Vector3::x(), warp: Vector3::z() })] {
        let Some(mesh) = answer(read_mesh(&path, axes), bytes) else { continue };
        assert!(mesh.positions.iter().flatten().chain(mesh.material.iter().flatten()).all(|c| c.is_finite()));
        assert!(
            (0..mesh.triangles.len()).all(|t| mesh.double_area(t) > 0.0 && mesh.double_area(t).is_finite())
        );
        write_shapes(&SAMPLE.path("back"), &mesh, &[], ShapeFormat::Obj)
            .expect("what was read can be written");
        same(&mesh, &read_mesh(&SAMPLE.path("back/mesh.obj"), None).expect("what was written can be read"));
    }
    SAMPLE.read("bent", bytes);
});
