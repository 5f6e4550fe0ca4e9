//! The curves that `check` and `curve` work on: those of a `material.json`, or a table of one curve.

use cloth_data::curve_file::{CurveFile, columns};
use cloth_data::error::{Error, Result};
use cloth_fit::material::check::context;
use cloth_fit::material::file::MaterialFile;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::curve::soundness::{Context, Finding, check};
use cloth_sim::material::{Component, Compression, Model};
use std::path::Path;

/// The file that curves were read from, to be written back in the same format.
#[derive(Debug, Clone)]
pub enum Source {
    /// A material file with all curves of a fit.
    Material(Box<MaterialFile>),
    /// A table of one curve.
    Table(CurveFile),
}

/// A curve of a file, with the units of that file.
#[derive(Debug, Clone)]
pub struct FileCurve {
    /// Component of the curve; of a table it matters only for rows below zero.
    pub component: Component,
    /// Name in messages: the component, or the file name of a table.
    pub name: String,
    /// The curve.
    pub curve: StiffnessCurve,
    /// Plausible stiffnesses and visited range that it is checked against.
    pub context: Context,
    /// Strain of the model per unit of the file's strain: 3 for a table over curvature, else 1.
    pub strain_per_unit: f64,
    /// Name and unit of the file's strain.
    pub axis: &'static str,
    /// Unit of the stresses.
    pub unit: &'static str,
}

impl FileCurve {
    /// All findings of the check.
    pub fn findings(&self) -> Vec<Finding> {
        check(&self.curve, &self.context)
    }
}

/// Reads a `material.json`, recognised by its extension, or a table.
///
/// * `component` — selects a curve of a material; component of a table
/// * `model` — model whose strain measure a table uses; `None` to infer it from the columns
///
/// # Errors
/// A bad file; a component that the file lacks; a table with rows below zero and no component.
pub fn read(
    path: &Path,
    component: Option<Component>,
    model: Option<Model>,
) -> Result<(Source, Vec<FileCurve>)> {
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json")) {
        return read_material(path, component);
    }
    let file = CurveFile::read(path)?;
    let component = match (component, file.measure) {
        (Some(component), _) => component,
        (None, None) if file.is_two_sided() => {
            let expected = "--component, since stretch and shear read rows below zero differently";
            return Err(Error::input(path, None, columns(file.measure)[0], "rows below zero", expected));
        }
        (None, _) => file.typical().0,
    };
    let model = model.unwrap_or(file.typical().1);
    let curve = file.curve(component, model, model.negative_strain(component, Compression::ZeroStrain))?;
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let (axis, unit) = match file.measure {
        None => ("strain", "N/m"),
        Some(measure) if measure.is_per_metre() => ("curvature [1/m]", "N"),
        Some(measure) => (measure.names()[0], "N/m"),
    };
    let context = context(model, component, None);
    let subject =
        FileCurve { component, name, curve, context, strain_per_unit: file.strain_per_unit(), axis, unit };
    Ok((Source::Table(file), vec![subject]))
}

fn read_material(path: &Path, wanted: Option<Component>) -> Result<(Source, Vec<FileCurve>)> {
    let file = MaterialFile::read(path)?;
    let curves = file.curves()?;
    let components = curves.components().filter(|component| wanted.is_none_or(|wanted| wanted == *component));
    let subjects: Vec<FileCurve> = components
        .filter_map(|component| {
            let hinges = file.model.strain_measure(component).is_per_metre();
            Some(FileCurve {
                component,
                name: component.to_string(),
                curve: curves.get(component)?.clone(),
                context: context(file.model, component, file.curves[&component].visited_strain),
                strain_per_unit: 1.0,
                axis: if hinges { "strain [1/m]" } else { "strain" },
                unit: if hinges { "N" } else { "N/m" },
            })
        })
        .collect();
    if subjects.is_empty() {
        let found = wanted.map_or("no observed curve".into(), |wanted| format!("no curve of {wanted}"));
        return Err(Error::input(path, None, "curves", found, "a component with control points"));
    }
    Ok((Source::Material(Box::new(file)), subjects))
}
