//! The heavy elastica without cloth code: a sheet clamped level at a table edge bends under its own weight.
//!
//! ```text
//!   ▒▒▒▒▒▒▒ s = 0                      dψ/dt = κ(M)         t = L − s, from the tip inwards
//!   ▒ table ───╮   ψ = π/2             dM/dt = ρ g t sin ψ
//!               ╲                      ψ: angle between the sheet and the way down
//!                ╲ s = L   M = 0       clamped level: ψ(t = L) = π/2
//! ```
//!
//! M(κ) is any odd, increasing law. Shooting solves for the angle at the tip; ψ(L) increases with it, so the solution
//! is unique. Starting at the tip and measuring from the downward direction preserves all digits where the end hangs
//! straight.

use std::f64::consts::FRAC_PI_2;

/// Runge–Kutta steps over the length: error of 1e-8 of the deflection at Γ = 1000, smaller below.
const STEPS: usize = 1000;

/// A point of the sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Distance beyond the edge, m.
    pub outward: f64,
    /// Distance below the table, m.
    pub below: f64,
    /// Downward slope from the horizontal, rad.
    pub slope: f64,
    /// Curvature, 1/m.
    pub curvature: f64,
}

/// Shape of a sheet beyond the edge.
#[derive(Debug, Clone, PartialEq)]
pub struct Elastica {
    length: f64,
    /// Points at equal distances along the sheet, the edge first.
    places: Vec<Place>,
}

impl Elastica {
    /// Solves for the shape.
    ///
    /// * `length` — overhang, m
    /// * `weight` — per area, N/m²
    /// * `moment` — per width, N, over curvature, 1/m
    ///
    /// # Panics
    /// If the law does not reach the moments that occur.
    pub fn solve(length: f64, weight: f64, moment: &dyn Fn(f64) -> f64) -> Self {
        let sheet = Sheet { step: length / STEPS as f64, weight, moment };
        // In logarithms, since a long end hangs straight down up to a tiny angle.
        let overshoot = |logarithm: f64| sheet.shoot(logarithm.exp(), &mut |_| {}) - FRAC_PI_2;
        let tip = root(&overshoot, -600.0, FRAC_PI_2.ln()).exp();
        let mut states = Vec::with_capacity(STEPS + 1);
        sheet.shoot(tip, &mut |state| states.push(state));
        assert_eq!(states.len(), STEPS + 1, "the root is level at the edge");
        let place = |[angle, moment, x, z]: State| {
            let [_, _, width, depth] = states[STEPS];
            Place {
                outward: width - x,
                below: depth - z,
                slope: FRAC_PI_2 - angle,
                curvature: sheet.curvature(moment),
            }
        };
        Self { length, places: states.iter().rev().map(|&state| place(state)).collect() }
    }

    /// The point at distance `s` from the edge along the sheet, m.
    pub fn at(&self, s: f64) -> Place {
        let position = (s / self.length).clamp(0.0, 1.0) * STEPS as f64;
        let index = (position as usize).min(STEPS - 1);
        let (t, step) = (position - index as f64, self.length / STEPS as f64);
        let [a, b] = [self.places[index], self.places[index + 1]];
        let slope = |p: &Place| p.slope.sin_cos();
        let ((fall_a, run_a), (fall_b, run_b)) = (slope(&a), slope(&b));
        Place {
            outward: hermite(t, [a.outward, b.outward], [run_a * step, run_b * step]),
            below: hermite(t, [a.below, b.below], [fall_a * step, fall_b * step]),
            slope: hermite(t, [a.slope, b.slope], [a.curvature * step, b.curvature * step]),
            curvature: a.curvature + (b.curvature - a.curvature) * t,
        }
    }

    /// The free end.
    pub fn tip(&self) -> Place {
        self.places[STEPS]
    }

    /// Deviation from level at the edge, rad: the residual of the boundary condition.
    pub fn defect(&self) -> f64 {
        self.places[0].slope
    }
}

/// Angle from the downward direction, moment, and the distance from the tip inwards and upwards.
type State = [f64; 4];

struct Sheet<'a> {
    step: f64,
    weight: f64,
    moment: &'a dyn Fn(f64) -> f64,
}

impl Sheet<'_> {
    /// Integrates from the tip, reports every state and returns the angle at the edge. Stops when the sheet turns
    /// upwards by more than rounding, from where it only turns further.
    fn shoot(&self, tip: f64, told: &mut dyn FnMut(State)) -> f64 {
        let mut state = [tip, 0.0, 0.0, 0.0];
        told(state);
        for index in 0..STEPS {
            if state[0] > FRAC_PI_2 + 1e-6 {
                break;
            }
            state = self.runge_kutta(index as f64 * self.step, state);
            told(state);
        }
        state[0]
    }

    fn runge_kutta(&self, t: f64, y: State) -> State {
        let h = self.step;
        let moved = |rate: &State, h: f64| -> State { std::array::from_fn(|i| y[i] + h * rate[i]) };
        let a = self.rate(t, &y);
        let b = self.rate(t + h / 2.0, &moved(&a, h / 2.0));
        let c = self.rate(t + h / 2.0, &moved(&b, h / 2.0));
        let d = self.rate(t + h, &moved(&c, h));
        std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
    }

    fn rate(&self, t: f64, &[angle, moment, ..]: &State) -> State {
        let (sine, cosine) = angle.sin_cos();
        [self.curvature(moment), self.weight * t * sine, sine, cosine]
    }

    /// Inverse of the law.
    fn curvature(&self, moment: f64) -> f64 {
        if moment == 0.0 {
            return 0.0;
        }
        let size = moment.abs();
        let mut high = 1.0;
        while (self.moment)(high) < size {
            high *= 2.0;
            assert!(high < 1e12, "a law that rises to {size} N");
        }
        root(&|curvature| (self.moment)(curvature) - size, 0.0, high) * moment.signum()
    }
}

