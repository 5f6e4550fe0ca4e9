//! `material.json`: a fitted fabric for a simulator, with its uncertainty.
//!
//! Versioned by its `schema`. Stores control points, not samples, so that a simulator reproduces the curves exactly.

mod control_point;
mod entry;

pub use control_point::{ControlPoint, Unit};
pub use entry::{Correlation, CurveEntry, ResidualEntry};

use crate::incremental::{FailedStage, FitReport};
use crate::stage::report::Basis;
use crate::stage::{Constraints, Settings, Variant};
use cloth_data::error::{Error, Result};
use cloth_data::frame::{Fabric, MeasurementSet};
use cloth_data::io::json_file::{parse_version, unique};
use cloth_data::io::read_text;
use cloth_data::io::schema::Schema;
use cloth_data::notice::Notice;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::material::{Component, Compression, Curves, Model};
use cloth_sim::mesh::Diagonals;
use cloth_sim::strain_measure::StrainMeasure;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::collections::BTreeMap;
use std::path::Path;

/// The file format. Version 2: notices may carry remedies.
pub const SCHEMA: Schema = Schema::new("material", &[|_| ()]);

/// Sides of a mesh's cells, m.
const MESHES: std::ops::RangeInclusive<f64> = 1e-5..=1.0;

/// The whole file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialFile {
    /// The current version of [`SCHEMA`].
    pub schema: String,
    /// The model of the curves' strain measures.
    pub model: Model,
    /// The model variant.
    #[serde(default)]
    pub variant: Variant,
    /// Behaviour of weft and warp under compression.
    pub compression: Compression,
    /// The measured sample.
    pub fabric: Fabric,
    /// Stress and strain measure of each curve, in words.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub measures: BTreeMap<Component, String>,
    /// One entry per component, observed or not.
    #[serde(deserialize_with = "unique")]
    pub curves: BTreeMap<Component, CurveEntry>,
    /// Residuals of each sequence.
    pub residuals: Vec<ResidualEntry>,
    /// Failed stages, with reasons.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<String>,
    /// Contradictions within the measurements.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notices: Vec<Notice>,
    /// Origin of the file.
    pub provenance: Provenance,
}

/// Origin of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Program and version.
    pub program: String,
    /// Constraints on the curves.
    pub constraints: Constraints,
    /// True for a fit by the published method ([`Settings::as_published`]); omitted otherwise.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub as_published: bool,
    /// Side of the cells of the mesh that the curves are for, m; omitted for curves of the continuum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub for_mesh_m: Option<f64>,
    /// Residuals above this multiple of the noise had less weight; omitted if all had full weight.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robust: Option<f64>,
    /// Split of the simulation's cells: a bending curve of hinges belongs to its triangulation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diagonals: Option<Diagonals>,
    /// Columns and rows of the simulation's grid, per sequence.
    #[serde(deserialize_with = "unique")]
    pub nodes: BTreeMap<String, [usize; 2]>,
    /// Changes after the fit, in order: repairs, and edits by hand.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<String>,
}

impl Provenance {
    /// True if the curves make up for the error of their grid, whatever the model.
    pub fn is_for_one_grid(&self) -> bool {
        self.as_published || self.for_mesh_m.is_some()
    }
}

