//! Cost of a cold start as bending gets soft against stretch: a table and figures for docs/stability.md.

use crate::balance;
use crate::chart::{Axes, log_figure};
use crate::stiff::{SOLVERS, STRETCH, Scene, settings};
use cloth_sim::equilibrium::{Solver, Status};
use cloth_sim::material::Model;
use plotters::style::{BLACK, Color, RGBColor, ShapeStyle};
use std::fmt::Write;
use std::path::Path;

const COLOURS: [RGBColor; 3] = [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115)];

/// Nodes per side.
const NODES: usize = 13;

/// One solve.
struct Solve {
    scene: Scene,
    model: Model,
    solver: &'static str,
    /// Stretch over bending stiffness, 1/m²; dimensionless for springs.
    ratio: f64,
    status: Status,
    factorisations: usize,
}

/// Both scenes, every model and solver: stretch over bending from 1 to 1e9, then stretch raised to 5e6 N/m at the same
/// bending.
fn solves() -> Vec<Solve> {
    let mut solves = Vec::new();
    let stiffnesses = (0..=9).map(|decade| (STRETCH, STRETCH * 10f64.powi(-decade)));
    let stiffnesses: Vec<_> = stiffnesses.chain([(5e5, 1e-5), (5e6, 1e-5)]).collect();
    for scene in Scene::ALL {
        for model in Model::ALL {
            for (solver, method) in SOLVERS {
                for &(stretch, bend) in &stiffnesses {
                    let sample = scene.sample(model, NODES, stretch, bend);
                    let cloth = sample.cloth().unwrap();
                    let mut x = sample.start.clone();
                    let found = Solver::new(&cloth).solve(&sample.curves, &mut x, &settings(method));
                    let balanced = balance::imbalance(&cloth, &sample, &x) <= 1.0;
                    assert!(balanced || !found.converged(), "not balanced: {found:?}");
                    let (status, factorisations) = (found.status, found.factorisations);
                    solves.push(Solve {
                        scene,
                        model,
                        solver,
                        ratio: stretch / bend,
                        status,
                        factorisations,
                    });
                }
            }
        }
    }
    solves
}

impl Solve {
    fn is_of(&self, scene: Scene, model: Model, solver: &str) -> bool {
        (self.scene, self.model, self.solver) == (scene, model, solver)
    }

    fn told(&self) -> String {
        match self.status {
            Status::Converged => self.factorisations.to_string(),
            status => format!("– ({status} after {})", self.factorisations),
        }
    }
}

/// Returns the table; writes the figures into docs/stability.
pub(crate) fn report() -> String {
    let solves = solves();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/stability");
    std::fs::create_dir_all(&folder).unwrap();
    for scene in Scene::ALL {
        let name = format!("convergence-{}.svg", scene.to_string().replace(' ', "-"));
        std::fs::write(folder.join(name), figure(&solves, scene)).unwrap();
    }
    let mut ratios: Vec<f64> = solves.iter().map(|solve| solve.ratio).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.dedup_by(|a, b| (*a / *b - 1.0).abs() < 1e-6);
    let heads: String = ratios.iter().map(|ratio| format!(" {ratio:.0e} |")).collect();
    let mut table =
        format!("| scene | model | solver |{heads}\n|---|---|---|{}\n", "---|".repeat(ratios.len()));
    for scene in Scene::ALL {
        for model in Model::ALL {
            for (solver, _) in SOLVERS {
                let _ = write!(table, "| {scene} | {model} | {solver} |");
                solves.iter().filter(|solve| solve.is_of(scene, model, solver)).for_each(|solve| {
                    let _ = write!(table, " {} |", solve.told());
                });
                table += "\n";
            }
        }
    }
    table
}

/// Factorisations against the ratio; runs that did not converge are crosses.
fn figure(solves: &[Solve], scene: Scene) -> String {
    let of = || solves.iter().filter(|solve| solve.scene == scene);
    let most = of().map(|solve| solve.factorisations).max().unwrap() as f64;
    let title = format!("Factorisations from a cold start, {scene}");
    let last = of().map(|solve| solve.ratio).fold(0.0, f64::max);
    let axes = Axes {
        title: &title,
        x: ("stretch / bending stiffness", 0.5..2.0 * last),
        y: ("factorisations", 0.8..1.3 * most),
    };
    log_figure(axes, |chart| {
        for (model, colour) in Model::ALL.into_iter().zip(COLOURS) {
            for (index, (solver, _)) in SOLVERS.into_iter().enumerate() {
                let style: ShapeStyle = if index == 0 { colour.filled() } else { colour.stroke_width(3) };
                let own = || solves.iter().filter(|solve| solve.is_of(scene, model, solver));
                let point = |solve: &Solve| (solve.ratio, solve.factorisations as f64);
                let converged = || own().filter(|solve| solve.status == Status::Converged).map(point);
                chart.paths([converged().collect()], colour.stroke_width(3), "");
                chart.dots(converged(), (8, style), &format!("{model}, {solver}"));
            }
        }
        let failed = of().filter(|solve| solve.status != Status::Converged);
        let failed = failed.map(|solve| (solve.ratio, solve.factorisations as f64));
        chart.crosses(failed, BLACK.stroke_width(3), "not converged");
    })
    .unwrap()
}
