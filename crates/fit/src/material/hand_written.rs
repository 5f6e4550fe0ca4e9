//! A hand-written material in TOML.

use cloth_data::curve_file::CurveFile;
use cloth_data::error::{Error, Result};
use cloth_data::io::TomlFile;
use cloth_data::points::Points as ControlPoints;
use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use cloth_sim::material::{BendingModel, Component, Compression, Curves, Model};
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, de};
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

/// The file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct HandWritten {
    pub(super) name: String,
    pub(super) areal_density_kg_m2: f64,
    model: Model,
    #[serde(default)]
    pub(super) compression: Compression,
    #[serde(default, rename = "notes")]
    _notes: Option<String>,
    curves: BTreeMap<Component, Points>,
}

/// A curve: a constant, control points, or a table beside the file.
#[derive(Debug, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a table: { stiffness_n_per_m = … }, of bending { rigidity_n_m = … }, or { file = \"….csv\" }"
)]
struct Points {
    #[serde(default)]
    strain: Option<Vec<f64>>,
    #[serde(default)]
    stiffness_n_per_m: Option<Numbers>,
    #[serde(default)]
    curvature_per_m: Option<Vec<f64>>,
    #[serde(default)]
    rigidity_n_m: Option<Numbers>,
    #[serde(default)]
    file: Option<PathBuf>,
}

impl HandWritten {
    /// Membrane and bending: a material with twist bends as a sheet.
    pub(super) fn model(&self) -> Model {
        let twists = self.curves.contains_key(&Component::BendTwist);
        if twists { self.model.with(BendingModel::Sheet) } else { self.model }
    }

    /// The curves of the file, validated.
    pub(super) fn curves(&self, path: &Path, file: &TomlFile) -> Result<Curves> {
        let Self { name, areal_density_kg_m2: density, compression, curves, .. } = self;
        let model = self.model();
        let foreign = curves.keys().find(|component| !model.components().contains(component));
        if let Some(component) = foreign {
            let expected = "bend-twist of a sheet, or bend-diagonal of hinges";
            return Err(file.invalid(
                &format!("curves.{component}"),
                "both bend-twist and bend-diagonal",
                expected,
            ));
        }
        if name.trim().is_empty() {
            return Err(file.invalid("name", "nothing", "the material's name"));
        }
        if !(*density > 0.0 && *density <= 10.0) {
            let expected = "kilograms per square metre, above 0 and at most 10";
            return Err(file.invalid("areal_density_kg_m2", density.to_string(), expected));
        }
        if curves.is_empty() {
            return Err(Error::input(path, None, "curves", "nothing", "the curve of at least one component"));
        }
        let curves = curves.iter().map(|(&component, points)| {
            let negative = model.negative_strain(component, *compression);
            if let Some(table) = points.table(component, file)? {
                let table = path.parent().unwrap_or(Path::new("")).join(table);
                return Ok((component, CurveFile::read(&table)?.curve(component, model, negative)?));
            }
            Ok((component, points.curve(model, component, negative, file)?))
        });
        curves.collect()
    }
}

impl Points {
    /// The file of the curve's table, if the curve is given as one.
    fn table(&self, component: Component, file: &TomlFile) -> Result<Option<&Path>> {
        let Some(table) = &self.file else { return Ok(None) };
        let others = [
            ("strain", self.strain.is_some()),
            ("stiffness_n_per_m", self.stiffness_n_per_m.is_some()),
            ("curvature_per_m", self.curvature_per_m.is_some()),
            ("rigidity_n_m", self.rigidity_n_m.is_some()),
        ];
        match others.into_iter().find(|(_, given)| *given) {
            Some((name, _)) => {
                let key = format!("curves.{component}.{name}");
                Err(file.invalid(&key, format!("{name} beside file"), "one of them"))
            }
            None => Ok(Some(table)),
        }
    }

    /// The curve over the model's own strain.
    fn curve(
        &self,
        model: Model,
        component: Component,
        negative: NegativeStrain,
        file: &TomlFile,
    ) -> Result<StiffnessCurve> {
        // Bending springs have a dimensionless strain of their own; its relation to curvature depends on the mesh.
        let measure = model.strain_measure(component);
        let hinge = measure.is_per_metre();
        let (places, values) = ((&self.strain, "strain"), (&self.stiffness_n_per_m, "stiffness_n_per_m"));
        let (physical_places, physical_values) =
            ((&self.curvature_per_m, "curvature_per_m"), (&self.rigidity_n_m, "rigidity_n_m"));
        let (places, values, other_places, other_values) = match hinge {
            true => (physical_places, physical_values, places, values),
            false => (places, values, physical_places, physical_values),
        };
        let key = |name: &str| format!("curves.{component}.{name}");
        for (given, name, instead) in [
            (other_places.0.is_some(), other_places.1, places.1),
            (other_values.0.is_some(), other_values.1, values.1),
        ] {
            if given {
                return Err(file.invalid(&key(name), name, format!("{instead}, for {component} of {model}")));
            }
        }
        let Some(Numbers(stiffnesses)) = values.0 else {
            return Err(file.invalid(&format!("curves.{component}"), "nothing", values.1));
        };
        let strains = match places.0 {
            Some(strains) => strains,
            None if stiffnesses.len() == 1 => &vec![0.0],
            None => {
                let found = format!("nothing for {} values", stiffnesses.len());
                return Err(file.invalid(&key(values.1), found, places.1));
            }
        };
        let points = ControlPoints {
            table: format!("curves.{component}"),
            places: (places.1, strains),
            values: (values.1, stiffnesses),
            strain_per_unit: measure.strain_per_unit(),
        };
        points.curve(negative, file)
    }
}

/// A number, or a list of numbers.
#[derive(Debug)]
struct Numbers(Vec<f64>);

impl<'de> Deserialize<'de> for Numbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_any(NumbersVisitor)
    }
}

struct NumbersVisitor;

impl<'de> Visitor<'de> for NumbersVisitor {
    type Value = Numbers;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or a list of numbers")
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> std::result::Result<Numbers, E> {
        Ok(Numbers(vec![value]))
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> std::result::Result<Numbers, E> {
        Ok(Numbers(vec![value as f64]))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> std::result::Result<Numbers, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = sequence.next_element()? {
            values.push(value);
        }
        Ok(Numbers(values))
    }
}
