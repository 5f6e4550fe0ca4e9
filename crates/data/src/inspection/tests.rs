use super::*;
use crate::frame::Frame;
use crate::io::read_set;
use crate::rig::{KnownFabric, Rig};
use nalgebra::{Isometry3, Vector3};
use std::path::Path;

const FIXTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures");

fn fixture(name: &str) -> MeasurementSet {
    read_set(&Path::new(FIXTURES).join(name)).unwrap()
}

/// Notices for one sequence of the denim set after a change.
fn noticed(name: &str, change: impl FnOnce(&mut Fabric, &mut Sequence)) -> Vec<Notice> {
    let MeasurementSet { mut fabric, sequences } = fixture("cotton-denim");
    let mut sequence = sequences.into_iter().find(|sequence| sequence.name == name).unwrap();
    change(&mut fabric, &mut sequence);
    inspect_sequence(&fabric, &sequence).1
}

/// The single notice must be a refusal and contain these phrases.
fn refused(notices: &[Notice], said: &[&str]) {
    let [notice] = notices else { panic!("{notices:?}") };
    assert_eq!(notice.severity, Severity::Refusal, "{notice}");
    let text = notice.to_string();
    said.iter().for_each(|part| assert!(text.contains(part), "{part:?} in {text}"));
}

fn each_place(sequence: &mut Sequence, change: impl Fn(&mut Vector3<f64>)) {
    sequence.frames.iter_mut().filter_map(|frame| frame.positions.as_mut()).flatten().for_each(change);
}

#[test]
fn nothing_is_noticed_of_what_is_as_it_should_be() {
    for name in ["cotton-denim", "cotton-satin", "rayon-spandex-knit", "wool-cotton"] {
        assert_eq!(inspect(&fixture(name)).notices, []);
    }
}

/// The figure before a phrase in a message.
fn figure(notice: &Notice, words: &str) -> f64 {
    let text = notice.to_string();
    let before = text.split(words).next().unwrap().trim_end();
    before.rsplit(' ').next().unwrap().parse().unwrap()
}

/// Largest drop of the tip below the rear of the sheet, mm.
fn largest_drop(sequence: &Sequence) -> f64 {
    let rest = &sequence.mesh.positions;
    let [back, tip] = [-0.1, 0.0].map(|x| {
        let on_line = move |v: &usize| (rest[*v].x - x).abs() < 1e-9;
        (0..rest.len()).filter(on_line).collect::<Vec<_>>()
    });
    assert_eq!([back.len(), tip.len()], [25, 25]);
    let mean = |line: &[usize], shape: &[Vector3<f64>]| line.iter().map(|&v| shape[v].z).sum::<f64>() / 25.0;
    let shapes = sequence.frames.iter().filter_map(|frame| frame.positions.as_ref());
    shapes.map(|shape| 1e3 * (mean(&back, shape) - mean(&tip, shape))).fold(0.0, f64::max)
}

/// The single notice must be a doubt and contain these phrases.
fn doubted(notices: &[Notice], said: &[&str]) {
    let [notice] = notices else { panic!("{notices:?}") };
    assert_eq!(notice.severity, Severity::Doubt, "{notice}");
    let text = notice.to_string();
    said.iter().for_each(|part| assert!(text.contains(part), "{part:?} in {text}"));
}

#[test]
fn a_bending_test_without_shapes_is_refused() {
    let notices = noticed("bend-warp", |_, sequence| {
        sequence.frames.iter_mut().for_each(|frame| frame.positions = None);
    });
    refused(&notices, &["positions.npy", "found nothing", "a bending test requires them"]);
}

#[test]
fn a_frame_that_hangs_otherwise_than_the_others_is_doubted() {
    for axis in [0, 2] {
        let notices = noticed("bend-warp", |_, sequence| {
            let places = sequence.frames[2].positions.iter_mut().flatten();
            places.for_each(|place| place[axis] = -place[axis]);
        });
        doubted(&notices, &["positions.npy", "do not hang down past the edge in frame 2, unlike"]);
    }
}

