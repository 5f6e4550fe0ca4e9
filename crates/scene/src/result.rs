//! Result folder of a simulation: `simulation.json`, `mesh.obj`, frames, `energies.csv`.

use crate::scene::Scene;
use crate::simulation::{End, Row, Simulation};
use cloth_data::error::Result;
use cloth_data::io::schema::Schema;
use cloth_data::io::{ShapeFormat, write_shapes};
use cloth_data::store::write_file;
use cloth_fit::material::Material;
use cloth_sim::dynamics::{Integrator, LinearSolver, Newton};
use cloth_sim::mesh::Mesh;
use nalgebra::Vector3;
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::Path;

/// Version of `simulation.json`.
const SCHEMA: Schema = Schema::new("simulation", &[]);

/// Writes a simulation to an existing folder.
///
/// # Errors
/// Errors of the file system.
pub fn write_simulation(
    folder: &Path,
    scene: &Scene,
    material: &Material,
    simulation: &Simulation,
    format: ShapeFormat,
) -> Result<()> {
    let placed = |positions: &[Vector3<f64>]| positions.iter().map(|p| p + scene.origin).collect::<Vec<_>>();
    let shapes: Vec<_> = simulation.frames.iter().map(|frame| placed(&frame.positions)).collect();
    let mesh = Mesh { positions: placed(&scene.mesh.positions), ..scene.mesh.clone() };
    write_shapes(folder, &mesh, &shapes, format)?;
    if !simulation.rows.is_empty() {
        write_file(&folder.join("energies.csv"), energies(&simulation.rows).as_bytes())?;
    }
    let json = format!("{:#}\n", simulation_json(scene, material, simulation));
    write_file(&folder.join("simulation.json"), json.as_bytes())
}

fn energies(rows: &[Row]) -> String {
    let mut text = String::from(
        "time_s,kinetic_j,elastic_j,weight_j,damping_j,wind_j,total_j,numerical_j,newton_iterations,linear_iterations,imbalance_n\n",
    );
    for Row { time, energies, step } in rows {
        let [newton, linear] =
            [step.map_or(0, |s| s.newton_iterations), step.map_or(0, |s| s.linear_iterations)];
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{time:.9},{:.9e},{:.9e},{:.9e},{:.9e},{:.9e},{:.9e},{:.9e},{newton},{linear},{:.3e}",
            energies.kinetic,
            energies.elastic,
            energies.weight,
            energies.damping,
            energies.wind,
            energies.total(),
            energies.numerical,
            step.map_or(0.0, |step| step.imbalance),
        );
    }
    text
}

/// `simulation.json`: settings, status and measures.
pub fn simulation_json(scene: &Scene, material: &Material, simulation: &Simulation) -> Value {
    let mut json = Map::new();
    let mut put = |key: &str, value: Value| _ = json.insert(key.into(), value);
    put("schema", json!(SCHEMA.id()));
    put("program", json!(concat!("fit-cloth ", env!("CARGO_PKG_VERSION"))));
    put("scene", json!(scene.name));
    put("material", json!(material.name));
    put("model", json!(material.model));
    put("compression", json!(material.compression));
    put("components", json!(simulation.components));
    put("rest_shape", json!(scene.rest));
    put("vertices", json!(scene.mesh.len()));
    put("triangles", json!(scene.mesh.triangles.len()));
    put("frames", json!(simulation.frames.len()));
    put("converged", json!(simulation.converged()));
    match simulation.end {
        End::Rest(descent) => {
            let found = descent.equilibrium;
            put(
                "rest",
                json!({
                    "status": found.status.to_string(),
                    "stable": found.converged(),
                    "escaped": found.escaped,
                    "energy_j": found.energy,
                    "imbalance_n": found.imbalance,
                    "tolerance_n": found.tolerance,
                    "steps": descent.steps,
                    "last_iterations": found.iterations,
                    "last_way_m": descent.last_way,
                }),
            );
            let holds: Vec<[f64; 3]> = simulation.holds.iter().map(|&force| force.into()).collect();
            put("hold_forces_n", json!(holds));
        }
        End::Motion { steps, not_converged, stopped } => {
            let last = simulation.rows.last();
            let mut motion = settings(scene);
            motion["steps"] = json!(steps);
            motion["duration_s"] = json!(last.map_or(0.0, |row| row.time));
            motion["steps_not_converged"] = json!(not_converged);
            if let Some(step) = stopped {
                motion["stopped_at_step"] = json!(step);
            }
            if let Some(row) = last {
                let energies = row.energies;
                motion["energies_j"] = json!({
                    "kinetic": energies.kinetic,
                    "elastic": energies.elastic,
                    "weight": energies.weight,
                    "damping": energies.damping,
                    "wind": energies.wind,
                    "numerical": energies.numerical,
                });
            }
            put("motion", motion);
        }
    }
    if let Some(droop) = &simulation.droop {
        put("droop", json!(droop));
    }
    if let Some(drape) = &simulation.drape {
        put("drape", json!(drape));
    }
    if !simulation.interventions.none() {
        put("interventions", json!(simulation.interventions));
    }
    put("seconds", json!(simulation.elapsed.as_secs_f64()));
    Value::Object(json)
}

/// Settings of the motion.
fn settings(scene: &Scene) -> Value {
    let dynamics = scene.dynamics;
    let mut json = json!({
        "step_s": dynamics.step,
        "damping": { "mass_per_s": dynamics.damping.mass, "stiffness_s": dynamics.damping.stiffness },
    });
    match dynamics.integrator {
        Integrator::RungeKutta => json["integrator"] = json!("runge-kutta"),
        Integrator::ImplicitEuler { newton, linear } => {
            json["integrator"] = json!("implicit-euler");
            match newton {
                Newton::Single => json["newton"] = json!("single"),
                Newton::Converged { tolerance } => {
                    json["newton"] = json!("converged");
                    json["tolerance"] = json!(tolerance);
                }
            }
            match linear {
                LinearSolver::Direct => json["linear"] = json!("direct"),
                LinearSolver::ConjugateGradient { tolerance, max_iterations } => {
                    json["linear"] = json!("conjugate-gradient");
                    json["linear_tolerance"] = json!(tolerance);
                    json["linear_iterations"] = json!(max_iterations);
                }
            }
        }
    }
    json
}
