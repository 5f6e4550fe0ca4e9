//! Synthetic strips, 0.2 × 0.05 m: 2000 ε + 20000 ε² N/m, noise of 5 mN, with each fault and without.

use super::reading::digits;
use super::*;
use crate::frame::Noise;
use crate::inspection::inspect_sequence;
use crate::notice::{Remedy, Severity};
use crate::strip::{Direction, Extension, StripTest, read_strip};
use nalgebra::{Isometry3, Vector3};
use rand::seq::SliceRandom;
use rand::{SeedableRng, rngs::StdRng};
use rand_distr::{Distribution, StandardNormal};

const GAUGE: f64 = 0.2;
const NOISE_N: f64 = 5e-3;
const SEEDS: u64 = 20;

/// Force of a strip with the given free length, N; zero while slack.
fn law(separation: f64, length: f64) -> f64 {
    let strain = (separation / length - 1.0).max(0.0);
    0.05 * (2000.0 * strain + 20000.0 * strain * strain)
}

/// Separations in equal steps, m.
fn course(from: f64, to: f64, steps: usize) -> Vec<f64> {
    (0..=steps).map(|step| from + (to - from) * step as f64 / steps as f64).collect()
}

/// Loading in steps of 0.2 mm, by 20 mm.
fn loading(force: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    course(GAUGE, 0.22, 100).into_iter().map(|separation| [separation, force(separation)]).collect()
}

fn noisy(rows: &[[f64; 2]], seed: u64) -> Vec<[f64; 2]> {
    let mut random = StdRng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    rows.iter().map(|[separation, force]| [*separation, force + NOISE_N * normal()]).collect()
}

fn sequence(rows: &[[f64; 2]]) -> Sequence {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("strip.csv");
    let lines: String = rows.iter().map(|[separation, force]| format!("{separation},{force}\n")).collect();
    std::fs::write(&path, format!("d_m,f_N\n{lines}")).unwrap();
    let extension = Extension::Separation("d_m".into());
    let test = StripTest::new(Direction::Weft, GAUGE, 0.05, extension, "f_N".into());
    read_strip(&path, &test).unwrap().sequence
}

fn fabric() -> Fabric {
    Fabric {
        name: "cloth".into(),
        width_m: 0.2,
        height_m: 0.05,
        areal_density_kg_m2: 0.3,
        thickness_m: None,
        source: None,
        notes: None,
    }
}

/// Severity, frame and text of every notice.
fn noticed(rows: &[[f64; 2]]) -> Vec<(Severity, String, String)> {
    let (_, notices) = inspect_sequence(&fabric(), &sequence(rows));
    let told = |notice: Notice| {
        let frame = notice.place.strip_prefix("forces.csv frame ").unwrap().to_string();
        let remedies = notice.remedies.iter().map(|remedy| match remedy {
            Remedy::Zero(force) => format!(" zero={force}"),
            Remedy::FreeLength(length) => format!(" free-length={length}"),
            Remedy::Robust => " robust".into(),
        });
        let remedies: String = remedies.collect();
        (notice.severity, frame, format!("{}; {}{remedies}", notice.found, notice.expected))
    };
    notices.into_iter().map(told).collect()
}

/// The single notice, which must be a doubt, and its frame.
fn doubt(rows: &[[f64; 2]]) -> (String, String) {
    let mut all = noticed(rows);
    assert_eq!(all.len(), 1, "{all:?}");
    let (severity, frame, words) = all.remove(0);
    assert_eq!(severity, Severity::Doubt);
    (frame, words)
}

/// The number after a phrase.
fn number(words: &str, after: &str) -> f64 {
    let (_, rest) = words.split_once(after).unwrap_or_else(|| panic!("no {after} in {words}"));
    rest.split([' ', ')']).next().unwrap().parse().unwrap()
}

/// Cycles that grow to 12 %, with unloading below loading and permanent set: the strip is slack near the gauge
/// length.
fn cycles() -> Vec<[f64; 2]> {
    let mut rows = Vec::new();
    let mut longest = GAUGE;
    for top in [0.208, 0.216, 0.224] {
        let length = GAUGE + 0.05 * (longest - GAUGE);
        rows.extend(course(GAUGE, top, 60).into_iter().map(|s| [s, law(s, length)]));
        longest = top;
        let set = GAUGE + 0.05 * (top - GAUGE);
        let share = law(top, length) / law(top, set);
        let back = |s: f64| share * law(s, set) * (0.7 + 0.3 * (s - set) / (top - set));
        rows.extend(course(top, GAUGE, 60).into_iter().skip(1).map(|s| [s, back(s)]));
    }
    rows
}

