//! The flags of the commands that read a curve.

use super::choice::{ComponentChoice, TableModel};
use clap::Args;
use cloth_sim::material::{Component, Model};

/// How a table of one curve is to be read.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Reading")]
pub struct Reading {
    /// The curve's component: which of a material.json [check: all]; of a table only where rows lie below zero, which
    /// stretch and shear read differently
    #[arg(long, value_enum)]
    pub component: Option<ComponentChoice>,
    /// The model whose strains a table is over [default: as its columns say, else stvk]
    #[arg(long, value_enum)]
    pub model: Option<TableModel>,
}

impl Reading {
    /// The component, if one was named.
    pub fn component(&self) -> Option<Component> {
        self.component.map(Component::from)
    }

    /// The model, if one was named.
    pub fn model(&self) -> Option<Model> {
        self.model.map(Model::from)
    }
}
