//! What `check` and `curve` work on: the curves of a `material.json`, or a table of one curve.

use cloth_data::curve_file::{CurveFile, columns};
use cloth_data::error::{Error, Result};
use cloth_fit::material::check::context;
use cloth_fit::material::file::MaterialFile;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::curve::soundness::{Context, Finding, check};
use cloth_sim::material::{Component, Compression, Model};
use std::path::Path;

/// Where curves came from, and go back to.
#[derive(Debug, Clone)]
pub enum Source {
    /// All curves of a fit.
    Material(Box<MaterialFile>),
    /// One curve.
    Table(CurveFile),
}

/// A curve of a file.
#[derive(Debug, Clone)]
pub struct Subject {
    /// Its component; of a table, where that matters.
    pub component: Component,
    /// What to call it.
    pub name: String,
    /// The curve.
    pub curve: StiffnessCurve,
    /// What it is checked against.
    pub context: Context,
    /// The model's strain over the file's: 3 for a table over curvature, else 1.
    pub strain_per_unit: f64,
    /// What the file calls the strain, with its unit.
    pub axis: &'static str,
    /// The unit of its stresses.
    pub unit: &'static str,
}

impl Subject {
    /// All that is to be said of it.
    pub fn findings(&self) -> Vec<Finding> {
        check(&self.curve, &self.context)
    }
}

/// Reads a `material.json`, known by its ending, or a table.
///
/// * `component` — the one that is wanted of a material, or that a table is of
/// * `model` — whose strains a table is over; `None` for what its columns say
///
/// # Errors
/// A bad file; a component that it does not have; a table with rows below zero without a component.
pub fn read(
    path: &Path,
    component: Option<Component>,
    model: Option<Model>,
) -> Result<(Source, Vec<Subject>)> {
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
        Subject { component, name, curve, context, strain_per_unit: file.strain_per_unit(), axis, unit };
    Ok((Source::Table(file), vec![subject]))
}

fn read_material(path: &Path, wanted: Option<Component>) -> Result<(Source, Vec<Subject>)> {
    let file = MaterialFile::read(path)?;
    let curves = file.curves()?;
    let components = curves.components().filter(|component| wanted.is_none_or(|wanted| wanted == *component));
    let subjects: Vec<Subject> = components
        .filter_map(|component| {
            let hinges = file.model.strain_measure(component).is_per_metre();
            Some(Subject {
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