#[test]
fn sound_strips_raise_no_notice() {
    let knit = |s: f64| 0.02 * (25.0 * (s / GAUGE - 1.0)).exp_m1();
    let soft = |s: f64| 0.05 * 20.0 * (s / GAUGE - 1.0);
    let locking = |s: f64| 0.01 * (90.0 * (s / GAUGE - 1.0)).exp_m1();
    let stiff_first = |s: f64| 4.0 * (1.0 - (-(s - GAUGE) / 4e-4).exp()) + law(s, GAUGE);
    // Pulled stepwise, it relaxes at every step by a quarter of the rise.
    let steps = (0..100).map(|row| {
        let step = GAUGE + 8e-4 * (row / 4) as f64;
        [step, law(step, GAUGE) * (1.0 + 0.1 * 0.5f64.powi(row % 4))]
    });
    // Held at the top of a loading while it relaxes by a third, then continued.
    let held = loading(|s| law(s, GAUGE)).into_iter().enumerate().flat_map(|(row, [s, force])| {
        let relaxed = move |time: f64| force * (0.67 + 0.33 * (-time / 5.0).exp());
        let regained = if row > 60 { 0.67 + 0.33 * (row - 60) as f64 / 40.0 } else { 1.0 };
        let hold = if row == 60 { 20 } else { 0 };
        std::iter::once([s, force * regained])
            .chain((1..=hold).map(move |time| [s, relaxed(f64::from(time))]))
    });
    // It relaxes while the clips come to a halt, then is released.
    let up = loading(|s| law(s, GAUGE));
    let [top, most] = *up.last().unwrap();
    let halt = [top + 1.2e-4, 0.93 * most];
    let down = up.iter().rev().map(|&[s, force]| [s, 0.8 * force]);
    let turned = up.iter().copied().chain([halt]).chain(down);
    let late = course(0.21, 0.22, 50).into_iter().map(|s| [s, law(s, GAUGE)]);
    let sparse = course(GAUGE, 0.22, 5).into_iter().map(|s| [s, law(s, GAUGE)]);
    let strips: Vec<(&str, Vec<[f64; 2]>)> = vec![
        ("loading", loading(|s| law(s, GAUGE))),
        ("cycles", cycles()),
        ("later cycles", cycles().split_off(121)),
        ("a knit", loading(knit)),
        ("a soft knit", loading(soft)),
        ("a locking cloth", loading(locking)),
        ("a cloth that is stiff at first", loading(stiff_first)),
        ("step by step", steps.collect()),
        ("held at the top", held.collect()),
        ("turned slowly", turned.collect()),
        ("seen from 5 %", late.collect()),
        ("a knit from 5 %", course(0.21, 0.24, 50).into_iter().map(|s| [s, knit(s)]).collect()),
        ("six rows", sparse.collect()),
        ("one row", vec![[0.21, 7.5]]),
    ];
    for (name, rows) in strips {
        assert_eq!(noticed(&rows), [], "{name}, exact");
        for seed in 0..SEEDS {
            assert_eq!(noticed(&noisy(&rows, seed)), [], "{name}, seed {seed}");
        }
    }
}

#[test]
fn frames_in_any_order_are_not_taken_for_a_broken_strip() {
    for seed in 0..SEEDS {
        let mut rows = noisy(&cycles(), seed);
        rows.shuffle(&mut StdRng::seed_from_u64(seed));
        assert_eq!(noticed(&rows), []);
    }
}