impl MaterialFile {
    /// Collects the result of one model's fit.
    ///
    /// * `given` — the file with the curves that the fit took as known, if there was one
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
            stage => CurveEntry::new(stage, &report.notices),
        };
        let sequences = report.sequences();
        let nodes = sequences.iter().map(|(_, sequence)| (sequence.name.clone(), sequence.nodes));
        Self {
            schema: SCHEMA.id(),
            model: settings.model,
            variant: settings.variant,
            compression: settings.compression,
            fabric: set.fabric.clone(),
            measures: settings
                .model
                .components()
                .into_iter()
                .map(|c| (c, measure(settings.model, c)))
                .collect(),
            curves: settings
                .model
                .components()
                .into_iter()
                .map(|component| (component, entry(component)))
                .collect(),
            residuals: sequences
                .iter()
                .map(|(stage, sequence)| ResidualEntry::new(sequence, &stage.dropped))
                .collect(),
            failures: report.failures.iter().map(FailedStage::in_words).collect(),
            notices: report.notices.clone(),
            provenance: Provenance {
                program: concat!("fit-cloth ", env!("CARGO_PKG_VERSION")).into(),
                constraints: settings.constraints,
                as_published: settings.is_as_published(),
                for_mesh_m: settings.for_mesh,
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
    /// A file that cannot be read or is not a material file, with line and field; a side of cells that no mesh has.
    pub fn read(path: &Path) -> Result<Self> {
        let text = read_text(path)?;
        let file: Self = parse_version(path, &text, &SCHEMA)?;
        file.named_curves().map_err(|defect| defect.at(path, &text))?;
        let own = file.model.components();
        if let Some(component) = file.curves.keys().find(|component| !own.contains(component)) {
            let expected =
                format!("the components of {}: {}", file.model, own.map(|c| c.to_string()).join(", "));
            return Err(Error::input(path, None, format!("curves.{component}"), "a curve", expected));
        }
        if let Some(side) = file.provenance.for_mesh_m.filter(|side| !MESHES.contains(side)) {
            let expected = "the side of a mesh's cells, 1e-5 to 1 m";
            return Err(Error::input(path, None, "provenance.for_mesh_m", side.to_string(), expected));
        }
        Ok(file)
    }

    /// Replaces an observed curve and records it in the provenance.
    ///
    /// Deviations are dropped, since they belong to the fitted curve. Other statements on the measurement are kept
    /// only if the control points keep their strains. Components that shared the curve no longer do.
    ///
    /// * `change` — description of the change
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
        // Strings, numbers and maps with string keys only: serialisation cannot fail.
        serde_json::to_string_pretty(self).map(|text| text + "\n").unwrap_or_default()
    }

    /// The curves that were observed or given.
    ///
    /// # Errors
    /// Control points that do not form a valid curve.
    pub fn curves(&self) -> Result<Curves> {
        self.named_curves().map_err(|defect| defect.at(Path::new("material.json"), ""))
    }

    /// The stiffnesses that the fit assumed for unmeasured components: [`Basis::all_assumed`].
    pub fn assumed(&self) -> BTreeMap<Component, f64> {
        Basis::all_assumed(|component| self.curves.get(&component)?.basis.as_ref())
    }

    fn named_curves(&self) -> std::result::Result<Curves, Defect> {
        let observed = self.curves.iter().filter(|(_, entry)| entry.observed);
        observed
            .map(|(&component, entry)| {
                let negative = self.model.negative_strain(component, self.compression);
                let curve = entry.curve(self.model, component, negative);
                curve.map(|curve| (component, curve)).map_err(|(point, reason)| Defect {
                    component,
                    point,
                    reason,
                })
            })
            .collect()
    }
}

/// Stress and strain measure of a component's curve.
fn measure(model: Model, component: Component) -> String {
    let measure = model.strain_measure(component);
    let [strain, stress] = measure.names();
    let stress = stress.replace("PK2", "second Piola–Kirchhoff (PK2)");
    match measure {
        measure if measure.is_of_membrane() => format!("{stress} per width [N/m] over {strain} [1]"),
        StrainMeasure::RingTwo => {
            "stress of ring-2 springs [N/m] over their strain [1], valid for this grid only".into()
        }
        _ => format!(
            "{stress} [N] over the strain of hinges [1/m], three times the curvature: stiffness_n_m is a third of the flexural \
             rigidity, rigidity_n_m"
        ),
    }
}

/// An invalid control point.
struct Defect {
    component: Component,
    /// Counted from 0.
    point: usize,
    reason: String,
}

