//! Cases 22 and 25: stretch a billion times as stiff as bending, and ten thousand times gravity, from a cold start; and
//! the solvers' cost.

use crate::balance;
use crate::property::for_all;
use crate::table::{Extent, Row};
use cloth_sim::equilibrium::{Method, Settings, Solver};
use cloth_sim::material::Model;
use cloth_sim::samples::{self, Sample};
use std::fmt;

/// A scene for increasing stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scene {
    Cantilever,
    ShearFrame,
}

impl fmt::Display for Scene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Cantilever => "cantilever",
            Self::ShearFrame => "shear frame",
        })
    }
}

impl Scene {
    pub(crate) const ALL: [Self; 2] = [Self::Cantilever, Self::ShearFrame];

    /// The sample, starting flat. The frame is sheared by 0.2 rad.
    ///
    /// * `stretch`, `bend` — stiffnesses in N/m and N·m; for springs, both in N/m
    pub(crate) fn sample(self, model: Model, nodes: usize, stretch: f64, bend: f64) -> Sample {
        let (sample, shear) = match self {
            Self::Cantilever => (samples::cantilever(model, nodes, stretch), 0.1),
            Self::ShearFrame => (samples::picture_frame(model, nodes, 0.2), 0.04),
        };
        let curves = samples::fabric(model, [stretch, shear * stretch, bend]).unwrap();
        Sample { curves, ..sample.unwrap() }
    }
}

/// The solvers by their names in tables.
pub(crate) const SOLVERS: [(&str, Method); 2] =
    [("mixed Newton", Method::MixedNewton), ("Levenberg–Marquardt", Method::LevenbergMarquardt)];

/// Settings with enough iterations: Levenberg–Marquardt may take thousands.
pub(crate) fn settings(method: Method) -> Settings {
    let max_iterations = if method == Method::MixedNewton { 200 } else { 5_000 };
    Settings { method, max_iterations, ..Settings::default() }
}

/// Stretch stiffness, N/m, while bending goes from equal to a billionth of it.
pub(crate) const STRETCH: f64 = 1e4;

/// Stretch over bending from 1 to 1e9 (1/m²), and a membrane ten thousand times as stiff at the same bending.
pub(crate) fn case_22(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for scene in Scene::ALL {
        for model in Model::ALL {
            for (name, method) in SOLVERS {
                let mut row = |condition: String, stretch: f64, bend: f64| {
                    let row = balance::row(22, format!("{scene}, {model}, {name}: {condition}"));
                    let inputs = (6..extent.runs(7, 14) as usize, 0.0..2e-5);
                    let runs = extent.runs(1, if method == Method::MixedNewton { 20 } else { 2 });
                    rows.push(for_all(row, runs, inputs, |row, (nodes, perturbed)| {
                        let mut sample = scene.sample(model, nodes, stretch, bend);
                        sample.perturb(perturbed);
                        let input = format!("{nodes}×{nodes}, perturbed by {perturbed:.1e} m");
                        balance::solve(row, &sample, &settings(method), &input).0
                    }));
                };
                for decade in 0..=9 {
                    row(format!("ratio 1e{decade}"), STRETCH, STRETCH * 10f64.powi(-decade));
                }
                for decade in 0..=4 {
                    row(format!("membrane × 1e{decade}"), 500.0 * 10f64.powi(decade), 1e-5);
                }
            }
        }
    }
    rows
}

/// Gravity from zero to ten thousand g; the held nodes carry the weight.
pub(crate) fn case_25(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for (scene, of) in [
        ("hanging sheet", samples::hanging_sheet as fn(Model, usize) -> _),
        ("cantilever", |model, nodes| samples::cantilever(model, nodes, 500.0)),
    ] {
        for model in Model::ALL {
            for times in [0.0, 1e-4, 1e-2, 1.0, 1e2, 1e3, 1e4] {
                // Without weight, ring-2 springs have no stiffness at flat, and a hanging sheet can swing.
                if times == 0.0 && (model == Model::SPRINGS || scene == "hanging sheet") {
                    continue;
                }
                let row = balance::row(25, format!("{scene}, {model}, {times} g"));
                let inputs = (5..10usize, 0.5..2.0, -1.0..2.0);
                rows.push(for_all(row, extent.runs(1, 50), inputs, |row, (nodes, more, density)| {
                    let mut sample: Sample = of(model, nodes).unwrap();
                    sample.gravity *= times * more;
                    sample.areal_density = 10f64.powf(density) * 0.1;
                    let cloth = sample.cloth().unwrap();
                    let mut solver = Solver::new(&cloth);
                    let mut x = sample.start.clone();
                    let found = solver.solve(&sample.curves, &mut x, &Settings::default());
                    let off = (solver.clip_forces()[0] + sample.weight()).norm();
                    let also = if off <= (1e-4 * sample.weight().norm()).max(found.tolerance) {
                        Ok(())
                    } else {
                        Err(format!("the clip bears {off:.1e} N more than the weight"))
                    };
                    let input =
                        format!("{nodes}×{nodes}, {more:.3} times, {:.3} kg/m²", sample.areal_density);
                    balance::judge(row, &cloth, &sample, &x, &found, also, &input)
                }));
            }
        }
    }
    rows
}
