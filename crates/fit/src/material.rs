//! A material to simulate: from a fit, from a known fabric, or written by hand.

pub mod bending;
pub mod check;
pub mod file;
mod hand_written;

use crate::material::file::MaterialFile;
use cloth_data::error::{Error, Result};
use cloth_data::io::TomlFile;
use cloth_data::rig::KnownFabric;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::material::{Component, Compression, Curves, Model};
use hand_written::HandWritten;
use std::path::Path;

/// A fabric as a simulation needs it.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name of the fabric.
    pub name: String,
    /// kg/m².
    pub areal_density: f64,
    /// The model of the curves' strain measures.
    pub model: Model,
    /// Behaviour of weft and warp under compression.
    pub compression: Compression,
    /// The curves; a component without one stores no energy.
    pub curves: Curves,
    /// Side of the cells of the mesh that the curves are for, m; `None` for curves of the continuum.
    pub for_mesh: Option<f64>,
}

impl Material {
    /// Reads `material.json` of a fit, a fabric of the virtual rig, or a hand-written material: docs/formats.md.
    ///
    /// # Errors
    /// A file that is none of these, with line and key; invalid curves.
    pub fn read(path: &Path) -> Result<Self> {
        if path.extension().is_some_and(|ending| ending == "json") {
            let file = MaterialFile::read(path)?;
            let curves = file.curves()?;
            let MaterialFile { model, compression, fabric, provenance, .. } = file;
            return Ok(Self {
                name: fabric.name,
                areal_density: fabric.areal_density_kg_m2,
                model,
                compression,
                curves,
                for_mesh: provenance.for_mesh_m,
            });
        }
        let file = TomlFile::read(path)?;
        // Only a fabric of the rig states the largest extension of its tests.
        if file.has("largest_extension") {
            let fabric = KnownFabric::of(&file)?;
            let curves = fabric.curves()?;
            return Ok(Self {
                name: fabric.name,
                areal_density: fabric.areal_density_kg_m2,
                model: fabric.model,
                compression: Compression::ZeroStrain,
                curves,
                for_mesh: None,
            });
        }
        let written = file.value::<HandWritten>()?;
        let curves = written.curves(path, &file)?;
        let model = written.model();
        let HandWritten { name, areal_density_kg_m2: areal_density, compression, .. } = written;
        Ok(Self { name, areal_density, model, compression, curves, for_mesh: None })
    }

    /// Copies the material with another rule for compression.
    ///
    /// # Errors
    /// None, if the material's curves are valid.
    pub fn with_compression(self, compression: Compression) -> Result<Self> {
        let Self { name, areal_density, model, curves, for_mesh, .. } = self;
        let curve = |component: Component| {
            let curve = curves.get(component)?;
            let negative = model.negative_strain(component, compression);
            let curve = StiffnessCurve::new(curve.strains().to_vec(), curve.stiffnesses().to_vec(), negative);
            let context = || format!("{name}, {component}");
            Some(match curve {
                Ok(curve) => Ok((component, curve)),
                Err(source) => Err(Error::Mechanics { context: context(), source }),
            })
        };
        let curves = Component::ALL.into_iter().filter_map(curve).collect::<Result<Curves>>()?;
        Ok(Self { name, areal_density, model, compression, curves, for_mesh })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Material> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cloth.toml");
        std::fs::write(&path, text).unwrap();
        Material::read(&path)
    }

    const SHEAR: &str = "[curves.shear]\nstiffness_n_per_m = 1\n";

    const HEAD: &str = "name = \"cloth\"\nareal_density_kg_m2 = 0.2\nmodel = \"stvk\"\n";

