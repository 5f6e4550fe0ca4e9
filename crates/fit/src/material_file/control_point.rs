//! A control point in `material.json`, whose keys tell its unit.

use crate::io::json_file::there;
use cloth_sim::material::{Component, Model};
use serde::{Deserialize, Serialize};

/// A control point. Its keys in the file tell its unit: see [`Unit`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Keys", into = "Keys")]
pub struct ControlPoint {
    /// The model's own strain; that of hinges in 1/m.
    pub strain: f64,
    /// Stiffness.
    pub stiffness: f64,
    /// Standard deviation of the stiffness; `None` where no frame sees it.
    pub deviation: Option<f64>,
    /// Of stiffness and deviation.
    pub unit: Unit,
}

/// The unit of a stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// N/m over a strain without unit: `stiffness_n_per_m`, `deviation_n_per_m`.
    NewtonPerMetre,
    /// N·m over the strain of hinges, 1/m: `stiffness_n_m`, `deviation_n_m`.
    NewtonMetre,
}

impl Unit {
    /// The unit of a component's stiffness in a model.
    pub fn of(model: Model, component: Component) -> Self {
        if component.is_bending() && model != Model::Springs {
            Self::NewtonMetre
        } else {
            Self::NewtonPerMetre
        }
    }
}

/// A control point as it stands in the file: the stiffness under one of two keys.
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
}

impl TryFrom<Keys> for ControlPoint {
    type Error = &'static str;

    fn try_from(keys: Keys) -> Result<Self, Self::Error> {
        let strain = keys.strain;
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
        let deviation = |unit| point.deviation.filter(|_| point.unit == unit);
        Self {
            strain: point.strain,
            stiffness_n_per_m: stiffness(Unit::NewtonPerMetre),
            deviation_n_per_m: deviation(Unit::NewtonPerMetre),
            stiffness_n_m: stiffness(Unit::NewtonMetre),
            deviation_n_m: deviation(Unit::NewtonMetre),
        }
    }
}