#[test]
fn a_few_mistracked_vertices_of_a_clip_do_not_contradict_its_pose() {
    for (moved, sound) in [(1, true), (2, true), (8, false), (25, false)] {
        let notices = noticed("stretch-weft", |_, sequence| {
            let held = sequence.clips[0].vertices.clone();
            assert_eq!(held.len(), 25);
            let places = sequence.frames[5].positions.as_mut().unwrap();
            held[..moved].iter().for_each(|&vertex| places[vertex].z += 0.02);
        });
        assert_eq!(notices.iter().all(|notice| notice.severity != Severity::Refusal), sound, "{notices:?}");
    }
}

#[test]
fn the_assumed_noise_of_clips_is_told_where_there_are_any() {
    let untold = |_: &mut Fabric, sequence: &mut Sequence| {
        sequence.noise.as_mut().unwrap().clip_m = None;
    };
    let notices = noticed("stretch-weft", untold);
    let [notice] = &notices[..] else { panic!("{notices:?}") };
    assert_eq!(notice.severity, Severity::Remark);
    assert!(notice.to_string().contains("taken as that of a vertex, 0.000075 m"), "{notice}");
    assert_eq!(noticed("bend-weft", untold), []);
}

#[test]
fn poses_of_another_scale_than_shapes_are_doubted_by_how_much() {
    for (factor, way) in [(0.9, "farther"), (1.1, "less far")] {
        let notices = noticed("stretch-weft", |_, sequence| {
            let poses = sequence.frames.iter_mut().flat_map(|frame| &mut frame.poses);
            poses.for_each(|pose| pose.translation.vector *= factor);
        });
        doubted(&notices, &["clips.csv against positions.npy", way, "one calibration"]);
        let told = figure(&notices[0], &format!("% {way}"));
        assert!((told - 100.0 * f64::abs(1.0 / factor - 1.0)).abs() < 0.5, "{}", notices[0]);
    }
}

#[test]
fn noise_of_clip_poses_is_no_other_scale() {
    let sequences = vec![Kind::StretchWeft, Kind::StretchWarp];
    let noisy = Rig { clip_noise: true, sequences, nodes: [13, 13], measured: [25, 25], ..Rig::default() };
    let fabric = KnownFabric::named("cotton-denim").unwrap();
    for seed in 1..=10 {
        let notices = inspect(&Rig { seed, ..noisy.clone() }.measure(&fabric).unwrap()).notices;
        assert!(notices.is_empty(), "{seed}: {}", notices[0]);
    }
}

#[test]
fn sheets_that_hang_along_other_yarns_than_their_kind_says_are_refused() {
    for (name, kind, angle) in [
        ("bend-weft", Kind::BendWarp, "0° to weft"),
        ("bend-warp", Kind::BendWeft, "90° to weft"),
        ("bend-bias", Kind::BendWarp, "45° to weft"),
        ("bend-warp", Kind::BendBias, "90° to weft"),
    ] {
        refused(&noticed(name, |_, sequence| sequence.kind = kind), &["test.toml kind", angle]);
    }
    let turned = noticed("bend-weft", |_, sequence| {
        sequence.mesh.material.iter_mut().for_each(|m| *m = nalgebra::Vector2::new(-m.y, m.x));
    });
    refused(&turned, &["test.toml kind", "90° to weft", "along weft"]);
}

