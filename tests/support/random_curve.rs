//! Random curves: control values over three decades.

use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use rand::{Rng, SeedableRng, rngs::StdRng};

/// A curve of two to eight control points at random strains up to 0.05 … 0.5, each stiffness between 1 and 1000 N/m,
/// log-uniform. Most are not stable.
///
/// * `seed` — determines the curve
///
/// # Panics
/// Never: the strains ascend.
pub fn random_curve(seed: u64, negative: NegativeStrain) -> StiffnessCurve {
    let mut rng = StdRng::seed_from_u64(seed);
    let points = rng.random_range(2..=8);
    let last = rng.random_range(0.05..0.5);
    // Gaps between a tenth and twice of an even share, so that no two points coincide.
    let gaps: Vec<f64> = (1..points).map(|_| rng.random_range(0.1..2.0)).collect();
    let whole: f64 = gaps.iter().sum();
    let strains = std::iter::once(0.0).chain(gaps.iter().scan(0.0, |sum, gap| {
        *sum += gap;
        Some(last * *sum / whole)
    }));
    let strains: Vec<f64> = strains.collect();
    let stiffnesses = (0..points).map(|_| 10f64.powf(rng.random_range(0.0..3.0))).collect();
    StiffnessCurve::new(strains, stiffnesses, negative).expect("ascending strains from zero")
}
