//! Settings of a fit: model and variant, grid, constraints, start, growth, outer loop.

use super::growth_rule::GrowthRule;
use crate::equilibria::SolveStart;
use crate::optimise::gauss_newton::{Globalisation, Options};
use crate::twin::replica::TableHold;
use crate::twin::specimen::{GridSize, MOST_NODES};
use cloth_data::error::{Error, Result};
use cloth_sim::equilibrium;
use cloth_sim::material::{Component, Compression, Model};
use cloth_sim::mesh::Diagonals;
use serde::{Deserialize, Serialize};

/// Constraints that keep a curve physical.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Constraints {
    /// dσ/dε everywhere above a thousandth of the largest stiffness of the gap start.
    #[default]
    Stable,
    /// Non-negative control values: the published rule.
    ControlPoints,
}

/// Model variants.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Variant {
    /// Nonlinear curves, separate for weft and warp.
    #[default]
    Orthotropic,
    /// Constant stiffness, separate for weft and warp.
    Linear,
    /// Nonlinear curves, shared by weft and warp.
    Isotropic,
    /// Constant stiffness, shared by weft and warp.
    LinearIsotropic,
}

impl Variant {
    /// All variants.
    pub const ALL: [Self; 4] = [Self::Orthotropic, Self::Linear, Self::Isotropic, Self::LinearIsotropic];

    /// True for constant stiffness.
    pub fn is_linear(self) -> bool {
        matches!(self, Self::Linear | Self::LinearIsotropic)
    }

    /// True if weft and warp share their curves.
    pub fn is_isotropic(self) -> bool {
        matches!(self, Self::Isotropic | Self::LinearIsotropic)
    }
}

impl std::fmt::Display for Variant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Orthotropic => "orthotropic",
            Self::Linear => "linear",
            Self::Isotropic => "isotropic",
            Self::LinearIsotropic => "linear-isotropic",
        })
    }
}

/// The constant stiffness at the start of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FirstStiffness {
    /// From the measurements: the stiffness that balances the clip forces on blended shapes (equilibrium gap), or
    /// that Peirce's formula gives for an overhang.
    #[default]
    FromMeasurements,
    /// Typical starts, whatever the fabric: 100 N/m for stretch, 10 N/m for shear, a flexural rigidity of 1e-5 N·m for bending.
    /// The published method does not state its start; these round numbers are ours and lie between light and heavy
    /// fabrics.
    Constant,
}

impl FirstStiffness {
    /// Stretch or shear, N/m; `None` if it comes from the measurements.
    pub(super) fn of_membrane(self, component: Component) -> Option<f64> {
        let constant = if component.is_stretch() { 100.0 } else { 10.0 };
        (self == Self::Constant).then_some(constant)
    }

    /// Flexural rigidity, N·m; `None` if it comes from the measurements.
    pub(super) fn of_bending(self) -> Option<f64> {
        (self == Self::Constant).then_some(1e-5)
    }
}

