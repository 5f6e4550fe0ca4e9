//! Strips that are not free at the gauge length: mounted under tension or slack, or with an offset load cell.

use super::polynomial::Polynomial;
use super::reading::{Pull, digits};
use super::toe::{self, CLEAR, Toe};
use crate::notice::{Notice, Remedy, Severity};

/// Share of the clip travel within which a reading counts as at the gauge length, and slack is negligible.
const NEAR: f64 = 0.01;
/// Share of the clip travel beyond which a free length is implausible: a force that varies this slowly is not a
/// tension.
const FAR: f64 = 0.5;
/// Share of the first stress: a more uncertain free length makes the band useless.
const UNSURE: f64 = 0.05;
/// Share of the first force; smaller offsets may be curvature of the curve.
const SHARE: f64 = 0.3;
/// Share of the span of the first readings, or of the slack, within which readings are extrapolated to rest.
const CLOSE: f64 = 0.25;
/// Share of the largest force from which an offset matters even if it hardly shifts the free length.
const LARGE: f64 = 0.01;

/// Checks the force at the gauge length and the separation at which force starts.
pub(super) fn check(pull: &Pull) -> Vec<Notice> {
    let (loading, near) = (pull.first_loading(), NEAR * pull.travel());
    let Some([first, _]) = loading.first().copied() else { return Vec::new() };
    if first > pull.gauge + near {
        return beyond(pull, &loading).into_iter().collect();
    }
    match toe::find(&loading, pull.threshold(), near) {
        Some(toe) => seen(pull, &toe, near),
        None => unseen(pull, &loading, near).into_iter().collect(),
    }
}

/// True if a force where none is expected distorts a curve.
///
/// * `shift` — reduction of the free length if the force is a tension, m
fn matters(pull: &Pull, force: f64, shift: Option<f64>) -> bool {
    let shifts = shift.is_some_and(|shift| (NEAR..FAR).contains(&(shift.abs() / pull.travel())));
    force.abs() > pull.threshold() && (shifts || force.abs() > LARGE * pull.largest_force())
}

/// Strip never observed at rest: its first readings show whether it was free there, and with what certainty.
fn beyond(pull: &Pull, loading: &[[f64; 2]]) -> Option<Notice> {
    let (reading, start) = (pull.readings.first()?, toe::first_rows(loading, pull.noise)?);
    let force = start.at(pull.gauge);
    let length = start.rises_through(0.0);
    let slack = length.map(|length| length - pull.gauge).filter(|slack| *slack > 0.0);
    let close = match slack {
        // Seen from afar, a curve that stiffens from rest on resembles slack.
        Some(slack) => reading.separation - pull.gauge < (1.0 + CLOSE) * slack,
        None => reading.separation - pull.gauge < CLOSE * start.span(),
    };
    let sure = force.abs() > SHARE * reading.force.abs() + 4.0 * start.error(pull.gauge)?;
    if close && sure && matters(pull, force, length.map(|length| pull.gauge - length)) {
        let found = format!(
            "first readings that extrapolate to {} N at the gauge length, {:.2} mm",
            digits(force, 3),
            1e3 * pull.gauge
        );
        let (cause, remedies) = match length.filter(|length| *length > pull.gauge) {
            Some(length) => {
                let slack = format!("the strip was slack, {}; or the zero is off", free_length(length));
                (slack, vec![longer(length)])
            }
            None => cause(pull, force, length.map(|length| (length, None)), None),
        };
        let notice = pull.notice(Severity::Doubt, reading, found, format!("none: {cause}"));
        return Some(notice.with(remedies));
    }
    let unsure = length_error(&start, start.rises_through(0.0)?)?;
    // dσ/σ = −dL F′/F
    let share = unsure * start.slope(reading.separation) / start.at(reading.separation);
    (share > UNSURE && !pull.has_shapes).then(|| {
        let out = 1e3 * (reading.separation - pull.gauge);
        let found = format!(
            "{} N in the first reading, {out:.2} mm beyond the free length, {:.2} mm",
            digits(reading.force, 3),
            1e3 * pull.gauge
        );
        let expected = format!(
            "readings from rest on: the first of these give the free length to ± {:.2} mm only, which makes the stress there ± \
             {:.0} % uncertain in addition to its band, unless it is known otherwise",
            1e3 * unsure,
            100.0 * share
        );
        pull.notice(Severity::Doubt, reading, found, expected)
    })
}

/// Uncertainty of the extrapolated zero, m: half of its 95 % band.
fn length_error(start: &Polynomial, length: f64) -> Option<f64> {
    Some(1.96 * start.error(length)? / start.slope(length))
}

