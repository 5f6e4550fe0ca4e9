//! Small tables with known results, and invalid tables and settings with their full messages.

use super::*;
use crate::frame::Fabric;
use crate::io::read_set;
use crate::notice::Severity;
use crate::rectangle::Rectangle;
use nalgebra::Vector2;
use std::fs;

/// Up to 10 % and back to 0, up to 20 % and back to 10 %, with a spring of 50 N/m.
fn rows() -> Vec<[f64; 2]> {
    let strains = [0.0, 0.05, 0.1, 0.05, 0.0, 0.1, 0.2, 0.1];
    strains.map(|strain| [0.08 * (1.0 + strain), 50.0 * 0.08 * strain]).to_vec()
}

fn table(header: &str, row: impl Fn(usize, [f64; 2]) -> String) -> String {
    let rows = rows().into_iter().enumerate().map(|(index, values)| row(index, values) + "\n");
    format!("{header}\n{}", rows.collect::<String>())
}

fn plain() -> String {
    table("branch,operator,clamp_distance_m,force_N", |index, [separation, force]| {
        format!("{},\"Smith, nan\",{separation},{force}", [0, 0, 0, 1, 1, 2, 2, 3][index])
    })
}

fn test() -> StripTest {
    let extension = Extension::Separation("clamp_distance_m".into());
    StripTest::new(Direction::Weft, 0.08, 0.04, extension, "force_N".into())
}

fn read(text: &str, test: &StripTest) -> Result<Sequence> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.csv");
    fs::write(&path, text).unwrap();
    read_strip(&path, test).map(|strip| strip.sequence)
}

/// The message, with the path of the table reduced to its name.
fn message(text: &str, test: &StripTest) -> String {
    let message = read(text, test).unwrap_err().to_string();
    message.find("t.csv").map_or(message.clone(), |start| message[start..].into())
}

/// Extension of the moving clamp and force along the pull, for all frames after the rest state.
fn curve(sequence: &Sequence) -> Vec<[f64; 2]> {
    let pull = sequence.force_direction.unwrap();
    let frames = sequence.frames.iter().skip(1);
    frames
        .map(|frame| [frame.poses[1].translation.vector.dot(&pull), frame.clip_force(1).unwrap().dot(&pull)])
        .collect()
}

fn expected() -> Vec<[f64; 2]> {
    rows().into_iter().map(|[separation, force]| [separation - 0.08, force]).collect()
}

fn assert_close(found: &[[f64; 2]], expected: &[[f64; 2]]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}

#[test]
fn every_direction_has_its_strip() {
    for (direction, pull) in
        [(Direction::Weft, Vector3::x()), (Direction::Warp, Vector3::y()), (Direction::Bias, Vector3::x())]
    {
        let sequence = read(&plain(), &StripTest { direction, ..test() }).unwrap();
        assert_eq!((sequence.kind, sequence.force_direction), (direction.kind(), Some(pull)));
        let Sequence { mesh, clips, .. } = &sequence;
        let middle =
            |clip: &Clip| clip.vertices.iter().map(|&v| mesh.positions[v]).sum::<Vector3<f64>>() / 2.0;
        assert!((middle(&clips[1]) - middle(&clips[0]) - pull * 0.08).norm() < 1e-15);
        let side = |clip: &Clip| mesh.positions[clip.vertices[1]] - mesh.positions[clip.vertices[0]];
        assert!(clips.iter().all(|clip| side(clip).norm() == 0.04 && side(clip).dot(&pull) == 0.0));
        let along = mesh.material[clips[1].vertices[0]] - mesh.material[clips[0].vertices[0]];
        let yarns = match direction {
            Direction::Weft => [0.08, 0.0],
            Direction::Warp => [0.0, 0.08],
            Direction::Bias => [0.08 * 0.5f64.sqrt(); 2],
        };
        assert!((along - Vector2::from(yarns)).norm() < 1e-15);
        assert_close(&curve(&sequence), &expected());
        let [width, height] = Rectangle::of(&sequence).unwrap().size;
        let sides = [width.max(height), width.min(height)];
        assert!((sides[0] - 0.08).abs() < 1e-12 && (sides[1] - 0.04).abs() < 1e-12);
    }
}

