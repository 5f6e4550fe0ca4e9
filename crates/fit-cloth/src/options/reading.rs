//! Flags of the commands that read a curve.

use super::choice::{ComponentChoice, ModelChoice};
use clap::Args;
use cloth_sim::material::{Component, Model};

/// Flags that say how a curve is read.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Reading")]
pub struct Reading {
    /// Component of the curve: selects one of a material.json [check: all]; needed for a table only if it has rows
    /// below zero, which stretch and shear read differently
    #[arg(long, value_enum)]
    pub component: Option<ComponentChoice>,
    /// Model whose strain measure the table uses [default: by its columns, else stvk]
    #[arg(long, value_enum)]
    pub model: Option<ModelChoice>,
}

impl Reading {
    /// The component, if one was named.
    pub fn component(&self) -> Option<Component> {
        self.component.map(Component::from)
    }

    /// The model, if one was named.
    pub fn model(&self) -> Option<Model> {
        self.model.map(|ModelChoice(model)| model)
    }
}
