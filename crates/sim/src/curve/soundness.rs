//! Checks whether a curve can be simulated: defects, their strains, and their consequences.
//!
//! ```text
//! k(ε) < 0                          negative stiffness
//! σ′(ε) < κ                         low tangent           κ = 10⁻³ of the largest secant stiffness
//! max σ′ > 10⁴ min σ′               tangent ratio
//! Tₙ < κ                            end slope: stress beyond the last control point
//! max k implausible for cloth       magnitude
//! ε outside the measured range      unvisited range
//! ```
//!
//! k and σ′ = k + εk′ are cubics on every segment. Intervals are isolated by halving their Bernstein coefficients;
//! extremes follow from the roots of the derivative.

use super::StiffnessCurve;
use super::polynomial::{Cubic, join};
use std::fmt;

/// κ, the least tangent allowed, as a share of the largest secant stiffness.
pub const LEAST_TANGENT: f64 = 1e-3;
/// Largest allowed ratio of two tangents of one curve.
pub const TANGENT_RATIO: f64 = 1e4;
/// Plausible range of a membrane's largest secant stiffness, N/m: from far below a knit to far above glass yarns.
pub const MEMBRANE_STIFFNESS: [f64; 2] = [1e-1, 1e6];
/// Plausible range of the largest stiffness of a hinge bending curve, N·m.
pub const BENDING_STIFFNESS: [f64; 2] = [1e-9, 1e-2];

/// Tolerance on all limits, as a share: fits and repairs end on a limit, up to rounding.
const ROUNDING: f64 = 1e-6;
/// The visited range may end before the last control point by this share of the control points' range.
const NEARLY_ALL: f64 = 0.01;

/// Optional knowledge about a curve besides its control points.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Context {
    /// Plausible range of its largest secant stiffness; `None` skips this check.
    pub magnitude: Option<[f64; 2]>,
    /// Strains visited by a measurement, if there was one.
    pub visited: Option<[f64; 2]>,
}

/// Kinds of findings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flaw {
    /// k < 0.
    NegativeStiffness,
    /// σ′ < κ.
    LowTangent,
    /// max σ′ / min σ′ > 10⁴.
    TangentRatio,
    /// σ′ < κ at the last control point, and hence everywhere beyond it.
    EndSlope,
    /// Stiffness outside the range of real cloth.
    Magnitude,
    /// Range without measurements.
    Unvisited,
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::NegativeStiffness => "negative-stiffness",
            Self::LowTangent => "low-tangent",
            Self::TangentRatio => "tangent-ratio",
            Self::EndSlope => "end-slope",
            Self::Magnitude => "magnitude",
            Self::Unvisited => "unvisited",
        })
    }
}

/// Severity of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// Do not simulate the curve as it is.
    Defect,
    /// For information only.
    Note,
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Defect => "defect",
            Self::Note => "note",
        })
    }
}

/// A defect of a curve, or a note on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finding {
    /// The flaw.
    pub kind: Flaw,
    /// Strain interval, in the curve's own strain; an infinite end extends without limit.
    pub strains: [f64; 2],
    /// Worst value in the interval: stiffness, tangent or ratio; for unvisited strains, their share of the range.
    pub value: f64,
    /// Limit on that value.
    pub limit: f64,
}

impl Finding {
    /// A defect or a note.
    pub fn severity(&self) -> Severity {
        match self.kind {
            // No energy minimum, or jumping equilibria: neither solver nor time step can fix that.
            Flaw::NegativeStiffness | Flaw::LowTangent | Flaw::EndSlope => Severity::Defect,
            // Stable, but the stiffest strain dictates the time step.
            Flaw::TangentRatio => Severity::Defect,
            // Stable too, but a factor of a thousand indicates a wrong unit; the result would be a different cloth.
            Flaw::Magnitude => Severity::Defect,
            // Every curve is extrapolated somewhere; solvers cope with that.
            Flaw::Unvisited => Severity::Note,
        }
    }

