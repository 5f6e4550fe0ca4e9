//! Fabrics with known curves, the input of the rig.

use crate::error::{Error, Result};
use crate::io::TomlFile;
use crate::points::Points;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::material::{Component, Compression, Curves, Model};
use cloth_sim::strain_measure::HINGE_STRAIN_PER_CURVATURE;
use serde::Deserialize;
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
    /// Model of the strains; springs are excluded, because their bending curve cannot be stated in curvatures.
    pub model: Model,
    /// Origin of the values.
    #[serde(default)]
    pub notes: Option<String>,
    /// Largest extension of each stretch test.
    pub largest_extension: LargestExtension,
    /// Largest shear angle of the picture frame, rad.
    pub largest_shear_rad: f64,
    /// First and last overhang on the table, m.
    pub overhang_m: [f64; 2],
    /// Shift of opposite edges along each other in the complex shear test, m.
    pub complex_shear_m: f64,
    /// Distance by which opposite corners are pulled apart, m.
    pub corner_pull_m: f64,
    /// Ratio of loading to unloading force at the same position.
    pub loading_ratio: f64,
    /// Standard deviation of the logarithm of the curve factor between samples of the fabric.
    pub sample_scatter: f64,
    /// Control points of the curves.
    pub curves: KnownCurves,
}

/// Largest extensions of the stretch tests, relative to the length.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct LargestExtension {
    /// Along weft.
    pub stretch_weft: f64,
    /// Along warp.
    pub stretch_warp: f64,
}

/// The six curves of a known fabric.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct KnownCurves {
    /// Stretch along weft.
    pub stretch_weft: MembranePoints,
    /// Stretch along warp.
    pub stretch_warp: MembranePoints,
    /// Shear between the yarns.
    pub shear: MembranePoints,
    /// Bending along weft.
    pub bend_weft: BendingPoints,
    /// Bending along warp.
    pub bend_warp: BendingPoints,
    /// Bending along the diagonals.
    pub bend_diagonal: BendingPoints,
}

/// Control points of a membrane curve.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MembranePoints {
    /// Strains of the fabric's model, ascending from 0.
    pub strain: Vec<f64>,
    /// Stiffnesses, N/m.
    pub stiffness_n_per_m: Vec<f64>,
}

/// Control points of a bending curve, in physical units.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BendingPoints {
    /// Curvatures, 1/m, ascending from 0.
    pub curvature_per_m: Vec<f64>,
    /// Flexural rigidities: moment per width over curvature, N·m.
    pub rigidity_n_m: Vec<f64>,
}

impl KnownCurves {
    /// The three membrane curves.
    pub fn membrane(&self) -> [(Component, &MembranePoints); 3] {
        [
            (Component::StretchWeft, &self.stretch_weft),
            (Component::StretchWarp, &self.stretch_warp),
            (Component::Shear, &self.shear),
        ]
    }

    /// The three bending curves.
    pub fn bending(&self) -> [(Component, &BendingPoints); 3] {
        [
            (Component::BendWeft, &self.bend_weft),
            (Component::BendWarp, &self.bend_warp),
            (Component::BendDiagonal, &self.bend_diagonal),
        ]
    }

    /// Control values of each curve, in its own unit.
    pub(super) fn values_mut(&mut self) -> [(Component, &mut Vec<f64>); 6] {
        [
            (Component::StretchWeft, &mut self.stretch_weft.stiffness_n_per_m),
            (Component::StretchWarp, &mut self.stretch_warp.stiffness_n_per_m),
            (Component::Shear, &mut self.shear.stiffness_n_per_m),
            (Component::BendWeft, &mut self.bend_weft.rigidity_n_m),
            (Component::BendWarp, &mut self.bend_warp.rigidity_n_m),
            (Component::BendDiagonal, &mut self.bend_diagonal.rigidity_n_m),
        ]
    }
}

/// The built-in fabrics and their files, which `fixtures/fabrics` holds too.
const BUILT_IN: [(&str, &str); 4] = [
    ("cotton-denim", include_str!("../../fabrics/cotton-denim.toml")),
    ("cotton-satin", include_str!("../../fabrics/cotton-satin.toml")),
    ("rayon-spandex-knit", include_str!("../../fabrics/rayon-spandex-knit.toml")),
    ("wool-cotton", include_str!("../../fabrics/wool-cotton.toml")),
];

