//! Files that are missing, incomplete or misnamed.

use super::*;

/// Replaces the text of a file.
fn text(file: &'static str, text: &'static str) -> impl Fn(&Path) {
    move |place: &Path| fs::write(place.join(file), text).unwrap()
}

#[test]
fn names_and_columns() {
    check(
        "fabric.toml",
        &[
            ("name = 'cotton \"denim\"'", "name = ' '", ":1 name: found nothing, expected the fabric's name"),
            (
                "thickness_m = ",
                "thickness_m = 1",
                ":5 thickness_m: found 10.0000001, expected a length above 0 and at most 0.1 m (millimetres?)",
            ),
        ],
    );
    check(
        "corners/clips.csv",
        &[("tx_m", "TX_M", ":1 header: found TX_M, expected tx_m (exactly this name)")],
    );
    let cases: &[(Change<'_>, &str)] = &[
        (
            &text("corners/clips.csv", "frame,clip\n0,low\n"),
            "corners/clips.csv:1 header: found no column tx_m, expected a column tx_m",
        ),
        (
            &text("stretch-weft/forces.csv", "frame,clip,fx_n,fy_n,fz_n,px_m\n0,low,1,1,1,1\n"),
            "stretch-weft/forces.csv:1 header: found a part of px_m, py_m, pz_m, expected all three or none",
        ),
        (
            &text("bend/test.toml", "kind = \"bend-bias\"\ngravity_m_s2 = [0, 0, -9.81]\n"),
            "bend/test.toml table: found nothing, expected [table], for a bending test",
        ),
    ];
    check_changes(cases);
}

#[test]
fn meshes_that_are_no_sheet() {
    const SQUARE: &str =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 2 2\n";
    let mesh = |more: &'static str| {
        move |place: &Path| fs::write(place.join("corners/mesh.obj"), format!("{SQUARE}{more}")).unwrap()
    };
    let large = |place: &Path| {
        let path = place.join("corners/mesh.obj");
        let text = fs::read_to_string(&path).unwrap();
        fs::write(path, text.replace("0.1", "100")).unwrap();
    };
    let cases: &[(Change<'_>, &str)] = &[
        (
            &mesh("f 1/1 2/2 3/3\nf 1/1 3/3 5/5\nf 1/1 3/3 4/4\n"),
            "corners/mesh.obj:12 mesh: found triangle 1: its rest area is zero (counted from 0), expected a sheet of cloth in metres",
        ),
        (
            &mesh("f 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 2/2 5/5 3/3\nf 5/5 2/2 3/3\n"),
            "corners/mesh.obj:14 mesh: found edge 1-2 belongs to three triangles (0, 2 and 3); cloth has at most two (counted from 0), expected a sheet of cloth in metres",
        ),
        (
            &large,
            "corners/mesh.obj v: found a specimen of 141.4213562373095 m across, expected metres (convert millimetres or centimetres to metres?)",
        ),
        (
            &text("corners/mesh.obj", "# empty\n"),
            "corners/mesh.obj v: found no vertex, expected the rest mesh",
        ),
    ];
    check_changes(cases);
}

#[test]
fn folders_that_are_none_and_names_that_are_no_text() {
    use std::os::unix::ffi::OsStrExt;
    let file = |place: &Path| {
        fs::remove_dir_all(place.join("corners")).unwrap();
        fs::remove_dir_all(place).unwrap();
        fs::write(place, "a file").unwrap();
    };
    let latin = |place: &Path| fs::write(place.join(std::ffi::OsStr::from_bytes(b"caf\xE9")), "").unwrap();
    let cases: &[(Change<'_>, &str)] = &[
        (&file, "set folder: found a file, expected a folder"),
        (&latin, "caf\u{FFFD} name: found bytes that are not UTF-8, expected a name in UTF-8"),
    ];
    check_changes(cases);
}
