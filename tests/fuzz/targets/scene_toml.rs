//! A scene; it may name a mesh beside it.

#![no_main]

use cloth_scene::scene::Scene;
use fit_cloth_fuzz::{Sample, answer};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static SAMPLE: LazyLock<Sample> = LazyLock::new(|| {
    let sample = Sample::default();
    sample.link("bent/mesh.obj", "a.obj");
    sample
});

fuzz_target!(|bytes: &[u8]| {
    if std::str::from_utf8(bytes).ok().and_then(takes_long) == Some(true) {
        return;
    }
    let path = SAMPLE.put("scene.toml", bytes);
    let Some(scene) = answer(Scene::read(&path), bytes) else { return };
    let nodes = scene.mesh.len();
    assert_eq!(scene.start.len(), 3 * nodes);
    assert!(scene.start.iter().chain(&scene.gravity).all(|number| number.is_finite()));
    assert!(scene.held.iter().all(|held| held.node < nodes));
    assert!(scene.guided.iter().all(|guided| guided.node < nodes));
});

/// True for a valid sheet with so many nodes that its mesh takes the time of a hundred other executions.
fn takes_long(text: &str) -> Option<bool> {
    let scene: toml::Table = text.parse().ok()?;
    let [grid, disc] = ["grid", "disc"].map(|shape| scene.get("sheet")?.get(shape));
    let nodes = grid.and_then(|grid| {
        let counts = grid.get("nodes")?.as_array()?.iter().map(|count| Some(count.as_integer()? as f64));
        counts.sum::<Option<f64>>()
    });
    let rings = disc.and_then(|disc| disc.get("rings")?.as_integer());
    Some(
        nodes.is_some_and(|nodes| (60.0..1e6).contains(&nodes))
            || rings.is_some_and(|rings| (20..=576).contains(&rings)),
    )
}
