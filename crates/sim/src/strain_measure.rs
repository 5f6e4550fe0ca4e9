//! Strain measures of the models, and the corresponding laboratory measures.
//!
//! ```text
//!                 strain of an element          physical measure p          load there
//! Green           E = (λ² − 1)/2                λ − 1                       P = λ σ(E)
//! engineering     λ − 1                         λ − 1                       P = σ(λ − 1)
//! shear           w_u·w_v = sin γ               γ, picture frame            S = σ(sin γ)
//! diagonal        ε± = √(1 ± sin γ) − 1         γ, picture frame            S cos γ = dW/dγ, W = ½ W_c(ε₊) + ½ W_c(ε₋)
//! hinge           3 κ on a regular grid         κ, rolled sheet             M = σ(3κ)
//! ring-2 springs  depends on the mesh           κ, rolled sheet             see Rolled
//! ```
//!
//! P is the force per rest width of a strip (engineering strain, nominal stress), S the force along a bar per its
//! length, M the moment per width. Diagonals: both diagonals of square cells.

use crate::curve::NegativeStrain;
use crate::curve::soundness::{BENDING_STIFFNESS, MEMBRANE_STIFFNESS};

/// Ratio of a hinge's own strain to the curvature, for a regular grid rolled about one of its axes. The flexural
/// rigidity exceeds the hinge's stiffness by the same factor.
///
/// ```text
/// ε = 3κ    D = 3k        κ in 1/m, D and k in N·m
/// ```
///
/// Source: h₀ = a third of the mean height; docs/model.md, "What a hinge's stiffness means".
pub const HINGE_STRAIN_PER_CURVATURE: f64 = 3.0;

/// Strain measure of a component in a model; the stress is conjugate to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StrainMeasure {
    /// Green strain, second Piola–Kirchhoff (PK2) stress per width.
    Green,
    /// Engineering strain, nominal stress per width.
    Engineering,
    /// w_u·w_v of a triangle.
    Shear,
    /// Engineering strain of the cells' diagonals.
    Diagonal,
    /// Curvature or twist of a sheet, 1/m.
    Curvature,
    /// Hinge strain of discrete shells, 1/m.
    Hinge,
    /// Strain of springs over two segments of a grid. Its curvature depends on the mesh:
    /// [`Bending::rolled`](crate::bending::Bending::rolled).
    RingTwo,
}

impl StrainMeasure {
    /// All measures; of those with the same columns the one of fitted curves first.
    pub const ALL: [Self; 7] = [
        Self::Green,
        Self::Engineering,
        Self::Shear,
        Self::Diagonal,
        Self::Hinge,
        Self::Curvature,
        Self::RingTwo,
    ];

    /// True for stretch and shear, false for bending.
    pub fn is_of_membrane(self) -> bool {
        match self {
            Self::Green | Self::Engineering | Self::Shear | Self::Diagonal => true,
            Self::Curvature | Self::Hinge | Self::RingTwo => false,
        }
    }

    /// The rule below zero strain under which a sheet in compression keeps its stiffness at zero.
    pub fn compression(self) -> NegativeStrain {
        match self {
            Self::Green => NegativeStrain::Green,
            Self::Engineering => NegativeStrain::Linear,
            Self::Shear | Self::Diagonal | Self::Curvature | Self::Hinge | Self::RingTwo => {
                NegativeStrain::Odd
            }
        }
    }

    /// Names of strain and stress. Curvature and moment for hinges and ring-2 springs, whose tables are in physical
    /// measures.
    pub fn names(self) -> [&'static str; 2] {
        match self {
            Self::Green => ["Green strain", "PK2 stress"],
            Self::Engineering => ["engineering strain", "nominal stress"],
            Self::Shear => ["shear strain", "shear stress"],
            Self::Diagonal => ["diagonal strain", "diagonal stress"],
            Self::Curvature | Self::Hinge | Self::RingTwo => ["curvature", "moment per width"],
        }
    }

    /// Column names of a table: strain, secant stiffness, stress, and the lower and upper limit of the stress.
    pub fn columns(self) -> [&'static str; 5] {
        const K: &str = "stiffness_n_per_m";
        match self {
            Self::Green => {
                ["green_strain", K, "pk2_stress_n_per_m", "pk2_stress_low_n_per_m", "pk2_stress_high_n_per_m"]
            }
            Self::Engineering => [
                "engineering_strain",
                K,
                "nominal_stress_n_per_m",
                "nominal_stress_low_n_per_m",
                "nominal_stress_high_n_per_m",
            ],
            Self::Shear => [
                "shear_strain",
                K,
                "shear_stress_n_per_m",
                "shear_stress_low_n_per_m",
                "shear_stress_high_n_per_m",
            ],
            Self::Diagonal => [
                "diagonal_strain",
                K,
                "diagonal_stress_n_per_m",
                "diagonal_stress_low_n_per_m",
                "diagonal_stress_high_n_per_m",
            ],
            Self::Curvature | Self::Hinge | Self::RingTwo => {
                ["curvature_per_m", "rigidity_n_m", "moment_n", "moment_low_n", "moment_high_n"]
            }
        }
    }

    /// True if strain, stress and stiffness are in 1/m, N and N·m; otherwise they are in 1, N/m and N/m.
    pub fn is_per_metre(self) -> bool {
        matches!(self, Self::Curvature | Self::Hinge)
    }

