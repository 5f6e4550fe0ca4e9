//! The onset of force in a loading: observed, or extrapolated from later rows.
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

/// A loading is extrapolated to zero from rows up to this multiple of its first force.
const REACH: f64 = 5.0;
/// The first force counts as at least this many standard deviations, so that enough rows exceed the noise.
pub(super) const CLEAR: f64 = 40.0;
/// Minimum number of rows on either side of a kink, and for an extrapolation.
const FEW: usize = 4;
/// A kink exists if a smooth curve with as many parameters has this many times its sum of squares.
const SHARPER: f64 = 4.0;

/// The onset of tension in a slack strip.
pub(super) struct Toe {
    /// Clip separation, m.
    pub(super) length: f64,
    /// Load cell reading while slack, N.
    pub(super) level: f64,
    /// Reduction of the length if that reading were a tension, m; `None` if it cannot be.
    pub(super) shift: Option<f64>,
}

/// Finds the kink at which force starts.
///
/// * `loading` — separations and forces
/// * `threshold` — smallest change of force above the noise, N
/// * `least` — negligible slack, m
pub(super) fn find(loading: &[[f64; 2]], threshold: f64, least: f64) -> Option<Toe> {
    let mean = |rows: &[[f64; 2]]| rows.iter().map(|row| row[1]).sum::<f64>() / rows.len() as f64;
    let level = mean(loading.get(..FEW)?);
    let slack = loading.windows(2).position(|two| two.iter().all(|row| row[1] - level > threshold))?;
    let (start, turn) = (loading[0][0], loading[slack][0]);
    if slack < FEW || turn - start < least {
        return None;
    }
    // The last of these rows may be taut already.
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

/// Free length, m: where a loading reaches zero, extrapolated from a given force. `None` if it does not.
///
/// * `from` — the force, N
/// * `noise` — standard deviation of the force, N
pub(super) fn free_length(loading: &[[f64; 2]], from: f64, noise: f64) -> Option<f64> {
    let first = loading.windows(2).position(|two| two.iter().all(|row| row[1] >= from))?;
    first_rows(&loading[first..], noise)?.rises_through(0.0)
}