/// Cubic with the given end values and slopes.
fn hermite(t: f64, [a, b]: [f64; 2], [slope_a, slope_b]: [f64; 2]) -> f64 {
    let u = 1.0 - t;
    u * u * (1.0 + 2.0 * t) * a + t * t * (1.0 + 2.0 * u) * b + t * u * (u * slope_a - t * slope_b)
}

/// Root of an increasing function by Ridders' method, to rounding.
fn root(f: &dyn Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let (mut f_low, mut f_high) = (f(low), f(high));
    assert!(f_low <= 0.0 && f_high >= 0.0, "{f_low} at {low}, {f_high} at {high}: no sign change");
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        let f_middle = f(middle);
        let scale = (f_middle * f_middle - f_low * f_high).sqrt();
        if scale == 0.0 || high - low <= 4.0 * f64::EPSILON * middle.abs() {
            break;
        }
        // Low and high have these signs, so the step goes up where the middle is still negative.
        let better = (middle - (middle - low) * f_middle / scale).clamp(low, high);
        let f_better = f(better);
        for (x, fx) in [(middle, f_middle), (better, f_better)] {
            if fx <= 0.0 && x >= low {
                (low, f_low) = (x, fx);
            }
            if fx >= 0.0 && x <= high {
                (high, f_high) = (x, fx);
            }
        }
    }
    if -f_low < f_high { low } else { high }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A linear law with this weight, for length 1: Γ = ρ g L³/D.
    fn linear(gamma: f64) -> Elastica {
        Elastica::solve(1.0, gamma, &|curvature| curvature)
    }

    #[test]
    fn a_stiff_sheet_is_a_beam() {
        for gamma in [1e-4, 1e-3] {
            let tip = linear(gamma).tip();
            let beam = gamma / 8.0;
            // The next term is of relative order Γ².
            assert!((tip.below / tip.outward / beam - 1.0).abs() < gamma * gamma, "{gamma}");
            let middle = linear(gamma).at(0.5).below;
            let beam = gamma * (6.0 - 2.0 + 0.25) * 0.25 / 24.0;
            assert!((middle / beam - 1.0).abs() < gamma * gamma, "{gamma}");
        }
    }

    #[test]
    fn the_chord_falls_by_41_5_degrees_where_peirce_says() {
        // Peirce: D = ρ g L³/8 when the chord falls by 41.5°; the exact curve has this angle at Γ = 8.0042.
        let tip = linear(8.0042).tip();
        let angle = tip.below.atan2(tip.outward).to_degrees();
        assert!((angle - 41.5).abs() < 1e-4, "{angle}");
    }

    #[test]
    fn only_gamma_matters() {
        let (length, rigidity, gamma) = (0.07, 3e-5, 20.0);
        let weight = gamma * rigidity / f64::powi(length, 3);
        let [a, b] = [Elastica::solve(length, weight, &|k| rigidity * k), linear(gamma)];
        for s in [0.1, 0.5, 0.77, 1.0] {
            let [a, b] = [a.at(s * length), b.at(s)];
            assert!(
                (a.outward / length - b.outward).abs() < 1e-9 && (a.below / length - b.below).abs() < 1e-9
            );
            assert!((a.slope - b.slope).abs() < 1e-9 && (a.curvature * length - b.curvature).abs() < 1e-4);
        }
    }

    #[test]
    fn any_law_balances_the_weight_beyond() {
        let law = |k: f64| 2e-5 * k + 4e-9 * k * k * k;
        let (length, weight) = (0.06, 1.5);
        let shape = Elastica::solve(length, weight, &law);
        assert!(shape.defect().abs() < 1e-12);
        for s in [0.0, 0.012, 0.03, 0.0444] {
            // Moment of the weight beyond s: ∫ w (x(q) − x(s)) dq, by the midpoint rule.
            let (here, parts) = (shape.at(s), 4000);
            let width = (length - s) / parts as f64;
            let arm = |part: usize| shape.at(s + (part as f64 + 0.5) * width).outward - here.outward;
            let moment: f64 = (0..parts).map(|part| weight * arm(part) * width).sum();
            assert!((law(here.curvature) / moment - 1.0).abs() < 1e-5, "{s}");
        }
    }

    #[test]
    fn a_long_sheet_hangs_straight() {
        let tip = linear(1e4).tip();
        // Off the downward direction by about e^-65.
        assert!((tip.slope - FRAC_PI_2).abs() < 1e-15 && tip.curvature.abs() < 1e-12);
    }
}
