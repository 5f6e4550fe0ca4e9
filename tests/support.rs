//! What several tests share.

use std::path::PathBuf;

/// A folder or file of the real measurements, below the folder that `FIT_CLOTH_DATA` names.
///
/// # Panics
/// When the variable is not set or nothing of that name is there: a test without its data has not been run.
pub fn data(name: &str) -> PathBuf {
    let Some(root) = std::env::var_os("FIT_CLOTH_DATA") else {
        panic!("set FIT_CLOTH_DATA to the folder with the real measurements: this test needs {name} from it");
    };
    let path = PathBuf::from(root).join(name);
    assert!(path.exists(), "{} does not exist: is FIT_CLOTH_DATA the right folder?", path.display());
    path
}
