//! Equilibria of representative scenes under mesh refinement: cost of an error, and order of convergence.
//!
//! A planar strip and a flat picture frame are homogeneous, so every mesh solves them exactly. These scenes are not:
//!
//! ```text
//! sagging strip    ▌‾‾╲__╱‾‾▐    pulled by 1 % between two bars, in space, under its weight
//! picture frame    sheared a little, in space, under its weight: below or just above where it buckles
//! cantilever       pushed off a table along warp
//! bars in shear    ▌  ▐          two bars moved along each other, in the plane: the corners are singular
//! ```

use crate::extent::Extent;
use crate::physical::Reference;
use crate::progress::Progress;
use crate::run::{Part, Run};
use crate::scene::{Balanced, TestScene, WEIGHT, root_mean_square_distance};
use crate::solver::Solver;
use cloth_data::error::Result;
use cloth_data::frame::Kind;
use cloth_data::rig::{KnownFabric, Rig};
use cloth_fit::stage::{Plan, Settings, bend, shear, stretch};
use cloth_sim::equilibrium::Tolerance;
use cloth_sim::material::{Component, Model};

/// Runs shorter than this, s, are repeated, and the fastest counts.
const SHORT: f64 = 0.05;
const REPEATS: usize = 3;

/// Maximum iterations of one minimisation: far more than any convergent one needs here.
const ITERATIONS: usize = 100;

/// Tolerances tried besides the default one.
const TOLERANCES: [Tolerance; 5] = [
    Tolerance::Relative(1e-2),
    Tolerance::Relative(1e-4),
    Tolerance::Relative(1e-6),
    Tolerance::Relative(1e-8),
    Tolerance::Absolute(1e-5),
];

/// All equilibrium runs of a study.
///
/// # Errors
/// A scene that the rig cannot build; a reference mesh on which a scene cannot be placed.
pub(crate) fn runs(fabric: &KnownFabric, extent: &Extent, progress: &dyn Progress) -> Result<Vec<Run>> {
    let reference = Reference { model: fabric.model, curves: fabric.curves()? };
    let mut runs = Vec::new();
    for scene in scenes(fabric, extent)? {
        for &model in extent.models.iter().filter(|&&model| suits(&scene, model)) {
            progress.note(&format!("{}, {model}: {1}x{1}", scene.name, extent.finest));
            let settings = settings(model, Solver::Default, extent.finest, None);
            let finest = scene.balance(&reference, &settings)?;
            let ladder = Ladder { scene: &scene, reference: &reference, model, finest };
            runs.extend(ladder.meshes(extent, progress)?);
            if model == Model::STVK {
                runs.extend(ladder.tolerances(extent)?);
            }
        }
    }
    Ok(runs)
}

/// True if a scene suits a model. Springs do not resist the first bend: compressed as in a picture frame, their sheet
/// has no limit shape to converge to.
fn suits(scene: &TestScene, model: Model) -> bool {
    !model.is_of_springs() || scene.set.sequences[0].kind != Kind::Shear
}

fn settings(model: Model, solver: Solver, nodes: usize, tolerance: Option<Tolerance>) -> Settings {
    // Both use the same scene; only the solver differs.
    let equilibrium = solver.equilibrium();
    let mut settings = Settings { model, nodes: Some([nodes; 2]), equilibrium, ..Settings::default() };
    settings.equilibrium.max_iterations = ITERATIONS;
    settings.equilibrium.tolerance = tolerance.unwrap_or(settings.equilibrium.tolerance);
    settings
}

/// Scenes with one frame each.
fn scenes(fabric: &KnownFabric, extent: &Extent) -> Result<[TestScene; 4]> {
    let with = |plan: Plan, components: &[Component]| Plan { components: components.to_vec(), ..plan };
    let mut gentle = fabric.clone();
    gentle.largest_extension.stretch_weft = 0.01;
    gentle.largest_shear_rad = 0.01;
    gentle.complex_shear_m = 0.05 * fabric.width_m;
    let coarse = || Rig { nodes: [13, 13], measured: [5, 5], frames: 1, ..Rig::default() };
    let fine = Rig { nodes: [extent.finest; 2], measured: [extent.finest; 2], frames: 1, ..Rig::default() };
    let strip = with(
        stretch::plan(&[Component::StretchWeft]),
        &[
            Component::StretchWeft,
            Component::StretchWarp,
            Component::BendWeft,
            Component::BendWarp,
            Component::BendDiagonal,
        ],
    );
    let bars = TestScene::new(&gentle, Kind::ComplexShear, coarse(), shear::plan(1))?;
    Ok([
        TestScene::new(&gentle, Kind::StretchWeft, coarse(), strip)?
            .with_gravity(WEIGHT)
            .without_shapes()
            .called("sagging strip"),
        TestScene::new(&gentle, Kind::Shear, coarse(), shear::plan(2))?
            .without_shapes()
            .called("picture frame"),
        TestScene::new(fabric, Kind::BendWarp, fine, bend::plan(&[Component::BendWarp], 1))?
            .called("cantilever"),
        bars.without_shapes().called("bars in shear"),
    ])
}

