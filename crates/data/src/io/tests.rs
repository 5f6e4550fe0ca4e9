//! Round trips of valid sets; the two child modules hold sets that must not be read.

mod fuzz;
mod malformed;

use super::*;
use crate::frame::{Clip, Cord, Kind, Noise, Phase, Table};
use cloth_sim::mesh::Mesh;
use nalgebra::{Isometry3, Vector2};

/// A square of two triangles, 0.1 m wide.
fn mesh() -> Mesh {
    let material: Vec<_> = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]].map(Vector2::from).to_vec();
    let positions = material.iter().map(|m| Vector3::new(m.x, m.y, 1.0 / 3.0)).collect();
    Mesh::new(positions, material, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

/// The rest shape, shifted, in values exact in float32; one vertex is unobserved.
fn shape(offset: f64) -> Vec<Vector3<f64>> {
    let mut shape: Vec<_> =
        mesh().positions.iter().map(|p| p.map(|value| f64::from((value + offset) as f32))).collect();
    shape[1] = Vector3::repeat(f64::NAN);
    shape
}

fn stretch() -> Sequence {
    let clip = |name: &str, vertices: &[usize]| Clip {
        name: name.into(),
        mass_kg: 0.0133,
        vertices: vertices.into(),
    };
    let pose =
        |step: f64| Isometry3::new(Vector3::new(0.0, -0.01 * step, 1e-9), Vector3::new(0.3, 0.1, 0.7) * step);
    let cord = |clip, x: f64, point| Cord { clip, force: Vector3::new(x, 1e-300, -0.1), point };
    let point = Some(Vector3::new(0.1, 0.2, 0.3));
    let frame = |index: usize, cords, positions| Frame {
        time: Some(index as f64 / 3.0),
        cycle: Some(index / 2),
        phase: Some([Phase::Loading, Phase::Unloading, Phase::Hold][index]),
        poses: vec![pose(0.0), pose(index as f64)],
        cords,
        positions,
    };
    Sequence {
        name: "stretch-weft".into(),
        kind: Kind::StretchWeft,
        gravity: Vector3::new(0.0, 0.0, -9.81),
        noise: Some(Noise { position_m: Some(7.5e-5), force_n: None, clip_m: None }),
        force_direction: Some(Vector3::new(0.6, 0.8, 0.0)),
        table: None,
        mesh: mesh(),
        clips: vec![clip("low", &[0, 1]), clip("high, \"left\"", &[3])],
        frames: vec![
            frame(0, vec![], Some(shape(0.0))),
            frame(1, vec![cord(1, 0.1, point), cord(0, 0.2, point), cord(1, 1e300, point)], None),
            frame(2, vec![cord(0, -0.0, point)], Some(shape(0.02))),
        ],
    }
}

fn bend() -> Sequence {
    let frame = |offset| Frame { positions: Some(shape(offset)), ..Frame::default() };
    Sequence {
        name: "bend".into(),
        kind: Kind::BendBias,
        noise: None,
        force_direction: None,
        table: Some(Table {
            edge_point_m: [0.05, 0.0, 0.0],
            edge_direction: [0.0, 1.0, 0.0],
            outward: [1.0, 0.0, 0.0],
        }),
        clips: vec![],
        frames: vec![frame(0.0), frame(0.01)],
        ..stretch()
    }
}

/// A sequence with clips only.
fn corners() -> Sequence {
    let mut sequence = Sequence { name: "corners".into(), kind: Kind::CornerPull, ..stretch() };
    for frame in &mut sequence.frames {
        *frame = Frame { poses: frame.poses.clone(), ..Frame::default() };
    }
    sequence
}

fn set() -> MeasurementSet {
    let fabric = Fabric {
        name: "cotton \"denim\"".into(),
        width_m: 0.1,
        height_m: 1.0 / 3.0,
        areal_density_kg_m2: 0.46,
        thickness_m: Some(1e-7),
        source: Some("a\nb".into()),
        notes: None,
    };
    MeasurementSet { fabric, sequences: vec![bend(), corners(), stretch()] }
}

/// Compares debug output, which shows every bit of a float except of NaN, which differs from itself.
fn same(a: &impl std::fmt::Debug, b: &impl std::fmt::Debug) {
    assert_eq!(format!("{a:?}"), format!("{b:?}"));
}

#[test]
fn a_set_comes_back_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("set");
    for _ in 0..2 {
        write_set(&place, &set()).unwrap();
        same(&read_set(&place).unwrap(), &set());
    }
    let more = Sequence { name: "another".into(), ..stretch() };
    write_sequence(&place, &more).unwrap();
    same(&read_set(&place).unwrap().sequences[0], &more);
    assert_eq!(read_set(&place).unwrap().sequences.len(), 4);
}

