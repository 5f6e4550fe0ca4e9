//! Shared code of the fuzz targets: files on disk, one of them fuzzed, and checks of every result.

#![forbid(unsafe_code)]

use cloth_data::error::{Error, Result};
use cloth_data::frame::{Frame, Sequence};
use cloth_data::io::{read_sequence, write_sequence};
use cloth_data::strip::Column;
use cloth_sim::curve::StiffnessCurve;
use std::fs;
use std::path::PathBuf;

/// Maximum length of a message, meant for one terminal line apart from lists of permitted names.
const LONGEST_MESSAGE: usize = 1000;

/// A folder with a set of one pulled and one bent 4-vertex strip, and the files of a target.
pub struct Sample {
    folder: PathBuf,
}

impl Default for Sample {
    fn default() -> Self {
        // Targets never return: tests/fuzz.sh removes the folder.
        let folder = tempfile::tempdir().expect("a folder for temporary files").keep();
        let sample = Self { folder };
        for name in ["pulled", "bent", "back"] {
            fs::create_dir(sample.path(name)).expect("a new folder");
        }
        for sequence in ["pulled", "bent"] {
            sample.put(&format!("{sequence}/mesh.obj"), MESH.as_bytes());
        }
        sample.put("pulled/test.toml", PULLED.as_bytes());
        sample.put("pulled/clips.csv", CLIPS.as_bytes());
        sample.put("bent/test.toml", BENT.as_bytes());
        sample.put("bent/positions.npy", &positions());
        sample.put("back/fabric.toml", FABRIC.as_bytes());
        sample
    }
}

impl Sample {
    /// Path of a file or folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Writes a file.
    pub fn put(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, bytes).expect("a file is written");
        path
    }

    /// Creates a hard link to a file.
    pub fn link(&self, name: &str, other: &str) {
        let _ = fs::remove_file(self.path(other));
        fs::hard_link(self.path(name), self.path(other)).expect("a link is made");
    }

    /// Reads a sequence with one file set to `bytes`: it is refused with a proper message, or survives a round trip.
    pub fn read(&self, sequence: &str, bytes: &[u8]) {
        answer(read_sequence(&self.path(sequence)), bytes).into_iter().for_each(|read| self.comes_back(read));
    }

    /// Writes a sequence that was read, and reads it again.
    pub fn comes_back(&self, read: Sequence) {
        assert!(numbers(&read).all(f64::is_finite), "{read:?}");
        let back = self.path("back");
        write_sequence(&back, &read).expect("what was read can be written");
        let mut rounded = read;
        // Shapes are written as float32, except far from the origin, where that is too coarse.
        let shapes = rounded.frames.iter_mut().filter_map(|frame| frame.positions.as_mut());
        let shapes: Vec<_> = shapes.flatten().collect();
        if !shapes.iter().any(|position| position.amax() > 1000.0) {
            shapes.into_iter().for_each(|position| *position = position.map(|value| f64::from(value as f32)));
        }
        let again = read_sequence(&back.join(&rounded.name)).expect("what was written can be read");
        same(&rounded, &again);
    }
}

/// The value read, if any; an error must state cause and place in one line.
pub fn answer<T>(result: Result<T>, bytes: &[u8]) -> Option<T> {
    let error = match result {
        Ok(read) => return Some(read),
        Err(error) => error,
    };
    let text = error.to_string();
    let Error::Input { line, field, found, expected, .. } = &error else { panic!("{error:?}") };
    assert!(!text.contains(char::is_control) && text.len() <= LONGEST_MESSAGE, "{text:?}");
    assert!([field, found, expected].iter().all(|part| !part.trim().is_empty()), "{error:?}");
    let lines = 1 + bytes.iter().filter(|&&byte| byte == b'\n' || byte == b'\r').count();
    assert!(line.is_none_or(|line| (1..=lines).contains(&line)), "{error:?}");
    None
}

/// Compares debug output, which shows every bit of a float except of NaN, which differs from itself.
pub fn same(a: &impl std::fmt::Debug, b: &impl std::fmt::Debug) {
    let [a, b] = [format!("{a:?}"), format!("{b:?}")];
    assert_eq!(a, b);
}