#[test]
fn vertices_beside_a_clip_that_move_with_it_are_told() {
    for held in [8..17, 0..13, 5..20] {
        let notices = noticed("stretch-weft", |_, sequence| {
            sequence.clips[0].vertices = sequence.clips[0].vertices[held.clone()].to_vec();
        });
        let share = format!(
            "clip low along {:.0} % of its side, and {} vertices",
            (held.len() - 1) as f64 / 0.24,
            25 - held.len()
        );
        doubted(&notices, &["test.toml clips.vertices", &share, "that move with it"]);
    }
    // No observation beside the clip.
    let notices = noticed("stretch-weft", |_, sequence| {
        sequence.clips[0].vertices.truncate(23);
        sequence.frames.iter_mut().for_each(|frame| frame.positions = None);
    });
    doubted(
        &notices,
        &["test.toml clips.vertices", "along 92 % of its side, expected all vertices it holds"],
    );
    // Vertices beside the clip of a free specimen lag.
    let notices = noticed("stretch-weft", |_, sequence| {
        let clips = sequence.clips.iter_mut();
        clips.for_each(|clip| clip.vertices = clip.vertices[8..17].to_vec());
        let rest = sequence.mesh.positions.clone();
        for frame in &mut sequence.frames {
            let [low, high] = [0, 1].map(|clip| frame.poses[clip].translation.vector.x);
            for (place, rest) in frame.positions.iter_mut().flatten().zip(&rest) {
                let beside = f64::max((rest.y - 0.05).abs() - 0.017, 0.0).min(0.05);
                let side = if rest.x < 0.05 { 1.0 } else { -1.0 };
                place.x += side * (high - low) / 0.1 * beside;
            }
        }
    });
    let held = notices.iter().filter(|notice| notice.place.contains("clips.vertices"));
    let said: Vec<String> = held.map(Notice::to_string).collect();
    assert!(
        said.len() == 2 && said.iter().all(|said| said.contains("along 33 % of its side, expected")),
        "{said:?}"
    );
}

#[test]
fn cords_that_pull_a_specimen_to_one_side_are_told() {
    let notices = noticed("stretch-weft", |_, sequence| {
        let cords = sequence.frames.iter_mut().flat_map(|frame| &mut frame.cords);
        cords.filter(|cord| cord.clip == 1).for_each(|cord| cord.force *= 1.5);
    });
    doubted(&notices, &["forces.csv", "to one side in 11 of 11 frames", "calibration of each load cell"]);
    // A force equal in every frame is weight.
    let notices = noticed("shear", |_, sequence| sequence.gravity = Vector3::new(0.0, -9.81, 0.0));
    assert!(notices.iter().any(|notice| notice.place == "test.toml gravity_m_s2"), "{notices:?}");
    // It does not affect the other tests.
    let mut set = fixture("cotton-denim");
    let shear = set.sequences.iter_mut().filter(|sequence| sequence.name == "shear");
    let cords = shear.flat_map(|sequence| &mut sequence.frames).flat_map(|frame| &mut frame.cords);
    cords.filter(|cord| cord.clip == 1).for_each(|cord| cord.force *= -1.0);
    assert!(inspect(&set).notices.iter().all(|notice| notice.sequence == "shear"));
    let one_cord_left_out = noticed("shear", |_, sequence| {
        let cords = sequence.frames.iter_mut().flat_map(|frame| &mut frame.cords);
        cords.filter(|cord| cord.clip == 2).for_each(|cord| cord.force.x = 0.0);
    });
    assert!(
        one_cord_left_out.iter().any(|notice| notice.found.contains("to one side")),
        "{one_cord_left_out:?}"
    );
}

#[test]
fn a_picture_frame_that_pulls_before_it_is_sheared_is_doubted() {
    let notices = noticed("shear", |_, sequence| {
        let cords = sequence.frames.iter_mut().flat_map(|frame| &mut frame.cords);
        for cord in cords {
            cord.force.y += [0.0, 1.5, 0.0, -1.5][cord.clip];
        }
    });
    doubted(&notices, &["forces.csv frame 0", "on clip right before the frame is sheared"]);
}