#[test]
fn noise_is_estimated_whatever_the_curve_and_its_spikes() {
    let estimated = |rows: &[[f64; 2]]| Pull::of(&sequence(rows), "", &[0; 400]).unwrap().noise;
    for rows in [loading(|s| law(s, GAUGE)), cycles()] {
        assert!(estimated(&rows) < 1e-3 * NOISE_N + 2e-3);
        let mean = (0..SEEDS).map(|seed| estimated(&noisy(&rows, seed))).sum::<f64>() / SEEDS as f64;
        assert!((mean / NOISE_N - 1.0).abs() < 0.1, "{mean}");
        let mut spiked = noisy(&rows, 0);
        spiked.iter_mut().skip(5).step_by(20).for_each(|row| row[1] += 50.0);
        assert!(estimated(&spiked) < 1.6 * NOISE_N);
    }
    let mut declared = sequence(&loading(|s| law(s, GAUGE)));
    declared.noise = Some(Noise { position_m: None, force_n: Some(0.3), clip_m: None });
    assert_eq!(Pull::of(&declared, "", &[0; 400]).unwrap().noise, 0.3);
}

#[test]
fn a_tension_at_the_gauge_length_is_noticed_with_the_free_length() {
    // 2 N at 200 mm: 2000 ε + 20000 ε² = 40 N/m at ε = 0.0170820.
    let length = GAUGE / 1.0170820;
    let rows = loading(|s| law(s, length));
    let mut inside = 0;
    for seed in 0..SEEDS {
        let (frame, words) = doubt(&noisy(&rows, seed));
        assert_eq!(frame, "1");
        assert!(words.starts_with("2.00 N at the gauge length, 200.00 mm"), "{words}");
        assert!((number(&words, " free-length=") - length).abs() < 1e-4, "{words}");
        assert!(words.contains(" zero=2") || words.contains(" zero=1.99"), "{words}");
        let off = 1e3 * (number(&words, " free-length=") - length).abs();
        inside += u64::from(off <= number(&words, "reaches zero, ± "));
    }
    assert!((SEEDS - 3..=SEEDS).contains(&inside), "{inside} of {SEEDS} within what is told");
}

#[test]
fn a_strip_that_was_never_at_rest_says_how_unsure_its_free_length_is() {
    let rows = |steps| -> Vec<[f64; 2]> {
        course(1.04 * GAUGE, 1.05 * GAUGE, steps).into_iter().map(|s| [s, law(s, GAUGE)]).collect()
    };
    let (frame, words) = doubt(&noisy(&rows(10), 1));
    assert_eq!(frame, "1");
    assert!(words.contains("8.00 mm beyond the free length, 200.00 mm"), "{words}");
    assert!((0.4..10.0).contains(&number(&words, "free length to ± ")), "{words}");
    // Ten times as far, with many readings.
    let rows: Vec<[f64; 2]> =
        course(1.04 * GAUGE, 1.14 * GAUGE, 100).into_iter().map(|s| [s, law(s, GAUGE)]).collect();
    assert_eq!(noticed(&noisy(&rows, 1)), []);
}

#[test]
fn a_tension_that_is_a_small_share_of_the_force_is_noticed_where_it_shifts_the_strain() {
    // 2 N of 800 N, a standard's pretension for a strong cloth: 400 ε + 4e5 ε² N/m.
    let length = 0.19;
    let strong = |s: f64| 0.05 * (400.0 * (s / length - 1.0) + 4e5 * (s / length - 1.0).powi(3));
    let rows: Vec<[f64; 2]> = course(GAUGE, 0.25, 200).into_iter().map(|s| [s, strong(s)]).collect();
    let (_, words) = doubt(&noisy(&rows, 1));
    assert!(words.contains("mounted under tension"), "{words}");
}

#[test]
fn a_slack_strip_is_noticed_with_the_free_length() {
    for (length, frame) in [(0.203, 16..=17), (0.2015, 8..=9)] {
        let rows = loading(|s| law(s, length));
        for seed in 0..SEEDS {
            let (at, words) = doubt(&noisy(&rows, seed));
            assert!(frame.contains(&at.parse().unwrap()), "{at}");
            assert!(words.starts_with("no force until"), "{words}");
            assert!((number(&words, " free-length=") - length).abs() < 1e-4, "{words}");
        }
    }
}

