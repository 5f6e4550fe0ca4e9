//! A control point in `material.json`; its keys state its unit.

use cloth_data::io::json_file::there;
use cloth_sim::material::{Component, Model};
use cloth_sim::strain_measure::HINGE_STRAIN_PER_CURVATURE;
use serde::{Deserialize, Serialize};

/// A control point. Its keys in the file state its unit: see [`Unit`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Keys", into = "Keys")]
pub struct ControlPoint {
    /// Strain in the model's measure; for hinges in 1/m.
    pub strain: f64,
    /// Stiffness.
    pub stiffness: f64,
    /// Standard deviation of the stiffness; `None` if no frame observes it.
    pub deviation: Option<f64>,
    /// Unit of stiffness and deviation.
    pub unit: Unit,
}

/// The unit of a stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// N/m, over a dimensionless strain: `stiffness_n_per_m`, `deviation_n_per_m`.
    NewtonPerMetre,
    /// N·m, over the hinge strain, 1/m: `stiffness_n_m`, `deviation_n_m`.
    NewtonMetre,
}

impl Unit {
    /// The unit of a component's stiffness in a model.
    pub fn of(model: Model, component: Component) -> Self {
        if model.strain_measure(component).is_per_metre() { Self::NewtonMetre } else { Self::NewtonPerMetre }
    }
}

/// A control point as written in the file: the stiffness under one of two keys.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    strain: f64,
    #[serde(default, deserialize_with = "there", skip_serializing_if = "Option::is_none")]
    stiffness_n_per_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    deviation_n_per_m: Option<f64>,
    #[serde(default, deserialize_with = "there", skip_serializing_if = "Option::is_none")]
    stiffness_n_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    deviation_n_m: Option<f64>,
    /// Physical measures of the hinges' strain and stiffness: curvature and flexural rigidity of a rolled sheet.
    #[serde(default, deserialize_with = "there", skip_serializing_if = "Option::is_none")]
    curvature_per_m: Option<f64>,
    #[serde(default, deserialize_with = "there", skip_serializing_if = "Option::is_none")]
    rigidity_n_m: Option<f64>,
}

impl Keys {
    /// Rejects a curvature or rigidity inconsistent with the hinges' strain and stiffness.
    fn check_physical(&self) -> Result<(), &'static str> {
        let strain =
            self.curvature_per_m.map(|curvature| (HINGE_STRAIN_PER_CURVATURE * curvature, self.strain));
        let rigidity = self.stiffness_n_m.unwrap_or(f64::NAN) * HINGE_STRAIN_PER_CURVATURE;
        let rigidity = self.rigidity_n_m.map(|given| (given, rigidity));
        let agrees = |(a, b): (f64, f64)| (a - b).abs() <= 1e-9 * b.abs();
        match [strain, rigidity].into_iter().flatten().all(agrees) {
            true => Ok(()),
            false => Err(
                "a contradiction, expected strain three times curvature_per_m and rigidity_n_m three times \
                          stiffness_n_m (after an edit, omit curvature_per_m and rigidity_n_m)",
            ),
        }
    }
}

impl TryFrom<Keys> for ControlPoint {
    type Error = &'static str;

    fn try_from(keys: Keys) -> Result<Self, Self::Error> {
        let strain = keys.strain;
        keys.check_physical()?;
        match (keys.stiffness_n_per_m, keys.deviation_n_per_m, keys.stiffness_n_m, keys.deviation_n_m) {
            (Some(stiffness), deviation, None, None) => {
                Ok(Self { strain, stiffness, deviation, unit: Unit::NewtonPerMetre })
            }
            (None, None, Some(stiffness), deviation) => {
                Ok(Self { strain, stiffness, deviation, unit: Unit::NewtonMetre })
            }
            _ => Err("no stiffness, or two, expected stiffness_n_per_m or, for hinges, stiffness_n_m"),
        }
    }
}

impl From<ControlPoint> for Keys {
    fn from(point: ControlPoint) -> Self {
        let stiffness = |unit| (point.unit == unit).then_some(point.stiffness);
        let hinges = point.unit == Unit::NewtonMetre;
        let deviation = |unit| point.deviation.filter(|_| point.unit == unit);
        Self {
            strain: point.strain,
            stiffness_n_per_m: stiffness(Unit::NewtonPerMetre),
            deviation_n_per_m: deviation(Unit::NewtonPerMetre),
            stiffness_n_m: stiffness(Unit::NewtonMetre),
            deviation_n_m: deviation(Unit::NewtonMetre),
            curvature_per_m: hinges.then_some(point.strain / HINGE_STRAIN_PER_CURVATURE),
            rigidity_n_m: hinges.then_some(HINGE_STRAIN_PER_CURVATURE * point.stiffness),
        }
    }
}