#[test]
fn one_load_cell_that_reads_wrong_in_every_test_is_doubted_where_nothing_weighs() {
    for factor in [1.3, 1.0 / 9.80665, 100.0] {
        let mut set = fixture("cotton-denim");
        let frames = set.sequences.iter_mut().flat_map(|sequence| &mut sequence.frames);
        frames.flat_map(|frame| &mut frame.cords).for_each(|cord| cord.force *= factor);
        let notices = inspect(&set).notices;
        let of = |name: &str| notices.iter().find(|notice| notice.sequence == name);
        for name in ["stretch-weft", "stretch-warp", "shear"] {
            let notice = of(name).unwrap_or_else(|| panic!("{factor}: {name}"));
            assert!(notice.to_string().contains("calibration of forces.csv"), "{notice}");
        }
        assert!(of("bend-weft").is_none(), "{factor}: {:?}", of("bend-weft"));
    }
    // Clips without mass in one test do not affect the others.
    let mut set = fixture("cotton-denim");
    let shear = set.sequences.iter_mut().filter(|sequence| sequence.name == "shear");
    shear.flat_map(|sequence| &mut sequence.clips).for_each(|clip| clip.mass_kg = 0.0);
    assert!(inspect(&set).notices.iter().all(|notice| notice.sequence == "shear"));
}

#[test]
fn heights_that_were_not_measured_are_told() {
    let notices = noticed("shear", |_, sequence| {
        sequence.noise = None;
        each_place(sequence, |place| place.z = 0.0);
    });
    let [notice] = &notices[..] else { panic!("{notices:?}") };
    assert!(
        notice.severity == Severity::Remark && notice.to_string().contains("as if no shapes were measured")
    );
}

#[test]
fn cloth_that_does_not_lie_on_its_table_is_doubted() {
    let notices = noticed("bend-warp", |_, sequence| {
        sequence.table.iter_mut().for_each(|table| table.edge_point_m[2] -= 4e-3);
    });
    doubted(&notices, &["edge_point_m", "lies 4.", "mm above the edge"]);
}

#[test]
fn a_sheet_that_rises_against_gravity_is_refused_with_its_causes_and_figures() {
    let drop = largest_drop(&sequence_of("bend-weft"));
    assert!(drop > 30.0);
    let close = |notice: &Notice, words: &str| (figure(notice, words) - drop).abs() < 0.06;
    let up = noticed("bend-weft", |_, sequence| sequence.gravity = -sequence.gravity);
    refused(
        &up,
        &["sequence bend-weft", "test.toml gravity_m_s2", "positions.npy", "the sign of gravity, or of z"],
    );
    assert!(close(&up[0], "mm above"), "{}", up[0]);
    let mirrored = noticed("bend-weft", |_, sequence| each_place(sequence, |place| place.z = -place.z));
    assert_eq!(mirrored, up);
    let turned = noticed("bend-weft", |_, sequence| {
        let table = sequence.table.as_mut().unwrap();
        table.outward = table.outward.map(|c| -c);
    });
    refused(&turned, &["test.toml table.outward", "gravity and z agree"]);
    assert!(close(&turned[0], "mm below"), "{}", turned[0]);
    let both = noticed("bend-weft", |_, sequence| {
        let table = sequence.table.as_mut().unwrap();
        table.outward = table.outward.map(|c| -c);
        sequence.gravity = -sequence.gravity;
    });
    refused(&both, &["table.outward with gravity_m_s2", "edge_point_m"]);
}

#[test]
fn a_sheet_that_stays_flat_under_its_weight_is_refused() {
    let exactly = noticed("bend-weft", |_, sequence| each_place(sequence, |place| place.z = 0.0));
    refused(&exactly, &["positions.npy", "flat", "83 mm", "z"]);
    let mut sign = 1.0;
    let mut toss = || {
        sign = -sign;
        sign * 1e-4
    };
    let with_noise = noticed("bend-weft", |_, sequence| {
        for place in sequence.frames.iter_mut().filter_map(|f| f.positions.as_mut()).flatten() {
            place.z = toss();
        }
    });
    refused(&with_noise, &["flat"]);
    // Gravity along the table, or zero.
    for gravity in [Vector3::zeros(), Vector3::x() * 9.81, Vector3::y() * -9.81] {
        let notices = noticed("bend-weft", |_, sequence| sequence.gravity = gravity);
        refused(&notices, &["test.toml gravity_m_s2", "not across the table"]);
    }
}