#[test]
fn a_zero_that_is_off_is_told_from_tension_where_the_strip_was_seen_slack() {
    let both = ["mounted under tension", "zero is off"];
    let causes = |words: &str| both.map(|cause| words.contains(cause));
    for seed in 0..SEEDS {
        // Neither cause can be excluded.
        let (_, words) = doubt(&noisy(&loading(|s| law(s, GAUGE) + 0.6), seed));
        assert_eq!(causes(&words), [true; 2], "{words}");
        assert!((number(&words, " zero=") - 0.6).abs() < 0.01, "{words}");
        // Cloth cannot push.
        let (_, words) = doubt(&noisy(&loading(|s| law(s, GAUGE) - 0.6), seed));
        assert_eq!(causes(&words), [false, true], "{words}");
        assert!((number(&words, " zero=") + 0.6).abs() < 0.01, "{words}");
        // Unloading reaches the slack range.
        for (offset, length, cause) in [(0.6, GAUGE, [false, true]), (0.0, 0.199, [true, false])] {
            let mut rows = loading(|s| law(s, length) + offset);
            rows.extend(course(0.22, GAUGE, 100).into_iter().skip(1).map(|s| [s, law(s, 0.204) + offset]));
            let (_, words) = doubt(&noisy(&rows, seed));
            assert_eq!(causes(&words), cause, "{words}");
        }
        // Slack at first: both faults are seen.
        let all = noticed(&noisy(&loading(|s| law(s, 0.203) + 0.6), seed));
        assert_eq!(all.len(), 2, "{all:?}");
        assert!((number(&all[0].2, " zero=") - 0.6).abs() < 0.01, "{all:?}");
        assert!((number(&all[1].2, " free-length=") - 0.203).abs() < 1e-4, "{all:?}");
        // The clamps started below the gauge length, where force already began.
        let near = course(0.19, 0.22, 150).into_iter().map(|s| [s, law(s, 0.197)]);
        let (_, words) = doubt(&noisy(&near.collect::<Vec<_>>(), seed));
        assert!((number(&words, " free-length=") - 0.197).abs() < 1e-4, "{words}");
    }
}

#[test]
fn what_follows_a_breakage_is_left_out() {
    let whole = loading(|s| law(s, GAUGE));
    // It breaks after row 80 and keeps tearing; or breaks within one reading; or slips by 3 mm and recovers.
    let torn = |row: usize| law(GAUGE + 0.0158, GAUGE) * 0.6 * 0.9f64.powi(row as i32 - 80);
    let tears = whole.iter().enumerate().map(|(row, &[s, f])| [s, if row < 80 { f } else { torn(row) }]);
    let snaps = whole.iter().enumerate().map(|(row, &[s, f])| match row {
        0..80 => [s, f],
        80..84 => [whole[79][0], 3.0 - row as f64 / 50.0],
        _ => [s, 0.0],
    });
    let slips =
        whole.iter().enumerate().map(|(row, &[s, f])| [s, if row < 80 { f } else { law(s - 3e-3, GAUGE) }]);
    for (rows, left) in
        [(tears.collect::<Vec<_>>(), "tears"), (snaps.collect(), "snaps"), (slips.collect(), "slips")]
    {
        for seed in 0..SEEDS {
            let sequence = sequence(&noisy(&rows, seed));
            let (kept, notices) = inspect_sequence(&fabric(), &sequence);
            let [notice] = &notices[..] else { panic!("{left}: {notices:?}") };
            assert_eq!((notice.severity, notice.place.as_str()), (Severity::Remark, "forces.csv frame 80"));
            assert!(notice.found.contains("with the clamps 215.80 mm apart"), "{notice}");
            assert_eq!(kept.frames, sequence.frames[..81]);
        }
    }
}

#[test]
fn steps_that_contradict_the_way_of_the_clips_are_named() {
    let rows = loading(|s| law(s, GAUGE));
    // It slips by a millimetre at row 60 and loses less than a seventh of the force.
    let slipped: Vec<[f64; 2]> =
        rows.iter().map(|[s, _]| [*s, law(*s - if *s > 0.2119 { 1e-3 } else { 0.0 }, GAUGE)]).collect();
    let set_back: Vec<[f64; 2]> =
        rows.iter().map(|[s, force]| [*s - if *s > 0.2119 { 3e-3 } else { 0.0 }, *force]).collect();
    let saturated: Vec<[f64; 2]> = rows.iter().map(|[s, force]| [*s, force.min(15.0)]).collect();
    for (rows, frame, said) in [
        (noisy(&slipped, 1), 61, "slipped"),
        (noisy(&slipped, 2), 61, "slipped"),
        (saturated, 84, "load cell reached its limit"),
    ] {
        let (at, words) = doubt(&rows);
        assert!(words.contains(said) && at.parse::<i32>().unwrap().abs_diff(frame) <= 1, "{at}: {words}");
    }
    let all = noticed(&noisy(&set_back, 1));
    assert!(
        all.iter().any(|(_, at, words)| words.contains("was the extension reset?") && at == "61"),
        "{all:?}"
    );
}

