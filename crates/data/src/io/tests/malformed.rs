//! Every defect of a file with its full message.

mod absent;

use super::*;
use std::path::PathBuf;
use std::sync::LazyLock;

/// Change of one file of a valid set.
type Change<'a> = &'a dyn Fn(&Path);

struct Sample {
    _folder: tempfile::TempDir,
    place: PathBuf,
}

impl Sample {
    /// Copies a set written once: writing and flushing a hundred sets would be slow.
    fn new() -> Self {
        static WRITTEN: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
            let folder = tempfile::tempdir().unwrap();
            write_set(&folder.path().join("set"), &set()).unwrap();
            folder
        });
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("set");
        let written = WRITTEN.path().join("set");
        for name in ["", "bend", "corners", "stretch-weft"] {
            fs::create_dir(place.join(name)).unwrap();
            for (file, is_folder) in entries(&written.join(name)).unwrap() {
                if !is_folder {
                    fs::copy(written.join(name).join(&file), place.join(name).join(&file)).unwrap();
                }
            }
        }
        Self { _folder: folder, place }
    }

    /// Message after a change, with paths relative to the set folder.
    fn message(&self, change: Change<'_>) -> String {
        change(&self.place);
        let error = read_set(&self.place).map_or_else(|error| error, |_| panic!("read in spite of a defect"));
        assert!(matches!(error, Error::Input { .. }), "{error:?}");
        let message = error.to_string().replace(&format!("{}/", self.place.display()), "");
        message.replace(&self.place.display().to_string(), "set")
    }
}