#[test]
fn the_first_frame_is_the_rest_and_every_row_another() {
    let sequence = read(&plain(), &StripTest { force_noise: Some(0.01), ..test() }).unwrap();
    let rest = &sequence.frames[0];
    assert!(rest.cords.is_empty() && rest.poses == [Isometry3::identity(); 2]);
    let steps: Vec<_> =
        sequence.frames.iter().map(|frame| (frame.cycle.unwrap(), frame.phase.unwrap())).collect();
    let [up, down] = [Phase::Loading, Phase::Unloading];
    // The last branch has only one row, which does not determine its direction.
    let last = (1, Phase::Hold);
    let expected =
        [(0, Phase::Hold), (0, up), (0, up), (0, up), (0, down), (0, down), (1, up), (1, up), last];
    assert_eq!(steps, expected);
    assert_eq!(sequence.noise, Some(Noise { position_m: None, force_n: Some(0.01), clip_m: None }));
    assert_eq!((sequence.name.as_str(), sequence.gravity), ("stretch-weft", Vector3::zeros()));
}

#[test]
fn units_come_from_the_name_or_are_asked_for() {
    let check = |header: &str, extension: Extension, force: &str, factors: [f64; 2], offset: f64| {
        let text = table(header, |_, [separation, force]| {
            format!("{},{}", (separation - offset) / factors[0], force / factors[1])
        });
        let test = StripTest { extension, force: force.into(), ..test() };
        assert_close(&curve(&read(&text, &test).unwrap()), &expected());
    };
    use Extension::{Displacement, Separation, Strain};
    check("d_mm,f_n", Separation("d_mm".into()), "f_n", [1e-3, 1.0], 0.0);
    check("d_cm,Load [kN]", Displacement("d_cm".into()), "Load [kN]", [1e-2, 1e3], 0.08);
    check("d_in,f (gf)", Displacement("d_in".into()), "f (gf)", [0.0254, 9.80665e-3], 0.08);
    check("Strain [%],f_1", Strain("Strain [%]".into()), "f_1:lbf", [0.0008, 4.4482216152605], 0.08);
    check("strain_1,f", Strain("strain_1:1".into()), "f:cN", [0.08, 0.01], 0.08);
    check("d_mm,f_kgf", Separation("d_mm:mm".into()), "f_kgf:kgf", [1e-3, 9.80665], 0.0);
    check("a:b,f_mn", Separation("a:b:m".into()), "f_mn", [1.0, 1e-3], 0.0);
}

#[test]
fn branches_rows_and_thinning_choose_rows() {
    let without = plain().replace("branch,", "number,");
    let chosen = |text: &str, test: StripTest, rows: &[usize]| {
        let expected: Vec<_> = rows.iter().map(|&row| expected()[row - 1]).collect();
        assert_close(&curve(&read(text, &test).unwrap()), &expected);
    };
    for text in [&plain(), &without] {
        chosen(text, StripTest { branches: Some(vec![2, 0]), ..test() }, &[1, 2, 3, 6, 7]);
        chosen(text, StripTest { branches: Some(vec![0, 1]), every: 2, ..test() }, &[1, 3, 4]);
    }
    let number = Some("number".to_string());
    chosen(&without, StripTest { branch_column: number, branches: Some(vec![3]), ..test() }, &[8]);
    chosen(&plain(), StripTest { rows: Some(6..=7), ..test() }, &[6, 7]);
    chosen(&plain(), StripTest { rows: Some(7..=usize::MAX), ..test() }, &[7, 8]);
    // A second header line with units and a last line of text are not data.
    let text = plain().replace("N\n", "N\n,,m,N\n") + "end,,,\n";
    chosen(&text, StripTest { rows: Some(2..=9), branches: Some(vec![2]), ..test() }, &[6, 7]);
}

fn strip(text: &str, test: &StripTest) -> Strip {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.csv");
    fs::write(&path, text).unwrap();
    read_strip(&path, test).unwrap()
}