#[test]
fn a_strip_without_a_reading_at_rest_is_followed_down_to_it() {
    let from = |first: f64, force: &dyn Fn(f64) -> f64| -> Vec<[f64; 2]> {
        course(GAUGE + first, 0.22, 50).into_iter().map(|s| [s, force(s)]).collect()
    };
    for seed in 0..SEEDS {
        let (_, words) = doubt(&noisy(&from(1e-3, &|s| law(s, GAUGE) + 1.0), seed));
        assert!(words.contains("extrapolate to 1.0") || words.contains("extrapolate to 0.9"), "{words}");
        let (_, words) = doubt(&noisy(&from(3.2e-3, &|s| law(s, GAUGE + 3e-3)), seed));
        assert!(words.contains("the strip was slack"), "{words}");
        assert!((number(&words, " free-length=").abs() - 0.203).abs() < 2e-4, "{words}");
    }
}

#[test]
fn a_spike_is_named_and_nothing_else_is_blamed() {
    for seed in 0..SEEDS {
        for (row, force) in [(50, 999.9), (50, -3.0), (2, 40.0), (97, 60.0)] {
            let mut rows = noisy(&loading(|s| law(s, GAUGE)), seed);
            rows[row][1] = force;
            let (frame, words) = doubt(&rows);
            assert_eq!(frame, (row + 1).to_string());
            assert!(words.starts_with(&digits(force, 4)) && words.contains(" robust"), "{words}");
        }
        let mut rows = noisy(&loading(|s| law(s, GAUGE)), seed);
        (rows[30][1], rows[31][1], rows[70][1]) = (80.0, 75.0, 0.0);
        let (frame, words) = doubt(&rows);
        assert!(frame == "31" && words.contains("likewise at 32, 71;"), "{words}");
    }
}

#[test]
fn numbers_have_the_digits_that_count() {
    let shown = [
        (0.0, "0.00"),
        (2.0, "2.00"),
        (-0.0599, "-0.0599"),
        (999.9, "1000"),
        (2e-5, "2.00e-5"),
        (4e7, "4.00e7"),
    ];
    for (value, expected) in shown {
        assert_eq!(digits(value, 3), expected);
    }
}

#[test]
fn forces_of_another_unit_are_noticed() {
    for (factor, unit) in [(1e-6, "MN"), (1e-3, "kN"), (1e3, "mN"), (1e6, "µN")] {
        let (frame, words) = doubt(&loading(|s| factor * law(s, GAUGE)));
        assert!(frame == "101" && words.contains(&format!("{unit} would be plausible")), "{words}");
    }
}

#[test]
fn any_two_clips_will_do_wherever_they_are() {
    let rows = noisy(&loading(|s| law(s, GAUGE / 1.0170820)), 3);
    let plain = sequence(&rows);
    let (_, expected) = inspect_sequence(&fabric(), &plain);
    // Moved and rotated, with the force known on the other clip.
    let motion = Isometry3::new(Vector3::new(3.0, -2.0, 0.5), Vector3::new(0.3, -0.8, 1.9));
    let mut moved = plain.clone();
    moved.clips.reverse();
    for frame in &mut moved.frames {
        frame.poses.reverse();
        frame.poses.iter_mut().for_each(|pose| *pose = motion * *pose);
        frame.cords.iter_mut().for_each(|cord| {
            (cord.clip, cord.force) = (1, -(motion * cord.force));
        });
    }
    let (_, found) = inspect_sequence(&fabric(), &moved);
    assert_eq!((expected.len(), found), (1, expected));
    moved.clips.pop();
    assert!(inspect_sequence(&fabric(), &moved).1.is_empty());
}
