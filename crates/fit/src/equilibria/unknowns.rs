//! The unknowns of a simulation: curves, each of one component or shared by several, as one vector of control values.
//!
//! ```text
//! k = (k of the first curve, k of the second, …)
//! ```
//!
//! An empty list simulates under known curves.

use cloth_sim::curve::StiffnessCurve;
use cloth_sim::error::Result;
use cloth_sim::material::{Component, Curves};
use nalgebra::DVector;

/// One unknown curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknown {
    /// The components that share it; at least one.
    pub components: Vec<Component>,
    /// Its current state; the strains of its control points are given, their stiffnesses are found.
    pub curve: StiffnessCurve,
}

impl Unknown {
    /// True if the curve is read by the size of a strain.
    pub fn is_odd(&self) -> bool {
        self.components.iter().all(|component| !component.is_stretch())
    }
}

/// The unknown curves, in the order of their control values.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Unknowns(Vec<Unknown>);

impl Unknowns {
    /// Of these curves.
    pub fn new(unknowns: Vec<Unknown>) -> Self {
        Self(unknowns)
    }

    /// One curve.
    pub fn one(components: &[Component], curve: StiffnessCurve) -> Self {
        Self(vec![Unknown { components: components.to_vec(), curve }])
    }

    /// The curves.
    pub fn iter(&self) -> impl Iterator<Item = &Unknown> {
        self.0.iter()
    }

    /// The components of each curve.
    pub fn groups(&self) -> Vec<Vec<Component>> {
        self.0.iter().map(|unknown| unknown.components.clone()).collect()
    }

    /// All control values, N/m (bending: N·m).
    pub fn values(&self) -> DVector<f64> {
        let values = self.0.iter().flat_map(|unknown| unknown.curve.stiffnesses());
        DVector::from_iterator(self.len(), values.copied())
    }

    /// Number of control values.
    pub fn len(&self) -> usize {
        self.0.iter().map(|unknown| unknown.curve.len()).sum()
    }

    /// True if nothing is unknown.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Copies the unknowns with other control values.
    ///
    /// # Errors
    /// Values that are not finite, or of another number.
    pub fn with_values(&self, values: &DVector<f64>) -> Result<Self> {
        let mut first = 0;
        let unknowns = self.0.iter().map(|unknown| {
            let own: Vec<f64> = values.iter().skip(first).take(unknown.curve.len()).copied().collect();
            first += unknown.curve.len();
            Ok(Unknown { curve: unknown.curve.with_stiffnesses(own)?, ..unknown.clone() })
        });
        unknowns.collect::<Result<_>>().map(Self)
    }

    /// The same curves without the fastest of their changes, from control point to control point, k̃ᵢ = (kᵢ₋₁ + 2kᵢ + kᵢ₊₁)/4.
    pub fn smooth(&self) -> Self {
        let smooth = |unknown: &Unknown| {
            let given = unknown.curve.stiffnesses();
            let mut smooth = given.to_vec();
            for (k, near) in smooth.iter_mut().skip(1).zip(given.windows(3)) {
                *k = 0.25 * (near[0] + 2.0 * near[1] + near[2]);
            }
            // Means of valid stiffnesses are valid.
            let curve = unknown.curve.with_stiffnesses(smooth).unwrap_or_else(|_| unknown.curve.clone());
            Unknown { curve, ..unknown.clone() }
        };
        Self(self.0.iter().map(smooth).collect())
    }

    /// The curves in place, beside those that are known.
    pub fn beside(&self, known: &Curves) -> Curves {
        let mut curves = known.clone();
        for Unknown { components, curve } in &self.0 {
            components.iter().for_each(|&component| curves.set(component, curve.clone()));
        }
        curves
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_sim::curve::{NegativeStrain, equidistant};

    #[test]
    fn a_smooth_curve_keeps_a_line_and_has_no_zigzag() {
        let of = |values: [f64; 5]| {
            let curve = StiffnessCurve::new(equidistant(5, 1.0), values.to_vec(), NegativeStrain::Odd);
            Unknowns::one(&[Component::BendWarp], curve.unwrap()).smooth().values()
        };
        assert_eq!(of([1.0, 2.0, 3.0, 4.0, 5.0]).as_slice(), [1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(of([2.0, 4.0, 2.0, 4.0, 2.0]).as_slice(), [2.0, 3.0, 3.0, 3.0, 2.0]);
    }
}