#[test]
fn what_the_machine_adds_is_taken_off() {
    // The load cell is off by 0.3 N, and the machine has a compliance of 1 mm/N of the true force.
    let (zero, compliance) = (0.3, 1e-3);
    use Extension::{Displacement, Separation, Strain};
    for (header, extension, of) in [
        ("d_m,f_N", Separation("d_m".into()), (|d| d) as fn(f64) -> f64),
        ("d_m,f_N", Displacement("d_m".into()), |d| d - 0.08),
        ("e,f_N", Strain("e:1".into()), |d| d / 0.08 - 1.0),
    ] {
        let text = table(header, |_, [separation, force]| {
            format!("{},{}", of(separation + compliance * force), force + zero)
        });
        let test = StripTest { extension, force: "f_N".into(), zero, compliance, ..test() };
        assert_close(&curve(&read(&text, &test).unwrap()), &expected());
    }
}

#[test]
fn strains_count_from_the_free_length() {
    let text = table("d_m,f_N", |_, [separation, force]| format!("{},{force}", separation - 0.08));
    let extension = || Extension::Displacement("d_m".into());
    for (length, shift) in [(FreeLength::Length(0.075), 0.005), (FreeLength::Gauge, 0.0)] {
        let test = StripTest { extension: extension(), force: "f_N".into(), free_length: length, ..test() };
        let strip = strip(&text, &test);
        assert_eq!(strip.free_length, 0.08 - shift);
        let longest = strip.sequence.mesh.positions.iter().fold(0.0f64, |longest, p| longest.max(p.x));
        assert_eq!(longest, strip.free_length);
        let rows: Vec<_> = expected().iter().map(|[extension, force]| [extension + shift, *force]).collect();
        assert_close(&curve(&strip.sequence), &rows);
    }
}

#[test]
fn a_preload_is_followed_down_to_the_free_length() {
    // A parabola starting at 78 mm, recorded from 70 or from 80 mm on; slack below.
    let force = |separation: f64| {
        let taut = (separation - 0.078f64).max(0.0);
        100.0 * taut + 2e4 * taut * taut
    };
    for from in [0.070, 0.080] {
        let row = |i: i32| from + 2e-4 * f64::from(i);
        let rows = (0..120).map(|i| format!("{},{}\n", row(i), force(row(i))));
        let text = format!("d_m,f_N\n{}", rows.collect::<String>());
        let with = |preload| StripTest {
            extension: Extension::Separation("d_m".into()),
            force: "f_N".into(),
            free_length: FreeLength::Preload(preload),
            ..test()
        };
        for preload in [0.05, 0.28, 1.0] {
            assert!((strip(&text, &with(preload)).free_length - 0.078).abs() < 1e-9);
        }
        let error = read(&text, &with(90.0)).unwrap_err().to_string();
        assert!(error.contains("does not pass from zero through 90 N"), "{error}");
    }
}

#[test]
fn a_row_that_repeats_the_one_before_is_left_out_and_said() {
    let text = table("d_m,f_N", |row, [separation, force]| {
        let line = format!("{separation},{force}");
        if row == 2 || row == 5 { format!("{line}\n{line}\n{line}") } else { line }
    });
    let test = StripTest { extension: Extension::Separation("d_m".into()), force: "f_N".into(), ..test() };
    let mut found = strip(&text, &test);
    assert_close(&curve(&found.sequence), &expected());
    assert_eq!(found.rows(), [1, 2, 3, 6, 7, 8, 11, 12]);
    let notices = found.inspect(Some(0.3));
    let [notice] = &notices[..] else { panic!("{notices:?}") };
    assert_eq!((notice.severity, notice.place.as_str()), (Severity::Remark, "t.csv row 4"));
    assert!(notice.found.starts_with("4 rows that repeat"), "{notice}");
    assert!(strip(&plain(), &self::test()).inspect(Some(0.3)).is_empty());
}

