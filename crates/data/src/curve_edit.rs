//! Manual edits of a curve: scaled in strain and stress, or extended.
//!
//! ```text
//! scaled      σ̂(f ε) = g σ(ε)                                   control points (f εᵢ, kᵢ g/f)
//! extended    σ̂ = σ up to ε_a,  σ̂ = σ(ε_a) + s (ε − ε_a) on to ε_b
//! ```
//!
//! Source: the edits of Strohkorb 2019, §4.2: larger strain steps, a larger final stress, an added linear trend.

use crate::error::{Error, Result};
use cloth_sim::curve::StiffnessCurve;

/// Points closer than this share of the range coincide.
const SAME: f64 = 1e-9;
/// Upper limit on the control points of an edited curve.
const MOST_POINTS: usize = 10_000;

/// Continuation of the stress beyond the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Trend {
    /// The tangent of the curve at the junction.
    Tangent,
    /// A given slope, N/m (bending: N·m).
    Slope(f64),
    /// A given stress at the end, N/m (bending: N).
    StressAtEnd(f64),
}

/// A straight segment of stress at the end of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extension {
    /// Strain at which the straight segment starts; the curve beyond it is dropped. Default: the last control point.
    pub from: Option<f64>,
    /// Strain of the new last control point.
    pub to: f64,
    /// Slope of the segment.
    pub trend: Trend,
    /// Number of control points to add. Default: spaced by the mean distance of the existing ones.
    pub points: Option<usize>,
}

/// Multiplies all strains and all stresses of a curve.
///
/// # Errors
/// A factor that is not positive and finite; overflow.
pub fn scaled(curve: &StiffnessCurve, strain: f64, stress: f64) -> Result<StiffnessCurve> {
    for (field, factor) in [("strain", strain), ("stress", stress)] {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(refuse(field, factor.to_string(), "a factor above 0"));
        }
    }
    made(
        curve.strains().iter().map(|knot| strain * knot).collect(),
        curve.stiffnesses().iter().map(|k| k * (stress / strain)).collect(),
        curve,
    )
}

/// Largest absolute stress at a control point.
pub fn largest_stress(curve: &StiffnessCurve) -> f64 {
    let stresses = curve.strains().iter().zip(curve.stiffnesses()).map(|(strain, k)| (strain * k).abs());
    stresses.fold(0.0, f64::max)
}

/// Appends a straight segment of stress to a curve.
///
/// Keeps the control points of the curve up to half a step before the junction, then adds one at the junction and
/// those of the segment. A spline through them is straight to third order in their spacing.
///
/// # Errors
/// An end that is not above the start of the segment; a start outside the curve; a slope or stress that is not
/// finite; no points, or more than 10 000.
pub fn extended(curve: &StiffnessCurve, extension: &Extension) -> Result<StiffnessCurve> {
    let last = curve.strains()[curve.len() - 1];
    let from = extension.from.unwrap_or(last);
    if !(from >= 0.0 && from <= last) {
        return Err(refuse("from", from.to_string(), format!("a strain of the curve, 0 to {last}")));
    }
    if !(extension.to > from && extension.to.is_finite()) {
        return Err(refuse("to", extension.to.to_string(), format!("a strain above {from}")));
    }
    let length = extension.to - from;
    let cloth_sim::curve::Response { stress, tangent } = curve.response(from);
    let slope = match extension.trend {
        Trend::Tangent => tangent,
        Trend::Slope(slope) => slope,
        Trend::StressAtEnd(end) => (end - stress) / length,
    };
    if !slope.is_finite() {
        return Err(refuse("slope", slope.to_string(), "a finite slope"));
    }
    let points = extension.points.unwrap_or_else(|| match curve.len() {
        1 => 1,
        own => (length / (last / (own - 1) as f64)).round().max(1.0) as usize,
    });
    if !(1..=MOST_POINTS).contains(&points) {
        return Err(refuse("points", points.to_string(), format!("1 to {MOST_POINTS}")));
    }
    let kept = curve.strains().iter().zip(curve.stiffnesses());
    // A spline through crowded points before a bend overshoots between them.
    let room = 0.5 * length / points as f64;
    let kept = kept.filter(|(knot, _)| **knot == 0.0 || **knot < from - room.max(SAME * last));
    let (mut strains, mut stiffnesses): (Vec<f64>, Vec<f64>) = kept.map(|(&knot, &k)| (knot, k)).unzip();
    if from > SAME * last {
        strains.push(from);
        stiffnesses.push(stress / from);
    }
    for i in 1..=points {
        let beyond = length * i as f64 / points as f64;
        let strain = if i == points { extension.to } else { from + beyond };
        strains.push(strain);
        stiffnesses.push((stress + slope * beyond) / strain);
    }
    made(strains, stiffnesses, curve)
}