#[test]
fn an_edge_that_is_elsewhere_is_found_and_its_distance_told() {
    for name in ["bend-weft", "bend-warp", "bend-bias"] {
        for off in [-0.02, -0.01, 0.01, 0.02] {
            let notices =
                noticed(name, |_, sequence| sequence.table.as_mut().unwrap().edge_point_m[0] += off);
            let [side, way] = if off > 0.0 {
                ["mm before it", "below the table before its edge"]
            } else {
                ["mm past it", "flat past the table's edge"]
            };
            refused(&notices, &["test.toml table.edge_point_m", way]);
            let told = figure(&notices[0], side);
            assert!((told - 1e3 * f64::abs(off)).abs() < 2.0, "{name}, {off}: {}", notices[0]);
        }
    }
    // By less than half of the line spacing.
    for off in [-0.0012, 0.0012] {
        assert_eq!(noticed("bend-weft", |_, s| s.table.as_mut().unwrap().edge_point_m[0] += off), []);
    }
    let doubted = noticed("bend-weft", |_, s| s.table.as_mut().unwrap().edge_point_m[0] += 0.006);
    assert!(matches!(&doubted[..], [notice] if notice.severity == Severity::Doubt), "{doubted:?}");
}

#[test]
fn poses_that_are_not_where_the_clips_were_seen_are_refused() {
    let halved = noticed("stretch-weft", |_, sequence| {
        let poses = sequence.frames.iter_mut().flat_map(|frame| &mut frame.poses);
        poses.for_each(|pose| pose.translation.vector *= 0.5);
    });
    refused(&halved, &["clips.csv", "positions.npy", "(rms)", "in frame 6", "qw first"]);
    // Half of the clip motion, and the noise of three coordinates.
    let MeasurementSet { sequences, .. } = fixture("cotton-denim");
    let sequence = sequences.iter().find(|s| s.name == "stretch-weft").unwrap();
    let way = sequence.frames[6].poses[0].translation.vector.norm();
    let expected = 1e3 * (0.25 * way * way + 3.0 * 7.5e-5f64.powi(2)).sqrt();
    assert!((figure(&halved[0], "mm (rms)") - expected).abs() < 0.1, "{expected} {}", halved[0]);
    // An instrument that tracks a clip by one vertex.
    let noisy = noticed("shear", |_, sequence| {
        let error = Isometry3::new(Vector3::new(1e-4, -1e-4, 5e-5), Vector3::new(0.0, 5e-4, 7e-4));
        sequence.frames.iter_mut().flat_map(|frame| &mut frame.poses).for_each(|pose| *pose = error * *pose);
    });
    assert_eq!(noisy, []);
}

fn sequence_of(name: &str) -> Sequence {
    fixture("cotton-denim").sequences.into_iter().find(|sequence| sequence.name == name).unwrap()
}

/// Unobserved points of all frames.
fn unobserved(sequence: &Sequence) -> Vec<(usize, usize)> {
    let frames = sequence.frames.iter().enumerate();
    let shapes = frames.filter_map(|(index, frame)| Some((index, frame.positions.as_ref()?)));
    shapes
        .flat_map(|(index, shape)| {
            shape.iter().enumerate().filter(|(_, p)| p.x.is_nan()).map(move |(v, _)| (index, v))
        })
        .collect()
}

/// Recorded position of a lost point, from its rest position and its true position.
type Way = fn(Vector3<f64>, Vector3<f64>) -> Vector3<f64>;

