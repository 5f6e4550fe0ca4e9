//! Error of a fit compared with the least error that its measurements allow.
//!
//! ```text
//! own mesh      curve that the fit can represent ──▶ its own simulation ──▶ + noise ──▶ fit     error of noise only
//! finer mesh    the fabric's curve ──▶ the rig's simulation             ──▶ + noise ──▶ fit     plus mesh and spline
//! floor         root mean square over the range of √(wᵀ (JᵀJ/σ²)⁻¹ w), w = ∂stress/∂k           Cramér and Rao
//! ```
//!
//! The floor accounts for noise alone, at the true curve. All control points are in use, so bias and variance are not
//! mixed.

use crate::extent::Extent;
use crate::own_mesh;
use crate::physical::{Reference, distance, loads};
use crate::progress::Progress;
use crate::run::{Ending, Part, Run};
use crate::scene::TestScene;
use crate::solver::Solver;
use crate::spent::spend;
use cloth_data::error::Result;
use cloth_data::frame::{Kind, MeasurementSet};
use cloth_data::rig::{KnownFabric, Rig, with_noise};
use cloth_fit::stage::GrowthRule;
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::report::StageReport;
use cloth_fit::stage::{self, Plan, Settings, Watch, bend, stretch};
use cloth_sim::material::{Component, Curves, Model};

/// Standard deviations from the centre of a 95 % band to its edge.
const BAND: f64 = 1.959_963_985;

/// Required gain of more control points, as a share: negative, so that all are used.
const ALWAYS: f64 = -1e6;

/// One stage of a fit, with its scene and the reference for its curve.
struct Stage {
    plan: Plan,
    scene: TestScene,
    settings: Settings,
    /// The other, known curves.
    known: Knowledge,
    reference: Reference,
    largest_noise: f64,
}

/// Ten times the vertex noise is 0.75 mm; above that, a stiff sheet with little sag has no recognisable shape.
const LARGEST_IN_BENDING: f64 = 10.0;

/// All noise runs of a study, not averaged.
///
/// # Errors
/// A scene that the rig cannot build, or a stage that fails without noise.
pub(crate) fn runs(fabric: &KnownFabric, extent: &Extent, progress: &dyn Progress) -> Result<Vec<Run>> {
    let mut runs = Vec::new();
    for (component, points) in [(Component::StretchWeft, 5), (Component::BendWeft, 2)] {
        let mut stage = Stage::new(fabric, component, points, extent)?;
        // The fit of the noise-free fabric is a curve that the fit can represent.
        progress.note(&format!("{component}, without noise"));
        let own = stage.fit(&stage.scene.set)?;
        let fine = stage.scene.set.clone();
        let finer = stage.reference.clone();
        stage.reference.curves.set(component, own.curve.curve.clone());
        let exact = own_mesh::simulated(&stage.scene, &stage.reference, &stage.settings)?;
        let noisy = with_noise(&exact, 1.0, 1.0, false, 0);
        let floor = floor(&stage.fit(&noisy)?);
        runs.extend(stage.series("own mesh", component, &exact, floor, extent, progress));
        stage.reference = finer;
        runs.extend(stage.series("finer mesh", component, &fine, floor, extent, progress));
    }
    Ok(runs)
}

/// Cramér–Rao floor at the instruments' noise, over the largest stress of the range. It comes from a fit to exact data
/// with that noise alone, drawn and declared: noise that was declared only would not stand in the bands.
fn floor(stage: &StageReport) -> Option<f64> {
    let samples = &stage.curve.samples;
    let largest = samples.iter().map(|sample| sample.stress.abs()).fold(0.0, f64::max);
    let square = |sample: &cloth_fit::stage::report::CurveRow| {
        sample.band.map(|[_, high]| ((high - sample.stress) / BAND).powi(2))
    };
    let sum = samples.iter().map(square).sum::<Option<f64>>()?;
    (largest > 0.0).then(|| (sum / samples.len() as f64).sqrt() / largest)
}

