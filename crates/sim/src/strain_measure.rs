//! The strain measures of the models, and what each is in a laboratory.
//!
//! ```text
//!                 strain of an element              physical measure p          load there
//! Green           E = (λ² − 1)/2                    λ − 1                       P = λ σ(E)
//! engineering     λ − 1                             λ − 1                       P = σ(λ − 1)
//! shear           w_u·w_v = sin γ                   γ, picture frame            S = σ(sin γ)
//! diagonal        ε± = √(1 ± sin γ) − 1             γ, picture frame            S cos γ = dW/dγ, W = ½ W_c(ε₊) + ½ W_c(ε₋)
//! hinge           3 κ on a regular grid             κ, rolled sheet             M = σ(3κ)
//! ring-2 springs  of each mesh its own              κ, rolled sheet             see Rolled
//! ```
//!
//! P is the force per rest width of a strip (engineering strain, nominal stress), S the force along a bar per its length,
//! M the moment per width. Diagonals: both of square cells.

use crate::curve::soundness::{BENDING_STIFFNESS, MEMBRANE_STIFFNESS};

/// A hinge's own strain per curvature where a regular grid is rolled about one of its axes; the flexural
/// rigidity is as many times the hinge's stiffness.
///
/// ```text
/// ε = 3κ    D = 3k        κ in 1/m, D and k in N·m
/// ```
///
/// Source: h₀ = a third of the mean height; docs/model.md, "What a hinge's stiffness means".
pub const HINGE_STRAIN_PER_CURVATURE: f64 = 3.0;

/// The strain of a component in a model; its stress is the conjugate one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StrainMeasure {
    /// Green strain, second Piola–Kirchhoff (PK2) stress per width.
    Green,
    /// Engineering strain, nominal stress per width.
    Engineering,
    /// w_u·w_v of triangles.
    Shear,
    /// Engineering strain of the cells' diagonals.
    Diagonal,
    /// Of discrete shells, 1/m.
    Hinge,
    /// Of springs over two segments of a grid. Only a mesh makes a curvature of it:
    /// [`Bending::rolled`](crate::bending::Bending::rolled).
    RingTwo,
}

impl StrainMeasure {
    /// Strain and stress in words; of hinges and ring-2 springs, whose tables are in physical terms, curvature and moment.
    pub fn names(self) -> [&'static str; 2] {
        match self {
            Self::Green => ["Green strain", "PK2 stress"],
            Self::Engineering => ["engineering strain", "nominal stress"],
            Self::Shear => ["shear strain", "shear stress"],
            Self::Diagonal => ["diagonal strain", "diagonal stress"],
            Self::Hinge | Self::RingTwo => ["curvature", "moment per width"],
        }
    }

    /// True if the strain is 1/m, the stress N and the stiffness N·m; else 1, N/m and N/m.
    pub fn is_per_metre(self) -> bool {
        self == Self::Hinge
    }

    /// Strain of the elements over the strain or curvature of a table: 3 for hinges, else 1.
    pub fn strain_per_unit(self) -> f64 {
        match self {
            Self::Hinge => HINGE_STRAIN_PER_CURVATURE,
            Self::Green | Self::Engineering | Self::Shear | Self::Diagonal | Self::RingTwo => 1.0,
        }
    }

    /// Between which the largest stiffness of a cloth lies, in the units of stiffness; `None` where it depends on the mesh.
    pub fn plausible_stiffness(self) -> Option<[f64; 2]> {
        match self {
            Self::Green | Self::Engineering | Self::Shear | Self::Diagonal => Some(MEMBRANE_STIFFNESS),
            Self::Hinge => Some(BENDING_STIFFNESS),
            Self::RingTwo => None,
        }
    }

    /// The physical measure at a strain: extension over rest length, shear angle in rad, or curvature in 1/m; `None` for
    /// ring-2 springs, and where no cloth has the strain.
    pub fn physical(self, strain: f64) -> Option<f64> {
        let physical = match self {
            // Without cancellation: (λ² − 1)/(λ + 1).
            Self::Green => 2.0 * strain / ((1.0 + 2.0 * strain).sqrt() + 1.0),
            Self::Engineering => strain,
            Self::Shear => strain.asin(),
            Self::Diagonal => (strain * (2.0 + strain)).asin(),
            Self::Hinge => strain / HINGE_STRAIN_PER_CURVATURE,
            Self::RingTwo => return None,
        };
        physical.is_finite().then_some(physical)
    }

    /// The strain at a physical measure; `None` for ring-2 springs.
    pub fn strain(self, physical: f64) -> Option<f64> {
        Some(match self {
            Self::Green => physical * (1.0 + 0.5 * physical),
            Self::Engineering => physical,
            Self::Shear => physical.sin(),
            Self::Diagonal => (1.0 + physical.sin()).sqrt() - 1.0,
            Self::Hinge => HINGE_STRAIN_PER_CURVATURE * physical,
            Self::RingTwo => return None,
        })
    }

    /// The load at a physical measure: force per rest width or per length of a bar, N/m, or moment per width, N; `None` for
    /// ring-2 springs.
    ///
    /// * `stress` — at a strain of the elements
    pub fn load(self, physical: f64, stress: impl Fn(f64) -> f64) -> Option<f64> {
        let own = stress(self.strain(physical)?);
        Some(match self {
            Self::Green => (1.0 + physical) * own,
            Self::Engineering | Self::Shear | Self::Hinge => own,
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

    /// Strain and secant stiffness in another measure that bear the same load as a stress here does at a strain of zero or
    /// more; `None` where either is that of ring-2 springs.
    pub fn secant_in(self, other: Self, strain: f64, stress: impl Fn(f64) -> f64) -> Option<[f64; 2]> {
        // At rest, as close to it: the stiffness there is a limit.
        let physical = self.physical(strain.max(1e-6))?;
        // The load of a stiffness of one.
        let unit = other.load(physical, |strain| strain)?;
        let there = if strain == 0.0 { 0.0 } else { other.strain(physical)? };
        Some([there, self.load(physical, stress)? / unit])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::{NegativeStrain, StiffnessCurve};
    use crate::finite_difference::derivative_error;

    const MEASURES: [StrainMeasure; 5] = [
        StrainMeasure::Green,
        StrainMeasure::Engineering,
        StrainMeasure::Shear,
        StrainMeasure::Diagonal,
        StrainMeasure::Hinge,
    ];

    #[test]
    fn the_way_back_ends_where_it_began() {
        for measure in MEASURES {
            for physical in [-0.1, 1e-9, 0.02, 0.3, 0.9] {
                let back = measure.physical(measure.strain(physical).unwrap()).unwrap();
                assert!((back / physical - 1.0).abs() < 1e-7, "{measure:?}: {back}, {physical}");
            }
        }
        assert_eq!(StrainMeasure::Shear.physical(1.2), None);
    }

    /// Virtual work: the load is the derivative of the energy over the physical measure, per what it acts through.
    #[test]
    fn a_load_is_conjugate_to_its_physical_measure() {
        let curve = StiffnessCurve::new(vec![0.0, 0.5], vec![2.0, 5.0], NegativeStrain::Odd).unwrap();
        for measure in MEASURES {
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
