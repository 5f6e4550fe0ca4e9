//! What a study is about: a measurement set, and the truth behind it where that is known.

use crate::extent::Extent;
use crate::fabrics::known;
use cloth_data::error::Result;
use cloth_data::frame::{Kind, MeasurementSet};
use cloth_data::rig::{KnownFabric, Rig};
use std::path::Path;

/// The fabric that is measured if no set is given, and whose scenes stand in where a set's fabric is unknown.
const BUILT_IN: &str = "cotton-denim";

/// A measurement set and its fabric.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    /// What is fitted.
    pub set: MeasurementSet,
    /// The fabric of the scenes that are only simulated: the set's, or where that is unknown cotton denim.
    pub fabric: KnownFabric,
    /// That is the set's own fabric: the truth is known.
    pub is_known: bool,
}

impl Subject {
    /// A set that was read; its fabric is known if its name is one of the rig's, or of a sample of one.
    ///
    /// # Errors
    /// None but those of a fabric file that comes with the program.
    pub fn of_set(set: MeasurementSet) -> Result<Self> {
        let (name, sample) = match set.fabric.name.rsplit_once('.') {
            Some((name, number)) => (name, number.parse().unwrap_or(0)),
            None => (&set.fabric.name[..], 1),
        };
        let own = known(name).filter(|_| sample > 0);
        let is_known = own.is_some();
        let text = own.or(known(BUILT_IN)).unwrap_or_default();
        let fabric = KnownFabric::parse(Path::new(name), text)?;
        Ok(Self { set, fabric: if is_known { fabric.sample(sample) } else { fabric }, is_known })
    }

    /// Cotton denim on the virtual rig, in the tests that are fitted.
    ///
    /// # Errors
    /// As [`Rig::measure`].
    pub fn built_in(extent: &Extent) -> Result<Self> {
        let fabric = KnownFabric::parse(Path::new(BUILT_IN), known(BUILT_IN).unwrap_or_default())?;
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
