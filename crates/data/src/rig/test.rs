//! A test as the rig carries it out: a sheet, what holds it, and how that moves.

use super::schedule::Step;
use super::sheet::Sheet;
use crate::frame::{Kind, Table};
use cloth_sim::mesh::Mesh;
use nalgebra::{Isometry3, Vector2, Vector3};

/// Gravity where a test has weight, m/s².
pub(super) const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

/// Distances below this are none, m.
const CLOSE: f64 = 1e-9;

/// A test.
pub(super) struct Test {
    /// Which.
    pub(super) kind: Kind,
    /// The sheet at rest.
    pub(super) sheet: Sheet,
    /// What holds it.
    pub(super) support: Support,
    /// Gravity, m/s². Without it the sheet stays in its plane.
    pub(super) gravity: Vector3<f64>,
    /// The motion of every clip, or of the sheet on the table, at a drive; none at drive 0.
    pub(super) motion: Box<dyn Fn(f64) -> Vec<Isometry3<f64>> + Send + Sync>,
    /// The frames to measure.
    pub(super) steps: Vec<Step>,
}

/// What holds a sheet.
pub(super) enum Support {
    /// Clips.
    Clips(Vec<Grip>),
    /// A table, over whose edge the sheet is pushed.
    Table {
        /// Where it ends.
        table: Table,
        /// What is no further beyond the edge is held too, m.
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
    /// Lowest corner, in the sheet's coordinates, m.
    pub(super) low: Vector2<f64>,
    /// Highest corner.
    pub(super) high: Vector2<f64>,
}

impl Grip {
    /// A long bar on a whole side of a sheet, 13.3 g (Miguel et al. 2012, §3).
    ///
    /// * `axis` — 0: a side where x is constant, 1: one where y is
    /// * `end` — 0 or 1: the side at 0, or the one opposite
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

    /// A point of the sheet lies in the clip.
    pub(super) fn holds(&self, point: &Vector2<f64>) -> bool {
        let slack = Vector2::repeat(CLOSE);
        *point >= self.low - slack && *point <= self.high + slack
    }

    /// Unit vector of the clip's longer side, in the sheet's coordinates.
    fn axis(&self) -> Vector3<f64> {
        let extent = self.high - self.low;
        if extent.x > extent.y { Vector3::x() } else { Vector3::y() }
    }
}

impl Test {
    /// The clips; none on a table.
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

    /// The vertices of a mesh of the sheet that a clip grips.
    pub(super) fn gripped(&self, mesh: &Mesh, grip: &Grip) -> Vec<usize> {
        (0..mesh.len()).filter(|&vertex| grip.holds(&self.sheet.own(&mesh.material[vertex]))).collect()
    }

    /// For every vertex the motions that hold it at a drive: none, one, or two where bars are hinged
    /// together.
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

    /// Long axis of every clip at these motions, in world coordinates.
    pub(super) fn axes(&self, motions: &[Isometry3<f64>]) -> Vec<Vector3<f64>> {
        let axis = |(grip, motion): (&Grip, &Isometry3<f64>)| {
            motion.rotation * (self.sheet.place.rotation * grip.axis())
        };
        self.grips().iter().zip(motions).map(axis).collect()
    }
}

/// Where a motion takes a point.
pub(super) fn moved(motion: &Isometry3<f64>, point: &Vector3<f64>) -> Vector3<f64> {
    motion.rotation * point + motion.translation.vector
}