/// One scene and model, on a sequence of refined meshes.
struct Ladder<'a> {
    scene: &'a TestScene,
    reference: &'a Reference,
    model: Model,
    finest: Balanced,
}

impl Ladder<'_> {
    fn meshes(&self, extent: &Extent, progress: &dyn Progress) -> Result<Vec<Run>> {
        let mut runs = Vec::new();
        let coarsest = extent.meshes[0];
        for solver in Solver::ALL {
            let mut shapes: Vec<Option<Vec<f64>>> = Vec::new();
            for &nodes in &extent.meshes {
                progress.note(&format!("{}, {}, {solver}: {nodes}x{nodes}", self.scene.name, self.model));
                let (mut run, balanced) = self.run(solver, nodes, None, coarsest)?;
                shapes.push((!run.failed()).then(|| balanced.shared(coarsest)));
                run.order = order(&shapes);
                runs.push(run);
            }
            if solver == Solver::Default {
                runs.push(self.finest(extent, shapes));
            }
        }
        Ok(runs)
    }

    /// The reference mesh: it has an order of convergence, but no error.
    fn finest(&self, extent: &Extent, mut shapes: Vec<Option<Vec<f64>>>) -> Run {
        let mut run =
            Run::new(Part::Equilibrium, &self.scene.name, self.model, Solver::Default, extent.finest);
        run.frames = self.finest.frames.len();
        run.spent = self.finest.spent;
        run.ending = self.finest.ending.clone();
        shapes.push((!run.failed()).then(|| self.finest.shared(extent.meshes[0])));
        run.order = order(&shapes);
        run
    }

    fn tolerances(&self, extent: &Extent) -> Result<Vec<Run>> {
        let solvers = Solver::ALL.into_iter();
        let pairs = solvers.flat_map(|solver| TOLERANCES.map(|tolerance| (solver, tolerance)));
        // The default tolerance has already run on all meshes.
        let new = pairs.filter(|(solver, tolerance)| *tolerance != solver.equilibrium().tolerance);
        let run = |(solver, tolerance)| {
            self.run(solver, extent.tolerances_on, Some(tolerance), extent.meshes[0]).map(|(run, _)| run)
        };
        new.map(run).collect()
    }

    fn run(
        &self,
        solver: Solver,
        nodes: usize,
        tolerance: Option<Tolerance>,
        shared: usize,
    ) -> Result<(Run, Balanced)> {
        let settings = settings(self.model, solver, nodes, tolerance);
        let solve = || self.scene.balance(self.reference, &settings);
        let mut balanced = solve()?;
        if balanced.spent.seconds < SHORT {
            for _ in 1..REPEATS {
                let again = solve()?;
                if again.spent.seconds < balanced.spent.seconds {
                    balanced = again;
                }
            }
        }
        let mut run = Run::new(Part::Equilibrium, &self.scene.name, self.model, solver, nodes);
        run.tolerance = settings.equilibrium.tolerance;
        run.frames = balanced.frames.len();
        run.spent = balanced.spent;
        run.ending = balanced.ending.clone();
        if !run.failed() {
            run.error_force = balanced.force_error(&self.finest);
            run.error_position_mm = balanced.position_error_mm(&self.finest, shared);
        }
        Ok((run, balanced))
    }
}

/// Order of convergence from the last three meshes, each with twice the cells of the previous one: log₂ of the ratio of
/// successive changes. Needs no exact solution.
fn order(shapes: &[Option<Vec<f64>>]) -> Option<f64> {
    let [.., Some(first), Some(second), Some(third)] = shapes else { return None };
    let [before, after] =
        [root_mean_square_distance(first, second), root_mean_square_distance(second, third)];
    // Changes at rounding level have no order.
    let size = third.iter().fold(0.0f64, |largest, place| largest.max(place.abs()));
    (after > 1e-10 * size).then(|| (before / after).log2()).filter(|order| order.is_finite())
}
