//! Bending test: a sheet pushed off a table edge bends under its own weight.
//!
//! ```text
//!  z │ ━━━━━━━━━━━━━┓╲
//!    │     table    ┃  ╲  overhang
//!    └──────────────┗━━──────▶ x
//! ```

use super::fabric::KnownFabric;
use super::schedule::Step;
use super::sheet::Sheet;
use super::test::{GRAVITY, Support, Test};
use crate::frame::{Kind, Table};
use nalgebra::{Isometry3, Rotation2, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// The test. Its drive is the overhang, m. At rest the whole sheet lies on the table, up to the edge.
///
/// A hinge represents half a cell on both its sides. For bending to start at the edge, the first row that bends must
/// lie half a cell beyond it. Overhangs are therefore rounded to the middle between two rows of the simulation.
///
/// * `nodes` — nodes of the simulation
pub(super) fn test(fabric: &KnownFabric, kind: Kind, nodes: [usize; 2], steps: Vec<Step>) -> Test {
    let sheet = sheet(fabric, kind);
    let axis = usize::from(kind == Kind::BendWarp);
    let row = sheet.size[axis] / (nodes[axis] - 1) as f64;
    let rounded = move |overhang: f64| ((overhang / row - 0.5).round().max(0.0) + 0.5) * row;
    Test {
        kind,
        sheet,
        support: Support::Table {
            table: Table {
                edge_point_m: [0.0; 3],
                edge_direction: [0.0, 1.0, 0.0],
                outward: [1.0, 0.0, 0.0],
            },
            reach: 0.5 * row,
        },
        gravity: GRAVITY,
        motion: Box::new(move |overhang| {
            let pushed = if overhang > 0.0 { rounded(overhang) } else { 0.0 };
            vec![Isometry3::translation(pushed, 0.0, 0.0)]
        }),
        steps,
    }
}

/// A sheet with weft, warp or bias along the outward direction x.
fn sheet(fabric: &KnownFabric, kind: Kind) -> Sheet {
    let size = [fabric.width_m, fabric.height_m];
    let quarter = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -FRAC_PI_2);
    let (yarns, rotation, length) = match kind {
        Kind::BendWarp => (0.0, quarter, fabric.height_m),
        Kind::BendBias => (-FRAC_PI_4, UnitQuaternion::identity(), fabric.width_m),
        _ => (0.0, UnitQuaternion::identity(), fabric.width_m),
    };
    let place = Isometry3::from_parts(Translation3::new(-length, 0.0, 0.0), rotation);
    Sheet { size, yarns: Rotation2::new(yarns), place }
}