    #[test]
    fn constants_and_control_points_and_nothing_for_what_is_not_named() {
        let curves = "[curves.stretch-weft]\nstiffness_n_per_m = 800\n\
                      [curves.bend-weft]\nrigidity_n_m = 3e-5\n\
                      [curves.bend-warp]\ncurvature_per_m = [0.0, 20.0]\nrigidity_n_m = [3e-5, 1.5e-5]\n";
        let cloth = read(&format!("{HEAD}{curves}")).unwrap();
        assert_eq!((cloth.model, cloth.compression), (Model::STVK, Compression::ZeroStrain));
        let of = |component| cloth.curves.get(component);
        assert_eq!(of(Component::StretchWeft).unwrap().stiffnesses(), [800.0]);
        // The hinges' strain is three times the curvature, their stiffness a third of the rigidity.
        let near = |found: &[f64], expected: &[f64]| {
            found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-18)
        };
        assert!(near(of(Component::BendWeft).unwrap().stiffnesses(), &[1e-5]));
        assert_eq!(of(Component::BendWarp).unwrap().strains(), [0.0, 60.0]);
        assert!(near(of(Component::BendWarp).unwrap().stiffnesses(), &[1e-5, 0.5e-5]));
        assert!(of(Component::Shear).is_none() && of(Component::StretchWarp).is_none());
        let slack = cloth.clone().with_compression(Compression::None).unwrap();
        assert_eq!(slack.curves.get(Component::StretchWeft).unwrap().stress(-0.1), 0.0);
        assert!(of(Component::StretchWeft).unwrap().stress(-0.1) < 0.0);
    }

    #[test]
    fn a_curve_may_stand_in_a_table_beside_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let [table, path] = ["shear.csv", "cloth.toml"].map(|name| folder.path().join(name));
        std::fs::write(table, "strain,stress_n_per_m\n0,0\n0.1,3\n0.2,6\n").unwrap();
        let write = |curve: &str| std::fs::write(&path, format!("{HEAD}[curves.shear]\n{curve}")).unwrap();
        write("file = \"shear.csv\"\n");
        let cloth = Material::read(&path).unwrap();
        assert!((cloth.curves.get(Component::Shear).unwrap().stress(-0.15) + 4.5).abs() < 1e-12);
        write("file = \"shear.csv\"\nstiffness_n_per_m = 3\n");
        let error = Material::read(&path).unwrap_err().to_string();
        assert!(error.contains("cloth.toml:6 ") && error.contains("beside file"), "{error}");
        write("file = \"nothing.csv\"\n");
        assert!(Material::read(&path).unwrap_err().to_string().contains("nothing.csv"));
        write("file = \"not\\nhing.csv\"\n");
        assert!(
            Material::read(&path).unwrap_err().to_string().contains("/not\\nhing.csv file: found nothing")
        );
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let refused = |text: &str, line: usize, words: &str| {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(&format!("cloth.toml:{line} ")) && error.contains(words), "{error}");
        };
        let with = |text: &str| format!("{HEAD}{text}");
        refused(&with("[curves.shear]\nstiffnes_n_per_m = 1\n"), 5, "stiffnes_n_per_m");
        refused(&with("[curves.shaer]\nstiffness_n_per_m = 1\n"), 4, "shaer");
        refused(&with("[curves.shear]\nrigidity_n_m = 1\n"), 5, "stiffness_n_per_m");
        refused(&with("[curves.bend-warp]\nstiffness_n_per_m = 1\n"), 5, "rigidity_n_m");
        refused(&with("[curves.shear]\nstrain = [0.0, 0.1]\nstiffness_n_per_m = [1.0]\n"), 5, "2 strains");
        refused(&with("[curves.shear]\nstrain = [0.1, 0.0]\nstiffness_n_per_m = [1.0, 2.0]\n"), 5, "shear");
        refused(&with("[curves.shear]\nstiffness_n_per_m = nan\n"), 5, "finite");
        refused(&with("[curves.shear]\nstiffness_n_per_m = \"soft\"\n"), 5, "a number");
        refused(&with(SHEAR).replace("0.2", "200"), 2, "0 and at most 10");
        refused(&with("[curves.shear]\nstrain = [0.0]\n"), 4, "found nothing, expected stiffness_n_per_m");
        refused(
            &with("[curves.shear]\nstiffness_n_per_m = [1, 2]\n"),
            5,
            "nothing for 2 values, expected strain",
        );
        refused(&with(SHEAR).replace("\"cloth\"", "\" \""), 1, "the material's name");
        let error = read(&with("[curves]\n")).unwrap_err().to_string();
        assert!(
            error.ends_with("curves: found nothing, expected the curve of at least one component"),
            "{error}"
        );
        let error = read(HEAD).unwrap_err().to_string();
        assert!(error.contains("curves"), "{error}");
    }

    #[test]
    fn fabrics_of_the_rig_are_materials_too() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/fabrics/cotton-denim.toml");
        let denim = Material::read(&path).unwrap();
        assert_eq!((denim.name.as_str(), denim.areal_density), ("cotton-denim", 0.46));
        assert_eq!(denim.curves.components().count(), 6);
    }
}
