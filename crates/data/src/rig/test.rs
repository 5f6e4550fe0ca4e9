//! A test of the rig: a sheet, its support, and the motion of the support.

use super::schedule::Step;
use super::sheet::Sheet;
use crate::frame::{Kind, Table};
use cloth_sim::mesh::Mesh;
use nalgebra::{Isometry3, Vector2, Vector3};

/// Gravity of tests with weight, m/s².
pub(super) const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

/// Distances below this count as zero, m.
const CLOSE: f64 = 1e-9;

/// A test.
pub(super) struct Test {
    /// Kind of the test.
    pub(super) kind: Kind,
    /// The sheet at rest.
    pub(super) sheet: Sheet,
    /// Support of the sheet.
    pub(super) support: Support,
    /// Gravity, m/s². Without it the sheet stays in its plane.
    pub(super) gravity: Vector3<f64>,
    /// Motion of every clip, or of the sheet on the table, as a function of the drive; identity at drive 0.
    pub(super) motion: Box<dyn Fn(f64) -> Vec<Isometry3<f64>> + Send + Sync>,
    /// The frames to measure.
    pub(super) steps: Vec<Step>,
}

/// Support of a sheet.
pub(super) enum Support {
    /// Clips.
    Clips(Vec<Grip>),
    /// A table, with the sheet pushed over its edge.
    Table {
        /// Position of the table.
        table: Table,
        /// Width of the strip beyond the edge that is held too, m.
        reach: f64,
    },
}

/// A clip, and the rectangle of the sheet that it grips.
#[derive(Debug, Clone)]
pub(super) struct Grip {
    /// Its name.
    pub(super) name: &'static str,
    /// Its mass, kg.
    pub(super) mass_kg: f64,
    /// Lowest corner, in sheet coordinates, m.
    pub(super) low: Vector2<f64>,
    /// Highest corner, in sheet coordinates, m.
    pub(super) high: Vector2<f64>,
}

impl Grip {
    /// A long bar on a whole side of a sheet, 13.3 g (Miguel et al. 2012, §3).
    ///
    /// * `axis` — 0: a side of constant x, 1: a side of constant y
    /// * `end` — 0: the side at 0, 1: the opposite one
    pub(super) fn bar(name: &'static str, sheet: &Sheet, axis: usize, end: usize) -> Self {
        let mut low = Vector2::zeros();
        let mut high = Vector2::from(sheet.size);
        if end == 0 {
            high[axis] = 0.0;
        } else {
            low[axis] = high[axis];
        }
        Self { name, mass_kg: 0.0133, low, high }
    }

    /// True if a point of the sheet lies in the clip.
    pub(super) fn holds(&self, point: &Vector2<f64>) -> bool {
        let slack = Vector2::repeat(CLOSE);
        *point >= self.low - slack && *point <= self.high + slack
    }

    /// Unit vector along the longer side of the clip, in sheet coordinates.
    fn axis(&self) -> Vector3<f64> {
        let extent = self.high - self.low;
        if extent.x > extent.y { Vector3::x() } else { Vector3::y() }
    }
}

impl Test {
    /// The clips; empty for a table.
    pub(super) fn grips(&self) -> &[Grip] {
        match &self.support {
            Support::Clips(grips) => grips,
            Support::Table { .. } => &[],
        }
    }

    /// True if all motion stays in the sheet's plane.
    pub(super) fn is_planar(&self) -> bool {
        self.gravity == Vector3::zeros()
    }

    /// Vertices of a mesh of the sheet held by a clip.
    pub(super) fn gripped(&self, mesh: &Mesh, grip: &Grip) -> Vec<usize> {
        (0..mesh.len()).filter(|&vertex| grip.holds(&self.sheet.own(&mesh.material[vertex]))).collect()
    }

    /// Motions that hold each vertex: none, one, or two where bars are hinged together.
    pub(super) fn holders(&self, mesh: &Mesh, motions: &[Isometry3<f64>]) -> Vec<Vec<usize>> {
        let vertices = 0..mesh.len();
        match &self.support {
            Support::Clips(grips) => {
                let own = |vertex: usize| self.sheet.own(&mesh.material[vertex]);
                let of = |point| (0..grips.len()).filter(|&clip| grips[clip].holds(&point)).collect();
                vertices.map(|vertex| of(own(vertex))).collect()
            }
            Support::Table { table, reach } => {
                let [edge, outward] = [table.edge_point_m, table.outward].map(Vector3::from);
                let beyond = |p: &Vector3<f64>| (moved(&motions[0], p) - edge).dot(&outward);
                let of = |p| if beyond(p) <= reach + CLOSE { vec![0] } else { vec![] };
                mesh.positions.iter().map(of).collect()
            }
        }
    }

    /// Long axis of every clip under these motions, in world coordinates.
    pub(super) fn axes(&self, motions: &[Isometry3<f64>]) -> Vec<Vector3<f64>> {
        let axis = |(grip, motion): (&Grip, &Isometry3<f64>)| {
            motion.rotation * (self.sheet.place.rotation * grip.axis())
        };
        self.grips().iter().zip(motions).map(axis).collect()
    }
}

/// Position of a point under a motion.
pub(super) fn moved(motion: &Isometry3<f64>, point: &Vector3<f64>) -> Vector3<f64> {
    motion.rotation * point + motion.translation.vector
}
