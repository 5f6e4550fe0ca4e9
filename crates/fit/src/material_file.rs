//! `material.json`: what a simulator needs of a fitted fabric, and how sure it is.
//!
//! Versioned by its `schema`. Control points, not samples, so that nothing is lost on the way to a simulator of ours.

mod control_point;
mod entry;

pub use control_point::{ControlPoint, Unit};
pub use entry::{Correlation, CurveEntry, ResidualEntry};

use crate::error::{Error, Result};
use crate::frame::{Fabric, MeasurementSet};
use crate::incremental::{Failure, FitReport};
use crate::io::{read_text, shortened, shown};
use crate::stage::{Constraints, Settings, Variant};
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::material::{Component, Compression, Curves, Model};
use cloth_sim::mesh::Diagonals;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The version of the file that is written and read.
pub const SCHEMA: &str = "fit-cloth/material/1";

/// Characters of what the JSON reader says is wrong: its lists of known keys are long.
const LONGEST_REASON: usize = 500;

/// The whole file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialFile {
    /// [`SCHEMA`].
    pub schema: String,
    /// The cloth model whose strains the curves are over.
    pub model: Model,
    /// Which of its freedoms were used.
    #[serde(default)]
    pub variant: Variant,
    /// What weft and warp do under compression.
    pub compression: Compression,
    /// The sample that was measured.
    pub fabric: Fabric,
    /// One entry a component, observed or not.
    pub curves: BTreeMap<Component, CurveEntry>,
    /// How each sequence was met.
    pub residuals: Vec<ResidualEntry>,
    /// Stages that came to nothing, and why.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<String>,
    /// How the file came about.
    pub provenance: Provenance,
}

/// How the file came about.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Program and version.
    pub program: String,
    /// What kept the curves physical.
    pub constraints: Constraints,
    /// The published method fitted it, as [`Settings::as_published`] says; absent where ours did.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub as_published: bool,
    /// Residuals above so many times the noise counted less; absent where all counted in full.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robust: Option<f64>,
    /// How the simulation's cells were split: a bending curve of hinges belongs to its triangulation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diagonals: Option<Diagonals>,
    /// Columns and rows of the simulation, a sequence each.
    pub nodes: BTreeMap<String, [usize; 2]>,
    /// What was changed after the fit, in order: repairs, and edits by hand.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<String>,
}

