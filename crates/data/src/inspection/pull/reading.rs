//! Readings of a strip between two clips: separation and tension, by branch.

use crate::branch::numbered;
use crate::frame::{Clip, Frame, Sequence};
use crate::kind::Holding;
use crate::measure::median;
use crate::notice::{Notice, Severity};
use crate::rectangle::rest_normal;
use nalgebra::{Isometry3, Vector3};
use std::ops::Range;

/// A measured force and the clip separation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reading {
    /// Number of the frame, or of the imported row.
    pub(crate) number: usize,
    /// Loading or unloading branch, from 0.
    pub(crate) branch: usize,
    /// Free length between the clips, m.
    pub(crate) separation: f64,
    /// Tension of the strip, N.
    pub(crate) force: f64,
}

/// All readings of a strip between two clips, in measured order.
pub(super) struct Pull {
    /// Name of the sequence.
    pub(super) sequence: String,
    /// Meaning of the reading numbers, e.g. `forces.csv frame`.
    pub(super) counted: String,
    /// Free length between the clips at rest, m.
    pub(super) gauge: f64,
    /// Width across the pull, m.
    pub(super) width: f64,
    /// Weight of the clips along the pull, N.
    pub(super) weight: f64,
    /// Standard deviation of a force, N: declared, otherwise estimated.
    pub(super) noise: f64,
    /// Standard deviation of the difference of two separations, m: of two clips in two frames.
    pub(super) step_noise: f64,
    /// Shapes were measured, which include the rest state.
    pub(super) has_shapes: bool,
    /// The first load cycle.
    pub(super) cycle: usize,
    pub(super) readings: Vec<Reading>,
}

/// A deviation of this many standard deviations is not noise.
pub(super) const NOISE: f64 = 5.0;
/// Share of the largest force by which the zero of a load cell may drift (ISO 7500-1, class 1).
const DRIFT: f64 = 1e-3;

impl Pull {
    /// Readings of a stretched strip; `None` if the sequence is not one, or has other than two clips.
    pub(super) fn of(sequence: &Sequence, counted: &str, numbers: &[usize]) -> Option<Self> {
        let stretched = sequence.kind.holding() == Holding::Strip;
        let [first, second] = &sequence.clips[..] else { return None };
        let centre = |clip: &Clip, pose: &Isometry3<f64>| {
            let middle: Vector3<f64> = clip.vertices.iter().map(|&v| sequence.mesh.positions[v]).sum();
            pose * nalgebra::Point3::from(middle / clip.vertices.len() as f64)
        };
        let between = |poses: [&Isometry3<f64>; 2]| centre(second, poses[1]) - centre(first, poses[0]);
        let rest = Isometry3::identity();
        let apart = between([&rest; 2]);
        let axis = apart.try_normalize(0.0)?;
        let along = |vertices: &[usize], axis: &Vector3<f64>| {
            extent(vertices.iter().map(|&v| sequence.mesh.positions[v].dot(axis)))
        };
        let gauge = along(&second.vertices, &axis)[0] - along(&first.vertices, &axis)[1];
        let across = rest_normal(&sequence.mesh).cross(&axis);
        let sides = along(&(0..sequence.mesh.len()).collect::<Vec<_>>(), &across);
        let reading = |(frame, &number): (&Frame, &usize)| {
            let [from, to] = &frame.poses[..] else { return None };
            let now = between([from, to]);
            let pull = now.try_normalize(0.0)?;
            // The pull on one clip equals the reaction at the other.
            let tensions = [(0, -pull), (1, pull)];
            let known =
                tensions.into_iter().filter_map(|(clip, pull)| Some(frame.clip_force(clip)?.dot(&pull)));
            let (count, sum) = known.fold((0, 0.0), |(count, sum), tension| (count + 1, sum + tension));
            let separation = gauge + now.norm() - apart.norm();
            (count > 0).then(|| Reading { number, branch: 0, separation, force: sum / f64::from(count) })
        };
        let mut readings: Vec<Reading> = sequence.frames.iter().zip(numbers).filter_map(reading).collect();
        if !stretched || !gauge.is_finite() || gauge <= 0.0 || readings.is_empty() {
            return None;
        }
        let separations: Vec<f64> = readings.iter().map(|reading| reading.separation).collect();
        for (reading, branch) in readings.iter_mut().zip(numbered(&separations)) {
            reading.branch = branch;
        }
        let declared = sequence.noise.and_then(|noise| noise.force_n);
        Some(Self {
            sequence: sequence.name.clone(),
            counted: counted.into(),
            gauge,
            width: sides[1] - sides[0],
            weight: (first.mass_kg + second.mass_kg) * sequence.gravity.dot(&axis).abs(),
            noise: declared.unwrap_or_else(|| noise(&readings)),
            step_noise: 2.0 * sequence.clip_noise(),
            has_shapes: sequence.frames.iter().any(|frame| frame.positions.is_some()),
            cycle: sequence.frames.iter().find_map(|frame| frame.cycle).unwrap_or(0),
            readings,
        })
    }