    /// True if the curve should not be simulated as it is.
    pub fn is_defect(&self) -> bool {
        self.severity() == Severity::Defect
    }

    /// True if the curve's shape, whatever its unit, can make a simulation fail.
    pub fn is_unstable(&self) -> bool {
        self.is_defect() && self.kind != Flaw::Magnitude
    }

    /// Consequence in a simulation.
    pub fn consequence(&self) -> &'static str {
        match self.kind {
            Flaw::NegativeStiffness => {
                "the stress has the wrong sign: strain drives itself further, and the cloth tears itself apart"
            }
            Flaw::LowTangent if self.value < 0.0 => {
                "stress falls as strain grows: neighbours share a load unevenly, and strain jumps to the end of the interval"
            }
            Flaw::LowTangent => {
                "stress hardly grows: strain drifts through the interval and solves converge slowly"
            }
            Flaw::TangentRatio => {
                "the stiffest strain dictates the time step, and matrices are ill-conditioned when both ends are visited"
            }
            Flaw::EndSlope if self.value < 0.0 => {
                "beyond the last control point stress falls for ever: cloth strained that far cannot recover"
            }
            Flaw::EndSlope => "beyond the last control point hardly anything resists further strain",
            Flaw::Magnitude if self.value == 0.0 => "it has no stiffness at all: nothing resists this strain",
            Flaw::Magnitude if self.value < self.limit => {
                "far too soft for a cloth, probably another unit: it folds without resistance or stretches without end"
            }
            Flaw::Magnitude => {
                "far too stiff for a cloth, probably another unit (pascals?): stable time steps become tiny"
            }
            Flaw::Unvisited => "no measurement covers these strains: the curve is a guess",
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = self.strains;
        match high {
            // Applies to the curve as a whole.
            _ if self.kind == Flaw::Magnitude => write!(f, "{}", self.kind)?,
            f64::INFINITY => write!(f, "{} from {low:.4} on", self.kind)?,
            _ => write!(f, "{} from {low:.4} to {high:.4}", self.kind)?,
        }
        match self.kind {
            Flaw::Unvisited => Ok(()),
            _ => write!(f, " ({:.3e}, limit {:.3e})", self.value, self.limit),
        }
    }
}

/// Largest and least values compared by the check.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremes {
    /// Largest secant stiffness k from zero to the last control point.
    pub largest_stiffness: f64,
    /// Least tangent σ′ in the same range.
    pub least_tangent: f64,
    /// Largest tangent σ′ in the same range.
    pub largest_tangent: f64,
}

/// Extremes of a curve between zero and its last control point.
pub fn extremes(curve: &StiffnessCurve) -> Extremes {
    let start = curve.stiffnesses()[0];
    let mut extremes = Extremes { largest_stiffness: start, least_tangent: start, largest_tangent: start };
    for Piece { stiffness, tangent, .. } in pieces(curve) {
        extremes.largest_stiffness = extremes.largest_stiffness.max(stiffness.at(stiffness.extremes()[1]));
        let [least, greatest] = tangent.extremes().map(|u| tangent.at(u));
        extremes.least_tangent = extremes.least_tangent.min(least);
        extremes.largest_tangent = extremes.largest_tangent.max(greatest);
    }
    extremes
}

/// All findings on a curve, worst first.
pub fn check(curve: &StiffnessCurve, context: &Context) -> Vec<Finding> {
    let Extremes { largest_stiffness, least_tangent, largest_tangent } = extremes(curve);
    let last = curve.strains()[curve.len() - 1];
    // A curve that is nowhere positive has no scale.
    let least_allowed = LEAST_TANGENT * largest_stiffness.max(0.0);
    let low = least_allowed * (1.0 - ROUNDING);
    let mut findings = intervals(curve, Flaw::NegativeStiffness, 0.0, 0.0);
    findings.extend(intervals(curve, Flaw::LowTangent, low, least_allowed));
    if least_tangent > 0.0 && largest_tangent > TANGENT_RATIO * (1.0 + ROUNDING) * least_tangent {
        let value = largest_tangent / least_tangent;
        findings.push(Finding {
            kind: Flaw::TangentRatio,
            strains: [0.0, last],
            value,
            limit: TANGENT_RATIO,
        });
    }
    let end = curve.response(last).tangent;
    if end < low {
        let strains = [last, f64::INFINITY];
        findings.push(Finding { kind: Flaw::EndSlope, strains, value: end, limit: least_allowed });
    }
    findings.extend(magnitude(largest_stiffness, last, context.magnitude));
    findings.extend(unvisited(last, context.visited));
    findings
}

