//! Settings of a strip test: information missing from the table, and the part of it to use.

use super::column::Column;
use crate::error::{Error, Result};
use crate::frame::Kind;
use crate::io::check_length;
use cloth_sim::mesh::Mesh;
use nalgebra::{Rotation2, Vector2, Vector3};
use std::f64::consts::FRAC_PI_4;
use std::ops::RangeInclusive;

/// Largest length and width of a strip, m.
pub(super) const LARGEST: f64 = 10.0;
/// Largest allowed reading of an empty load cell, N.
const LARGEST_ZERO: f64 = 1e6;

/// Direction of the pull relative to the yarns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Along the weft yarns.
    Weft,
    /// Along the warp yarns.
    Warp,
    /// At 45° to both.
    Bias,
}

impl Direction {
    /// Kind of the sequence.
    pub fn kind(self) -> Kind {
        match self {
            Self::Weft => Kind::StretchWeft,
            Self::Warp => Kind::StretchWarp,
            Self::Bias => Kind::StretchBias,
        }
    }
}

/// Representation of the clamp distance in the table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Extension {
    /// The distance itself, a length.
    Separation(Column),
    /// Increase over the gauge length, a length.
    Displacement(Column),
    /// Increase divided by the gauge length (engineering strain).
    Strain(Column),
}

/// Clamp distance at which the strip is straight and free, the reference of strains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FreeLength {
    /// The gauge length.
    Gauge,
    /// A given length, m, for a strip mounted slack or under tension.
    Length(f64),
    /// The zero of the first loading, extrapolated by a parabola from this force, N.
    Preload(f64),
}

/// Settings of a strip test.
#[derive(Debug, Clone, PartialEq)]
pub struct StripTest {
    /// Name of the sequence. Default: its kind.
    pub name: String,
    /// Direction of the pull.
    pub direction: Direction,
    /// Clamp distance at zero displacement, m.
    pub gauge: f64,
    /// The free length. Default: the gauge length.
    pub free_length: FreeLength,
    /// Width of the strip, across the pull, m.
    pub width: f64,
    /// Clamp distance.
    pub extension: Extension,
    /// The load cell's reading, positive in tension.
    pub force: Column,
    /// Load cell reading without load, N. Default: 0.
    pub zero: f64,
    /// Compliance of machine and clamps, m/N, subtracted from the extension. Default: 0.
    pub compliance: f64,
    /// Column that numbers the branches of the test. Default: `branch` if the table has it; otherwise branches are
    /// split where the extension reverses by more than 2 % of its range, and numbered from 0.
    pub branch_column: Option<String>,
    /// Branches to use. Default: all.
    pub branches: Option<Vec<usize>>,
    /// Rows to use, both ends included; the first row below the header is 1, and blank lines do not count.
    /// `usize::MAX` = the last one. Default: all.
    pub rows: Option<RangeInclusive<usize>>,
    /// Use the first row of every branch and then every n-th. Default: 1, every row.
    pub every: usize,
    /// Standard deviation of the load cell, N. Default: unknown.
    pub force_noise: Option<f64>,
}

impl Extension {
    /// Column of the extension.
    pub fn column(&self) -> &Column {
        match self {
            Self::Separation(column) | Self::Displacement(column) | Self::Strain(column) => column,
        }
    }
}

impl StripTest {
    /// Names of the required columns.
    pub fn columns(&self) -> Vec<&str> {
        let asked = [&self.extension.column().name, &self.force.name];
        asked.into_iter().chain(&self.branch_column).map(String::as_str).collect()
    }

    /// A test with the defaults above.
    pub fn new(direction: Direction, gauge: f64, width: f64, extension: Extension, force: Column) -> Self {
        Self {
            name: direction.kind().to_string(),
            direction,
            gauge,
            free_length: FreeLength::Gauge,
            width,
            extension,
            force,
            zero: 0.0,
            compliance: 0.0,
            branch_column: None,
            branches: None,
            rows: None,
            every: 1,
            force_noise: None,
        }
    }

    /// Checks the settings.
    ///
    /// # Errors
    /// The first setting outside its range.
    pub fn validate(&self) -> Result<()> {
        let refuse = |field, found: String, expected: &str| {
            Err(Error::Setting { field, found, expected: expected.into() })
        };
        if self.name.is_empty() {
            return refuse("name", "nothing".into(), "a name for the sequence");
        }
        let free_length = match self.free_length {
            FreeLength::Length(length) => length,
            FreeLength::Gauge | FreeLength::Preload(_) => self.gauge,
        };
        for (field, value) in [("gauge", self.gauge), ("width", self.width), ("free_length", free_length)] {
            check_length(value, LARGEST).or_else(|expected| refuse(field, value.to_string(), &expected))?;
        }
        if let FreeLength::Preload(force) = self.free_length
            && !(force > 0.0 && force.is_finite())
        {
            return refuse("preload", force.to_string(), "a force above 0, in N");
        }
        if !(self.zero.abs() <= LARGEST_ZERO) {
            return refuse("zero", self.zero.to_string(), "a force of at most 1e6, in N");
        }
        if !(self.compliance >= 0.0 && self.compliance.is_finite()) {
            return refuse("compliance", self.compliance.to_string(), "0 or more, in m/N");
        }
        if self.every == 0 {
            return refuse("every", "0".into(), "1 for every row, 2 for every second, …");
        }
        if self.branches.as_ref().is_some_and(Vec::is_empty) {
            return refuse("branches", "none".into(), "at least one branch");
        }
        match self.force_noise.filter(|noise| !(*noise > 0.0 && noise.is_finite())) {
            Some(noise) => refuse("force_noise", noise.to_string(), "a standard deviation above 0, in N"),
            None => Ok(()),
        }
    }

    /// Rest mesh and direction of the pull; vertices 0 and 1 are in the fixed clamp, 2 and 3 in the moving one.
    ///
    /// * `length` — free length, m
    pub(super) fn specimen(&self, length: f64) -> cloth_sim::error::Result<(Mesh, Vector3<f64>)> {
        let (l, w) = (length, self.width);
        let (corners, triangles, pull) = match self.direction {
            Direction::Warp => {
                ([[0.0, 0.0], [w, 0.0], [0.0, l], [w, l]], [[0, 1, 3], [0, 3, 2]], Vector3::y())
            }
            Direction::Weft | Direction::Bias => {
                ([[0.0, 0.0], [0.0, w], [l, 0.0], [l, w]], [[0, 2, 3], [0, 3, 1]], Vector3::x())
            }
        };
        let turn = Rotation2::new(if self.direction == Direction::Bias { FRAC_PI_4 } else { 0.0 });
        let corners = corners.map(Vector2::from);
        let positions = corners.iter().map(|corner| Vector3::new(corner.x, corner.y, 0.0)).collect();
        let material = corners.iter().map(|corner| turn * corner).collect();
        Ok((Mesh::new(positions, material, triangles.to_vec())?, pull))
    }
}