impl Defect {
    /// The error, with the line of the control point in the file's text.
    fn at(self, path: &Path, text: &str) -> Error {
        #[derive(Deserialize)]
        struct File<'a> {
            #[serde(borrow)]
            curves: BTreeMap<Component, Entry<'a>>,
        }
        #[derive(Deserialize)]
        struct Entry<'a> {
            #[serde(borrow, default)]
            control_points: Vec<&'a RawValue>,
        }
        let Self { component, point, reason } = self;
        let places = serde_json::from_str::<File<'_>>(text).ok();
        let place = places.as_ref().and_then(|file| file.curves.get(&component)?.control_points.get(point));
        // A raw value is a slice of the text.
        let offset = place.map(|place| place.get().as_ptr() as usize - text.as_ptr() as usize);
        let line = offset.map(|offset| 1 + text.bytes().take(offset).filter(|&byte| byte == b'\n').count());
        Error::input(path, line, format!("curves.{component}.control_points[{point}]"), reason, CURVE)
    }
}

/// Requirements on an observed curve.
const CURVE: &str = "control points at ascending strains from 0, with finite stiffnesses in the model's unit";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::incremental::{self, Stage};
    use crate::stage::Watch;
    use crate::stage::knowledge::Knowledge;
    use cloth_data::frame::Kind;
    use cloth_data::rig::Rig;
    use cloth_sim::curve::NegativeStrain;

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
                r#"{"strain":6.0,"stiffness_n_m":1e-6,"deviation_n_m":1e-8,"curvature_per_m":2.0,"rigidity_n_m":3e-6}"#,
            ),
        ] {
            let entry = entry(text).unwrap();
            assert_eq!(entry.control_points[0].unit, unit);
            assert_eq!(serde_json::to_string(&entry.control_points[0]).unwrap(), text);
            assert_eq!(Unit::of(Model::STVK, component), unit);
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
        refused(b"{\n[}", ":2 JSON: found key must be a string");
        let long = "a\\n".repeat(1000);
        refused(format!("{{\"schema\": \"{long}\"}}").as_bytes(), "schema: found \"a\\na\\n");
        let unknown = format!("{{\"schema\": \"{}\", \"{long}\": 1}}", SCHEMA.id());
        refused(unknown.as_bytes(), "…: found an unknown key");
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
            r#"{"strain":0.0,"stiffness_n_m":1.0,"rigidity_n_m":1.0}"#,
            r#"{"strain":6.0,"stiffness_n_m":1.0,"curvature_per_m":6.0}"#,
            r#"{"strain":0.0,"stiffness_n_per_m":1.0,"rigidity_n_m":3.0}"#,
        ] {
            assert!(entry(text).is_err(), "{text}");
        }
        let hinges = entry(r#"{"strain":0.0,"stiffness_n_m":1.0}"#).unwrap();
        let odd = cloth_sim::curve::NegativeStrain::Odd;
        assert!(hinges.curve(Model::STVK, Component::Shear, odd).is_err());
        assert!(hinges.curve(Model::SPRINGS, Component::BendWeft, odd).is_err());
    }

    /// Two strips of denim, made up, and their stretch curves, on coarse grids.
    fn fitted() -> MaterialFile {
        let fabric = cloth_data::rig::KnownFabric::named("cotton-denim").unwrap();
        let sequences = vec![Kind::StretchWeft, Kind::StretchWarp];
        let rig = Rig { sequences, nodes: [9, 9], measured: [5, 5], frames: 6, ..Rig::default() };
        let set = rig.measure(&fabric).unwrap();
        let settings = Settings { nodes: Some([5, 5]), variant: Variant::Isotropic, ..Settings::default() };
        let stages = [Stage::Stretch];
        let report =
            incremental::fit(&set, &stages, &Knowledge::default(), &settings, &mut Watch::default()).unwrap();
        MaterialFile::new(&set, &settings, &report, None)
    }

    #[test]
    fn what_a_fit_found_stands_in_its_file_and_comes_back() {
        let mut file = fitted();
        assert_eq!(
            (file.schema.as_str(), file.model, file.variant),
            (&*SCHEMA.id(), Model::STVK, Variant::Isotropic)
        );
        assert_eq!((file.curves.len(), file.residuals.len(), file.failures.len()), (6, 2, 0));
        let [weft, warp] = [Component::StretchWeft, Component::StretchWarp];
        let entry = &file.curves[&weft];
        assert!(entry.observed && !entry.given && entry.converged == Some(true));
        assert_eq!(entry.shared_by, [weft, warp]);
        assert!(entry.noise_n.is_some() && entry.noise_m.is_none());
        assert!(entry.control_points.iter().all(|point| point.unit == Unit::NewtonPerMetre));
        assert_eq!(file.curves[&Component::Shear], CurveEntry::default());
        let residual = &file.residuals[1];
        assert_eq!((residual.sequence.as_str(), residual.kind), ("stretch-weft", Kind::StretchWeft));
        assert!(residual.rms_force_n.unwrap() < residual.largest_force_n.unwrap());
        assert!(residual.rms_position_m.is_some() && residual.dropped_frames.is_empty());
        assert_eq!(file.provenance.nodes["stretch-warp"], [5, 5]);

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("material.json");
        std::fs::write(&path, file.to_json()).unwrap();
        assert_eq!(MaterialFile::read(&path).unwrap(), file);
        let material = crate::material::Material::read(&path).unwrap();
        assert_eq!((material.name.as_str(), material.areal_density), ("cotton-denim", 0.46));
        assert_eq!(material.curves, file.curves().unwrap());

        // Another curve: no longer shared, without deviations, and recorded in the provenance.
        let points = &file.curves[&weft].control_points;
        let strains: Vec<f64> = points.iter().map(|point| point.strain).collect();
        let stiffnesses = points.iter().map(|point| 2.0 * point.stiffness).collect();
        let curve = StiffnessCurve::new(strains, stiffnesses, NegativeStrain::Green).unwrap();
        let visited = file.curves[&weft].visited_strain;
        file.set_curve(weft, &curve, "doubled");
        let entry = &file.curves[&weft];
        assert!(entry.shared_by.is_empty() && file.curves[&warp].shared_by.is_empty());
        assert!(entry.control_points.iter().all(|point| point.deviation.is_none()));
        assert_eq!(
            (entry.visited_strain, &file.provenance.changes[..]),
            (visited, &["stretch-weft: doubled".into()][..])
        );
        assert_eq!(file.curves().unwrap().get(weft).unwrap().stiffnesses(), curve.stiffnesses());
        // With other strains, statements on the measurement no longer apply.
        file.set_curve(weft, &StiffnessCurve::constant(5.0, NegativeStrain::Green).unwrap(), "made constant");
        assert_eq!((file.curves[&weft].visited_strain, file.provenance.changes.len()), (None, 2));
    }

    #[test]
    fn what_is_no_material_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("material.json");
        let good = fitted().to_json();
        let refused = |old: &str, new: &str, words: &str| {
            assert!(good.contains(old), "{old}");
            std::fs::write(&path, good.replace(old, new)).unwrap();
            let error = MaterialFile::read(&path).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        };
        refused(
            "material/2",
            "material/9",
            "schema: found \"fit-cloth/material/9\", expected fit-cloth/material/2 or older: a newer fit-cloth wrote",
        );
        std::fs::write(&path, good.replace("material/2", "material/1")).unwrap();
        assert_eq!(MaterialFile::read(&path).unwrap(), fitted());
        refused(
            "material/2\",\n  \"model\"",
            "material/1\",\n  \"models\"",
            "material.json:3 models: found an unknown key",
        );
        refused("\"schema\"", "schema", "material.json:2 JSON: found ");
        refused("\"variant\"", "\"variants\"", "material.json:4 variants: found an unknown key");
        refused(
            "\"strain\": 0.0",
            "\"strain\": 9.0",
            "curves.stretch-weft.control_points[0]: found the first strain must be zero",
        );
        let unit = "stiffness_n_m instead of stiffness_n_per_m";
        refused(
            "\"stiffness_n_per_m\"",
            "\"stiffness_n_m\"",
            "found no stiffness, or two, expected stiffness_n_per_m",
        );
        let mut file = fitted();
        let points = &mut file.curves.get_mut(&Component::StretchWeft).unwrap().control_points;
        points.iter_mut().for_each(|point| point.unit = Unit::NewtonMetre);
        assert!(file.curves().unwrap_err().to_string().contains(unit));
    }
}