impl MaterialFile {
    /// Collects what the fit of one model found.
    ///
    /// * `given` — the file whose curves the fit took as known, if there was one
    pub fn new(
        set: &MeasurementSet,
        settings: &Settings,
        report: &FitReport,
        given: Option<&MaterialFile>,
    ) -> Self {
        let entry = |component| match report.stage(component) {
            None if report.knowledge.knows(component) => given
                .and_then(|file| file.curves.get(&component))
                .map(|entry| CurveEntry { given: true, ..entry.clone() })
                .unwrap_or_default(),
            stage => CurveEntry::new(stage),
        };
        let sequences = report.sequences();
        let nodes = sequences.iter().map(|(_, sequence)| (sequence.name.clone(), sequence.nodes));
        Self {
            schema: SCHEMA.into(),
            model: settings.model,
            variant: settings.variant,
            compression: settings.compression,
            fabric: set.fabric.clone(),
            curves: Component::ALL.into_iter().map(|component| (component, entry(component))).collect(),
            residuals: sequences
                .iter()
                .map(|(stage, sequence)| ResidualEntry::new(sequence, &stage.dropped))
                .collect(),
            failures: report.failures.iter().map(Failure::in_words).collect(),
            provenance: Provenance {
                program: concat!("fit-cloth ", env!("CARGO_PKG_VERSION")).into(),
                constraints: settings.constraints,
                as_published: settings.is_as_published(),
                robust: settings.robust,
                diagonals: Some(settings.diagonals),
                nodes: nodes.collect(),
                changes: Vec::new(),
            },
        }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// A file that cannot be read, or is no such file, with line and field.
    pub fn read(path: &Path) -> Result<Self> {
        let text = read_text(path)?;
        let refuse = |error: serde_json::Error| {
            let line = Some(error.line()).filter(|&line| line > 0);
            let found = shortened(&error.to_string(), LONGEST_REASON);
            Error::input(path, line, "material", found, "a material.json that fit-cloth wrote")
        };
        // The version first: another one may well have other fields.
        let value: serde_json::Value = serde_json::from_str(&text).map_err(refuse)?;
        if value["schema"] != SCHEMA {
            return Err(Error::input(path, None, "schema", shown(&value["schema"].to_string()), SCHEMA));
        }
        let file: Self = serde_json::from_str(&text).map_err(refuse)?;
        file.named_curves()
            .map_err(|(component, found)| Error::input(path, None, component.to_string(), found, CURVE))?;
        Ok(file)
    }

    /// Puts another curve in the place of an observed one, and says so in the provenance.
    ///
    /// Deviations go: they were those of the curve that was fitted. What the measurement told of it stays only where the
    /// control points keep their strains. Components that shared the curve no longer do.
    ///
    /// * `change` — in words, what was done
    pub fn set_curve(&mut self, component: Component, curve: &StiffnessCurve, change: &str) {
        let unit = Unit::of(self.model, component);
        let entry = self.curves.entry(component).or_default();
        let strains = entry.control_points.iter().map(|point| point.strain);
        if !strains.eq(curve.strains().iter().copied()) {
            *entry = CurveEntry { observed: true, given: entry.given, ..CurveEntry::default() };
        }
        let points = curve.strains().iter().zip(curve.stiffnesses());
        entry.control_points = points
            .map(|(&strain, &stiffness)| ControlPoint { strain, stiffness, deviation: None, unit })
            .collect();
        let sharing = std::mem::take(&mut entry.shared_by);
        for other in sharing.into_iter().filter(|&other| other != component) {
            self.curves.entry(other).or_default().shared_by.clear();
        }
        self.provenance.changes.push(format!("{component}: {change}"));
    }

    /// The file's text.
    pub fn to_json(&self) -> String {
        // Strings, numbers and maps with string keys: nothing here can fail to be JSON.
        serde_json::to_string_pretty(self).map(|text| text + "\n").unwrap_or_default()
    }

    /// The curves that were observed or given.
    ///
    /// # Errors
    /// Control points that make no curve.
    pub fn curves(&self) -> Result<Curves> {
        self.named_curves().map_err(|(component, found)| {
            Error::input(Path::new("material.json"), None, component.to_string(), found, CURVE)
        })
    }

    fn named_curves(&self) -> std::result::Result<Curves, (Component, String)> {
        let observed = self.curves.iter().filter(|(_, entry)| entry.observed);
        observed
            .map(|(&component, entry)| {
                let negative = self.model.negative_strain(component, self.compression);
                let curve = entry.curve(self.model, component, negative);
                curve.map(|curve| (component, curve)).map_err(|found| (component, found))
            })
            .collect()
    }
}

/// What an observed curve must have.
const CURVE: &str = "control points at ascending strains from 0, with finite stiffnesses in the model's unit";

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(text: &str) -> serde_json::Result<CurveEntry> {
        serde_json::from_str(&format!(r#"{{ "observed": true, "control_points": [{text}] }}"#))
    }

    #[test]
    fn a_stiffness_is_read_by_its_unit_and_written_alike() {
        for (component, unit, text) in [
            (Component::Shear, Unit::NewtonPerMetre, r#"{"strain":0.0,"stiffness_n_per_m":0.1}"#),
            (
                Component::BendWarp,
                Unit::NewtonMetre,
                r#"{"strain":0.0,"stiffness_n_m":1e-6,"deviation_n_m":1e-8}"#,
            ),
        ] {
            let entry = entry(text).unwrap();
            assert_eq!(entry.control_points[0].unit, unit);
            assert_eq!(serde_json::to_string(&entry.control_points[0]).unwrap(), text);
            assert!(entry.curve(Model::Stvk, component, cloth_sim::curve::NegativeStrain::Odd).is_ok());
        }
    }

    #[test]
    fn what_is_no_material_is_refused_in_one_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("material.json");
        let refused = |bytes: &[u8], words: &str| {
            std::fs::write(&path, bytes).unwrap();
            let error = MaterialFile::read(&path).unwrap_err();
            let text = error.to_string();
            assert!(matches!(error, Error::Input { .. }), "{error:?}");
            assert!(text.contains(words) && text.len() < 1000 && !text.contains('\n'), "{text}");
        };
        refused(b"{\n\"schema\": \"\xE9\"}", ":2 text: found the byte 0xE9");
        refused(b"", "file: found an empty file");
        refused(b"{\n[}", ":2 material: found key must be a string");
        let long = "a\\n".repeat(1000);
        refused(format!("{{\"schema\": \"{long}\"}}").as_bytes(), "schema: found \"a\\na\\n");
        let unknown = format!("{{\"schema\": \"{SCHEMA}\", \"{long}\": 1}}");
        refused(unknown.as_bytes(), ":1 material: found unknown field `a\\na\\n");
        std::fs::remove_file(&path).unwrap();
        let error = MaterialFile::read(&path).unwrap_err().to_string();
        assert!(error.ends_with("file: found nothing, expected a file"), "{error}");
    }

    #[test]
    fn a_stiffness_in_no_unit_or_in_two_or_in_the_wrong_one_is_refused() {
        for text in [
            r#"{"strain":0.0}"#,
            r#"{"strain":0.0,"stiffness_n_m":1.0,"stiffness_n_per_m":1.0}"#,
            r#"{"strain":0.0,"stiffness_n_m":1.0,"deviation_n_per_m":1.0}"#,
            r#"{"strain":0.0,"stiffness_n":1.0}"#,
        ] {
            assert!(entry(text).is_err(), "{text}");
        }
        let hinges = entry(r#"{"strain":0.0,"stiffness_n_m":1.0}"#).unwrap();
        let odd = cloth_sim::curve::NegativeStrain::Odd;
        assert!(hinges.curve(Model::Stvk, Component::Shear, odd).is_err());
        assert!(hinges.curve(Model::Springs, Component::BendWeft, odd).is_err());
    }
}
