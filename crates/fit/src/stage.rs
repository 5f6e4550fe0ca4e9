//! The stages of the fit. Each fits one component on the sequences that show it, others known or left out.

pub mod stretch;

use crate::error::{Error, Result};
use crate::gauss_newton::{Iteration, Options};
use crate::simulation::Meter;
use cloth_sim::equilibrium;
use cloth_sim::material::{Component, Compression, Model};
use cloth_sim::mesh::Diagonals;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What keeps a curve physical.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Constraints {
    /// dσ/dε everywhere above a thousandth of the largest stiffness of the gap start.
    #[default]
    Stable,
    /// Control values not negative: the published rule.
    ControlPoints,
}

/// How a curve is fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// The cloth model; default StVK.
    pub model: Model,
    /// Columns and rows of the simulation's grid; default as many cells as 25×25 nodes have, near square.
    pub nodes: Option<[usize; 2]>,
    /// How its cells are split; default '/'.
    pub diagonals: Diagonals,
    /// Most control points; default 5.
    pub points: usize,
    /// What keeps the curve physical; default stable.
    pub constraints: Constraints,
    /// Compression; default with the stiffness at zero strain.
    pub compression: Compression,
    /// How equilibria are found.
    pub equilibrium: equilibrium::Settings,
    /// More control points must lower the root mean square residual by this share; default 1 %. (Published: 1 % of its
    /// square.)
    pub growth_gain: f64,
    /// The outer loop.
    pub outer: Options,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            model: Model::Stvk,
            nodes: None,
            diagonals: Diagonals::Forward,
            points: 5,
            constraints: Constraints::Stable,
            compression: Compression::ZeroStrain,
            equilibrium: equilibrium::Settings::default(),
            growth_gain: 0.01,
            // A share of 1e-6 of the sum of squares, or of 1e-7 of the stiffnesses, is far below any noise.
            outer: Options {
                gain_tolerance: 1e-6,
                step_tolerance: 1e-7,
                max_iterations: 50,
                ..Options::default()
            },
        }
    }
}

impl Settings {
    /// Names the setting that cannot be.
    ///
    /// # Errors
    /// No control point, or more than 50; fewer than 3 nodes a side or more than 1000.
    pub fn validate(&self) -> Result<()> {
        let setting = |field, found: String, expected: &str| {
            Err(Error::Setting { field, found, expected: expected.into() })
        };
        if !(1..=50).contains(&self.points) {
            return setting("points", self.points.to_string(), "1 to 50 control points");
        }
        match self.nodes {
            Some(nodes) if nodes.iter().any(|side| !(3..=1000).contains(side)) => {
                setting("nodes", format!("{}x{}", nodes[0], nodes[1]), "3 to 1000 nodes a side")
            }
            _ => Ok(()),
        }
    }
}

/// Whoever watches a fit.
pub struct Watch<'a> {
    /// Counts while frames are solved.
    pub meter: Arc<Meter>,
    /// Is told of every level and iteration.
    pub observe: Box<dyn FnMut(Event<'_>) + 'a>,
}

impl Default for Watch<'_> {
    /// Nobody.
    fn default() -> Self {
        Self { meter: Arc::default(), observe: Box::new(|_| ()) }
    }
}

/// What happens during a fit.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// A level of the curve's growth begins.
    Level {
        /// The component.
        component: Component,
        /// Control points.
        points: usize,
    },
    /// A step was tried.
    Iteration {
        /// The step.
        iteration: &'a Iteration,
        /// Root mean square residual.
        rms: f64,
        /// Factorisations so far.
        factorisations: usize,
        /// Seconds so far.
        seconds: f64,
    },
}
