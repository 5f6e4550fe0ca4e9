//! The pose of a sheet at the edge of a table.

use nalgebra::Vector2;

/// Place and slope of the sheet at a table's edge, and the tilt of its lines.
///
/// A sheet under gravity alone moves with the place, so that only the slope changes its shape.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EdgePose {
    /// Outward and up, m.
    pub place: Vector2<f64>,
    /// Rise of the lines along the edge, outward and up, m/m.
    pub tilt: Vector2<f64>,
    /// Angle of the sheet to the outward direction, rad.
    pub slope: f64,
}

impl EdgePose {
    /// Number of unknowns: place, tilt, slope.
    pub const UNKNOWNS: usize = 5;

    /// The pose after a step of its unknowns.
    pub fn after(&self, step: &[f64]) -> Self {
        Self {
            place: self.place + Vector2::new(step[0], step[1]),
            tilt: self.tilt + Vector2::new(step[2], step[3]),
            slope: self.slope + step[4],
        }
    }

    /// Position of a point of the sheet.
    ///
    /// * `shape` — its coordinate outward or up if the sheet's place is 0 and its lines are along the edge
    /// * `shares` — of place and tilt
    pub fn coordinate(&self, shape: f64, side: usize, shares: [f64; 2]) -> f64 {
        shape + shares[0] * self.place[side] + shares[1] * self.tilt[side]
    }
}
