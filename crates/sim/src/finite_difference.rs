//! Checks a derivative against finite differences. Shared by all models: a new model adds one line of test.

/// Largest difference between a derivative and its finite difference, relative to the largest entry of the derivative.
///
/// ```text
/// f′(x) ≈ [8 (f(x+h) − f(x−h)) − (f(x+2h) − f(x−2h))]/(12 h) = f′(x) + O(h⁴)
/// ```
///
/// * `value` — n values at a point with m coordinates
/// * `derivative` — n rows of m entries at `x`, row by row
/// * `h` — step, in the units of x
/// * `scale` — smallest magnitude against which a difference is compared, in the units of the derivative
pub fn derivative_error(
    value: impl Fn(&[f64]) -> Vec<f64>,
    derivative: &[f64],
    x: &[f64],
    h: f64,
    scale: f64,
) -> f64 {
    let mut point = x.to_vec();
    let size = derivative.iter().fold(scale, |largest: f64, d| largest.max(d.abs()));
    let mut worst: f64 = 0.0;
    for j in 0..x.len() {
        let mut at = |offset: f64| {
            point[j] = x[j] + offset;
            let result = value(&point);
            point[j] = x[j];
            result
        };
        let samples = [h, -h, 2.0 * h, -2.0 * h].map(&mut at);
        for i in 0..samples[0].len() {
            let near = 8.0 * (samples[0][i] - samples[1][i]);
            let far = samples[2][i] - samples[3][i];
            let difference = (near - far) / (12.0 * h);
            let error = (difference - derivative[i * x.len() + j]).abs() / size;
            // A NaN counts as an error.
            if !(error <= worst) {
                worst = error;
            }
        }
    }
    worst
}