#[test]
fn points_that_were_not_followed_are_left_out_and_no_others() {
    let clean = sequence_of("bend-weft");
    let fabric = fixture("cotton-denim").fabric;
    let failed: Vec<(usize, usize)> = (0..clean.frames.len())
        .flat_map(|frame| (0..625).filter(move |v| (v * 7 + frame * 11) % 31 == 0).map(move |v| (frame, v)))
        .collect();
    let ways: [(&str, Way); 4] = [
        ("at the same place", |_, _| Vector3::zeros()),
        ("at their rest position", |rest, _| rest),
        ("at their rest position", |rest, _| rest.map(|c| f64::from(c as f32))),
        ("far from their neighbours", |_, seen| seen + Vector3::new(0.0, 0.012, 0.016)),
    ];
    for (said, way) in ways {
        let mut sequence = clean.clone();
        for &(frame, vertex) in &failed {
            let place = &mut sequence.frames[frame].positions.as_mut().unwrap()[vertex];
            *place = way(clean.mesh.positions[vertex], *place);
        }
        let (inspected, notices) = inspect_sequence(&fabric, &sequence);
        let [notice] = &notices[..] else { panic!("{notices:?}") };
        assert_eq!(notice.severity, Severity::Remark);
        let text = notice.to_string();
        assert!(text.contains(&format!("{} {said}", failed.len())) && text.contains("in 6 frames"), "{text}");
        assert!(text.contains(&format!("vertex {} in frame {}", failed[0].1, failed[0].0)), "{text}");
        assert_eq!(unobserved(&inspected), failed, "{said}");
    }
}

#[test]
fn shapes_that_were_lost_in_every_frame_are_doubted() {
    let fabric = fixture("cotton-denim").fabric;
    let mut sequence = sequence_of("stretch-weft");
    let lose = |frame: &mut Frame| frame.positions.iter_mut().flatten().for_each(|place| place.fill(0.0));
    sequence.frames[1..].iter_mut().for_each(lose);
    assert!(inspect_sequence(&fabric, &sequence).1.iter().all(|notice| notice.severity == Severity::Remark));
    lose(&mut sequence.frames[0]);
    let notices = inspect_sequence(&fabric, &sequence).1;
    let doubt = notices.iter().find(|notice| notice.severity == Severity::Doubt).unwrap().to_string();
    assert!(doubt.contains("positions.npy") && doubt.contains("no vertex tracked"), "{doubt}");
}

#[test]
fn what_truly_rests_is_observed() {
    let fabric = fixture("cotton-denim").fabric;
    // A sheet with one half exactly at rest on the table and the other hanging, and one that rests completely.
    let mut sequence = sequence_of("bend-weft");
    let rest = sequence.mesh.positions.clone();
    let hang = |p: &Vector3<f64>| {
        let past = (p.x + 0.05).max(0.0);
        Vector3::new(
            p.x.min(-0.05) + past.cos().mul_add(past, -0.3 * past),
            p.y,
            -20.0 * past * past.min(0.02),
        )
    };
    let hung: Vec<Vector3<f64>> = rest.iter().map(hang).collect();
    for (frame, shape) in sequence.frames.iter_mut().zip([&rest, &hung, &rest, &hung, &rest, &hung]) {
        frame.positions = Some(shape.clone());
    }
    let (inspected, notices) = inspect_sequence(&fabric, &sequence);
    assert_eq!(unobserved(&inspected), []);
    assert!(notices.iter().all(|notice| notice.severity > Severity::Remark), "{notices:?}");
    // Held by a clip that stays while the rest is stretched by half.
    let mut sequence = sequence_of("stretch-weft");
    let rest = sequence.mesh.positions.clone();
    for frame in &mut sequence.frames {
        frame.positions = Some(rest.iter().map(|p| Vector3::new(1.5 * p.x, p.y, p.z)).collect());
        frame.poses[0] = Isometry3::identity();
        frame.poses[1] = Isometry3::translation(0.05, 0.0, 0.0);
    }
    let (inspected, notices) = inspect_sequence(&fabric, &sequence);
    assert_eq!((unobserved(&inspected), notices), (vec![], vec![]));
}