/// All numbers of a sequence except its shapes, which may contain NaN.
fn numbers(sequence: &Sequence) -> impl Iterator<Item = f64> {
    let Sequence { gravity, noise, force_direction, table, mesh, clips, frames, .. } = sequence;
    let mut numbers = gravity.as_slice().to_vec();
    numbers.extend(noise.iter().flat_map(|noise| [noise.position_m, noise.force_n]).flatten());
    numbers.extend(force_direction.iter().flatten());
    numbers.extend(table.iter().flat_map(|t| [t.edge_point_m, t.edge_direction, t.outward]).flatten());
    numbers.extend(mesh.positions.iter().flatten().chain(mesh.material.iter().flatten()));
    numbers.extend(clips.iter().map(|clip| clip.mass_kg));
    for Frame { time, poses, cords, positions, .. } in frames {
        numbers.extend(time);
        numbers.extend(poses.iter().flat_map(|pose| pose.translation.vector.into_iter().copied()));
        numbers.extend(poses.iter().flat_map(|pose| pose.rotation.coords.into_iter().copied()));
        numbers.extend(cords.iter().flat_map(|cord| cord.force.iter().chain(cord.point.iter().flatten())));
        let coordinates = positions.iter().flatten().flatten();
        numbers.extend(coordinates.filter(|coordinate| !coordinate.is_nan()));
    }
    numbers.into_iter()
}

/// `positions.npy` with the rest shape and a moved one with an unobserved vertex.
fn positions() -> Vec<u8> {
    let mut header = String::from("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 4, 3), }");
    header = format!("{header:<117}\n");
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(header.as_bytes());
    for moved in [0.0, 0.01f32] {
        for [x, y] in [[0.0, 0.0], [0.0, 0.04], [0.08, 0.0], [0.08, 0.04]] {
            let z = if moved > 0.0 && x == 0.0 && y == 0.0 { f32::NAN } else { moved };
            let place = if z.is_nan() { [z; 3] } else { [x, y, z] };
            bytes.extend(place.into_iter().flat_map(f32::to_le_bytes));
        }
    }
    bytes
}

/// The first two columns of a table, in the form a user gives them.
pub fn columns(table: &[u8]) -> Option<[Column; 2]> {
    let header = std::str::from_utf8(table).ok()?.lines().next()?;
    let mut names = header.split(',').map(|name| Column::from(name.trim().trim_matches('"')));
    Some([names.next()?, names.next()?])
}

/// Checks that a curve has finite stress, tangent and energy around its control points.
pub fn evaluate(curve: &StiffnessCurve) {
    for strain in curve.strains().iter().flat_map(|&strain| [-strain, 0.5 * strain, strain, 1.1 * strain]) {
        let response = curve.response(strain);
        let all = [response.stress, response.tangent, curve.energy(strain)];
        assert!(all.into_iter().all(f64::is_finite), "{all:?} at {strain} of {curve:?}");
    }
}

const FABRIC: &str = "name = \"cotton knit\"\nwidth_m = 0.08\nheight_m = 0.04\nareal_density_kg_m2 = 0.3\n";

const MESH: &str = "v 0 0 0\nv 0 0.04 0\nv 0.08 0 0\nv 0.08 0.04 0\nvt 0 0\nvt 0 0.04\nvt 0.08 0\nvt 0.08 0.04\n\
                    f 1/1 3/3 4/4\nf 1/1 4/4 2/2\n";

const PULLED: &str = "kind = \"stretch-weft\"\ngravity_m_s2 = [0.0, 0.0, 0.0]\n\
                      [[clips]]\nname = \"fixed\"\nmass_kg = 0.0\nvertices = [0, 1]\n\
                      [[clips]]\nname = \"moving\"\nmass_kg = 0.0\nvertices = [2, 3]\n";

const CLIPS: &str = "frame,clip,tx_m,ty_m,tz_m,qw,qx,qy,qz\n0,fixed,0,0,0,1,0,0,0\n0,moving,0,0,0,1,0,0,0\n\
                     1,fixed,0,0,0,1,0,0,0\n1,moving,0.004,0,0,1,0,0,0\n";

const BENT: &str = "kind = \"bend-weft\"\ngravity_m_s2 = [0.0, 0.0, -9.81]\n[table]\nedge_point_m = [0.05, 0.0, 0.0]\n\
                    edge_direction = [0.0, 1.0, 0.0]\noutward = [1.0, 0.0, 0.0]\n";
