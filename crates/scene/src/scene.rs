//! Scenes: a sheet, its holds, the surrounding air, and the settings of the motion. Only the parts that a scene names
//! are assembled.

mod array;
mod file;
mod hold;
mod motion;
mod sheet;
mod start;
#[cfg(test)]
mod tests;

pub use file::ShapeMeasure;
pub use hold::Circle;
pub use start::normal;

use array::vector;
use cloth_data::error::{Error, Result};
use cloth_data::io::TomlFile;
use cloth_fit::material::Material;
use cloth_sim::cloth::{Cloth, Problem, Rest};
use cloth_sim::dynamics;
use cloth_sim::error::Error as Defect;
use cloth_sim::load::{Guided, Held};
use cloth_sim::material::Component;
use cloth_sim::mesh::Mesh;
use file::SceneFile;
use nalgebra::Vector3;
use std::path::Path;

/// A prepared scene.
pub struct Scene {
    /// Its name.
    pub name: String,
    /// Origin of all coordinates here, in the scene file's coordinates, m: at the sheet if that is far from zero,
    /// otherwise zero.
    pub origin: Vector3<f64>,
    /// The sheet at rest, in its initial position.
    pub mesh: Mesh,
    /// Its shape without bending moments.
    pub rest: Rest,
    /// Gravity, m/s².
    pub gravity: Vector3<f64>,
    /// Components that store energy; `None` for all that the material has.
    pub components: Option<Vec<Component>>,
    /// Held nodes; every hold is a clip, in file order.
    pub held: Vec<Held>,
    /// Nodes that may move in some directions only.
    pub guided: Vec<Guided>,
    /// The circle on a support, if it is the only hold.
    pub support: Option<Circle>,
    /// Positions of the nodes at the start, 3 per node, m.
    pub start: Vec<f64>,
    /// Measurement at the end.
    pub measure: Option<ShapeMeasure>,
    /// Duration, s; `None` if the scene ends at rest only.
    pub duration: Option<f64>,
    /// Recorded shapes per second of motion, 1/s.
    pub frames_per_second: f64,
    /// Step, integrator, damping, wind.
    pub dynamics: dynamics::Settings,
    file: TomlFile,
}

impl Scene {
    /// Reads a scene; files named in it are relative to its folder.
    ///
    /// # Errors
    /// A file that is not a valid scene, with line and key.
    pub fn read(path: &Path) -> Result<Self> {
        let file = TomlFile::read(path)?;
        let scene: SceneFile = file.value()?;
        if scene.name.trim().is_empty() {
            return Err(file.invalid("name", "nothing", "the scene's name"));
        }
        let mut mesh = sheet::mesh(&scene.sheet, path, &file)?;
        let origin = sheet::origin(&mesh);
        mesh.positions.iter_mut().for_each(|position| *position -= origin);
        let hold::Holds { held, guided, support } = hold::holds(&scene.held, &mesh, &file)?;
        let gravity = vector(&file, "gravity_m_s2", scene.gravity_m_s2)?;
        let positive = |key: &str, value: f64| match value > 0.0 && value.is_finite() {
            true => Ok(value),
            false => Err(file.invalid(key, value.to_string(), "a number above 0")),
        };
        let duration = scene.duration_s.map(|duration| positive("duration_s", duration)).transpose()?;
        let step = positive("step_s", scene.step_s)?;
        let frames_per_second = positive("frames_per_s", scene.frames_per_s)?;
        let dynamics = motion::settings(step, &scene.solver, &scene.damping, scene.wind.as_ref(), &file)?;
        let start = start::perturbed(&mesh, &held, &guided, scene.start.perturbation_m, &file)?;
        if scene.measure == Some(ShapeMeasure::DrapeCoefficient) && support.is_none() {
            let expected = "droop, or one [[held]] circle and nothing else: the support of the drape";
            return Err(file.invalid("measure", "drape-coefficient", expected));
        }
        if scene.measure == Some(ShapeMeasure::Droop) && held.is_empty() {
            return Err(file.invalid("measure", "droop", "a sheet with [[held]] nodes"));
        }
        Ok(Self {
            name: scene.name,
            origin,
            mesh,
            rest: scene.sheet.rest,
            gravity,
            components: scene.components,
            held,
            guided,
            support,
            start,
            measure: scene.measure,
            duration,
            frames_per_second,
            dynamics,
            file,
        })
    }

    /// Components of the material that take part.
    ///
    /// # Errors
    /// A component that the scene names but the material lacks.
    pub fn components(&self, material: &Material) -> Result<Vec<Component>> {
        let Some(components) = &self.components else { return Ok(material.curves.components().collect()) };
        let missing = components.iter().position(|&component| material.curves.get(component).is_none());
        match missing {
            None => Ok(components.clone()),
            Some(index) => {
                let found = format!("{}, which {} has no curve for", components[index], material.name);
                let known: Vec<_> =
                    material.curves.components().map(|component| component.to_string()).collect();
                let expected = format!("some of {}", known.join(", "));
                Err(self.file.invalid(&format!("components[{index}]"), found, expected))
            }
        }
    }

    /// The scene's cloth, made of a material; at rest something must hold it.
    ///
    /// # Errors
    /// Those of [`Cloth::new`], with the scene's file and line if they apply.
    pub fn cloth(&self, material: &Material, components: &[Component], at_rest: bool) -> Result<Cloth> {
        let problem = Problem {
            mesh: &self.mesh,
            model: material.model,
            components,
            areal_density: material.areal_density,
            gravity: self.gravity,
            held: &self.held,
            tied: &[],
            guided: &self.guided,
            planar: false,
            rest: self.rest,
        };
        let cloth = if at_rest { Cloth::new(&problem) } else { Cloth::in_motion(&problem) };
        cloth.map_err(|defect| self.explain(defect))
    }

    /// Converts an error of the mechanics to bad input of the scene, if it is one.
    pub fn explain(&self, defect: Defect) -> Error {
        match &defect {
            Defect::Unpinned { .. } => {
                let expected = "[[held]] nodes in every part, for a shape at rest";
                self.file.invalid("sheet", defect.to_string(), expected)
            }
            Defect::NeedsGrid { .. } => {
                self.file.invalid("sheet", defect.to_string(), "grid, or another model")
            }
            Defect::InvalidValue { field: "runge_kutta", expected, .. } => {
                self.file.invalid("solver.integrator", "runge-kutta", *expected)
            }
            Defect::UnstableStep { limit, .. } => {
                let expected = format!("at most {limit:.3e} s, or integrator = \"implicit-euler\"");
                self.file.invalid("step_s", self.dynamics.step.to_string(), expected)
            }
            _ => Error::Mechanics { context: self.name.clone(), source: defect },
        }
    }

    /// Bad input at a key of the scene.
    pub fn invalid(&self, key: &str, found: impl Into<String>, expected: impl Into<String>) -> Error {
        self.file.invalid(key, found, expected)
    }
}
