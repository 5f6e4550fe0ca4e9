//! From where a sheet is seen.

use crate::scene::normal;
use cloth_sim::mesh::Mesh;
use nalgebra::{Rotation3, Unit, Vector3};

/// A hanging sheet is seen from its front, turned so far and from so far above, rad.
const HANGING: [f64; 2] = [0.5, 0.2];
/// A lying one is seen along warp, turned so far and from so far above, rad.
const LYING: [f64; 2] = [0.35, 0.45];

/// A direction of view; all vectors of unit length.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    /// Against gravity.
    pub(super) upright: Vector3<f64>,
    /// To the right in the picture.
    right: Vector3<f64>,
    /// Up in the picture.
    up: Vector3<f64>,
    /// To the eye.
    pub(super) towards: Vector3<f64>,
}

impl View {
    /// A good view of a sheet; z is up where there is no gravity.
    pub(super) fn of(mesh: &Mesh, gravity: Vector3<f64>) -> Self {
        let upright = (-gravity).try_normalize(0.0).unwrap_or(Vector3::z());
        let level = |direction: Vector3<f64>| direction - upright * direction.dot(&upright);
        let front = level(normal(mesh));
        let (front, [turn, rise]) = match front.norm() > 0.5 {
            true => (front.normalize(), HANGING),
            false => {
                let aside = if upright.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
                (level(aside).normalize().cross(&upright), LYING)
            }
        };
        let turned = Rotation3::from_axis_angle(&Unit::new_normalize(upright), turn) * front;
        let towards = turned * rise.cos() + upright * rise.sin();
        let right = upright.cross(&towards).normalize();
        Self { upright, right, up: towards.cross(&right), towards }
    }

    /// The same from straight above.
    pub(super) fn above(&self) -> Self {
        Self { up: self.upright.cross(&self.right), towards: self.upright, ..*self }
    }

    pub(super) fn is_from_above(&self) -> bool {
        self.towards == self.upright
    }

    /// Right, up, and towards the eye, m.
    pub(super) fn see(&self, point: Vector3<f64>) -> [f64; 3] {
        [self.right, self.up, self.towards].map(|axis| axis.dot(&point))
    }

    /// Two level directions across each other.
    pub(super) fn level(&self) -> [Vector3<f64>; 2] {
        [self.right, self.upright.cross(&self.right)]
    }

    /// Where light comes from: over the left shoulder.
    pub(super) fn light(&self) -> Vector3<f64> {
        (self.towards + 0.5 * self.up - 0.7 * self.right).normalize()
    }

    /// Lowest and highest of what is seen, right and up, m.
    pub(super) fn extent(&self, points: &[Vector3<f64>]) -> [[f64; 2]; 2] {
        let seen = points.iter().map(|&point| self.see(point));
        seen.fold([[f64::MAX; 2], [f64::MIN; 2]], |[low, high], [x, y, _]| {
            [[low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]]
        })
    }
}
