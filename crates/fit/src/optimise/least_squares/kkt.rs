//! A point with its multipliers, and its distance from optimality.

use nalgebra::DVector;

/// A point and the multipliers of all (unit) rows, zero for rows that are not held.
#[derive(Debug, Clone)]
pub(super) struct Held {
    pub(super) point: DVector<f64>,
    pub(super) multipliers: DVector<f64>,
}

/// Violation of the optimality conditions, in scaled unknowns; every figure is relative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kkt {
    /// Largest entry of gradient − Gᵀλ, over ‖y‖ + ‖q‖.
    pub stationarity: f64,
    /// Largest violation of a row, over the size of the numbers in it.
    pub primal: f64,
    /// Largest negative multiplier, over the same as stationarity.
    pub dual: f64,
    /// Largest product of multiplier and slack, over both scales.
    pub complementarity: f64,
}

impl Kkt {
    /// The largest of the figures; NaN if one is.
    pub fn largest(&self) -> f64 {
        let figures = [self.stationarity, self.primal, self.dual, self.complementarity];
        figures
            .into_iter()
            .fold(0.0, |worst, figure| if figure > worst || figure.is_nan() { figure } else { worst })
    }
}
