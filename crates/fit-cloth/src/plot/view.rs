//! Viewing directions.

use cloth_data::frame::Table;
use cloth_scene::scene::normal as normal_of;
use cloth_sim::mesh::Mesh;
use nalgebra::{Matrix3, Rotation3, Unit, Vector2, Vector3};

/// A hanging sheet is viewed from its front: turn and elevation, rad.
const HANGING: [f64; 2] = [0.5, 0.2];
/// A lying sheet is viewed along warp: turn and elevation, rad.
const LYING: [f64; 2] = [0.35, 0.45];
/// A sheet between clips is viewed from above its plane, one off a table from beyond the edge: turn and elevation, rad.
const CLIPPED: [f64; 2] = [0.25, 0.95];
const OFF_TABLE: [f64; 2] = [1.0, 0.35];

/// A viewing direction; all vectors are unit vectors.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    /// Against gravity.
    pub(super) upright: Vector3<f64>,
    /// Right in the picture.
    right: Vector3<f64>,
    /// Up in the picture.
    up: Vector3<f64>,
    /// Towards the eye.
    pub(super) towards: Vector3<f64>,
}

impl View {
    /// A good view of a sheet; z is up if there is no gravity.
    pub(super) fn of(mesh: &Mesh, gravity: Vector3<f64>) -> Self {
        let upright = (-gravity).try_normalize(0.0).unwrap_or(Vector3::z());
        let level = |direction: Vector3<f64>| direction - upright * direction.dot(&upright);
        let front = level(normal_of(mesh));
        let (front, [turn, rise]) = match front.norm() > 0.5 {
            true => (front.normalize(), HANGING),
            false => {
                let aside = if upright.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
                (level(aside).normalize().cross(&upright), LYING)
            }
        };
        Self::straight(upright, front).aslant([turn, rise])
    }

    /// Perpendicular to a sheet's mean plane, weft to the right; a sheet off a table is viewed along the edge.
    pub(super) fn against(mesh: &Mesh, table: Option<&Table>, gravity: Vector3<f64>) -> Self {
        if let Some(table) = table {
            let [edge, outward] = [table.edge_direction, table.outward].map(Vector3::from);
            let normal = outward.cross(&edge);
            let upright = if normal.dot(&gravity) > 0.0 { -normal } else { normal };
            return Self::straight(upright, outward.cross(&upright));
        }
        let [normal, weft] = flattest(mesh);
        Self { upright: normal, right: weft, up: normal.cross(&weft), towards: normal }
    }

    /// An oblique version of [`Self::against`] that shows out-of-plane shapes.
    pub(super) fn beside(mesh: &Mesh, table: Option<&Table>, gravity: Vector3<f64>) -> Self {
        let straight = Self::against(mesh, table, gravity);
        match table {
            Some(_) => straight.aslant(OFF_TABLE),
            None => Self::straight(straight.towards, straight.right.cross(&straight.towards)).aslant(CLIPPED),
        }
    }

    /// A horizontal view; `towards` must be horizontal.
    fn straight(upright: Vector3<f64>, towards: Vector3<f64>) -> Self {
        Self { upright, right: upright.cross(&towards).normalize(), up: upright, towards }
    }

    /// Turns a horizontal view around the vertical and raises it, rad.
    fn aslant(&self, [turn, rise]: [f64; 2]) -> Self {
        let upright = self.upright;
        let turned = Rotation3::from_axis_angle(&Unit::new_normalize(upright), turn) * self.towards;
        let towards = turned * rise.cos() + upright * rise.sin();
        let right = upright.cross(&towards).normalize();
        Self { upright, right, up: towards.cross(&right), towards }
    }

    /// View from vertically above.
    pub(super) fn above(&self) -> Self {
        Self { up: self.upright.cross(&self.right), towards: self.upright, ..*self }
    }

    pub(super) fn is_from_above(&self) -> bool {
        self.towards == self.upright
    }

    /// View coordinates of a point: right, up, towards the eye, m.
    pub(super) fn see(&self, point: Vector3<f64>) -> [f64; 3] {
        [self.right, self.up, self.towards].map(|axis| axis.dot(&point))
    }

    /// Two perpendicular horizontal directions.
    pub(super) fn level(&self) -> [Vector3<f64>; 2] {
        [self.right, self.upright.cross(&self.right)]
    }

    /// Direction towards the light: over the left shoulder.
    pub(super) fn light(&self) -> Vector3<f64> {
        (self.towards + 0.5 * self.up - 0.7 * self.right).normalize()
    }

    /// Minimum and maximum of the view coordinates right and up, m.
    pub(super) fn extent(&self, points: &[Vector3<f64>]) -> [[f64; 2]; 2] {
        let seen = points.iter().map(|&point| self.see(point));
        seen.fold([[f64::MAX; 2], [f64::MIN; 2]], |[low, high], [x, y, _]| {
            [[low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]]
        })
    }
}

/// Normal of a sheet's mean plane, on its front, and the direction of weft in that plane.
fn flattest(mesh: &Mesh) -> [Vector3<f64>; 2] {
    let count = mesh.len() as f64;
    let middle = mesh.positions.iter().sum::<Vector3<f64>>() / count;
    let centre = mesh.material.iter().sum::<Vector2<f64>>() / count;
    let spread: Matrix3<f64> = mesh.positions.iter().map(|p| (p - middle) * (p - middle).transpose()).sum();
    let parts = spread.symmetric_eigen();
    let normal: Vector3<f64> = parts.eigenvectors.column(parts.eigenvalues.imin()).into();
    let normal = if normal.dot(&normal_of(mesh)) < 0.0 { -normal } else { normal };
    let weft: Vector3<f64> =
        mesh.positions.iter().zip(&mesh.material).map(|(p, m)| (p - middle) * (m.x - centre.x)).sum();
    let weft = weft - normal * weft.dot(&normal);
    [normal, weft.try_normalize(0.0).unwrap_or_else(|| perpendicular(normal))]
}

/// A direction perpendicular to another.
fn perpendicular(direction: Vector3<f64>) -> Vector3<f64> {
    let aside = if direction.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    (aside - direction * aside.dot(&direction)).normalize()
}
