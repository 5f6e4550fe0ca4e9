//! Cubics over the unit interval: extremes, and intervals below a limit.

/// p(u) = c₀ + c₁u + c₂u² + c₃u³ for 0 ≤ u ≤ 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cubic(pub(super) [f64; 4]);

/// Bisections before an interval is judged by its midpoint: 1e-12 of the whole.
const HALVINGS: u32 = 40;

impl Cubic {
    pub(super) fn at(&self, u: f64) -> f64 {
        let [a, b, c, d] = self.0;
        a + u * (b + u * (c + u * d))
    }

    /// Least and greatest value. Each is at an end or where the derivative is zero.
    pub(super) fn extremes(&self) -> [f64; 2] {
        let [_, b, c, d] = self.0;
        let (half, product) = (c, 3.0 * b * d);
        // 3d u² + 2c u + b = 0, without cancellation; a division by zero gives a root outside the interval.
        let root = (half * half - product).sqrt();
        let sum = -(half + root.copysign(half));
        let inside = [sum / (3.0 * d), b / sum].into_iter().filter(|u| *u > 0.0 && *u < 1.0);
        inside.chain([1.0]).fold([0.0, 0.0], |[low, high], u| {
            let value = self.at(u);
            [if value < self.at(low) { u } else { low }, if value > self.at(high) { u } else { high }]
        })
    }

    /// Intervals where the cubic is below a limit, ascending.
    ///
    /// The Bernstein coefficients bound the cubic. If they all lie on one side of the limit, so does the cubic;
    /// otherwise the interval is halved.
    pub(super) fn below(&self, limit: f64) -> Vec<[f64; 2]> {
        let [a, b, c, d] = self.0;
        let a = a - limit;
        let bernstein = [a, a + b / 3.0, a + (2.0 * b + c) / 3.0, a + b + c + d];
        let mut intervals = Vec::new();
        collect(bernstein, [0.0, 1.0], HALVINGS, &mut intervals);
        intervals
    }
}

fn collect(bernstein: [f64; 4], [low, high]: [f64; 2], halvings: u32, intervals: &mut Vec<[f64; 2]>) {
    if bernstein.iter().all(|&value| value >= 0.0) {
        return;
    }
    let [a, b, c, d] = bernstein;
    let [ab, bc, cd] = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + d)];
    let [abc, bcd] = [0.5 * (ab + bc), 0.5 * (bc + cd)];
    let middle = 0.5 * (abc + bcd);
    if bernstein.iter().all(|&value| value < 0.0) || halvings == 0 && middle < 0.0 {
        join(intervals, [low, high]);
    } else if halvings > 0 {
        let half = 0.5 * (low + high);
        collect([a, ab, abc, middle], [low, half], halvings - 1, intervals);
        collect([middle, bcd, cd, d], [half, high], halvings - 1, intervals);
    }
}

/// Appends an interval; extends the last one if the two touch.
pub(super) fn join(intervals: &mut Vec<[f64; 2]>, [low, high]: [f64; 2]) {
    match intervals.last_mut() {
        Some(last) if last[1] == low => last[1] = high,
        _ => intervals.push([low, high]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng, rngs::StdRng};

    #[test]
    fn roots_and_extremes_are_those_of_many_samples() {
        let mut rng = StdRng::seed_from_u64(5);
        for trial in 0..500 {
            let mut coefficients: [f64; 4] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
            // Include quadratics, lines and constants.
            coefficients[4 - trial % 4..].fill(0.0);
            let cubic = Cubic(coefficients);
            let below = cubic.below(0.0);
            assert!(below.windows(2).all(|pair| pair[0][1] < pair[1][0]));
            let [least, greatest] = cubic.extremes().map(|u| cubic.at(u));
            for i in 0..=1000 {
                let u = f64::from(i) / 1000.0;
                let value = cubic.at(u);
                assert!(value >= least - 1e-15 && value <= greatest + 1e-15);
                let inside = below.iter().any(|[low, high]| *low <= u && u <= *high);
                assert!(value.abs() < 1e-9 || inside == (value < 0.0), "{coefficients:?} at {u}: {value}");
            }
        }
    }

    #[test]
    fn the_roots_of_a_known_cubic_are_found_to_rounding() {
        // (u − ¼)(u − ½)(u − ¾)
        let cubic = Cubic([-0.09375, 0.6875, -1.5, 1.0]);
        let below = cubic.below(0.0);
        let expected = [[0.0, 0.25], [0.5, 0.75]];
        assert!(below.iter().flatten().zip(expected.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-11));
        assert_eq!(below.len(), 2);
        // A cubic that only touches the limit is not below it.
        assert!(Cubic([0.0625, -0.5, 1.0, 0.0]).below(0.0).is_empty());
    }
}
