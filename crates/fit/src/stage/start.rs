//! Start of a stage, without simulation: a constant stiffness, and constants for unknown curves.

use super::gap;
use super::knowledge::Knowledge;
use super::level::domain;
use super::plan::{Plan, mechanics, unfit};
use super::settings::{Constraints, Settings};
use crate::equilibria::Objective;
use crate::optimise::gauss_newton::LinearConstraints;
use crate::twin::replica::Replica;
use cloth_data::error::Result;
use cloth_sim::curve::{StiffnessCurve, equidistant};
use cloth_sim::material::{Component, Curves};
use std::collections::BTreeMap;

/// Start of a stage.
pub(super) struct Start {
    /// The constant stiffness, N/m (bending: N·m per the model's own strain).
    pub(super) stiffness: f64,
    /// Estimate of the largest stiffness.
    pub(super) largest: f64,
    /// Curves of the other components: known or assumed.
    pub(super) known: Curves,
    /// Unmeasured components, with their assumed constant stiffness.
    pub(super) assumed: BTreeMap<Component, f64>,
}

/// Estimates the start from forces (equilibrium gap) or shapes (Peirce's cantilever), or takes a constant.
///
/// # Errors
/// Measurements that no positive stiffness can explain.
pub(super) fn start(
    plan: &Plan,
    replicas: &[Replica],
    knowledge: &Knowledge,
    settings: &Settings,
) -> Result<Start> {
    // Assumed curves use the measured value, not the start.
    let [stiffness, measured] = match plan.objective {
        Objective::Forces => {
            let measured = from_forces(plan, replicas, settings)?;
            [settings.first_stiffness.of_membrane(plan.fitted[0]).unwrap_or(measured), measured]
        }
        Objective::Positions => {
            let most = most_that_bends(plan, knowledge.curves(), settings);
            let from = |rigidity| from_shapes(plan, replicas, rigidity).map(|stiffness| stiffness.min(most));
            [from(settings.first_stiffness.of_bending())?, from(None)?]
        }
    };
    let mut known = knowledge.without(&plan.fitted).curves().clone();
    let mut assumed = BTreeMap::new();
    for component in plan.components_of(settings.model) {
        if plan.fitted.contains(&component) || known.get(component).is_some() {
            continue;
        }
        let negative = settings.model.negative_strain(component, settings.compression);
        let constant = assumption(plan, replicas, component, measured, knowledge.curves());
        known.set(component, StiffnessCurve::constant(constant, negative).map_err(mechanics(plan))?);
        assumed.insert(component, constant);
    }
    let largest = match plan.objective {
        Objective::Forces => largest_from_forces(plan, replicas, measured, settings)?,
        Objective::Positions => measured,
    };
    Ok(Start { stiffness: stiffness * settings.start_factor, largest, known, assumed })
}

/// The assumed constant for an unknown curve.
fn assumption(
    plan: &Plan,
    replicas: &[Replica],
    component: Component,
    stiffness: f64,
    known: &Curves,
) -> f64 {
    if component.is_bending() && !plan.fitted[0].is_bending() {
        return softest_bending(known).unwrap_or_else(|| usual_bending(replicas, component));
    }
    // Across a strip, and for the other bending components: as the fitted one. It hardly matters.
    if component.is_bending() || plan.fitted[0].is_stretch() {
        return stiffness;
    }
    let shear = if plan.fitted[0] == Component::Shear { stiffness } else { 0.0 };
    unyielding(replicas, component, shear)
}

/// Stiffness of a nearly inextensible membrane under its own weight or under the forces of shear, N/m: assumed for an
/// unknown stretch or shear curve in tests of other components.
///
/// * `shear` — the shear stiffness, N/m; 0 without shear
pub(crate) fn unyielding(replicas: &[Replica], component: Component, shear: f64) -> f64 {
    let weight = replicas
        .iter()
        .map(|replica| replica.weight.norm() * replica.specimen.grid.width.max(replica.specimen.grid.height))
        .fold(0.0, f64::max);
    let stretch = f64::max(2000.0 * weight, 100.0 * shear);
    if component.is_stretch() { stretch } else { 0.1 * stretch }
}

/// The smallest stiffness of the known bending curves, assumed for the unknown ones.
pub(crate) fn softest_bending(known: &Curves) -> Option<f64> {
    let bends = known.components().filter(|component| component.is_bending());
    let stiffnesses =
        bends.filter_map(|component| known.get(component)).flat_map(StiffnessCurve::stiffnesses);
    stiffnesses.copied().reduce(f64::min)
}

/// Bending length of the median fabric, m: ∛(rigidity / weight per area). Of 168 fabrics measured in three
/// directions, 95 of 100 lie between 10 and 32 mm. Source: Feng et al. 2022.
const USUAL_BENDING_LENGTH: f64 = 0.019;