/// Strip observed slack.
fn seen(pull: &Pull, &Toe { length, level, shift }: &Toe, near: f64) -> Vec<Notice> {
    let first = &pull.readings[0];
    let mut notices = Vec::new();
    if matters(pull, level, shift) {
        let found = format!("{} N while the strip is slack", digits(level, 3));
        let expected = format!("none: the load cell's zero is off, {}", taking_off(level));
        let remedies = vec![zero(level)];
        notices.push(pull.notice(Severity::Doubt, first, found, expected).with(remedies));
    }
    let gauge = format!("the gauge length, {:.2} mm", 1e3 * pull.gauge);
    // A strip that was stretched before is longer, which is not a fault.
    if length > pull.gauge + near && pull.cycle == 0 {
        let taut = pull.readings.iter().find(|reading| reading.separation >= length).unwrap_or(first);
        let found = format!("no force until the clamps are {:.2} mm apart", 1e3 * length);
        let expected = format!("force beyond {gauge}: the strip was slack, {}", free_length(length));
        let remedies = vec![longer(length)];
        notices.push(pull.notice(Severity::Doubt, taut, found, expected).with(remedies));
    }
    if length < pull.gauge - near {
        let found = format!("force from a clamp distance of {:.2} mm on", 1e3 * length);
        let expected = format!("none below {gauge}: {}", free_length(length));
        let remedies = vec![longer(length)];
        notices.push(pull.notice(Severity::Doubt, first, found, expected).with(remedies));
    }
    notices
}

/// Strip with force from the first reading on.
fn unseen(pull: &Pull, loading: &[[f64; 2]], near: f64) -> Option<Notice> {
    let at_gauge = loading.partition_point(|row| row[0] < pull.gauge - near);
    let (rows, reading) = (loading.get(at_gauge..)?, pull.readings.get(at_gauge)?);
    // In a stepwise test the strip may be free just before.
    let is_free = |row: &[f64; 2]| row[1].abs() <= pull.threshold() && row[0] > pull.gauge - 2.0 * near;
    if loading[..at_gauge].iter().any(is_free) {
        return None;
    }
    let start = toe::first_rows(rows, pull.noise)?;
    let (force, length) = (start.at(pull.gauge), start.rises_through(0.0));
    // A parabola that does not reach zero is steepest here; noise is then irrelevant.
    let tangent = || (force > CLEAR * pull.noise).then(|| force / start.slope(pull.gauge));
    let shift = length.map(|length| pull.gauge - length).or_else(tangent);
    let wrong = [reading.force, force].iter().all(|force| matters(pull, *force, shift));
    if !wrong || reading.force * force < 0.0 {
        return None;
    }
    let before = loading[..at_gauge].first().map(|row| row[1]);
    let after = || toe::find(&pull.last_unloading(), pull.threshold(), near).map(|toe| toe.level);
    let found = format!("{} N at the gauge length, {:.2} mm", digits(force, 3), 1e3 * pull.gauge);
    let length = length.map(|length| (length, length_error(&start, length)));
    let (cause, remedies) = cause(pull, force, length, before.or_else(after));
    Some(pull.notice(Severity::Doubt, reading, found, format!("none: {cause}")).with(remedies))
}

/// Explains a force at the gauge length.
///
/// * `length` — free length if the force is a tension, and half of its band, m
/// * `slack` — load cell reading of the slack strip, if observed, N
fn cause(
    pull: &Pull,
    force: f64,
    length: Option<(f64, Option<f64>)>,
    slack: Option<f64>,
) -> (String, Vec<Remedy>) {
    let zeroed = format!("the load cell's zero is off, {}", taking_off(force));
    // An extrapolation that leaves the plausible range gives no length.
    let length = length.filter(|(length, _)| (0.5 * pull.gauge..pull.gauge).contains(length));
    let tension = match length {
        Some((length, unsure)) => format!(
            "the strip was mounted under tension, {}, where a parabola through the first readings reaches zero{}",
            free_length(length),
            unsure.map_or(String::new(), |unsure| format!(", ± {:.2} mm", 1e3 * unsure))
        ),
        None => {
            "the strip was mounted under tension, and these readings do not determine its free length".into()
        }
    };
    let is = |level: f64| slack.is_some_and(|slack| (slack - level).abs() <= pull.threshold());
    let lengths: Vec<Remedy> = length.map(|(length, _)| longer(length)).into_iter().collect();
    if force < 0.0 || is(force) {
        (zeroed, vec![zero(force)])
    } else if is(0.0) {
        (tension, lengths)
    } else {
        let both = format!("{tension}; or {zeroed}: its unloaded reading tells which");
        (both, [lengths, vec![zero(force)]].concat())
    }
}

/// Subtracts a force, as exact as it is printed.
fn zero(force: f64) -> Remedy {
    Remedy::Zero(digits(force, 3).parse().unwrap_or(force))
}

/// Another free length, to a hundredth of a millimetre.
fn longer(length: f64) -> Remedy {
    Remedy::FreeLength((1e5 * length).round() / 1e5)
}

fn taking_off(force: f64) -> String {
    let force = digits(force, 3);
    format!("subtract {force} N from every force")
}

fn free_length(length: f64) -> String {
    format!("its free length is {:.2} mm", 1e3 * length)
}
