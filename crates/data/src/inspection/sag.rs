//! Compares the weight with the direction in which a sheet hangs off a table, in most frames or in single ones.
//!
//! ```text
//! ━━━━━┓╲          ━━━━━┓     ╱        ╱┏━━━━━         ━━━━━┓───────
//!      ┃ ╲              ┃ __╱       _╱  ┃                   ┃
//!   as weight         gravity or z    outward or edge     z is missing
//! ```

use super::profile::{Line, Profile, profiles, up};
use crate::frame::{Fabric, Sequence};
use crate::io::shortened;
use crate::notice::Notice;

/// Heights that differ by less count as equal, in standard deviations of a coordinate. A line averages many vertices,
/// but a table may be uneven by a tenth of a millimetre.
const ALIKE: f64 = 3.0;

/// A single deviating frame, as opposed to a wrinkle, in multiples of that.
const ODD: f64 = 10.0;

/// Upper limit of rigidity of woven and knitted fabrics, N·m: sailcloth and leather stay below a thousandth.
const STIFFEST: f64 = 1e-2;

/// Refuses an overhang test whose sheet does not hang in the direction of its weight.
pub(super) fn check(fabric: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    let Some(table) = sequence.table else { return };
    let mut refuse = |place: &str, found: String, expected: &str| {
        notices.push(Notice::refusal(
            &sequence.name,
            place,
            format!("shapes and weight disagree: {found}"),
            expected,
        ));
    };
    let Some(up) = up(&table, &sequence.gravity) else {
        let [x, y, z] = sequence.gravity.into();
        let found =
            format!("gravity {x}, {y}, {z} is not across the table, which edge_direction and outward span");
        let expected =
            "gravity that pulls the overhang below the table: check its axis and size, or those of the table";
        return refuse("test.toml gravity_m_s2, table", found, expected);
    };
    let profiles = profiles(sequence, &table, &up);
    let sags: Vec<Sag> = profiles.iter().filter_map(Sag::of).collect();
    let alike = ALIKE * sequence.position_noise();
    let hanging = sags.iter().filter(|sag| sag.overhang > 0.0);
    let bent: Vec<&Sag> = hanging.filter(|sag| sag.most() > alike).collect();
    let Some(most) = bent.iter().max_by(|a, b| a.most().total_cmp(&b.most())) else {
        let Some(longest) = sags.iter().max_by(|a, b| a.overhang.total_cmp(&b.overhang)) else { return };
        let weight = fabric.areal_density_kg_m2 * sequence.gravity.norm();
        // A cantilever under its own weight.
        if weight * longest.overhang.powi(4) / (8.0 * STIFFEST) > alike {
            let found = format!(
                "the sheet is flat within {:.2} mm in every frame, despite an overhang of {:.0} mm in frame {} and its \
                 weight",
                1e3 * alike,
                1e3 * longest.overhang,
                longest.frame
            );
            let expected = "a tip below the table: is z (the height) missing, or 0?";
            refuse("positions.npy", found, expected);
        }
        return;
    };
    let agree = bent.iter().filter(|other| other.way() == most.way()).count();
    let Some((place, expected)) = most.way().causes().filter(|_| 2 * agree > bent.len()) else { return };
    let found = format!(
        "the sheet bends {} and its end there lies {:.1} mm {} the other in frame {} ({agree} of {} frames agree)",
        if most.way().past { "past the edge" } else { "before the edge, on the table," },
        1e3 * most.rise.abs(),
        if most.way().below { "below" } else { "above" },
        most.frame,
        bent.len()
    );
    refuse(place, found, expected);
}

/// Doubts a sequence in which single frames hang differently from the others.
pub(super) fn check_frames(_: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    let Some(table) = sequence.table else { return };
    let Some(up) = up(&table, &sequence.gravity) else { return };
    let least = ODD * ALIKE * sequence.position_noise();
    let is_odd = |sag: &Sag| sag.most() > least && (!sag.lies || sag.way().causes().is_some());
    let sags = profiles(sequence, &table, &up).iter().filter_map(Sag::of).collect::<Vec<_>>();
    let frames: Vec<String> = sags.iter().filter(|s| is_odd(s)).map(|sag| sag.frame.to_string()).collect();
    if frames.is_empty() {
        return;
    }
    notices.push(Notice::doubt(
        &sequence.name,
        "positions.npy",
        format!(
            "sheets that do not hang down past the edge in frame {}, unlike in the other frames",
            shortened(&frames.join(", "), 60)
        ),
        "the same direction in all frames: leave these frames out, or use the axes of the others",
    ));
}

/// Sag of a sheet in one frame.
struct Sag {
    frame: usize,
    /// Part of the sheet lies on the table.
    lies: bool,
    /// Length past the edge, m; 0 if none or all of it is.
    overhang: f64,
    /// Range of heights on the table, m.
    on: f64,
    /// Range of heights past the edge, m.
    past: f64,
    /// Height of the outer end relative to the end on the table, m.
    rise: f64,
}

/// The side of the edge on which a sheet bends, and whether the end there is the lower one.
#[derive(PartialEq)]
struct Way {
    past: bool,
    below: bool,
}

impl Sag {
    fn of(profile: &Profile) -> Option<Self> {
        let [on, past] = profile.split();
        let range = |lines: &[Line]| {
            let ends = lines.iter().fold([f64::MAX, f64::MIN], |[low, high], line| {
                [low.min(line.height), high.max(line.height)]
            });
            f64::max(ends[1] - ends[0], 0.0)
        };
        let (first, last) = (profile.lines.first()?, profile.lines.last()?);
        Some(Self {
            frame: profile.frame,
            lies: !on.is_empty(),
            overhang: last.rest - on.last().map_or(last.rest, |line| line.rest),
            on: range(on),
            past: range(past),
            rise: last.height - first.height,
        })
    }

    fn most(&self) -> f64 {
        self.on.max(self.past)
    }

    fn way(&self) -> Way {
        let past = self.past > self.on;
        Way { past, below: (self.rise < 0.0) == past }
    }
}

impl Way {
    /// The likely cause, by file and field, and the expected state; `None` if the sheet hangs correctly.
    fn causes(&self) -> Option<(&'static str, &'static str)> {
        match (self.past, self.below) {
            (true, true) => None,
            (true, false) => Some((
                "test.toml gravity_m_s2 or positions.npy",
                "an end below the table: the sign of gravity, or of z; outward agrees with the shapes",
            )),
            (false, true) => Some((
                "test.toml table.outward",
                "a sheet that bends past the edge: the sign of outward; gravity and z agree with each other",
            )),
            (false, false) => Some((
                "test.toml table.edge_point_m, or table.outward with gravity_m_s2 or positions.npy",
                "a sheet that bends past the edge, and down: the place of the edge; or the sign of outward and also that of \
                 gravity or z",
            )),
        }
    }
}
