//! Start of a scene: the sheet, slightly perturbed out of its plane.

use cloth_data::error::Result;
use cloth_data::io::TomlFile;
use cloth_sim::load::{Guided, Held};
use cloth_sim::mesh::Mesh;
use nalgebra::{Vector2, Vector3};

/// Number of waves in the perturbation, with directions spread evenly over half a turn.
const WAVES: usize = 12;

/// Stacked coordinates of the sheet, with every free node moved along the sheet's normal by up to `size`, m.
///
/// The perturbation is a fixed function of the material coordinates over the sheet's size L, independent of the mesh,
/// so that a finer mesh starts alike:
///
/// ```text
/// Σ_k sin(2π λ_k (u cos α_k + v sin α_k)/L + φ_k) / n      α_k = kπ/n,   λ_k from 1 to 4,   φ_k irregular
/// ```
pub(super) fn perturbed(
    mesh: &Mesh,
    held: &[Held],
    guided: &[Guided],
    size: f64,
    file: &TomlFile,
) -> Result<Vec<f64>> {
    if !(size >= 0.0 && size.is_finite()) {
        return Err(file.invalid("start.perturbation_m", size.to_string(), "0 or more"));
    }
    let normal = normal(mesh);
    let centre = mesh.material.iter().sum::<Vector2<f64>>() / mesh.len() as f64;
    let extent = 2.0 * mesh.material.iter().map(|m| (m - centre).norm()).fold(0.0, f64::max);
    let mut moves = vec![true; mesh.len()];
    let fixed = held.iter().map(|held| held.node).chain(guided.iter().map(|guided| guided.node));
    fixed.for_each(|node| moves[node] = false);
    let place = |(node, rest): (usize, &Vector3<f64>)| {
        let by = if moves[node] { size * shape((mesh.material[node] - centre) / extent) } else { 0.0 };
        <[f64; 3]>::from(rest + by * normal)
    };
    Ok(mesh.positions.iter().enumerate().flat_map(place).collect())
}

/// Perturbation at a point, between −1 and 1.
fn shape(place: Vector2<f64>) -> f64 {
    use std::f64::consts::{PI, TAU};
    let wave = |k: usize| {
        let (sine, cosine) = (PI * k as f64 / WAVES as f64).sin_cos();
        // Multiples of the golden ratio and of √2 never repeat.
        let count = 1.0 + 3.0 * (0.618_033_988_749_894_9 * k as f64).fract();
        let phase = TAU * (std::f64::consts::SQRT_2 * k as f64).fract();
        (TAU * count * (place.x * cosine + place.y * sine) + phase).sin()
    };
    (0..WAVES).map(wave).sum::<f64>() / WAVES as f64
}

/// Mean unit normal of a sheet; the z axis if it is undefined.
pub fn normal(mesh: &Mesh) -> Vector3<f64> {
    let cross = |[a, b, c]: &[usize; 3]| {
        let [a, b, c] = [a, b, c].map(|&node| mesh.positions[node]);
        (b - a).cross(&(c - a))
    };
    let sum: Vector3<f64> = mesh.triangles.iter().map(cross).sum();
    sum.try_normalize(0.0).unwrap_or(Vector3::z())
}