/// Settings of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// The cloth model; default StVK.
    pub model: Model,
    /// Model variant; default orthotropic.
    pub variant: Variant,
    /// Columns and rows of the simulation's grid; default as many cells as 25×25 nodes have, near square.
    pub nodes: Option<[usize; 2]>,
    /// Side of the cells of a simulator's mesh, m: curves for that grid, at least two cells a side; default `None`: curves
    /// of the continuum.
    pub for_mesh: Option<f64>,
    /// Split of the grid's cells; default alternating: cells all split one way twist a bent sheet.
    pub diagonals: Diagonals,
    /// Maximum number of control points; default 5.
    pub points: usize,
    /// Constraints on the curve; default stable.
    pub constraints: Constraints,
    /// Behaviour under compression; default the stiffness at zero strain.
    pub compression: Compression,
    /// Equilibrium solver. Published: Levenberg–Marquardt to 10 µN, its matrix also used for the sensitivities.
    pub equilibrium: equilibrium::Settings,
    /// Start of equilibria; default the frame's last one. Published: the measured shape.
    pub solve_start: SolveStart,
    /// Start stiffness of a stage; default from the measurements. Published: not stated.
    pub first_stiffness: FirstStiffness,
    /// Constraint at a table; default the overhang with an edge that is found. Published: the part on the table.
    pub table: TableHold,
    /// Correction for the grid's error, so that curves are those of the continuum; default true. Published: false, curves
    /// for one grid. Never of springs, which stand for their own grid.
    pub corrected: bool,
    /// Clips are exactly where they were measured; default false: they err by their noise, where it is known. Published:
    /// true.
    pub exact_clips: bool,
    /// Criterion for more control points; default a decrease of the root mean square residual by 1 %. Published: its
    /// square.
    pub growth: GrowthRule,
    /// The mean over constant, straight and bent curves of all control points, weighed by the data, in place of one number
    /// of points; default true. Published: false.
    pub averaged: bool,
    /// Residuals above this multiple of the noise (of the typical residual if the noise is not given) have less
    /// weight; default `None`: full weight for all.
    pub robust: Option<f64>,
    /// Multiplies the start stiffness of every stage; default 1. Tests whether a fit depends on its start.
    pub start_factor: f64,
    /// Outer loop; default a trust region, to full convergence. Published: a line search, until a step gains less
    /// than 1 %.
    pub outer: Options,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            model: Model::STVK,
            variant: Variant::Orthotropic,
            nodes: None,
            for_mesh: None,
            diagonals: Diagonals::Alternating,
            points: 5,
            constraints: Constraints::Stable,
            compression: Compression::ZeroStrain,
            equilibrium: equilibrium::Settings::default(),
            solve_start: SolveStart::LastEquilibrium,
            first_stiffness: FirstStiffness::FromMeasurements,
            table: TableHold::default(),
            corrected: true,
            exact_clips: false,
            growth: GrowthRule::default(),
            averaged: true,
            robust: None,
            start_factor: 1.0,
            // 1e-6 of the sum of squares, or 1e-7 of the stiffnesses, is far below any noise.
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
    /// Maximum number of control points for the variant.
    pub fn most_points(&self) -> usize {
        if self.variant.is_linear() { 1 } else { self.points }
    }

    /// True if simulated values are corrected for the grid.
    pub(crate) fn corrects(&self) -> bool {
        self.corrected && self.for_mesh.is_none() && !self.model.is_of_springs()
    }

    /// Size of the grid.
    pub(crate) fn grid(&self) -> GridSize {
        match (self.for_mesh, self.nodes) {
            (Some(side), _) => GridSize::Cell(side),
            (None, Some(nodes)) => GridSize::Nodes(nodes),
            (None, None) => GridSize::NearSquare,
        }
    }

    /// The published method, with the same model, variant, grid and compression. Each of these settings can also be
    /// changed separately.
    ///
    /// Source: Miguel et al. 2012, §5.1 and §5.2; details that they leave open: docs/model.md, "The method as
    /// published".
    pub fn as_published(self) -> Self {
        Self {
            constraints: Constraints::ControlPoints,
            equilibrium: equilibrium::Settings {
                method: equilibrium::Method::LevenbergMarquardt,
                tolerance: equilibrium::Tolerance::Absolute(1e-5),
                escape: false,
                ..self.equilibrium
            },
            solve_start: SolveStart::Measured,
            first_stiffness: FirstStiffness::Constant,
            table: TableHold::AsSeen,
            corrected: false,
            exact_clips: true,
            growth: GrowthRule::PUBLISHED,
            averaged: false,
            robust: None,
            outer: Options { globalisation: Globalisation::LineSearch, gain_tolerance: 0.01, ..self.outer },
            ..self
        }
    }

    /// True for the settings of [`Settings::as_published`].
    pub fn is_as_published(&self) -> bool {
        *self == self.clone().as_published()
    }

    /// Rejects invalid settings, by name.
    ///
    /// # Errors
    /// No control point, or more than 50; `robust` or the start factor not positive; no try at growth; fewer than 3
    /// nodes per side or more than 1000; a side of the cells that is not positive, or beside nodes.
    pub fn validate(&self) -> Result<()> {
        let setting = |field, found: String, expected: &str| {
            Err(Error::Setting { field, found, expected: expected.into() })
        };
        if !(1..=50).contains(&self.points) {
            return setting("points", self.points.to_string(), "1 to 50 control points");
        }
        if !self.robust.is_none_or(|limit| limit > 0.0 && limit.is_finite()) {
            return setting(
                "robust",
                format!("{:?}", self.robust),
                "a positive multiple of the noise, e.g. 3",
            );
        }
        if !(self.start_factor > 0.0 && self.start_factor.is_finite()) {
            return setting("start_factor", self.start_factor.to_string(), "a positive number");
        }
        if self.growth.tries == 0 {
            return setting("growth.tries", "0".into(), "at least 1");
        }
        if let Some(side) = self.for_mesh {
            if !(side > 0.0 && side.is_finite()) {
                return setting("for_mesh", side.to_string(), "a positive side of a cell, m");
            }
            if let Some([columns, rows]) = self.nodes {
                return setting("nodes", format!("{columns}x{rows}"), "none beside a side of the cells");
            }
        }
        match self.nodes {
            Some(nodes) if nodes.iter().any(|side| !(3..=MOST_NODES).contains(side)) => {
                setting("nodes", format!("{}x{}", nodes[0], nodes[1]), "3 to 1000 nodes a side")
            }
            _ => Ok(()),
        }
    }
}