fn made(strains: Vec<f64>, stiffnesses: Vec<f64>, like: &StiffnessCurve) -> Result<StiffnessCurve> {
    StiffnessCurve::new(strains, stiffnesses, like.negative())
        .map_err(|source| Error::Mechanics { context: "the edited curve".into(), source })
}

fn refuse(field: &'static str, found: String, expected: impl Into<String>) -> Error {
    Error::Setting { field, found, expected: expected.into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_sim::curve::{NegativeStrain, equidistant};

    fn curve() -> StiffnessCurve {
        let k = vec![100.0, 110.0, 130.0, 160.0, 200.0];
        StiffnessCurve::new(equidistant(5, 0.2), k, NegativeStrain::Odd).unwrap()
    }

    #[test]
    fn a_scaled_curve_has_the_same_stress_further_out() {
        let (curve, scaled) = (curve(), scaled(&curve(), 10.0, 2.0).unwrap());
        for strain in [-0.1, 0.013, 0.1, 0.19, 0.3] {
            let (found, expected) = (scaled.stress(10.0 * strain), 2.0 * curve.stress(strain));
            assert!((found / expected - 1.0).abs() < 1e-12);
        }
        assert!((largest_stress(&scaled) - 80.0).abs() < 1e-12);
        assert!(super::scaled(&curve, 0.0, 1.0).is_err() && super::scaled(&curve, 1.0, f64::NAN).is_err());
    }

    #[test]
    fn an_extended_curve_is_itself_and_then_straight() {
        let curve = curve();
        let longer = |trend, from| Extension { from, to: 0.3, trend, points: None };
        let more = extended(&curve, &longer(Trend::Tangent, None)).unwrap();
        assert_eq!(more.strains(), [0.0, 0.05, 0.1, 0.15000000000000002, 0.2, 0.25, 0.3]);
        for strain in [0.03, 0.12, 0.2, 0.25, 0.3] {
            assert!((more.stress(strain) / curve.stress(strain) - 1.0).abs() < 0.01, "{strain}");
        }
        let to = extended(&curve, &longer(Trend::StressAtEnd(90.0), Some(0.12))).unwrap();
        assert_eq!(to.strains()[..3], [0.0, 0.05, 0.12]);
        assert!((to.stress(0.3) - 90.0).abs() < 1e-12);
        assert!((to.stress(0.12) - curve.stress(0.12)).abs() < 1e-12);
        let slope =
            extended(&curve, &Extension { points: Some(40), ..longer(Trend::Slope(500.0), None) }).unwrap();
        assert_eq!(slope.len(), 45);
        assert!((slope.response(0.26).tangent / 500.0 - 1.0).abs() < 1e-3);
        for wrong in [
            Extension { to: 0.1, ..longer(Trend::Tangent, None) },
            Extension { from: Some(0.25), ..longer(Trend::Tangent, None) },
            Extension { points: Some(0), ..longer(Trend::Tangent, None) },
            longer(Trend::Slope(f64::NAN), None),
        ] {
            assert!(extended(&curve, &wrong).is_err(), "{wrong:?}");
        }
    }
}