#[test]
fn rows_after_a_breakage_are_left_out_and_the_last_one_before_is_named() {
    // Every row twice, the first two not selected: breakage after row 60 of the table.
    let force = |i: i32| if i <= 30 { 0.1 * f64::from(i) } else { 0.5 };
    let rows = (1..=40).map(|i| format!("{0},{1}\n{0},{1}\n", f64::from(i) * 1e-4, force(i)));
    let text = format!("d_m,f_N\n{}", rows.collect::<String>());
    let test = StripTest {
        extension: Extension::Displacement("d_m".into()),
        force: "f_N".into(),
        rows: Some(3..=usize::MAX),
        ..test()
    };
    let mut strip = strip(&text, &test);
    let notices = strip.inspect(None);
    let broken = notices.iter().find(|notice| notice.found.contains("it broke or slipped")).unwrap();
    assert_eq!((broken.severity, broken.place.as_str()), (Severity::Remark, "t.csv row 59"));
    assert_eq!((strip.rows().len(), strip.rows().last()), (29, Some(&59)));
    assert_eq!((strip.sequence.frames.len(), strip.branches()), (30, vec![0]));
}

#[test]
fn bad_tables_are_refused() {
    let check = |old: &str, new: &str, expected: &str| {
        assert!(plain().contains(old), "{old}");
        assert_eq!(message(&plain().replacen(old, new, 1), &test()), expected);
    };
    check(
        "force_N",
        "force",
        "t.csv:1 header: found no column \"force_N\", expected one of branch, operator, clamp_distance_m, force, exactly as it stands there",
    );
    check("0.084,", "nan,", "t.csv:3 clamp_distance_m: found nan, expected a finite number");
    check(",0.084", ",", "t.csv:3 clamp_distance_m: found nothing, expected a number");
    check("0.084", "0.0,84", "t.csv:3 row: found 5 fields, expected 4 fields, as in the header in line 1");
    check("\n1,", "\n1.5,", "t.csv:5 branch: found 1.5, expected a whole number from 0");
    check(
        "0.084,",
        "84.0,",
        "t.csv:3 clamp_distance_m: found clamps 84 m apart, expected 0.5 to 10 gauge lengths of 0.08 m \
         (another unit, or another of separation, displacement and strain?)",
    );
    assert_eq!(
        message(&plain().replace(',', ";"), &test()),
        "t.csv:1 header: found semicolons (;) between the columns, expected commas between the columns and points \
         in the numbers (export as comma-separated values)"
    );
    assert_eq!(
        message("clamp_distance_m,force_N\n", &test()),
        "t.csv row: found nothing below the header, expected at least one row"
    );
}

#[test]
fn a_unit_is_never_guessed() {
    let check = |header: &str, extension: Extension, force: &str, expected: &str| {
        let text = table(header, |_, [separation, force]| format!("{separation},{force}"));
        let test = StripTest { extension, force: force.into(), ..test() };
        assert_eq!(message(&text, &test), expected);
    };
    let m = || Extension::Separation("d_m".into());
    check(
        "d_m,force",
        m(),
        "force",
        "t.csv:1 force: found no unit, expected one of N, kN, cN, mN, gf, kgf, lbf, \
         in its name as force [UNIT] or asked for as force:UNIT",
    );
    check(
        "strain_1,f_N",
        Extension::Strain("strain_1".into()),
        "f_N",
        "t.csv:1 strain_1: found no unit, expected one of 1, %, in its name as strain_1 [UNIT] or asked for as strain_1:UNIT",
    );
    check("d_m,f_N", m(), "f_N:kN", "t.csv:1 f_N: found N in its name and kN asked for, expected one unit");
    check(
        "d_m,f_N",
        m(),
        "f_N:lb",
        "t.csv:1 f_N: found the unit \"lb\" asked for, expected one of N, kN, cN, mN, gf, kgf, lbf",
    );
    check(
        "d_m,f_N",
        Extension::Displacement("f_N".into()),
        "d_m",
        "t.csv:1 f_N: found the unit N, expected one of m, mm, cm, in",
    );
    // A name may contain characters that move the cursor of a terminal.
    check(
        "\u{1b}d,f_N",
        Extension::Separation("\u{1b}d".into()),
        "f_N",
        "t.csv:1 \\u{1b}d: found no unit, expected one of m, mm, cm, in, in its name as \\u{1b}d [UNIT] or asked for as \\u{1b}d:UNIT",
    );
    // A whole row taken for a name is not repeated in full.
    let long = "d".repeat(2000);
    let short = "d".repeat(60) + "…";
    check(
        &format!("{long},f_N"),
        Extension::Separation(long.as_str().into()),
        "f_N",
        &format!(
            "t.csv:1 {short}: found no unit, expected one of m, mm, cm, in, in its name as {short} [UNIT] or asked for as {short}:UNIT"
        ),
    );
    // Mega is not milli.
    check(
        "d_m,f_MN",
        m(),
        "f_MN",
        "t.csv:1 f_MN: found no unit, expected one of N, kN, cN, mN, gf, kgf, lbf, \
         in its name as f_MN [UNIT] or asked for as f_MN:UNIT",
    );
}

