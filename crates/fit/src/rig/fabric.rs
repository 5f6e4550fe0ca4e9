//! A fabric whose curves are known: what the rig measures.

use crate::error::{Error, Result};
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::material::{Component, Compression, Curves, Model};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// A known fabric: `fixtures/fabrics/*.toml`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KnownFabric {
    /// Name.
    pub name: String,
    /// Weft extent of the specimen, m.
    pub width_m: f64,
    /// Warp extent of the specimen, m.
    pub height_m: f64,
    /// Mass per area, kg/m².
    pub areal_density_kg_m2: f64,
    /// The model whose strains the curves are over.
    pub model: Model,
    /// Where its figures come from.
    #[serde(default)]
    pub notes: Option<String>,
    /// How far each stretch test pulls, as a share of the length.
    pub largest_extension: BTreeMap<Component, f64>,
    /// Control points of its curves.
    pub curves: BTreeMap<Component, ControlPoints>,
}

/// Control points of a stiffness curve.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControlPoints {
    /// Strains, ascending from 0.
    pub strain: Vec<f64>,
    /// Stiffnesses, N/m.
    pub stiffness_n_per_m: Vec<f64>,
}

impl KnownFabric {
    /// Reads a fabric from the text of its file.
    ///
    /// # Errors
    /// Text that is no such file, with its place.
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        toml::from_str(text).map_err(|error| {
            let line = error.span().map(|span| text[..span.start.min(text.len())].matches('\n').count() + 1);
            Error::input(
                path,
                line,
                "fabric",
                error.message().trim(),
                "name, width_m, height_m, areal_density_kg_m2, model, [largest_extension] and [curves.…]",
            )
        })
    }

    /// The curves, checked.
    ///
    /// # Errors
    /// Control points that make no curve; a missing stretch curve.
    pub fn curves(&self) -> Result<Curves> {
        for needed in [Component::StretchWeft, Component::StretchWarp] {
            if !self.curves.contains_key(&needed) {
                return Err(Error::Setting {
                    field: "curves",
                    found: format!("no {needed}"),
                    expected: "stretch-weft and stretch-warp".into(),
                });
            }
        }
        self.curves
            .iter()
            .map(|(&component, points)| {
                let negative = self.model.negative_strain(component, Compression::ZeroStrain);
                StiffnessCurve::new(points.strain.clone(), points.stiffness_n_per_m.clone(), negative)
                    .map(|curve| (component, curve))
                    .map_err(|source| Error::Mechanics {
                        context: format!("{}, {component}", self.name),
                        source,
                    })
            })
            .collect()
    }

    /// How far a stretch test pulls.
    ///
    /// # Errors
    /// None given, or not positive.
    pub fn largest_extension(&self, component: Component) -> Result<f64> {
        match self.largest_extension.get(&component) {
            Some(&share) if share > 0.0 && share <= 3.0 => Ok(share),
            other => Err(Error::Setting {
                field: "largest_extension",
                found: format!("{component} = {other:?}"),
                expected: "a share of the length between 0 and 3".into(),
            }),
        }
    }
}