    /// Ratio of element strain to the strain or curvature of a table: 3 for hinges, otherwise 1.
    pub fn strain_per_unit(self) -> f64 {
        match self {
            Self::Hinge => HINGE_STRAIN_PER_CURVATURE,
            Self::Green
            | Self::Engineering
            | Self::Shear
            | Self::Diagonal
            | Self::Curvature
            | Self::RingTwo => 1.0,
        }
    }

    /// Plausible range of a cloth's largest stiffness, in the units of stiffness; `None` if it depends on the mesh.
    pub fn plausible_stiffness(self) -> Option<[f64; 2]> {
        match self {
            Self::Curvature => Some(BENDING_STIFFNESS.map(|k| HINGE_STRAIN_PER_CURVATURE * k)),
            Self::Hinge => Some(BENDING_STIFFNESS),
            Self::RingTwo => None,
            Self::Green | Self::Engineering | Self::Shear | Self::Diagonal => Some(MEMBRANE_STIFFNESS),
        }
    }

    /// Physical measure at a strain: extension over rest length, shear angle in rad, or curvature in 1/m. `None` for
    /// ring-2 springs and for impossible strains.
    pub fn physical(self, strain: f64) -> Option<f64> {
        let physical = match self {
            // Without cancellation: (λ² − 1)/(λ + 1).
            Self::Green => 2.0 * strain / ((1.0 + 2.0 * strain).sqrt() + 1.0),
            Self::Engineering | Self::Curvature => strain,
            Self::Shear => strain.asin(),
            Self::Diagonal => (strain * (2.0 + strain)).asin(),
            Self::Hinge => strain / HINGE_STRAIN_PER_CURVATURE,
            Self::RingTwo => return None,
        };
        physical.is_finite().then_some(physical)
    }

    /// Strain at a physical measure; `None` for ring-2 springs.
    pub fn strain(self, physical: f64) -> Option<f64> {
        Some(match self {
            Self::Green => physical * (1.0 + 0.5 * physical),
            Self::Engineering | Self::Curvature => physical,
            Self::Shear => physical.sin(),
            Self::Diagonal => (1.0 + physical.sin()).sqrt() - 1.0,
            Self::Hinge => HINGE_STRAIN_PER_CURVATURE * physical,
            Self::RingTwo => return None,
        })
    }

    /// Load at a physical measure: force per rest width or per bar length, N/m, or moment per width, N; `None` for
    /// ring-2 springs.
    ///
    /// * `stress` — stress at an element strain
    pub fn load(self, physical: f64, stress: impl Fn(f64) -> f64) -> Option<f64> {
        let own = stress(self.strain(physical)?);
        Some(match self {
            Self::Green => (1.0 + physical) * own,
            Self::Engineering | Self::Shear | Self::Curvature | Self::Hinge => own,
            Self::Diagonal => {
                let along = |sine: f64| {
                    let stretch = (1.0 + sine).sqrt();
                    0.25 * stress(stretch - 1.0) / stretch
                };
                along(physical.sin()) - along(-physical.sin())
            }
            Self::RingTwo => return None,
        })
    }

    /// Strain and secant stiffness in another measure that give the same load as a stress in this measure at a strain ≥
    /// 0; `None` if either measure is that of ring-2 springs.
    pub fn secant_in(self, other: Self, strain: f64, stress: impl Fn(f64) -> f64) -> Option<[f64; 2]> {
        // The stiffness at rest is a limit: evaluate it nearby.
        let physical = self.physical(strain.max(1e-6))?;
        // Load for a stiffness of one.
        let unit = other.load(physical, |strain| strain)?;
        let there = if strain == 0.0 { 0.0 } else { other.strain(physical)? };
        Some([there, self.load(physical, stress)? / unit])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::StiffnessCurve;
    use crate::finite_difference::derivative_error;

    fn measures() -> impl Iterator<Item = StrainMeasure> {
        StrainMeasure::ALL.into_iter().filter(|measure| *measure != StrainMeasure::RingTwo)
    }

    #[test]
    fn the_way_back_ends_where_it_began() {
        for measure in measures() {
            for physical in [-0.1, 1e-9, 0.02, 0.3, 0.9] {
                let back = measure.physical(measure.strain(physical).unwrap()).unwrap();
                assert!((back / physical - 1.0).abs() < 1e-7, "{measure:?}: {back}, {physical}");
            }
        }
        assert_eq!(StrainMeasure::Shear.physical(1.2), None);
    }

    /// Virtual work: the load is the derivative of the energy with respect to the physical measure, per unit of width
    /// or length.
    #[test]
    fn a_load_is_conjugate_to_its_physical_measure() {
        let curve = StiffnessCurve::new(vec![0.0, 0.5], vec![2.0, 5.0], NegativeStrain::Odd).unwrap();
        for measure in measures() {
            let energy = |p: f64| match measure {
                StrainMeasure::Diagonal => {
                    let strain = |sine: f64| (1.0 + sine).sqrt() - 1.0;
                    0.5 * (curve.energy(strain(p.sin())) + curve.energy(strain(-p.sin())))
                }
                _ => curve.energy(measure.strain(p).unwrap()),
            };
            for p in [0.05, 0.1, 0.4f64] {
                let lever = match measure {
                    StrainMeasure::Shear | StrainMeasure::Diagonal => p.cos(),
                    StrainMeasure::Hinge => HINGE_STRAIN_PER_CURVATURE,
                    _ => 1.0,
                };
                let load = measure.load(p, |strain| curve.stress(strain)).unwrap();
                let error = derivative_error(|p| vec![energy(p[0])], &[load * lever], &[p], 1e-4, 1e-9);
                assert!(error < 1e-7, "{measure:?} at {p}: {error:.1e}");
            }
        }
    }
}