#[test]
fn a_strip_that_only_gets_shorter_and_a_zero_that_no_reading_reaches_are_refused() {
    let shrinking = StripTest { free_length: FreeLength::Length(0.12), ..test() };
    let words = "t.csv clamp_distance_m: found no clamp distance above the free length, 0.12 m, expected an extension \
                 that grows with the pull: the other sign, or another free length";
    assert_eq!(message(&plain(), &shrinking), words);
    let words = "zero: found 2, expected a reading without load: at most the largest force, 0.8 N";
    assert_eq!(message(&plain(), &StripTest { zero: 2.0, ..test() }), words);
}

#[test]
fn a_machine_that_would_lengthen_as_far_as_it_went_is_doubted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.csv");
    fs::write(&path, plain()).unwrap();
    let notices = |compliance| read_strip(&path, &StripTest { compliance, ..test() }).unwrap().inspect(None);
    // 0.8 N at 16 mm.
    let said =
        |notice: &Notice| notice.found.contains("a compliance that accounts for 40 % of the extension");
    assert!(notices(8e-3).iter().any(said) && !notices(1e-3).iter().any(|n| n.found.contains("compliance")));
}

#[test]
fn bad_settings_are_refused() {
    let check = |test: StripTest, expected: &str| assert_eq!(message(&plain(), &test), expected);
    let length = "expected a length above 0 and at most 10 m";
    for gauge in [-0.08, 0.0, f64::NAN] {
        check(StripTest { gauge, ..test() }, &format!("gauge: found {gauge}, {length}"));
    }
    let longer = format!("{length} (millimetres or centimetres?)");
    check(StripTest { width: 40.0, ..test() }, &format!("width: found 40, {longer}"));
    check(
        StripTest { free_length: FreeLength::Length(0.0), ..test() },
        &format!("free_length: found 0, {length}"),
    );
    check(
        StripTest { free_length: FreeLength::Preload(0.0), ..test() },
        "preload: found 0, expected a force above 0, in N",
    );
    check(StripTest { zero: f64::NAN, ..test() }, "zero: found NaN, expected a force of at most 1e6, in N");
    check(StripTest { compliance: -1.0, ..test() }, "compliance: found -1, expected 0 or more, in m/N");
    check(
        StripTest { free_length: FreeLength::Length(0.0), ..test() },
        &format!("free_length: found 0, {length}"),
    );
    check(
        StripTest { free_length: FreeLength::Preload(0.0), ..test() },
        "preload: found 0, expected a force above 0, in N",
    );
    check(StripTest { zero: f64::NAN, ..test() }, "zero: found NaN, expected a force of at most 1e6, in N");
    check(StripTest { compliance: -1.0, ..test() }, "compliance: found -1, expected 0 or more, in m/N");
    check(
        StripTest { every: 0, ..test() },
        "every: found 0, expected 1 for every row, 2 for every second, …",
    );
    check(
        StripTest { branches: Some(vec![]), ..test() },
        "branches: found none, expected at least one branch",
    );
    check(
        StripTest { force_noise: Some(0.0), ..test() },
        "force_noise: found 0, expected a standard deviation above 0, in N",
    );
    check(
        StripTest { name: String::new(), ..test() },
        "name: found nothing, expected a name for the sequence",
    );
    let missing = "t.csv branch: found no row of branch 6, expected branches that the table has: ";
    check(StripTest { branches: Some(vec![0, 6]), ..test() }, &format!("{missing}0, 1, 2, 3"));
    check(StripTest { branches: Some(vec![6]), rows: Some(4..=6), ..test() }, &format!("{missing}1, 2"));
    check(
        StripTest { branch_column: Some("cycle".into()), ..test() },
        "t.csv:1 header: found no column \"cycle\", expected one of branch, operator, clamp_distance_m, force_N, exactly as it stands there",
    );
    let range = |rows, expected: &str| check(StripTest { rows: Some(rows), ..test() }, expected);
    range(0..=3, "t.csv row: found rows 0 to 3 asked for, expected rows from 1 to 8");
    range(3..=9, "t.csv row: found rows 3 to 9 asked for, expected rows from 1 to 8");
    range(9..=usize::MAX, "t.csv row: found rows 9 to the last asked for, expected rows from 1 to 8");
    let (late, early) = (4, 3);
    range(late..=early, "t.csv row: found rows 4 to 3 asked for, expected rows from 1 to 8");
}