#[test]
fn what_cannot_be_read_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("set");
    let empty = MeasurementSet { sequences: vec![], ..set() };
    write_set(&place, &empty).unwrap();
    let check = |change: &dyn Fn(&mut Sequence), expected: &str| {
        let mut sequence = stretch();
        change(&mut sequence);
        let error = write_sequence(&place, &sequence).unwrap_err().to_string();
        assert_eq!(error.replace(place.to_str().unwrap(), "set"), expected);
        assert_eq!(read_set(&place).unwrap(), empty);
    };
    check(&|s| s.frames[0].poses.truncate(1), "frames[].poses: found 1, expected 2, one for every clip");
    check(
        &|s| s.frames[1].cords[0].point = None,
        "cords[].point: found a point for some cords only, expected a point for every cord of a sequence, or for none",
    );
    check(
        &|s| s.frames[1].phase = None,
        "phase: found a value in 2 frames only, expected a value in every frame of a sequence, or in none",
    );
    check(
        &|s| s.name = "a/b".into(),
        "sequences[].name: found a/b, expected the name of a folder that is not hidden, without comma or quote",
    );
    check(
        &|s| s.frames[1].cords[0].force.x = f64::NAN,
        "set/stretch-weft/forces.csv:2 fx_n: found NaN, expected a finite number",
    );
    check(
        &|s| s.frames[1].cords[0].clip = 2,
        "frames[].cords[].clip: found 2, expected less than 2, the number of clips",
    );
    check(
        &|s| s.frames[0].positions.as_mut().unwrap().truncate(3),
        "frames[].positions: found 3, expected 4, one for every vertex",
    );
    let twice = MeasurementSet { sequences: vec![stretch(), bend()], ..set() };
    assert_eq!(
        write_set(&place, &twice).unwrap_err().to_string(),
        "sequences[].name: found stretch-weft before bend, expected unique names in ascending order"
    );
    let other = folder.path().join("home");
    fs::create_dir(&other).unwrap();
    fs::write(other.join("thesis.txt"), "all of it").unwrap();
    assert!(matches!(write_set(&other, &set()), Err(Error::Input { .. })));
    assert!(other.join("thesis.txt").exists());
}

#[test]
fn shapes_may_be_mesh_files_and_tables_may_have_any_line_ending() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("set");
    let sequence = stretch();
    write_set(&place, &MeasurementSet { sequences: vec![sequence.clone()], ..set() }).unwrap();
    let place = place.join("stretch-weft");
    fs::remove_file(place.join("positions.npy")).unwrap();
    let frames = place.join("frames");
    fs::create_dir(&frames).unwrap();
    let expected = [shape(0.0), shape(0.01), shape(0.02)];
    let text: String = expected[0].iter().map(|p| format!("v {} {} {} 1 0 0\n", p.x, p.y, p.z)).collect();
    fs::write(frames.join("0000.obj"), text).unwrap();
    let header = |format: &str, number: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment a shape\nelement vertex 4\nproperty uchar red\nproperty {number} x\n\
             property {number} y\nproperty {number} z\nelement face 9\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    for (index, big) in [(1, false), (2, true)] {
        let mut bytes =
            header(if big { "binary_big_endian" } else { "binary_little_endian" }, "double").into_bytes();
        for position in &expected[index] {
            bytes.push(255);
            bytes.extend(position.iter().flat_map(|v| if big { v.to_be_bytes() } else { v.to_le_bytes() }));
        }
        fs::write(frames.join(format!("{index:04}.ply")), bytes).unwrap();
    }
    let clips = fs::read_to_string(place.join("clips.csv")).unwrap();
    for ending in ["\n", "\r", "\r\n", "\n\n"] {
        fs::write(place.join("clips.csv"), format!("\u{feff}{}", clips.trim_end().replace('\n', ending)))
            .unwrap();
        let read = read_sequence(&place).unwrap();
        for (frame, expected) in read.frames.iter().zip(&expected) {
            same(&frame.positions, &Some(expected));
        }
        same(&read.frames[2].poses, &sequence.frames[2].poses);
    }
    let rows: String =
        expected[0].iter().map(|p| format!("7 0.5 {} {}\r\n", p.y.abs().max(0.25), 1)).collect();
    fs::write(frames.join("0000.ply"), header("ascii", "float") + &rows).unwrap();
    let text = ply::read(&frames.join("0000.ply")).unwrap();
    assert_eq!(text, vec![Vector3::new(0.5, 0.25, 1.0); 4]);
}

