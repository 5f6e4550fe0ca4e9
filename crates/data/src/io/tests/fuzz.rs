//! Damaged files give an error or still read; they never panic.

use super::*;
use rand::rngs::StdRng;
use rand::seq::IndexedRandom;
use rand::{Rng, SeedableRng};

/// Fragments that have broken readers before.
const PIECES: [&str; 22] = [
    "nan",
    "-inf",
    "1e400",
    "0",
    "-1",
    "18446744073709551615",
    "99999999999",
    "\"",
    ",",
    ";",
    "\r",
    "\n\n",
    "[",
    "(",
    "{",
    "'",
    "\u{2212}1",
    "é",
    "\0",
    "/",
    ".",
    "= ",
];

fn damage(bytes: &mut Vec<u8>, random: &mut StdRng) {
    let at = random.random_range(0..=bytes.len());
    let end = (at + random.random_range(0..12)).min(bytes.len());
    match random.random_range(0..6) {
        0 => bytes.truncate(at),
        1 => _ = bytes.drain(at..end),
        2 => bytes[at..end].iter_mut().for_each(|byte| *byte = random.random()),
        3 => _ = bytes.splice(at..at, PIECES.choose(random).unwrap().bytes()),
        4 => _ = bytes.splice(at..end, PIECES.choose(random).unwrap().bytes()),
        _ => {
            let copy = bytes[at..].to_vec();
            bytes.extend(copy);
        }
    }
}

#[test]
fn no_bytes_make_a_reader_panic() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("set");
    write_set(&place, &set()).unwrap();
    // Adds a sequence with mesh files.
    let frames = place.join("corners").join("frames");
    fs::create_dir(&frames).unwrap();
    let rows = "0 0 0\n0.1 0 0\n0.1 0.1 0\n0 0.1 0\n";
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement face 1\nproperty list uint uchar a\nelement vertex 4\n\
             property float x\nproperty float y\nproperty float z\nend_header\n"
        )
    };
    fs::write(frames.join("0000.ply"), header("ascii") + "2 1 1\n" + rows).unwrap();
    let mut binary = header("binary_little_endian").into_bytes();
    binary.extend([2, 0, 0, 0, 1, 1]);
    binary.extend((0..12).flat_map(|index| (0.1 * index as f32).to_le_bytes()));
    fs::write(frames.join("0001.ply"), binary).unwrap();
    fs::write(frames.join("0002.obj"), obj::written(&mesh())).unwrap();
    read_set(&place).unwrap();

    let mut files = vec![place.join("fabric.toml"), frames.join("0000.ply"), frames.join("0001.ply")];
    for sequence in ["bend", "stretch-weft"] {
        files.extend(
            entries(&place.join(sequence)).unwrap().into_keys().map(|name| place.join(sequence).join(name)),
        );
    }
    let mut random = StdRng::seed_from_u64(7);
    let (mut read, mut refused) = (0, 0);
    for _ in 0..2000 {
        let file = files.choose(&mut random).unwrap();
        let valid = fs::read(file).unwrap();
        let mut bytes = valid.clone();
        for _ in 0..random.random_range(1..4) {
            damage(&mut bytes, &mut random);
        }
        fs::write(file, bytes).unwrap();
        match read_set(&place) {
            Ok(_) => read += 1,
            Err(error) => {
                assert!(matches!(error, Error::Input { .. }), "{error:?}");
                assert!(!error.to_string().contains('\n'), "{error}");
                refused += 1;
            }
        }
        fs::write(file, valid).unwrap();
    }
    assert!(read > 50 && refused > 500, "{read} read, {refused} refused");
}
