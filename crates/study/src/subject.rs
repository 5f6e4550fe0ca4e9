//! Subject of a study: a measurement set, and its known fabric if there is one.

use crate::extent::Extent;
use cloth_data::error::Result;
use cloth_data::frame::{Kind, MeasurementSet};
use cloth_data::rig::{KnownFabric, Rig};

/// Fabric to measure if no set is given; also used for the scenes if a set's fabric is unknown.
const BUILT_IN: &str = "cotton-denim";

/// A measurement set and its fabric.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    /// The set to fit.
    pub set: MeasurementSet,
    /// Fabric of the simulated scenes: the set's own, or cotton denim if that is unknown.
    pub fabric: KnownFabric,
    /// True if `fabric` is the set's own: the truth is known.
    pub is_known: bool,
}

impl Subject {
    /// A given set. Its fabric is known if the set is named after a fabric of the rig, or after a sample of one.
    ///
    /// # Errors
    /// Only those of a built-in fabric file.
    pub fn of_set(set: MeasurementSet) -> Result<Self> {
        let (name, sample) = match set.fabric.name.rsplit_once('.') {
            Some((name, number)) => (name, number.parse().unwrap_or(0)),
            None => (&set.fabric.name[..], 1),
        };
        let is_known = sample > 0 && KnownFabric::names().any(|known| known == name);
        let fabric = KnownFabric::named(if is_known { name } else { BUILT_IN })?;
        Ok(Self { set, fabric: if is_known { fabric.sample(sample) } else { fabric }, is_known })
    }

    /// Cotton denim measured on the virtual rig, in the tests used for fits.
    ///
    /// # Errors
    /// Those of [`Rig::measure`].
    pub fn built_in(extent: &Extent) -> Result<Self> {
        let fabric = KnownFabric::named(BUILT_IN)?;
        let rig = Rig {
            sequences: vec![
                Kind::StretchWeft,
                Kind::StretchWarp,
                Kind::Shear,
                Kind::BendWeft,
                Kind::BendWarp,
                Kind::BendBias,
            ],
            nodes: [extent.rig_nodes; 2],
            measured: [25, 25],
            frames: 6,
            cord_hysteresis: true,
            ..Rig::default()
        };
        Ok(Self { set: rig.measure(&fabric)?, fabric, is_known: true })
    }
}