#[test]
fn weight_that_the_cords_do_not_bear_is_told_with_its_figures() {
    // Four bars of 13.3 g and 100 mm square of 460 g/m², as simulated: 57.8 g.
    let borne = 0.0578 * 9.81;
    let wrong = [
        noticed("shear", |fabric, _| fabric.areal_density_kg_m2 *= 6.5),
        noticed("shear", |_, s| s.clips.iter_mut().for_each(|clip| clip.mass_kg *= 1000.0)),
        noticed("shear", |_, s| s.gravity = -s.gravity),
    ];
    for (notices, weight) in wrong.iter().zip([0.0831 * 9.81, 53.2046 * 9.81, borne]) {
        let [notice] = &notices[..] else { panic!("{notices:?}") };
        assert_eq!(notice.severity, Severity::Doubt);
        let text = notice.to_string();
        for field in ["areal_density_kg_m2", "mass_kg", "gravity_m_s2"] {
            assert!(text.contains(field), "{text}");
        }
        assert!((figure(notice, "N against gravity").abs() - borne).abs() < 0.02, "{text}");
        assert!((figure(notice, "N, expected") / weight - 1.0).abs() < 0.01, "{text}");
    }
    for size in [981.0, 1.0, 9810.0] {
        for name in ["shear", "bend-weft"] {
            let notices = noticed(name, |_, sequence| sequence.gravity = Vector3::z() * -size);
            refused(&notices, &["test.toml gravity_m_s2", &size.to_string(), "9.81"]);
        }
    }
    // Unmeasured quantities contradict nothing.
    let silent = [
        noticed("shear", |fabric, sequence| {
            fabric.areal_density_kg_m2 *= 6.5;
            sequence.frames.iter_mut().flat_map(|f| &mut f.cords).for_each(|cord| cord.force.z = 0.0);
        }),
        noticed("shear", |fabric, sequence| {
            fabric.areal_density_kg_m2 *= 6.5;
            sequence.frames.iter_mut().for_each(|frame| frame.cords.retain(|cord| cord.clip > 0));
        }),
        noticed("shear", |fabric, sequence| {
            fabric.areal_density_kg_m2 *= 6.5;
            sequence.force_direction = Some(Vector3::x());
        }),
        noticed("stretch-weft", |fabric, _| fabric.areal_density_kg_m2 *= 6.5),
    ];
    assert_eq!(silent, [[], [], [], []].map(|none: [Notice; 0]| none.to_vec()));
}

#[test]
fn an_areal_density_that_a_frame_contradicts_is_doubted_where_rigidity_follows_from_it() {
    let doubted = |set: &MeasurementSet| {
        let notices = inspect(set).notices.into_iter();
        notices.filter(|n| n.severity == Severity::Doubt).map(|n| n.sequence).collect::<Vec<_>>()
    };
    let mut set = fixture("cotton-denim");
    set.fabric.areal_density_kg_m2 *= 6.5;
    assert_eq!(
        doubted(&set),
        ["complex-shear", "corner-pull", "shear", "bend-bias", "bend-warp", "bend-weft"]
    );
    // Clips heavier than the measured weight: the cloth is not at fault.
    let mut set = fixture("cotton-denim");
    set.sequences.iter_mut().flat_map(|s| &mut s.clips).for_each(|clip| clip.mass_kg *= 1000.0);
    assert_eq!(doubted(&set), ["complex-shear", "corner-pull", "shear"]);
}

#[test]
fn noise_by_which_nothing_can_be_weighed_is_refused() {
    for deviation in [0.0, -1e-4, f64::NAN] {
        let notices = noticed("bend-weft", |_, sequence| {
            sequence.noise.as_mut().unwrap().position_m = Some(deviation);
        });
        refused(&notices, &["noise.position_m", "above 0"]);
    }
    for deviation in [-1e-4, f64::INFINITY] {
        let notices = noticed("stretch-weft", |_, sequence| {
            sequence.noise.as_mut().unwrap().clip_m = Some(deviation);
        });
        refused(&notices, &["noise.clip_m", "0 (exact poses)"]);
    }
    assert_eq!(noticed("bend-weft", |_, sequence| sequence.noise = None), []);
}