#[test]
fn a_set_is_made_grows_and_must_agree() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("knit");
    let known = FabricFields { name: Some("knit".into()), areal_density: Some(0.3), thickness: Some(2e-4) };
    let sequence = |name: &str| read(&plain(), &StripTest { name: name.into(), ..test() }).unwrap();
    let add = |sample: &FabricFields, name: &str, replace| {
        add_to_set(&place, sample, &sequence(name), replace)
            .map_err(|error| error.to_string().replace(folder.path().to_str().unwrap(), ""))
    };
    let refused = |sample: &FabricFields, name: &str, expected: &str| {
        assert_eq!(add(sample, name, false).unwrap_err(), expected);
    };
    refused(
        &FabricFields { name: None, ..known.clone() },
        "a",
        "/knit/fabric.toml name: found no such file and no value given, expected the fabric's name, for a new set",
    );
    refused(
        &FabricFields { areal_density: None, ..known.clone() },
        "a",
        "/knit/fabric.toml areal_density_kg_m2: found no such file and no value given, \
         expected the mass per area, for a new set",
    );
    refused(
        &FabricFields { areal_density: Some(300.0), ..known.clone() },
        "a",
        "/knit/fabric.toml:4 areal_density_kg_m2: found 300, expected kilograms per square metre, above 0 and at \
         most 10 (convert g/m² to kg/m²: divide by 1000)",
    );
    refused(
        &known,
        "../a",
        "sequences[].name: found ../a, expected the name of a folder that is not hidden, without comma or quote",
    );
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);

    assert_eq!(add(&known, "a", false), Ok(Added::NewSet));
    assert_eq!(add(&FabricFields::default(), "b", false), Ok(Added::NewSequence));
    assert_eq!(add(&known, "b", true), Ok(Added::Replaced));
    let set = read_set(&place).unwrap();
    assert_eq!(set.sequences, [sequence("a"), sequence("b")]);
    let Fabric { width_m, height_m, thickness_m, .. } = set.fabric;
    assert_eq!((width_m, height_m, thickness_m), (0.08, 0.04, Some(2e-4)));

    refused(
        &known,
        "a",
        "/knit/a sequence: found one of that name, expected a new name, or leave to replace it",
    );
    refused(
        &FabricFields { areal_density: Some(0.31), ..known.clone() },
        "c",
        "/knit/fabric.toml areal_density_kg_m2: found 0.3, expected 0.31, the value given (or give none)",
    );
    refused(
        &FabricFields { name: Some("denim".into()), ..known.clone() },
        "c",
        "/knit/fabric.toml name: found knit, expected denim, the value given (or give none)",
    );
    let elsewhere = tempfile::tempdir().unwrap();
    let made = add_to_set(&elsewhere.path().join("x/y"), &known, &sequence("a"), false).unwrap();
    assert_eq!(made, Added::NewSet, "the folders above are made");
    let file = add_to_set(&place.join("fabric.toml"), &known, &sequence("a"), true).unwrap_err();
    assert!(file.to_string().ends_with("folder: found something else, expected a set's folder, or nothing"));
    assert_eq!(read_set(&place).unwrap().sequences.len(), 2);
}
