//! What several tests share.

use std::path::PathBuf;

/// A file of the reference data, which lie outside the repository.
///
/// # Panics
/// If the environment variable `FIT_CLOTH_DATA` does not name their folder, or the file is not there.
pub fn data(name: &str) -> PathBuf {
    let Some(folder) = std::env::var_os("FIT_CLOTH_DATA") else {
        panic!("set FIT_CLOTH_DATA to the folder of the reference data; this test reads {name} in it")
    };
    let path = PathBuf::from(folder).join(name);
    assert!(path.exists(), "{} does not exist; is FIT_CLOTH_DATA right?", path.display());
    path
}

/// The fields of a simple comma-separated file of the reference data, without its header; no field is quoted with a comma.
///
/// # Panics
/// If it cannot be read.
pub fn rows(name: &str) -> Vec<Vec<String>> {
    let path = data(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.lines().skip(1).map(|line| line.split(',').map(|field| field.trim().to_owned()).collect()).collect()
}
