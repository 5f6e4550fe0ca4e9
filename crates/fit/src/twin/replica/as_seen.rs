//! A sheet on a table as published: the nodes on the table are held where they were seen, all others are free.
//!
//! The sheet bends at the edge itself, which falls between two lines of nodes, so that the fitted rigidity is far too
//! large: see [`overhang`](super::overhang) for the default. Source: Miguel et al. 2012, §5.1.

use super::layout::Layout;
use super::profile::Profile;
use super::skip::Skip;
use crate::twin::specimen::Specimen;
use cloth_sim::load::Held;
use nalgebra::{Vector2, Vector3};

/// Fewest nodes on the table, without which the sheet could rotate, and past its edge.
const FEWEST: usize = 3;

/// Nodes of one line agree up to rounding, as a share of the sheet.
const TOGETHER: f64 = 1e-6;

/// A sheet on a table.
pub(super) struct AsSeen {
    /// The nodes on the table.
    pub(super) held: Vec<Held>,
    /// Length of cloth past the edge, m.
    pub(super) length: f64,
    /// From the edge to the outermost nodes, in the axes of the edge, m.
    pub(super) chord: Vector3<f64>,
    /// The shape; nodes that nobody saw lie on the profile of the others. 3 stacked coordinates per node, m.
    pub(super) start: Vec<f64>,
}

/// The nodes of a shape that are on the table.
///
/// * `shape` — 3 stacked coordinates per node of the specimen, NaN where unobserved
///
/// # Errors
/// The reason why the frame tells nothing of bending.
pub(super) fn held(layout: &Layout, specimen: &Specimen, shape: &[f64]) -> Result<AsSeen, Skip> {
    let along = |node: usize| layout.sheet.unrolled(specimen.mesh.positions[node].xy())[0];
    let place = |node: usize| layout.placed(&Vector3::from_column_slice(&shape[3 * node..3 * node + 3]));
    let seen = (0..specimen.mesh.len()).filter(|&node| place(node).x.is_finite());
    let (hanging, lying): (Vec<usize>, Vec<usize>) = seen.partition(|&node| place(node).x > 0.0);
    let Some(edge) = hanging.iter().map(|&node| along(node)).reduce(f64::min) else {
        return Err(Skip::NothingHangsOver);
    };
    // The hanging part may swing back under the table.
    let held: Vec<Held> =
        lying.into_iter().filter(|&node| along(node) < edge).map(|node| Held { node, clip: None }).collect();
    if hanging.len() < FEWEST || held.len() < FEWEST {
        return Err(Skip::FewPoints { seen: hanging.len() });
    }
    let end = hanging.iter().map(|&node| along(node)).fold(f64::MIN, f64::max);
    let outermost = hanging.iter().filter(|&&node| along(node) >= end - TOGETHER * layout.sheet.length);
    let outermost: Vec<Vector3<f64>> = outermost.map(|&node| place(node)).collect();
    let chord = outermost.iter().sum::<Vector3<f64>>() / outermost.len() as f64;
    Ok(AsSeen { held, length: layout.sheet.length - edge, chord, start: completed(layout, specimen, shape) })
}

/// A shape with unobserved nodes on the profile of the observed ones.
fn completed(layout: &Layout, specimen: &Specimen, shape: &[f64]) -> Vec<f64> {
    let flat = |node: usize| layout.sheet.unrolled(specimen.mesh.positions[node].xy());
    let place = |node: usize| layout.placed(&Vector3::from_column_slice(&shape[3 * node..3 * node + 3]));
    let seen: Vec<usize> = (0..specimen.mesh.len()).filter(|&node| place(node).x.is_finite()).collect();
    let along = |&node: &usize| (flat(node)[0], Vector2::new(place(node).x, place(node).z));
    let profile = Profile::new(seen.iter().map(along).collect());
    let lateral =
        seen.iter().map(|&node| place(node).y - flat(node)[1]).sum::<f64>() / seen.len().max(1) as f64;
    let back = layout.axes.inverse();
    let mut start = shape.to_vec();
    for node in (0..specimen.mesh.len()).filter(|&node| !place(node).x.is_finite()) {
        let [s, across] = flat(node);
        let at = profile.at(s);
        let at = back.rotation * Vector3::new(at.x, across + lateral, at.y) + back.translation.vector;
        start[3 * node..3 * node + 3].copy_from_slice(at.as_slice());
    }
    start
}
