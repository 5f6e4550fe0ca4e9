//! The result of a simulation.

use super::interventions::interventions;
use super::list::list;
use cloth_fit::material::Material;
use cloth_fit::twin::specimen::is_alike;
use cloth_scene::drape::Drape;
use cloth_scene::droop::Droop;
use cloth_scene::scene::Scene;
use cloth_scene::simulation::{End, Simulation};
use cloth_sim::cloth::Rest;
use cloth_sim::descent::Descent;
use cloth_sim::mesh::Mesh;
use std::fmt::Write;

/// Scene and material, energies, forces and measures, and a verdict.
pub fn simulation(scene: &Scene, material: &Material, simulation: &Simulation) -> String {
    let mut text = format!(
        "{} of {} ({}, {} vertices)\ncomponents: {}\nrest shape: {}\n\n",
        scene.name,
        material.name,
        material.model,
        scene.mesh.len(),
        list(&simulation.components),
        match scene.rest {
            Rest::Flat => "flat",
            Rest::AsLaidOut => "as laid out",
        }
    );
    if let Some(row) = simulation.rows.last() {
        let energies = row.energies;
        let _ = writeln!(
            text,
            "after {:.3} s, in J: kinetic {:.3e}, elastic {:.3e}, weight {:.3e}; since the start: dissipated by damping {:.3e}, work of the air {:.3e}, lost by the integrator {:.3e}",
            row.time,
            energies.kinetic,
            energies.elastic,
            energies.weight,
            energies.damping,
            energies.wind,
            energies.numerical
        );
    }
    for (index, force) in simulation.holds.iter().enumerate() {
        let _ = writeln!(text, "hold {index}: {:.4e}, {:.4e}, {:.4e} N", force.x, force.y, force.z);
    }
    text += &simulation.droop.as_ref().map(droop).unwrap_or_default();
    text += &simulation.drape.as_ref().map(drape).unwrap_or_default();
    format!("{text}\n{}{}\n", interventions(&simulation.interventions), verdict(simulation))
}

/// A warning if curves for one mesh are simulated on another one.
///
/// * `side` — of the cells that the curves are for, m
pub fn other_mesh(side: f64, mesh: &Mesh) -> Option<String> {
    let area: f64 = (0..mesh.triangles.len()).map(|triangle| mesh.double_area(triangle)).sum();
    // A cell is two triangles.
    let own = (area / mesh.triangles.len() as f64).sqrt();
    (!is_alike(own, side)).then(|| {
        format!(
            "the curves make up for the error of cells of {} mm, this sheet's are {:.1} mm (a fit without --for-mesh, or for them)",
            1e3 * side,
            1e3 * own
        )
    })
}

fn droop(droop: &Droop) -> String {
    let mut text = format!(
        "lowest point: {:.2} mm below the held nodes, {:.2} mm as laid out",
        1e3 * droop.depth_m,
        1e3 * droop.flat_depth_m
    );
    if let Some(share) = droop.share {
        let _ = write!(text, "; droop {:.3} %", 100.0 * share);
    }
    if let Some((edge, middle)) = droop.bottom_edge_sinks_m.zip(droop.bottom_middle_sinks_m) {
        let _ = write!(
            text,
            "\nbottom edge: sinks by {:.2} mm on average, its middle by {:.2} mm",
            1e3 * edge,
            1e3 * middle
        );
    }
    text + "\n"
}

fn drape(drape: &Drape) -> String {
    let [least, most] = drape.rim_depth_m;
    format!(
        "drape coefficient: {:.2} % (scan lines: ± {:.3} %), {} folds; the rim hangs {:.1} to {:.1} mm below the support\n",
        100.0 * drape.coefficient,
        100.0 * drape.coefficient_error,
        drape.folds,
        1e3 * least,
        1e3 * most
    )
}

fn verdict(simulation: &Simulation) -> String {
    match simulation.end {
        End::Rest(descent) => at_rest(&descent),
        End::Motion { steps, stopped: Some(step), .. } => format!(
            "NOT converged: step {step} gave non-finite numbers; the last good state, after {steps} steps, is the last frame. A shorter step_s may help."
        ),
        End::Motion { steps, not_converged: 0, .. } => format!("Converged: all {steps} steps."),
        End::Motion { steps, not_converged, .. } => format!(
            "NOT converged: {not_converged} of {steps} steps were not solved to the tolerance. A shorter step_s may help."
        ),
    }
}

fn at_rest(descent: &Descent) -> String {
    let found = descent.equilibrium;
    let state = if found.converged() { "At rest, and stable" } else { "NOT converged" };
    let mut text = format!(
        "{state}: {} after {} steps of descent; the largest imbalance of a node is {:.1e} N (allowed: {:.1e} N).",
        found.status, descent.steps, found.imbalance, found.tolerance
    );
    if found.escaped {
        text += " An unstable equilibrium was met and left: another shape is equally possible.";
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_sim::mesh::{Diagonals, Grid};

    #[test]
    fn curves_for_other_cells_are_told() {
        for (diagonals, columns) in [(Diagonals::Alternating, 21), (Diagonals::Forward, 20)] {
            let mesh = Grid { columns, rows: 11, width: 0.2, height: 0.1, diagonals }.mesh().unwrap();
            assert_eq!(other_mesh(0.01, &mesh), None);
            assert!(other_mesh(0.02, &mesh).unwrap().contains("cells of 20 mm, this sheet's are 10."));
        }
    }
}