/// Replaces part of a text file and compares the message.
fn check(file: &str, cases: &[(&str, &str, &str)]) {
    let mut wrong = Vec::new();
    for (old, new, expected) in cases {
        let message = Sample::new().message(&|place| {
            let path = place.join(file);
            let text = fs::read_to_string(&path).unwrap();
            assert!(text.contains(old), "{old:?} is not in {text:?}");
            fs::write(&path, text.replacen(old, new, 1)).unwrap();
        });
        let expected = format!("{file}{expected}");
        if message != expected {
            wrong.push(format!("{new:?}\n   found {message}\nexpected {expected}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Compares messages after arbitrary changes.
fn check_changes(cases: &[(Change<'_>, &str)]) {
    let mut wrong = Vec::new();
    for (index, (change, expected)) in cases.iter().enumerate() {
        let message = Sample::new().message(change);
        if message != *expected {
            wrong.push(format!("case {index}\n   found {message}\nexpected {expected}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn fabric_file() {
    check(
        "fabric.toml",
        &[
            (
                "width_m = 0.1",
                "\" \" = 840",
                ":2 blanks: found an unknown key, expected one of name, width_m, height_m, areal_density_kg_m2, thickness_m, source, notes, schema",
            ),
            (
                "width_m = 0.1",
                "width_m = -1",
                ":2 width_m: found -1, expected a length above 0 and at most 10 m",
            ),
            (
                "width_m = 0.1",
                "width_m = nan",
                ":2 width_m: found NaN, expected a length above 0 and at most 10 m",
            ),
            ("width_m = 0.1", "width_m = \"wide\"", ":2 width_m: found string \"wide\", expected a number"),
            (
                "width_m = 0.1",
                "width_mm = 100",
                ":2 width_mm: found an unknown key, expected width_m (convert millimetres to metres)",
            ),
            (
                "width_m = 0.1",
                "breadth = 100",
                ":2 breadth: found an unknown key, expected one of name, width_m, height_m, areal_density_kg_m2, thickness_m, source, notes, schema",
            ),
            (
                "width_m = 0.1",
                "width_m = 0,1",
                ":2 width_m: found unexpected key or value, expected a number with a decimal point, not a comma",
            ),
            (
                "width_m = 0.1",
                "width_m = 0.1\nwidth_m = 0.1",
                ":3 width_m: found duplicate key, expected every key once",
            ),
            ("width_m = 0.1\n", "", " width_m: found nothing, expected a value"),
            // A key may contain quotes and line feeds: the message stays on one line and lists the known keys.
            (
                "width_m = 0.1",
                "\"a`\\n, expected `b\" = 1",
                ":2 a: found an unknown key, expected one of name, width_m, height_m, areal_density_kg_m2, thickness_m, source, notes, schema",
            ),
            (
                "0.46",
                "460",
                ":4 areal_density_kg_m2: found 460, expected kilograms per square metre, above 0 and at most 10 (convert g/m² to kg/m²: divide by 1000)",
            ),
        ],
    );
}

#[test]
fn test_file() {
    check(
        "stretch-weft/test.toml",
        &[
            (
                "\"stretch-weft\"",
                "\"stretch\"",
                ":1 kind: found unknown variant stretch, expected one of stretch-weft, stretch-warp, stretch-bias, shear, bend-weft, bend-warp, bend-bias, complex-shear, corner-pull",
            ),
            ("-9.81]", "inf]", ":2 gravity_m_s2[2]: found inf, expected a finite number"),
            (
                "-9.81]",
                "-9.81, 1]",
                ":2 gravity_m_s2: found more than three numbers, expected an array of length 3",
            ),
            (
                "0.6",
                "0.7",
                ":3 force_direction: found a vector of length 1.063014581273465, expected unit length",
            ),
            (
                "position_m",
                "position_mm",
                ":6 position_mm: found an unknown key, expected position_m (convert millimetres to metres)",
            ),
            ("0.000075", "0", ":6 noise.position_m: found 0, expected a standard deviation above 0"),
            (
                "name = \"low\"",
                "name = \"\"",
                ":9 clips[0].name: found nothing, expected a name without spaces around it",
            ),
            (
                "name = \"low\"",
                "name = 'high, \"left\"'",
                ":14 clips[1].name: found high, \"left\" twice, expected another name for every clip",
            ),
            ("name = \"low\"\n", "", ":8 clips[0].name: found nothing, expected a value"),
            (
                "mass_kg = 0.0133",
                "mass_kg = -0.0133",
                ":10 clips[0].mass_kg: found -0.0133, expected a mass of 0 or more",
            ),
            (
                "mass_kg = 0.0133",
                "mass_kg = \"0.0133\"",
                ":10 clips[0].mass_kg: found string \"0.0133\", expected a number",
            ),
            (
                "[0, 1]",
                "[0, 4]",
                ":11 clips[0].vertices[1]: found 4, expected 0 to 3, for mesh.obj has 4 vertices",
            ),
            (
                "[0, 1]",
                "[0, -1]",
                ":11 clips[0].vertices[1]: found integer -1, expected a whole number from 0",
            ),
            ("[0, 1]", "[0, 0]", ":11 clips[0].vertices[1]: found 0 twice, expected every vertex once"),
            (
                "[0, 1]",
                "[]",
                ":11 clips[0].vertices: found nothing, expected the vertices that the clip holds",
            ),
            (
                "[[clips]]",
                "[table]\nedge_point_m = [0, 0, 0]\nedge_direction = [0, 1, 0]\noutward = [1, 0, 0]\n[[clips]]",
                ":8 table: found [table], expected none for a stretch-weft test",
            ),
        ],
    );
    check(
        "bend/test.toml",
        &[
            (
                "outward = [1.0",
                "outward = [2.0",
                ":7 table.outward: found a vector of length 2, expected unit length",
            ),
            (
                "outward = [1.0, 0.0",
                "outward = [0.0, 1.0",
                ":7 table.outward: found [0.0, 1.0, 0.0], expected a right angle to edge_direction",
            ),
            (
                "[table]",
                "[[clips]]\nname = \"a\"\nmass_kg = 0\nvertices = [0]\n[table]",
                ":4 clips: found [[clips]], expected none for a bending test",
            ),
        ],
    );
}

#[test]
fn mesh_file() {
    check(
        "stretch-weft/mesh.obj",
        &[
            (
                "v 0.1 0 ",
                "v 0.1 nan ",
                ":3 v: found nan in 1 of 3 coordinates, expected finite numbers, or nan in all three",
            ),
            ("v 0.1 0 ", "v 0.1 inf ", ":3 v: found inf, expected a finite number"),
            ("v 0.1 0 ", "v 0,1 0 ", ":3 v: found 0,1, expected a number with a decimal point, not a comma"),
            ("v 0.1 0 0.3333333333333333", "v 0.1 0", ":3 v: found 2 numbers, expected 3 numbers"),
            (
                "v 0.1 0 ",
                "v 0 0 ",
                ":3 mesh: found vertices 0 and 1 have the same rest position; merge them (counted from 0), expected a sheet of cloth in metres",
            ),
            (
                "v 0.1 0 ",
                "v 100 0 ",
                ":10 mesh: found edge 0-1: 100 m between rest positions, 0.1 m between material coordinates; they must agree within 1 % (millimetres?) (counted from 0), expected a sheet of cloth in metres",
            ),
            (
                "vt 0.1 0\n",
                "vt 100 0\n",
                ":10 mesh: found edge 0-1: 0.1 m between rest positions, 100 m between material coordinates; they must agree within 1 % (millimetres?) (counted from 0), expected a sheet of cloth in metres",
            ),
            (
                "vt 0.1 0\n",
                "vt 10 0\n",
                ":10 mesh: found edge 0-1: 0.1 m between rest positions, 10 m between material coordinates; they must agree within 1 % (centimetres?) (counted from 0), expected a sheet of cloth in metres",
            ),
            (
                "vt 0 0\nvt 0.1 0\nvt 0.1 0.1\nvt 0 0.1\n",
                "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n",
                ":10 mesh: found edge 0-1: 0.1 m between rest positions, 1 m between material coordinates; they must agree within 1 % (counted from 0), expected vt in metres; these, from 0 to 1, are texture coordinates: multiply u by the sample's width and v by its height",
            ),
            (
                "f 1/1 2/2 3/3",
                "f 0/1 2/2 3/3",
                ":10 f v: found 0, expected an index from 1, or from -1 backwards",
            ),
            (
                "f 1/1 2/2 3/3",
                "f 1/1 2/2 5/3",
                ":10 f v: found 5, expected an index that exists (there are 4)",
            ),
            (
                "f 1/1 2/2 3/3",
                "f 1/1 2/2 3/9",
                ":10 f vt: found 9, expected an index that exists (there are 4)",
            ),
            ("f 1/1 2/2 3/3", "f 1/1 2/2 -5/3", ":10 f v: found -5, expected at most 4 backwards"),
            (
                "f 1/1 2/2 3/3",
                "f 1/1 2/2 3",
                ":10 f vt: found nothing, expected v/vt at every corner: vt are the material coordinates in metres",
            ),
            (
                "f 1/1 2/2 3/3",
                "f 1/1 2/2 3//1",
                ":10 f vt: found nothing, expected v/vt at every corner: vt are the material coordinates in metres",
            ),
            ("f 1/1 2/2 3/3", "f 1/1 2/2", ":10 f: found 2 corners, expected three or more"),
            (
                "f 1/1 2/2 3/3",
                "f 1/1 2/2 2/2",
                ":10 mesh: found triangle 0: vertex 1 of 4 does not exist or is named twice (counted from 0), expected a sheet of cloth in metres",
            ),
            ("f 1/1 2/2 3/3", "f 1/1 2/2 x/3", ":10 f v: found x, expected an index"),
            (
                "f 1/1 2/2 3/3",
                "f 1/1 3/3 2/2",
                ":11 mesh: found triangles 0 and 1 are wound in opposite senses at edge 0-2 (counted from 0), expected a sheet of cloth in metres",
            ),
            (
                "f 1/1 2/2 3/3",
                "f 1/1 2/2 3/4",
                ":11 f vt: found another vt for vertex 2 (counted from 0) than on line 10, expected one vt for every vertex (no seams)",
            ),
            ("f 1/1 2/2 3/3\n", "", ":3 v: found a vertex of no face, expected every vertex in a face"),
            (
                "f 1/1 2/2 3/3\n",
                "f 1/1 2/2 3/3\nf 1/1 2/2 4/4\nf 2/2 1/1 3/3\n",
                ":11 mesh: found triangles 0 and 1 are wound in opposite senses at edge 0-1 (counted from 0), expected a sheet of cloth in metres",
            ),
            (
                "f 1/1 2/2 3/3\n",
                "face 1 2 3\n",
                ":10 keyword: found face, expected v, vt, f, or another keyword of OBJ",
            ),
        ],
    );
}

#[test]
fn clip_table() {
    check(
        "corners/clips.csv",
        &[
            ("tx_m", "tx_mm", ":1 header: found tx_mm, expected tx_m (convert millimetres to metres)"),
            ("tx_m", "tx", ":1 header: found tx, expected tx_m (the values in metres, the unit in the name)"),
            (
                "tx_m",
                "x",
                ":1 header: found x, expected only the columns frame, clip, tx_m, ty_m, tz_m, qw, qx, qy, qz",
            ),
            ("tx_m", "qw", ":1 header: found qw twice, expected every column once"),
            (
                "tx_m,",
                "",
                ":2 row: found 9 fields in every row (another line as the header?), expected 8 fields, as in the header in line 1",
            ),
            ("tx_m,", ",", ":1 header: found no name for column 3, expected a name for every column"),
            (
                "qz\n",
                "qz,force_n\n",
                ":2 row: found 9 fields in every row (another line as the header?), expected 10 fields, as in the header in line 1",
            ),
            (
                "frame,clip,tx_m,ty_m,tz_m,qw,qx,qy,qz\n",
                "frame;clip;tx_m;ty_m;tz_m;qw;qx;qy;qz\n",
                ":1 header: found semicolons (;) between the columns, expected commas between the columns and points in the numbers (export as comma-separated values)",
            ),
            (
                "frame,clip,tx_m,ty_m,tz_m,qw,qx,qy,qz\n",
                "frame\tclip\n",
                ":1 header: found tabs between the columns, expected commas between the columns and points in the numbers (export as comma-separated values)",
            ),
            ("0,low,0,", "0,low,nan,", ":2 tx_m: found nan, expected a finite number"),
            ("0,low,0,", "0,low,-inf,", ":2 tx_m: found -inf, expected a finite number"),
            ("0,low,0,", "0,low,1e400,", ":2 tx_m: found 1e400, expected a number below 1.8e308"),
            (
                "0,low,0,",
                "0,low,\u{2212}0.1,",
                ":2 tx_m: found \u{2212}0.1, expected a number with the ASCII minus sign (-), not the Unicode one",
            ),
            ("0,low,0,", "0,low,,", ":2 tx_m: found nothing, expected a number"),
            (
                "0,low,0,",
                "0,low,\"0,5\",",
                ":2 tx_m: found 0,5, expected a number with a decimal point, not a comma",
            ),
            (
                "0,low,0,",
                "0,low,0,5,",
                ":2 row: found 10 fields, expected 9 fields, as in the header in line 1",
            ),
            ("0,low,0,", "0,low,0;", ":2 row: found 8 fields, expected 9 fields, as in the header in line 1"),
            (
                "0,low,0,",
                "0,low,\"0,",
                ":2 quote: found no closing quote at the end of the field, expected a quote (\") there",
            ),
            ("0,low,0,", "\n\n0,low,zero,", ":4 tx_m: found zero, expected a number"),
            ("0,low,0,", "0.0,low,0,", ":2 frame: found 0.0, expected a whole number from 0"),
            ("0,low,0,", "0,lo,0,", ":2 clip: found lo, expected a clip of test.toml: low, high, \"left\""),
            (
                "0,low,0,",
                "1,low,0,",
                ":4 frame: found frame 1 of low twice, expected one pose for every clip and frame",
            ),
            (
                "0,low,0,",
                "7,low,0,",
                " frame: found no pose of low in frame 0, expected one pose for every clip and frame, from frame 0 on",
            ),
            (
                "0,low,0,",
                "0,low,50,",
                " frame 0: found clips 50.0500999000002 m apart, expected metres (convert millimetres or centimetres to metres?)",
            ),
            (
                ",1,0,0,0\n",
                ",1.1,0,0,0\n",
                ":2 qw,qx,qy,qz: found a quaternion of length 1.1, expected unit length: qw first, then qx, qy, qz",
            ),
            (
                ",1,0,0,0\n",
                ",1,0,0\n",
                ":2 row: found 8 fields, expected 9 fields, as in the header in line 1",
            ),
        ],
    );
}

#[test]
fn other_tables() {
    check(
        "stretch-weft/forces.csv",
        &[
            ("1,low", "3,low", ":3 frame: found 3, expected 0 to 2, the frames of clips.csv"),
            ("px_m", "px_cm", ":1 header: found px_cm, expected px_m (convert centimetres to metres)"),
            ("fx_n", "fx_mn", ":1 header: found fx_mn, expected fx_n (convert millinewtons to newtons)"),
            (
                "fx_n",
                "fx",
                ":1 header: found fx, expected fx_n (the values in newtons, the unit in the name)",
            ),
        ],
    );
    check(
        "stretch-weft/frames.csv",
        &[
            ("0,0,0,loading", "0,0,0,up", ":2 phase: found up, expected loading, unloading or hold"),
            ("0,0,0,loading\n", "", " frame: found no frame 0, expected 0 to 2"),
            ("0,0,0,loading", "1,0,0,loading", ":3 frame: found 1 twice, expected every frame once"),
            (
                "0,0,0,loading",
                "9,0,0,loading",
                ":2 frame: found 9, expected 0 to 2, the frames of the sequence",
            ),
            ("0,0,0,loading", "0,0,-1,loading", ":2 cycle: found -1, expected a whole number from 0"),
        ],
    );
}

#[test]
fn bytes_that_are_no_text() {
    let utf16 = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<_>>();
    let with_mark = [vec![0xFF, 0xFE], utf16("frame")].concat();
    let cases: [(&[u8], &str); 8] = [
        (
            b"PK\x03\x04\x14\0",
            "corners/clips.csv text: found a workbook (.xlsx, .ods or .xls) or another archive, expected plain text (of a workbook save the sheet as CSV)",
        ),
        (
            b"\xD0\xCF\x11\xE0\xA1",
            "corners/clips.csv text: found a workbook (.xlsx, .ods or .xls) or another archive, expected plain text (of a workbook save the sheet as CSV)",
        ),
        (&with_mark, "corners/clips.csv:1 text: found UTF-16, expected UTF-8 (save the file as UTF-8)"),
        (
            &utf16("frame\nclip"),
            "corners/clips.csv:1 text: found a zero byte (UTF-16, or not a text?), expected UTF-8 (save the file as UTF-8)",
        ),
        (
            b"frame\rclip\r\n\xE9",
            "corners/clips.csv:3 text: found the byte 0xE9 (Latin-1?), expected UTF-8 (save the file as UTF-8)",
        ),
        (b"", "corners/clips.csv file: found an empty file, expected content"),
        (b"\n\n", "corners/clips.csv header: found nothing, expected the names of the columns"),
        (
            "\n\u{2000}".as_bytes(),
            "corners/clips.csv:2 header: found nothing, expected the names of the columns",
        ),
    ];
    for (bytes, expected) in cases {
        let write = |place: &Path| fs::write(place.join("corners/clips.csv"), bytes).unwrap();
        check_changes(&[(&write, expected)]);
    }
}

#[test]
fn shapes() {
    let array = |place: &Path| place.join("bend/positions.npy");
    let edit = |old: &'static str, new: &'static str| {
        move |place: &Path| {
            let mut bytes = fs::read(array(place)).unwrap();
            let at = bytes.windows(old.len()).position(|window| window == old.as_bytes()).unwrap();
            bytes.splice(at..at + old.len(), new.bytes());
            fs::write(array(place), bytes).unwrap();
        }
    };
    // The first coordinate of the second frame is 48 bytes after the header of 128.
    let coordinate = |value: f32| {
        move |place: &Path| {
            let mut bytes = fs::read(array(place)).unwrap();
            bytes.splice(128 + 48..128 + 52, value.to_le_bytes());
            fs::write(array(place), bytes).unwrap();
        }
    };
    let millimetres = |place: &Path| {
        let shapes = [0.0, 1.0].map(|offset| shape(offset).iter().map(|p| p * 1000.0).collect::<Vec<_>>());
        fs::write(array(place), npy::written(&[Some(&shapes[0]), Some(&shapes[1])], 4)).unwrap();
    };
    // Shapes in float32 a thousand kilometres away.
    let far = |place: &Path| {
        let near = npy::written(&[Some(&shape(0.0)), Some(&shape(1.0))], 4);
        let (header, data) = near.split_at(128);
        let far = |bytes: &[u8]| (f32::from_le_bytes(bytes.try_into().unwrap()) + 1e6).to_le_bytes();
        let data: Vec<u8> = data.chunks_exact(4).flat_map(far).collect();
        fs::write(array(place), [header, &data].concat()).unwrap();
    };
    let unseen = |place: &Path| fs::write(array(place), npy::written(&[Some(&shape(0.0)), None], 4)).unwrap();
    let files = |names: &'static [&'static str]| {
        move |place: &Path| {
            fs::create_dir(place.join("corners/frames")).unwrap();
            for name in names {
                fs::write(place.join("corners/frames").join(name), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n")
                    .unwrap();
            }
        }
    };
    let three = |place: &Path| {
        files(&["0000.obj"])(place);
        fs::write(place.join("corners/frames/0000.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap();
    };
    let ply = |text: &'static str| {
        move |place: &Path| {
            fs::create_dir(place.join("corners/frames")).unwrap();
            fs::write(place.join("corners/frames/0.ply"), text).unwrap();
        }
    };
    let cases: &[(Change<'_>, &str)] = &[
        (
            &edit("\u{1}\0", "\u{9}\0"),
            "bend/positions.npy header: found no NumPy array, expected a file written by numpy.save",
        ),
        (
            &edit("<f4", ">f4"),
            "bend/positions.npy descr: found >f4, expected <f4 or <f8 (little-endian float32 or float64)",
        ),
        (
            &edit("<f4", "   "),
            "bend/positions.npy descr: found blanks, expected <f4 or <f8 (little-endian float32 or float64)",
        ),
        (
            &edit("False", "True"),
            "bend/positions.npy fortran_order: found True, expected False (save numpy.ascontiguousarray of the array)",
        ),
        (
            &edit("(2, 4, 3)", "(2, 5, 3)"),
            "bend/positions.npy shape: found (2, 5, 3), expected (frames, 4, 3), as mesh.obj has 4 vertices",
        ),
        (
            &edit("(2, 4, 3)", "(3, 4, 3)"),
            "bend/positions.npy data: found 96 bytes, expected 144 bytes, for the shape (3, 4, 3)",
        ),
        (
            &edit("(2, 4, 3)", "(4, 2, 3)"),
            "bend/positions.npy shape: found (4, 2, 3), expected (frames, 4, 3), as mesh.obj has 4 vertices",
        ),
        (
            &edit("(2, 4, 3), }", "(6148914691236517205, 4, 3), }"),
            "bend/positions.npy data: found 114 bytes, expected fewer frames",
        ),
        (
            &edit("shape", "shap_"),
            "bend/positions.npy shape: found nothing, expected a header as numpy.save writes it",
        ),
        (
            &coordinate(f32::INFINITY),
            "bend/positions.npy frame 1 vertex 0: found inf, expected a coordinate below 3.4e38 m, or NaN where the vertex was not observed",
        ),
        (
            &coordinate(f32::NAN),
            "bend/positions.npy frame 1 vertex 0: found NaN in 1 of 3 coordinates, expected NaN in all three or in none",
        ),
        (
            &millimetres,
            "bend/positions.npy frame 0: found 4 of 4 edges more than ten times as long as at rest, expected metres (convert millimetres to metres?)",
        ),
        (
            &far,
            "bend/positions.npy data: found float32 coordinates of 1000001 m, expected float64 at this distance, or a nearer origin (millimetres? divide by 1000)",
        ),
        (
            &unseen,
            "bend/positions.npy file: found no observed vertex in frame 1, expected at least one in every frame",
        ),
        (
            &|place| fs::create_dir(place.join("bend/frames")).unwrap(),
            "bend/positions.npy file: found positions.npy and frames/, expected either the array or the folder frames/, not both",
        ),
        (&files(&[]), "corners/frames folder: found no file, expected 0000.obj, 0001.obj, … or .ply"),
        (
            &files(&["0000.obj", "0002.obj"]),
            "corners/frames/0002.obj file: found frame 2, expected frame 1: frames are numbered without gaps",
        ),
        (
            &files(&["0000.obj", "0.ply"]),
            "corners/frames/0000.obj file: found frame 0 twice, also corners/frames/0.ply, expected one file a frame",
        ),
        (&files(&["0000.obj", "0001.obj"]), "corners shapes: found 2 frames, expected 3, as in clips.csv"),
        (
            &files(&["0000.stl"]),
            "corners/frames/0000.stl file: found 0000.stl, expected 0000.obj, 0001.obj, … or .ply",
        ),
        (&three, "corners/frames/0000.obj vertices: found 3, expected 4, as in mesh.obj"),
        (
            &ply(
                "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  end_header\n0 0 0\n0 1,5 0\n",
            ),
            "corners/frames/0.ply:9 y: found 1,5, expected a number with a decimal point, not a comma",
        ),
        (
            &ply(
                "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  end_header\n0 0 0\n0 1\n",
            ),
            "corners/frames/0.ply:9 z: found nothing, expected a number",
        ),
        (
            &ply(
                "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  end_header\n0 0 0 7\n",
            ),
            "corners/frames/0.ply:8 row: found 7, expected nothing after the last property",
        ),
        (
            &ply(
                "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  end_header\n0 0 0\n",
            ),
            "corners/frames/0.ply element vertex: found 1 rows, expected 4",
        ),
        (
            &ply("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nend_header\n0\n0\n0\n0\n"),
            "corners/frames/0.ply y: found nothing, expected x, y and z of the element vertex",
        ),
        (
            &ply("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x"),
            "corners/frames/0.ply:4 PLY: found Unexpected end of file while reading header (missing 'end_he…, expected a PLY file with x, y and z of every vertex",
        ),
        (
            &ply(
                "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n\
                  end_header\n0 0 0\n0 1e39 0\n0 0 0\n0 0 0\n",
            ),
            "corners/frames/0.ply frame 0 vertex 1: found 1e39, expected a coordinate below 3.4e38 m, or NaN where the vertex was not observed",
        ),
        (
            &ply("ply\nformat ascii 1.0\nelement vertex 999999999999\nproperty float x\nend_header\n"),
            "corners/frames/0.ply element vertex: found 999999999999, expected at most the number of rows in the file",
        ),
        (
            &ply("ply\nformat ascii 1.0\nelement vertex 9\nend_header\n"),
            "corners/frames/0.ply element vertex: found no property, expected at least one",
        ),
        (
            &ply("ply\nformat ascii 1.0\nelement face 0\nproperty float x\nend_header\n"),
            "corners/frames/0.ply element vertex: found nothing, expected the vertices",
        ),
        (
            &ply("solid\n"),
            "corners/frames/0.ply:1 PLY: found Expected magic number 'ply'., expected a PLY file with x, y and z of every vertex",
        ),
    ];
    check_changes(cases);
}

#[test]
fn files_and_folders() {
    let remove = |name: &'static str| move |place: &Path| fs::remove_file(place.join(name)).unwrap();
    let folder_for = |name: &'static str| {
        move |place: &Path| {
            remove(name)(place);
            fs::create_dir(place.join(name)).unwrap();
        }
    };
    let copy = |from: &'static str, to: &'static str| {
        move |place: &Path| _ = fs::copy(place.join(from), place.join(to)).unwrap()
    };
    let huge = |place: &Path| {
        fs::File::options().write(true).open(place.join("fabric.toml")).unwrap().set_len(3 << 30).unwrap();
    };
    let socket = |place: &Path| {
        remove("fabric.toml")(place);
        std::os::unix::net::UnixListener::bind(place.join("fabric.toml")).unwrap();
    };
    let cases: &[(Change<'_>, &str)] = &[
        (&remove("fabric.toml"), "fabric.toml file: found nothing, expected a file"),
        (
            &|place| {
                fs::create_dir(place.join("inner")).unwrap();
                fs::rename(place.join("fabric.toml"), place.join("inner/fabric.toml")).unwrap();
            },
            "set folder: found a folder of sets: inner, expected one of them",
        ),
        (
            &|place| {
                remove("fabric.toml")(place);
                fs::rename(place.join("corners/test.toml"), place.join("test.toml")).unwrap();
            },
            "set folder: found a sequence of a set, expected the set, which is the folder above it",
        ),
        (&remove("corners/test.toml"), "corners/test.toml file: found nothing, expected a file"),
        (&remove("corners/mesh.obj"), "corners/mesh.obj file: found nothing, expected a file"),
        (&remove("corners/clips.csv"), "corners/clips.csv file: found nothing, expected a file"),
        (&folder_for("corners/mesh.obj"), "corners/mesh.obj file: found a folder, expected a regular file"),
        (
            &copy("corners/clips.csv", "corners/clip.csv"),
            "corners/clip.csv file: found a name that no sequence has, expected only test.toml, mesh.obj, positions.npy, frames, clips.csv, forces.csv, frames.csv",
        ),
        (
            &copy("corners/clips.csv", "bend/clips.csv"),
            "bend/clips.csv file: found clips.csv in a bend-bias test, expected none: bending tests have no clips",
        ),
        (&huge, "fabric.toml file: found 3221225472 bytes, expected at most 2 GiB"),
        (&socket, "fabric.toml file: found a pipe, socket or device, expected a regular file"),
        (&|place| fs::remove_dir_all(place).unwrap(), "set folder: found nothing, expected a folder"),
    ];
    check_changes(cases);
}