impl KnownFabric {
    /// Names of the built-in fabrics.
    pub fn names() -> impl Iterator<Item = &'static str> {
        BUILT_IN.into_iter().map(|(name, _)| name)
    }

    /// A built-in fabric.
    ///
    /// # Errors
    /// A name that is not built in.
    pub fn named(name: &str) -> Result<Self> {
        let Some((_, text)) = BUILT_IN.into_iter().find(|(known, _)| *known == name) else {
            let expected = format!("one of {}", Self::names().collect::<Vec<_>>().join(", "));
            return Err(Error::Setting { field: "fabric", found: name.into(), expected });
        };
        Self::parse(Path::new(name), text)
    }

    /// Reads a fabric file.
    ///
    /// # Errors
    /// As [`KnownFabric::parse`]; an unreadable file.
    pub fn read(path: &Path) -> Result<Self> {
        Self::of(&TomlFile::read(path)?)
    }

    /// Parses the text of a fabric file.
    ///
    /// # Errors
    /// A text that is not a fabric file, or a value that no fabric or test can have, with its line.
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        Self::of(&TomlFile::of(path, text.to_string()))
    }

    /// The fabric described by a file.
    pub fn of(file: &TomlFile) -> Result<Self> {
        let fabric: Self = file.value()?;
        fabric.check(file)?;
        Ok(fabric)
    }

    /// The curves over the strain of the model's elements, checked.
    ///
    /// # Errors
    /// Control points that do not form a curve.
    pub fn curves(&self) -> Result<Curves> {
        let membrane = self
            .curves
            .membrane()
            .map(|(component, points)| (component, points.strain.clone(), points.stiffness_n_per_m.clone()));
        let scaled =
            |values: &[f64], factor: f64| -> Vec<f64> { values.iter().map(|v| v * factor).collect() };
        let bending = self.curves.bending().map(|(component, points)| {
            let strains = scaled(&points.curvature_per_m, HINGE_STRAIN_PER_CURVATURE);
            (component, strains, scaled(&points.rigidity_n_m, 1.0 / HINGE_STRAIN_PER_CURVATURE))
        });
        let curve = |(component, strains, stiffnesses)| {
            let negative = self.model.negative_strain(component, Compression::ZeroStrain);
            let context = || format!("{}, {component}", self.name);
            StiffnessCurve::new(strains, stiffnesses, negative)
                .map(|curve| (component, curve))
                .map_err(|source| Error::Mechanics { context: context(), source })
        };
        membrane.into_iter().chain(bending).map(curve).collect()
    }

    fn check(&self, file: &TomlFile) -> Result<()> {
        if self.name.trim().is_empty() {
            return Err(file.invalid("name", "nothing", "the fabric's name"));
        }
        if self.model.is_of_springs() {
            let hinged: Vec<&str> =
                Model::ALL.iter().filter(|model| !model.is_of_springs()).map(|model| model.name()).collect();
            let expected = format!("{}, whose hinges bend", hinged.join(" or "));
            return Err(file.invalid("model", "springs", expected));
        }
        let [first, last] = self.overhang_m;
        if file.has("overhang_m[2]") || !(0.0 < first && first < last) {
            let found = format!("{:?}", self.overhang_m);
            return Err(file.invalid(
                "overhang_m",
                found,
                "a first overhang above 0 and a last one above it",
            ));
        }
        let side = self.width_m.min(self.height_m);
        for (key, value, most) in [
            ("width_m", self.width_m, 10.0),
            ("height_m", self.height_m, 10.0),
            ("areal_density_kg_m2", self.areal_density_kg_m2, 10.0),
            ("largest_extension.stretch-weft", self.largest_extension.stretch_weft, 3.0),
            ("largest_extension.stretch-warp", self.largest_extension.stretch_warp, 3.0),
            ("largest_shear_rad", self.largest_shear_rad, 1.2),
            ("overhang_m[1]", last, 0.95 * side),
            ("complex_shear_m", self.complex_shear_m, side),
            ("corner_pull_m", self.corner_pull_m, side),
            ("loading_ratio", self.loading_ratio, 10.0),
            ("sample_scatter", self.sample_scatter, 1.0),
        ] {
            if !(value > 0.0 && value <= most) {
                let metres = match key.ends_with("_m") {
                    true if value > most => " m (millimetres or centimetres?)",
                    true => " m",
                    false => "",
                };
                let expected = format!("above 0 and at most {most}{metres}");
                return Err(file.invalid(key, value.to_string(), expected));
            }
        }
        let points = |component: Component, places, values, strain_per_unit| {
            let negative = self.model.negative_strain(component, Compression::ZeroStrain);
            let table = format!("curves.{component}");
            Points { table, places, values, strain_per_unit }.curve(negative, file).map(|_| ())
        };
        for (component, MembranePoints { strain, stiffness_n_per_m }) in self.curves.membrane() {
            points(component, ("strain", strain), ("stiffness_n_per_m", stiffness_n_per_m), 1.0)?;
        }
        for (component, BendingPoints { curvature_per_m, rigidity_n_m }) in self.curves.bending() {
            let places = ("curvature_per_m", &curvature_per_m[..]);
            points(component, places, ("rigidity_n_m", rigidity_n_m), HINGE_STRAIN_PER_CURVATURE)?;
        }
        Ok(())
    }
}