/// The stiffness of one bending component that gives the sheet the usual bending length.
fn usual_bending(replicas: &[Replica], component: Component) -> f64 {
    let curvature = 1.0 / USUAL_BENDING_LENGTH;
    let of_replica = |replica: &Replica| {
        let rolled = replica.cloths.iter().find_map(|cloth| cloth.bending()?.rolled(component))?;
        let rigidity = replica.areal_density * STANDARD_GRAVITY * USUAL_BENDING_LENGTH.powi(3);
        Some(rigidity * curvature / (rolled.lever(curvature) * rolled.strain(curvature)))
    };
    replicas.iter().find_map(of_replica).unwrap_or(0.0)
}

/// m/s²; bending lengths refer to it, whatever the gravity of the test.
const STANDARD_GRAVITY: f64 = 9.81;

/// The mean stiffness that balances the clip forces on the blended shapes, as if the fitted curve carried all the
/// load.
fn from_forces(plan: &Plan, replicas: &[Replica], settings: &Settings) -> Result<f64> {
    let range = blended_range(plan, replicas);
    let frames = replicas.iter().flat_map(|replica| &replica.frames);
    let extension = frames.map(|frame| frame.extension).fold(0.0, f64::max);
    let name = plan.name();
    if range < 0.1 * extension {
        return Err(unfit(
            replicas,
            format!("a {name} strain of only {range:.2e} at an extension or shear angle of {extension:.2e}"),
            "a pull along the yarns of the test's kind: check kind, and vt in mesh.obj",
        ));
    }
    let negative = settings.model.negative_strain(plan.fitted[0], settings.compression);
    let one = StiffnessCurve::constant(1.0, negative).map_err(mechanics(plan))?;
    let mean = gap::start(replicas, &plan.fitted, &one, &LinearConstraints::everywhere(1))[0];
    if !(mean > 0.0) {
        return Err(unfit(
            replicas,
            format!("clip forces that give a stiffness of {mean:.3e} N/m"),
            "the force of the cords on each clip, outward under stretch: check its sign, or force_direction",
        ));
    }
    Ok(mean)
}

/// The largest control value of a curve with the maximum number of points, on the blended shapes.
fn largest_from_forces(plan: &Plan, replicas: &[Replica], mean: f64, settings: &Settings) -> Result<f64> {
    let negative = settings.model.negative_strain(plan.fitted[0], settings.compression);
    let points = settings.most_points();
    let strains = equidistant(points, blended_range(plan, replicas));
    let fine = StiffnessCurve::new(strains, vec![mean; points], negative).map_err(mechanics(plan))?;
    let positive = domain(&fine, Constraints::ControlPoints, 0.0).map_err(mechanics(plan))?;
    Ok(gap::start(replicas, &plan.fitted, &fine, &positive).amax().max(mean))
}

/// The largest strain on the blended shapes of all frames.
fn blended_range(plan: &Plan, replicas: &[Replica]) -> f64 {
    let odd = !plan.fitted[0].is_stretch();
    replicas
        .iter()
        .flat_map(|replica| replica.frames.iter().map(move |frame| (replica, frame)))
        .flat_map(|(replica, frame)| {
            plan.fitted.iter().flat_map(move |&c| replica.cloth(frame).strains(c, &frame.start))
        })
        .fold(f64::MIN_POSITIVE, |largest, [strain, _]| largest.max(if odd { strain.abs() } else { strain }))
}

/// Ring-2 springs depend on the yarns: if stiffer, the yarns stretch instead, and the bending stiffness does not
/// rise.
fn most_that_bends(plan: &Plan, known: &Curves, settings: &Settings) -> f64 {
    let yarns = plan.components.iter().filter(|component| component.is_stretch());
    let stiffnesses = yarns.filter_map(|&component| Some(known.get(component)?.stiffnesses()[0]));
    let largest = stiffnesses.fold(0.0, f64::max);
    if settings.model.is_of_springs() && largest > 0.0 { largest } else { f64::INFINITY }
}

/// The median over all frames of the stiffness by Peirce's formula; with `given`, of the stiffness for that rigidity,
/// N·m.
fn from_shapes(plan: &Plan, replicas: &[Replica], given: Option<f64>) -> Result<f64> {
    let mut found: Vec<f64> = Vec::new();
    for replica in replicas {
        for frame in &replica.frames {
            let bending = replica.cloth(frame).bending();
            let rolled = plan.fitted.iter().find_map(|&component| bending?.rolled(component));
            if let (Some(rolled), Some([rigidity, curvature])) = (rolled, frame.peirce) {
                let rigidity = given.unwrap_or(rigidity);
                let stress = rigidity * curvature / rolled.lever(curvature);
                found.push(stress / rolled.strain(curvature));
            }
        }
    }
    found.retain(|stiffness| stiffness.is_finite() && *stiffness > 0.0);
    found.sort_by(f64::total_cmp);
    found.get(found.len() / 2).copied().ok_or_else(|| {
        unfit(
            replicas,
            "no overhang that sags under its weight".into(),
            "nonzero gravity_m_s2, and cloth that hangs over the edge",
        )
    })
}
