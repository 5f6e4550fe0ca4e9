//! The air: wind, and drag on moving cloth.

use super::state::State;
use crate::cloth::Cloth;
use crate::element::{gather, stacked};
use crate::error::{Error, Result};
use nalgebra::{Matrix3, Vector3};

/// Moving air and its drag on cloth.
///
/// ```text
/// w(t) = velocity + gust sin(2π t / gust_period)
/// a node's share of a triangle    F = B (w − v_node)
/// B = (A/3) ½ρ [ c_n |u·n| n nᵀ + c_t |u| (I − n nᵀ) ]      u = w − v of the triangle's middle, n its normal
/// ```
///
/// Pressure and friction grow with the square of the speed. B is evaluated at the start of a step, so still air always
/// takes energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wind {
    /// Mean velocity, m/s.
    pub velocity: Vector3<f64>,
    /// Gust amplitude, m/s; zero for steady wind.
    pub gust: Vector3<f64>,
    /// Gust period, s.
    pub gust_period: f64,
    /// Density ρ, kg/m³; 1.2 at 20 °C.
    pub density: f64,
    /// c_n; about 1.2 for a plate across the wind (Hoerner 1965).
    pub normal_drag: f64,
    /// c_t; a few hundredths for a plate along the wind.
    pub tangential_drag: f64,
}

impl Default for Wind {
    /// Air at rest.
    fn default() -> Self {
        Self {
            velocity: Vector3::zeros(),
            gust: Vector3::zeros(),
            gust_period: 1.0,
            density: 1.2,
            normal_drag: 1.2,
            tangential_drag: 0.02,
        }
    }
}

impl Wind {
    /// Velocity of the air at a time (s), m/s.
    pub fn at(&self, time: f64) -> Vector3<f64> {
        self.velocity + self.gust * (std::f64::consts::TAU * time / self.gust_period).sin()
    }

    /// Computes B at every node, kg/s.
    pub(super) fn drag(&self, cloth: &Cloth, state: &State, air: Vector3<f64>, drag: &mut Vec<Matrix3<f64>>) {
        drag.clear();
        drag.resize(cloth.points(), Matrix3::zeros());
        for &nodes in cloth.triangles() {
            let [a, b, c] = gather::<3, 3>(stacked(nodes), &state.positions);
            let [p, q, r] = gather::<3, 3>(stacked(nodes), &state.velocities);
            let across = (b - a).cross(&(c - a));
            let Some(normal) = across.try_normalize(f64::MIN_POSITIVE) else { continue };
            let relative = air - (p + q + r) / 3.0;
            let share = self.density * across.norm() / 12.0;
            let along_normal = normal * normal.transpose();
            let block = along_normal * (share * self.normal_drag * relative.dot(&normal).abs())
                + (Matrix3::identity() - along_normal) * (share * self.tangential_drag * relative.norm());
            nodes.iter().for_each(|&node| drag[node] += block);
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        let numbers = [
            ("wind.density", self.density, self.density >= 0.0),
            ("wind.normal_drag", self.normal_drag, self.normal_drag >= 0.0),
            ("wind.tangential_drag", self.tangential_drag, self.tangential_drag >= 0.0),
            ("wind.gust_period", self.gust_period, self.gust_period > 0.0),
            ("wind.velocity", self.velocity.norm(), true),
            ("wind.gust", self.gust.norm(), true),
        ];
        match numbers.iter().find(|(_, value, fits)| !(*fits && value.is_finite())) {
            Some(&(field, value, _)) => Err(Error::InvalidValue {
                field,
                value,
                expected: "a finite number, 0 or more; a period above 0",
            }),
            None => Ok(()),
        }
    }
}