    /// The branches as ranges of readings.
    pub(super) fn branches(&self) -> Vec<Range<usize>> {
        branches(&self.readings)
    }

    /// True if the readings are in test order; shuffled readings reverse at almost every row.
    pub(super) fn is_in_order(&self) -> bool {
        self.readings.len() >= 4 * self.branches().len()
    }

    /// Separations and forces of the first branch, if it is a loading.
    pub(super) fn first_loading(&self) -> Vec<[f64; 2]> {
        let first = self.branches().first().map_or(&[][..], |branch| &self.readings[branch.clone()]);
        match first {
            [from, .., to] if to.separation > from.separation => points(first),
            _ => Vec::new(),
        }
    }

    /// The last unloading branch, from its end backwards.
    pub(super) fn last_unloading(&self) -> Vec<[f64; 2]> {
        let unloads = |branch: &Range<usize>| {
            let [from, to] = [branch.start, branch.end - 1].map(|row| self.readings[row].separation);
            branch.len() > 1 && to < from
        };
        let last = self.branches().into_iter().rev().find(unloads);
        let mut points = last.map_or(Vec::new(), |branch| points(&self.readings[branch]));
        points.reverse();
        points
    }

    /// Smallest force that noise, drift and the weight of the clips do not explain, N.
    pub(super) fn threshold(&self) -> f64 {
        (NOISE * self.noise).max(DRIFT * self.largest_force()) + self.weight
    }

    pub(super) fn largest_force(&self) -> f64 {
        self.readings.iter().fold(0.0, |largest, reading| largest.max(reading.force.abs()))
    }

    /// Travel of the clips, m.
    pub(super) fn travel(&self) -> f64 {
        let [low, high] = extent(self.readings.iter().map(|reading| reading.separation));
        high - low
    }

    /// Excludes readings.
    ///
    /// * `readings` — indices, ascending
    pub(super) fn leave_out(&mut self, readings: &[usize]) {
        let mut row = 0..;
        self.readings.retain(|_| row.next().is_some_and(|row| readings.binary_search(&row).is_err()));
    }

    pub(super) fn notice(
        &self,
        severity: Severity,
        reading: &Reading,
        found: String,
        expected: String,
    ) -> Notice {
        let place = format!("{} {}", self.counted, reading.number);
        Notice::new(severity, &self.sequence, place, found, expected)
    }
}

pub(super) fn points(readings: &[Reading]) -> Vec<[f64; 2]> {
    readings.iter().map(|reading| [reading.separation, reading.force]).collect()
}

fn branches(readings: &[Reading]) -> Vec<Range<usize>> {
    let ends = readings.chunk_by(|a, b| a.branch == b.branch).scan(0, |end, branch| {
        *end += branch.len();
        Some(*end - branch.len()..*end)
    });
    ends.collect()
}

/// Standard deviation of a force, N, from the deviation of four consecutive readings from a parabola at any spacing.
/// The median ignores a few bad readings.
pub(super) fn noise(readings: &[Reading]) -> f64 {
    let miss = |four: &[Reading]| {
        // The third divided difference as a weighted sum of the forces.
        let weights: [f64; 4] = std::array::from_fn(|i| {
            let others = (0..4).filter(|&j| j != i);
            others.map(|j| four[i].separation - four[j].separation).product::<f64>().recip()
        });
        let sum: f64 = weights.iter().zip(four).map(|(weight, reading)| weight * reading.force).sum();
        (sum / weights.iter().map(|weight| weight * weight).sum::<f64>().sqrt()).abs()
    };
    let fours = branches(readings).into_iter().flat_map(|branch| readings[branch].windows(4));
    let misses = fours.map(miss).filter(|miss| miss.is_finite()).collect();
    // The median of |x| for a normal x with unit deviation.
    median(misses).unwrap_or(0.0) / 0.6745
}

fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::MAX, f64::MIN], |[low, high], value| [low.min(value), high.max(value)])
}

/// Formats a number with the given count of significant digits.
pub(super) fn digits(value: f64, count: usize) -> String {
    let above_one = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    match (-3.0..6.0).contains(&above_one) {
        true => format!("{value:.*}", (count as f64 - 1.0 - above_one).max(0.0) as usize),
        false => format!("{value:.*e}", count - 1),
    }
}
