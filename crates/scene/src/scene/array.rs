//! Arrays of numbers in a scene's file.

use cloth_data::error::Result;
use cloth_data::io::TomlFile;
use nalgebra::Vector3;

/// Three finite numbers.
pub(super) fn vector(file: &TomlFile, key: &str, value: [f64; 3]) -> Result<Vector3<f64>> {
    check_length(file, key, 3)?;
    if value.iter().all(|component| component.is_finite()) {
        return Ok(value.into());
    }
    Err(file.invalid(key, format!("{value:?}"), "three finite numbers"))
}

/// Two finite numbers.
pub(super) fn pair(file: &TomlFile, key: &str, value: [f64; 2]) -> Result<[f64; 2]> {
    check_length(file, key, 2)?;
    if value.iter().all(|number| number.is_finite()) {
        return Ok(value);
    }
    Err(file.invalid(key, format!("{value:?}"), "two finite numbers"))
}

/// Rejects an array longer than expected; the excess would otherwise be dropped silently.
pub(super) fn check_length(file: &TomlFile, key: &str, length: usize) -> Result<()> {
    if !file.has(&format!("{key}[{length}]")) {
        return Ok(());
    }
    Err(file.invalid(key, format!("more than {length} numbers"), format!("an array of length {length}")))
}
