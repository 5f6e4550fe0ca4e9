//! Clips that hold only part of a side, or list only part of the vertices they hold.
//!
//! ```text
//!  ┃●──●──●       listed
//!  ┃●──●──●
//!   ○──●──●  d    beside it: a free vertex lags by about ε d along the pull, a held one does not
//! ```

use crate::frame::{Fabric, Sequence, is_seen};
use crate::kind::Holding;
use crate::measure::{clip_centres, mean, moved};
use crate::notice::Notice;
use crate::rectangle::{Rectangle, bounds};
use nalgebra::Vector2;

/// A vertex that lags by less than this share of ε d is held; a free vertex lags by at least half of ε d.
const HELD: f64 = 0.25;
/// Lags are evaluated if their expected sum exceeds this many times the noise.
const SURE: f64 = 10.0;
/// Vertices within this share of the specimen size lie on one line; the rest is rounding.
const TIE: f64 = 1e-6;
/// Fewer vertices may result from an oblique cut.
const FEWEST: usize = 3;

/// A clip that grips this share of its side counts as gripping all of it.
const WHOLE: f64 = 0.98;

/// Doubts a stretched specimen whose clips do not hold whole sides. With 83 % of a side, a fit that ignores shear
/// makes denim 12 % too stiff; the error grows if a clip holds more than it lists.
pub(super) fn check(_: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    let stretched = sequence.kind.holding() == Holding::Strip;
    if stretched && sequence.clips.len() == 2 {
        notices.extend([0, 1].into_iter().filter_map(|clip| holds_part(sequence, clip)));
    }
}

fn holds_part(sequence: &Sequence, clip: usize) -> Option<Notice> {
    let Rectangle { flat, size, .. } = Rectangle::of(sequence).ok()?;
    let listed = &sequence.clips[clip].vertices;
    let centre = |clip: usize| mean(sequence.clips[clip].vertices.iter().map(|&vertex| flat[vertex]));
    let between = centre(1 - clip) - centre(clip);
    let (pull, across) = if between.x.abs() > between.y.abs() { (0, 1) } else { (1, 0) };
    let [low, high] = bounds(listed.iter().map(|&vertex| flat[vertex]));
    let share = (high[across] - low[across]) / size[across];
    if share >= WHOLE {
        return None;
    }
    let tie = TIE * between.norm();
    let alongside = |place: &Vector2<f64>| place[pull] >= low[pull] - tie && place[pull] <= high[pull] + tie;
    let beside = flat.iter().enumerate().filter(|(_, place)| alongside(place)).map(|(vertex, place)| {
        // Beyond half the distance to the other clip the lag no longer grows.
        let apart = f64::max(low[across] - place[across], place[across] - high[across]);
        (vertex, apart.min(0.5 * between.norm()))
    });
    let beside: Vec<(usize, f64)> = beside.filter(|(_, apart)| *apart > tie).collect();
    let rest = &sequence.mesh.positions;
    let (mut both, mut free) = (0.0, 0.0);
    for frame in &sequence.frames {
        let (Some(positions), [_, _]) = (&frame.positions, &frame.poses[..]) else { continue };
        let centres = clip_centres(sequence, frame);
        let now = centres[1 - clip] - centres[clip];
        let strain = now.norm() / between.norm() - 1.0;
        let Some(toward) = now.try_normalize(0.0).filter(|_| strain > 0.0) else { continue };
        for &(vertex, apart) in beside.iter().filter(|(vertex, _)| is_seen(&positions[*vertex])) {
            let lag = (positions[vertex] - moved(&frame.poses[clip], &rest[vertex])).dot(&toward);
            both += lag * strain * apart;
            free += (strain * apart).powi(2);
        }
    }
    let told = beside.len() >= FEWEST && free.sqrt() >= SURE * sequence.position_noise();
    let more = match told && both <= HELD * free {
        true => format!(", and {} vertices beside them that move with it", beside.len()),
        false => String::new(),
    };
    let name = &sequence.clips[clip].name;
    Some(Notice::doubt(
        &sequence.name,
        "test.toml clips.vertices",
        format!("vertices of clip {name} along {:.0} % of its side{more}", 100.0 * share),
        "all vertices it holds, along the whole side: cloth beside a clip is sheared, which a stretch fit ignores, so \
         that the curve becomes too stiff",
    ))
}
