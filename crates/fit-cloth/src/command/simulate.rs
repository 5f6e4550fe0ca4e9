//! `fit-cloth simulate`: simulates a scene with a material, in motion or at rest.

use crate::failure::Failure;
use crate::options::{BendingChoice, CompressionChoice, STABLE, refuse_within};
use crate::outcome::Outcome;
use crate::output::Output;
use crate::plot::write_simulation_plots;
use crate::printing::{Printing, print_result, warn, warn_of_defects};
use crate::progress::StepBar;
use crate::text;
use clap::{Args, ValueEnum};
use cloth_data::error::Error;
use cloth_data::io::ShapeFormat;
use cloth_fit::material::Material;
use cloth_fit::material::bending::Converted;
use cloth_fit::material::check::{check_curves, refuse_unstable};
use cloth_fit::result::check_output;
use cloth_scene::result::{simulation_json, write_simulation};
use cloth_scene::scene::Scene;
use cloth_scene::simulation::{Simulation, in_motion, to_rest};
use std::io::Write;
use std::path::PathBuf;

const EXAMPLE: &str = "\
Example:
  fit-cloth simulate fixtures/scenes/hang.toml --material fixtures/materials/cotton.toml
  fit-cloth simulate fixtures/scenes/drape.toml --material fixtures/materials/cotton.toml --rest

Writes simulation.json, mesh.obj, frames/*.obj, energies.csv and plots/shapes.svg. A material is the material.json of a
fit, or a TOML file: docs/formats.md.";

/// `fit-cloth simulate`.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXAMPLE)]
pub struct SimulateOptions {
    /// The scene, a TOML file: sheet, supports, air, solver
    pub scene: PathBuf,
    /// Material of the sheet: a material.json or a TOML file
    #[arg(long, value_name = "FILE")]
    pub material: PathBuf,
    /// Output folder; a previous result there is replaced [default: out/ and the scene's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Solve for the equilibrium instead of simulating motion
    #[arg(long, conflicts_with = "duration")]
    pub rest: bool,
    /// Format of shapes: one file per frame, or one NumPy array
    #[arg(long, value_enum, default_value_t = FormatChoice::Obj)]
    pub format: FormatChoice,
    /// Simulated time [default: from the scene]
    #[arg(long, value_name = "SECONDS", value_parser = parse_duration)]
    pub duration: Option<f64>,
    /// Accept curves whose stiffness or tangent is not positive
    #[arg(long)]
    pub allow_unstable: bool,
    /// Bending: moment against curvature, or the hinges or springs of the material [default: the material's]
    #[arg(long, value_enum)]
    pub bending: Option<BendingChoice>,
    /// Weft and warp under compression [default: from the material]
    #[arg(long, value_enum)]
    pub compression: Option<CompressionChoice>,
}

/// [`ShapeFormat`] on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FormatChoice {
    /// frames/0000.obj …
    Obj,
    /// frames/0000.ply …
    Ply,
    /// positions.npy
    Npy,
}

impl From<FormatChoice> for ShapeFormat {
    fn from(choice: FormatChoice) -> Self {
        match choice {
            FormatChoice::Obj => Self::Obj,
            FormatChoice::Ply => Self::Ply,
            FormatChoice::Npy => Self::Npy,
        }
    }
}

/// Simulates a scene.
///
/// # Errors
/// Bad input; an output folder that is not a previous result; I/O errors.
pub fn run(
    options: &SimulateOptions,
    printing: Printing,
    output: &mut impl Write,
) -> Result<Outcome, Failure> {
    let folder = options.output_folder();
    check_output(&folder, "--out")?;
    for (flag, path) in [("SCENE", &options.scene), ("--material", &options.material)] {
        refuse_within(flag, path, &folder)?;
    }
    let scene = Scene::read(&options.scene)?;
    let material = Material::read(&options.material)?;
    let material = match options.compression {
        Some(choice) => material.with_compression(choice.into())?,
        None => material,
    };
    let material = match options.bending {
        Some(choice) => {
            let Converted { material, twist } = material.bending_as(choice.into())?;
            twist.iter().for_each(|words| warn(printing, words));
            material
        }
        None => material,
    };
    // Only the components that the scene uses.
    let curves = material.curves.only(&scene.components(&material)?);
    if !options.allow_unstable {
        refuse_unstable(&curves, &options.material, STABLE)?;
    }
    let out = Output::claim(&folder)?;
    let findings = check_curves(material.model, &curves, |_| None);
    warn_of_defects(printing, &options.material.display().to_string(), &findings);
    if let Some(warning) = material.for_mesh.and_then(|side| text::other_mesh(side, &scene.mesh)) {
        warn(printing, &warning);
    }
    let simulation = options.simulate(&scene, &material, printing)?;
    out.replace(|temporary| {
        write_simulation(temporary, &scene, &material, &simulation, options.format.into())?;
        write_simulation_plots(temporary, &scene, &simulation)
    })?;
    let text = text::simulation(&scene, &material, &simulation);
    let text = format!("{text}\nWritten to {}", folder.display());
    print_result(printing, output, &text, &simulation_json(&scene, &material, &simulation))?;
    Ok(if simulation.converged() { Outcome::Done } else { Outcome::NotConverged })
}

impl SimulateOptions {
    fn output_folder(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| {
            PathBuf::from("out").join(self.scene.file_stem().unwrap_or("simulation".as_ref()))
        })
    }

    fn simulate(&self, scene: &Scene, material: &Material, printing: Printing) -> Result<Simulation, Error> {
        let bar = StepBar::new(&scene.name, !printing.quiet);
        let simulation = if self.rest {
            to_rest(scene, material, &mut |step| bar.at(step, None))
        } else {
            let duration = self.duration.or(scene.duration).ok_or_else(|| {
                scene.invalid("duration_s", "nothing", "duration_s in the scene, --duration or --rest")
            })?;
            in_motion(scene, material, duration, &mut |step, steps| bar.at(step, Some(steps)))
        };
        bar.finish();
        simulation
    }
}

fn parse_duration(text: &str) -> Result<f64, String> {
    let seconds: Option<f64> = text.parse().ok();
    seconds
        .filter(|seconds| *seconds > 0.0 && seconds.is_finite())
        .ok_or_else(|| format!("{text}: expected a number of seconds above 0"))
}
