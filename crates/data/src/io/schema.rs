//! Versions of the files that fit-cloth writes, `fit-cloth/NAME/VERSION`, and the conversions of older ones.
//!
//! A change that an older program could not read makes a new version, with a conversion from the version before. Tables
//! carry the version of the file in their folder; a changed meaning gets a new column name.

use serde_json::Value;

/// Turns one version of a file into the next.
pub type Conversion = fn(&mut Value);

/// A file format.
#[derive(Debug, Clone, Copy)]
pub struct Schema {
    name: &'static str,
    /// The first leads from version 1 to 2, the last to the current one.
    conversions: &'static [Conversion],
}

impl Schema {
    /// The format of this name, and how each older version becomes the next.
    pub const fn new(name: &'static str, conversions: &'static [Conversion]) -> Self {
        Self { name, conversions }
    }

    /// The current version.
    pub fn version(&self) -> usize {
        self.conversions.len() + 1
    }

    /// The current version as it stands in a file.
    pub fn id(&self) -> String {
        format!("fit-cloth/{}/{}", self.name, self.version())
    }

    /// The version of a file, from its id; `None` for another format, or none.
    pub fn version_of(&self, id: &str) -> Option<usize> {
        let version: usize =
            id.strip_prefix("fit-cloth/")?.strip_prefix(self.name)?.strip_prefix('/')?.parse().ok()?;
        (version > 0).then_some(version)
    }

    /// The expected id, with a remedy for a file of a newer version.
    pub fn expected(&self, id: &str) -> String {
        match self.version_of(id) {
            Some(version) if version > self.version() => {
                format!("{} or older: a newer fit-cloth wrote this file", self.id())
            }
            _ => self.id(),
        }
    }

    /// Converts an older version to the current one.
    pub(super) fn convert(&self, version: usize, value: &mut Value) {
        self.conversions.iter().skip(version.max(1) - 1).for_each(|convert| convert(value));
        value["schema"] = Value::String(self.id());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::json_file::parse_version;
    use serde::Deserialize;
    use std::path::Path;

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Third {
        schema: String,
        length_m: f64,
    }

    /// `mm` became `length_mm`, then `length_m`.
    const THIRD: Schema = Schema::new(
        "probe",
        &[
            |value| rename(value, "mm", "length_mm", 1.0),
            |value| rename(value, "length_mm", "length_m", 1e-3),
        ],
    );

    fn rename(value: &mut Value, old: &str, new: &str, factor: f64) {
        let Some(length) = value.as_object_mut().and_then(|map| map.remove(old)) else { return };
        value[new] = (factor * length.as_f64().unwrap_or_default()).into();
    }

    fn read(text: &str) -> crate::error::Result<Third> {
        parse_version(Path::new("probe.json"), text, &THIRD)
    }

    #[test]
    fn older_versions_are_converted_step_by_step() {
        let current = Third { schema: "fit-cloth/probe/3".into(), length_m: 0.25 };
        for text in [
            "{\"schema\": \"fit-cloth/probe/1\", \"mm\": 250}",
            "{\"schema\": \"fit-cloth/probe/2\", \"length_mm\": 250}",
            "{\"schema\": \"fit-cloth/probe/3\", \"length_m\": 0.25}",
        ] {
            assert_eq!(read(text).unwrap(), current, "{text}");
        }
    }

    #[test]
    fn newer_and_other_versions_are_named() {
        let refused = |id: &str| read(&format!("{{\"schema\": \"{id}\"}}")).unwrap_err().to_string();
        let newer = refused("fit-cloth/probe/4");
        assert!(
            newer.contains("schema: found \"fit-cloth/probe/4\", expected fit-cloth/probe/3 or older"),
            "{newer}"
        );
        for other in ["fit-cloth/material/1", "fit-cloth/probe/0", "fit-cloth/probe/x", "", "probe"] {
            assert!(refused(other).ends_with("expected fit-cloth/probe/3"), "{other}");
        }
        assert!(
            read("{}").unwrap_err().to_string().contains("schema: found null, expected fit-cloth/probe/3")
        );
        // A fault in an older file is named without a line: the text is converted.
        let fault =
            read("{\"schema\": \"fit-cloth/probe/1\", \"mm\": 250, \"inch\": 1}").unwrap_err().to_string();
        assert!(fault.starts_with("probe.json inch: found an unknown key"), "{fault}");
    }
}