impl Stage {
    fn new(fabric: &KnownFabric, component: Component, points: usize, extent: &Extent) -> Result<Self> {
        let nodes = extent.noise_nodes;
        let (kind, plan) = match component.is_bending() {
            true => (Kind::BendWeft, bend::plan(&[component], 1)),
            false => (Kind::StretchWeft, stretch::plan(&[component])),
        };
        let rig = Rig {
            nodes: [extent.rig_nodes; 2],
            // Shapes are measured at the fit's own nodes.
            measured: [nodes; 2],
            frames: 6,
            ..Rig::default()
        };
        let settings = Settings {
            model: Model::STVK,
            nodes: Some([nodes; 2]),
            points,
            growth: GrowthRule { gain: ALWAYS, ..GrowthRule::default() },
            ..Settings::default()
        };
        let curves = fabric.curves()?;
        let others = curves.components().filter(|&other| other != component);
        let others: Curves = others.filter_map(|other| Some((other, curves.get(other)?.clone()))).collect();
        Ok(Self {
            scene: TestScene::new(fabric, kind, rig, plan.clone())?,
            plan,
            settings,
            known: Knowledge::exact(others),
            reference: Reference { model: fabric.model, curves },
            largest_noise: if component.is_bending() { LARGEST_IN_BENDING } else { f64::INFINITY },
        })
    }

    fn fit(&self, set: &MeasurementSet) -> Result<StageReport> {
        let mut known = self.known.clone();
        let found = stage::fit(set, &self.plan, &mut known, &self.settings, &mut Watch::default())?;
        found.ok_or_else(|| cloth_data::error::Error::Geometry {
            sequence: self.scene.name.clone(),
            found: "nothing to fit".into(),
            expected: "a sequence that shows the curve".into(),
        })
    }

    /// Runs every noise level and seed on one exact set.
    fn series(
        &self,
        mesh: &str,
        component: Component,
        exact: &MeasurementSet,
        floor: Option<f64>,
        extent: &Extent,
        progress: &dyn Progress,
    ) -> Vec<Run> {
        let name = format!("{component}, {mesh}");
        // Every noise level has its own seeds: the same draws, merely scaled, would have the same relative error.
        let levels = extent.noises.iter().filter(|&&noise| noise <= self.largest_noise).enumerate();
        let pairs = levels.flat_map(|(level, &noise)| {
            (1..=extent.seeds).map(move |seed| (noise, 1000 * level as u64 + seed))
        });
        pairs
            .map(|(noise, seed)| {
                progress.note(&format!("{name}: noise x {noise}, seed {seed}"));
                let set = with_noise(exact, noise, noise, false, seed);
                Run {
                    points: Some(self.settings.points),
                    noise: Some(noise),
                    seed: Some(seed),
                    floor: floor.map(|floor| floor * noise),
                    ..self.run(&name, component, &set, progress)
                }
            })
            .collect()
    }

    fn run(&self, name: &str, component: Component, set: &MeasurementSet, progress: &dyn Progress) -> Run {
        let nodes = self.settings.nodes.map_or(0, |[columns, _]| columns);
        let mut run = Run::new(Part::Noise, name, self.settings.model, Solver::Default, nodes);
        let mut known = self.known.clone();
        let meter = progress.meter();
        let mut watch = Watch { meter: meter.clone(), observe: Box::new(|_| ()) };
        let (found, spent) =
            spend(&meter, || stage::fit(set, &self.plan, &mut known, &self.settings, &mut watch));
        run.spent = spent;
        match found {
            Ok(Some(stage)) => {
                run.frames = stage.sequences.iter().map(|sequence| sequence.frames).sum();
                let expected = |place| self.reference.load(component, place);
                run.error_curve = distance(&loads(&stage), expected);
                if !stage.converged {
                    run.ending = Ending::Failed("not converged".into());
                }
            }
            Ok(None) => run.ending = Ending::Failed("nothing to fit".into()),
            Err(error) => run.ending = Ending::Failed(error.to_string()),
        }
        run
    }
}
