//! Where the force of a loading begins: seen, or found from the rows above.
//!
//! ```text
//!  force          ╱            force         ╱
//!    │          ╱                │        ╱
//!    │  slack ╱ a parabola       │     ╱     a parabola through the first rows,
//! level ____╱                    │  ·        followed down to zero
//!    └──────┴──── separation     └─┴────────── separation
//!         free length            free length
//! ```

use super::polynomial::Polynomial;

/// A loading is followed down to zero from rows up to so many times the force that it begins with.
const REACH: f64 = 5.0;
/// That force counts as so many standard deviations at least, so that enough rows are above the noise.
pub(super) const CLEAR: f64 = 40.0;
/// Rows that are needed on either side of a kink, and to follow a loading.
const FEW: usize = 4;
/// A kink is one if a smooth curve with as many parameters has so many times its sum of squares.
const SHARPER: f64 = 4.0;

/// Where a slack strip becomes taut.
pub(super) struct Toe {
    /// Clips this far apart, m.
    pub(super) length: f64,
    /// What the load cell reads while the strip is slack, N.
    pub(super) level: f64,
    /// By how much the length would be less if that were a tension, m; `None` if it cannot be.
    pub(super) shift: Option<f64>,
}

/// Finds the kink at which force begins.
///
/// * `loading` — separations and forces
/// * `threshold` — a change of force that is no noise, N
/// * `least` — slack that does not matter, m
pub(super) fn find(loading: &[[f64; 2]], threshold: f64, least: f64) -> Option<Toe> {
    let mean = |rows: &[[f64; 2]]| rows.iter().map(|row| row[1]).sum::<f64>() / rows.len() as f64;
    let level = mean(loading.get(..FEW)?);
    let slack = loading.windows(2).position(|two| two.iter().all(|row| row[1] - level > threshold))?;
    let (start, turn) = (loading[0][0], loading[slack][0]);
    if slack < FEW || turn - start < least {
        return None;
    }
    // The last rows may be taut already.
    let level = mean(&loading[..slack - slack / FEW]);
    let beyond = loading.iter().skip(slack + FEW).take_while(|row| row[0] <= 2.0 * turn - start);
    let window = loading.get(..slack + FEW + beyond.count())?;
    let taut = Polynomial::through(&window[slack..], 2)?;
    let length = taut.rises_through(level)?;
    let (before, after) = window.split_at(window.partition_point(|row| row[0] < length));
    let kinked = before.iter().map(|row| (row[1] - level).powi(2)).sum::<f64>() + taut.squares(after);
    let smooth = Polynomial::through(window, 3)?.squares(window);
    let found = length - start >= least && length <= turn && smooth > SHARPER * kinked;
    found.then(|| Toe { length, level, shift: taut.rises_through(0.0).map(|zero| length - zero) })
}

/// A parabola through the first rows of a loading.
///
/// * `noise` — standard deviation of the force, N
pub(super) fn first_rows(loading: &[[f64; 2]], noise: f64) -> Option<Polynomial> {
    let first = loading.first()?[1];
    let highest = first + (REACH - 1.0) * first.abs().max(CLEAR * noise);
    let rows = loading.iter().enumerate();
    let count = rows.take_while(|(row, point)| *row <= FEW || point[1] <= highest).count();
    Polynomial::through(&loading[..count], 2)
}

/// The free length: where a loading comes to zero, followed from a force down, m. `None` if it does not.
///
/// * `from` — the force, N
/// * `noise` — standard deviation of the force, N
pub(super) fn free_length(loading: &[[f64; 2]], from: f64, noise: f64) -> Option<f64> {
    let first = loading.windows(2).position(|two| two.iter().all(|row| row[1] >= from))?;
    first_rows(&loading[first..], noise)?.rises_through(0.0)
}
