//! Components of a stage and the tests that show them.

use super::settings::Settings;
use crate::equilibria::Objective;
use crate::twin::replica::{Parts, Replica};
use cloth_data::error::{Error, Result};
use cloth_data::frame::{Kind, MeasurementSet};
use cloth_sim::material::{Component, Model};

/// The tests that show any of some components, each once.
pub fn kinds_of_all(components: &[Component]) -> Vec<Kind> {
    Kind::ALL.into_iter().filter(|kind| kind.shows().iter().any(|shown| components.contains(shown))).collect()
}

/// Components of a stage and the tests that show them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    /// The components that share the fitted curve: one, or weft and warp of an isotropic variant.
    pub fitted: Vec<Component>,
    /// Components that store energy, of any model.
    pub components: Vec<Component>,
    /// Quantities compared.
    pub objective: Objective,
    /// The tests that show it.
    pub kinds: Vec<Kind>,
    /// Sheets between clips stay in their plane.
    pub flat: bool,
    /// First or second pass over the component.
    pub pass: usize,
}

impl Plan {
    /// The fitted components by name.
    pub fn name(&self) -> String {
        let names: Vec<String> = self.fitted.iter().map(|component| component.to_string()).collect();
        names.join(" = ")
    }

    /// The components of a model that store energy.
    pub fn components_of(&self, model: Model) -> Vec<Component> {
        model.components().into_iter().filter(|component| self.components.contains(component)).collect()
    }

    /// The replicas of all sequences of a set that show what is fitted.
    ///
    /// # Errors
    /// Sequences that no replica can be made of.
    pub fn replicas(&self, set: &MeasurementSet, settings: &Settings) -> Result<Vec<Replica>> {
        self.refined(set, settings, 1)
    }

    /// As [`Plan::replicas`], on a multiple of the cells along overhangs.
    ///
    /// # Errors
    /// As above.
    pub fn refined(
        &self,
        set: &MeasurementSet,
        settings: &Settings,
        refinement: usize,
    ) -> Result<Vec<Replica>> {
        let parts = |kind: Kind| Parts {
            model: settings.model,
            components: self.components_of(settings.model),
            areal_density: set.fabric.areal_density_kg_m2,
            grid: settings.grid(),
            diagonals: settings.diagonals,
            refinement,
            table: settings.table,
            // Strips cut on the bias are pulled taut, and nobody saw them buckle.
            flat: self.flat || kind.is_on_the_bias(),
        };
        let shows = set.sequences.iter().filter(|sequence| self.kinds.contains(&sequence.kind));
        let replicas = shows.map(|sequence| Replica::new(sequence, &parts(sequence.kind)));
        let strained = |replica: &Replica| self.fitted.iter().any(|&component| replica.shows(component));
        replicas.filter(|replica| replica.as_ref().map_or(true, strained)).collect()
    }
}

/// Sequences that cannot be fitted.
pub(super) fn unfit(replicas: &[Replica], found: String, expected: &str) -> Error {
    let names: Vec<&str> = replicas.iter().map(|replica| &replica.name[..]).collect();
    Error::Geometry { sequence: names.join(", "), found, expected: expected.into() }
}

/// The mechanics' refusal, with the stage's name.
pub(super) fn mechanics(plan: &Plan) -> impl Fn(cloth_sim::error::Error) -> Error {
    let context = plan.name();
    move |source| Error::Mechanics { context: context.clone(), source }
}