/// Intervals where stiffness or tangent is below a limit.
fn intervals(curve: &StiffnessCurve, kind: Flaw, below: f64, limit: f64) -> Vec<Finding> {
    let of = |piece: &Piece| if kind == Flaw::NegativeStiffness { piece.stiffness } else { piece.tangent };
    let mut found = Vec::new();
    let mut worst = Vec::new();
    for piece in pieces(curve) {
        let cubic = of(&piece);
        for [low, high] in cubic.below(below) {
            // Neighbouring pieces share their knot bit for bit.
            let strains = [piece.strain(low), piece.strain(high)];
            let least = cubic.extremes()[0].clamp(low, high);
            let value = [low, least, high].into_iter().map(|u| cubic.at(u)).fold(f64::INFINITY, f64::min);
            let before = found.len();
            join(&mut found, strains);
            match worst.last_mut() {
                Some(last) if found.len() == before => *last = f64::min(*last, value),
                _ => worst.push(value),
            }
        }
    }
    if curve.len() == 1 && curve.stiffnesses()[0] < below {
        found.push([0.0, f64::INFINITY]);
        worst.push(curve.stiffnesses()[0]);
    }
    found.into_iter().zip(worst).map(|(strains, value)| Finding { kind, strains, value, limit }).collect()
}

fn magnitude(largest: f64, last: f64, plausible: Option<[f64; 2]>) -> Option<Finding> {
    let [low, high] = plausible?;
    let limit = match largest {
        largest if !(largest >= low) => low,
        largest if largest > high => high,
        _ => return None,
    };
    Some(Finding { kind: Flaw::Magnitude, strains: [0.0, last], value: largest, limit })
}

fn unvisited(last: f64, visited: Option<[f64; 2]>) -> Vec<Finding> {
    let Some([low, high]) = visited else { return Vec::new() };
    let gaps = [[0.0, low.min(last)], [high.max(0.0), last]];
    let gap = |[from, to]: [f64; 2]| {
        let finding =
            Finding { kind: Flaw::Unvisited, strains: [from, to], value: (to - from) / last, limit: 0.0 };
        (to - from > NEARLY_ALL * last).then_some(finding)
    };
    gaps.into_iter().filter_map(gap).collect()
}

/// A segment of a curve, with u = (ε − start)/width.
struct Piece {
    start: f64,
    end: f64,
    stiffness: Cubic,
    tangent: Cubic,
}

impl Piece {
    fn strain(&self, u: f64) -> f64 {
        if u == 1.0 { self.end } else { self.start + u * (self.end - self.start) }
    }
}

fn pieces(curve: &StiffnessCurve) -> impl Iterator<Item = Piece> + '_ {
    curve.segments.iter().zip(curve.strains.windows(2)).map(|(segment, ends)| {
        let ([a, b, c, d], e) = (segment.coefficients, segment.start);
        let h = ends[1] - ends[0];
        // (εk)′ = k + εk′ with ε = e + t.
        let tangent = [a + e * b, 2.0 * (b + e * c), 3.0 * (c + e * d), 4.0 * d];
        let powers = [1.0, h, h * h, h * h * h];
        let scaled = |coefficients: [f64; 4]| Cubic(std::array::from_fn(|i| coefficients[i] * powers[i]));
        Piece { start: ends[0], end: ends[1], stiffness: scaled([a, b, c, d]), tangent: scaled(tangent) }
    })
}

#[cfg(test)]
mod tests;