#[test]
fn obj_quads_and_relative_indices_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.obj");
    let text = "o cloth # one quad\nv 0 0 0\nv 1 0 0\nvt 0 0\nvt 1 0\nv 1 1 0\nv 0 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n\
                f -4/-4/-1 2/2/1 -2/-2 4/4\n";
    fs::write(&path, text).unwrap();
    let mesh = obj::Obj::read(&path).unwrap().mesh().unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.material[2], Vector2::new(1.0, 1.0));
}

#[test]
fn double_precision_arrays_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("positions.npy");
    // Version 2 of the format, as written by numpy.save.
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2, 3), }\n";
    let mut bytes = b"\x93NUMPY\x02\x00".to_vec();
    bytes.extend((header.len() as u32).to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend([0.1, 0.2, 0.3, 0.4, 0.5, 0.6].into_iter().flat_map(f64::to_le_bytes));
    fs::write(&path, bytes).unwrap();
    let expected = vec![Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.4, 0.5, 0.6)];
    assert_eq!(npy::read(&path, 2).unwrap(), [expected]);
}

#[test]
fn a_line_of_an_obj_file_goes_on_after_a_backslash() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("set");
    write_set(&place, &set()).unwrap();
    let path = place.join("stretch-weft/mesh.obj");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replace("f 1/1 2/2 3/3", "# a comment goes on nowhere \\\nf 1/1 \\\n2/2\\\n3/3"))
        .unwrap();
    same(&read_set(&place).unwrap(), &set());
}

#[test]
fn nan_in_a_text_of_ply_is_a_vertex_that_was_not_observed() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("set");
    write_set(&place, &set()).unwrap();
    let bend = place.join("bend");
    fs::remove_file(bend.join("positions.npy")).unwrap();
    fs::create_dir(bend.join("frames")).unwrap();
    let header = "ply\nformat ascii 1.0\nelement camera 1\nproperty float focus\nelement vertex 4\n\
                  property list uchar int near\nproperty float x\nproperty float y\nproperty uchar red\n\
                  property float z\nend_header\n.5\n";
    for (index, frame) in set().sequences[0].frames.iter().enumerate() {
        let row = |p: &Vector3<f64>| match p.x.is_nan() {
            true => "0 nan -nan 9 NaN\n".to_string(),
            false => format!("2 3 4 {} {} 255 {}\n", p.x, p.y, p.z),
        };
        let rows: String = frame.positions.iter().flatten().map(row).collect();
        fs::write(bend.join(format!("frames/{index}.ply")), format!("{header}{rows}")).unwrap();
    }
    same(&read_set(&place).unwrap(), &set());
}

#[test]
fn a_set_far_away_is_written_in_double_precision() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("set");
    let by = Vector3::new(5e6, -3e6, 400.0);
    let mut far = MeasurementSet { sequences: vec![bend()], ..set() };
    far.sequences[0].mesh.positions.iter_mut().for_each(|position| *position += by);
    for frame in &mut far.sequences[0].frames {
        frame.positions.iter_mut().flatten().for_each(|position| *position += by);
    }
    write_set(&place, &far).unwrap();
    same(&read_set(&place).unwrap(), &far);
}
