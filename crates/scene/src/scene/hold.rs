//! Holds of a scene's sheet.

use super::array::{pair, vector};
use super::file::{BoxFile, CircleFile, Corner, EdgeName, FreeName, HoldFile};
use cloth_data::error::Result;
use cloth_data::io::TomlFile;
use cloth_sim::load::{Free, Guided, Held};
use cloth_sim::mesh::Mesh;
use nalgebra::Vector2;
use std::collections::BTreeMap;

/// A circle in material coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// Centre, m.
    pub centre: Vector2<f64>,
    /// Radius, m.
    pub radius: f64,
}

/// All held and guided nodes.
pub(super) struct Holds {
    pub(super) held: Vec<Held>,
    pub(super) guided: Vec<Guided>,
    pub(super) support: Option<Circle>,
}

/// Extra reach of edges and circles, as a share of the sheet's size, so that rounding does not decide.
const REACH: f64 = 1e-6;

/// Nodes named by the file's holds; a node in several holds belongs to the first.
pub(super) fn holds(holds: &[HoldFile], mesh: &Mesh, file: &TomlFile) -> Result<Holds> {
    let mut held = BTreeMap::new();
    let mut guided = BTreeMap::new();
    for (clip, hold) in holds.iter().enumerate() {
        let key = format!("held[{clip}]");
        let nodes = select(hold, &key, mesh, file)?;
        if nodes.is_empty() {
            return Err(file.invalid(&key, "no node there", "a place where the sheet has nodes"));
        }
        match free(hold, &key, file)? {
            None => nodes.into_iter().for_each(|node| _ = held.entry(node).or_insert(clip)),
            Some(free) => nodes.into_iter().for_each(|node| _ = guided.entry(node).or_insert(free)),
        }
    }
    guided.retain(|node, _| !held.contains_key(node));
    let support = match holds {
        [HoldFile { circle: Some(CircleFile { centre_m, radius_m }), free: None, .. }] => {
            Some(Circle { centre: (*centre_m).into(), radius: *radius_m })
        }
        _ => None,
    };
    Ok(Holds {
        held: held.into_iter().map(|(node, clip)| Held { node, clip: Some(clip) }).collect(),
        guided: guided.into_iter().map(|(node, free)| Guided { node, free }).collect(),
        support,
    })
}

fn select(hold: &HoldFile, key: &str, mesh: &Mesh, file: &TomlFile) -> Result<Vec<usize>> {
    let fold = |start: f64, of: fn(f64, f64) -> f64| {
        mesh.material.iter().fold(Vector2::repeat(start), |m, p| m.zip_map(p, of))
    };
    let [low, high] = [fold(f64::MAX, f64::min), fold(f64::MIN, f64::max)];
    let reach = REACH * (high - low).amax();
    let all = |inside: &dyn Fn(Vector2<f64>) -> bool| -> Vec<usize> {
        (0..mesh.len()).filter(|&node| inside(mesh.material[node])).collect()
    };
    let HoldFile { corner, edge, within, circle, nodes, .. } = hold;
    Ok(match (corner, edge, within, circle, nodes) {
        (Some(corner), None, None, None, None) => {
            let at = match corner {
                Corner::BottomLeft => low,
                Corner::BottomRight => Vector2::new(high.x, low.y),
                Corner::TopLeft => Vector2::new(low.x, high.y),
                Corner::TopRight => high,
            };
            let nearest = (0..mesh.len())
                .min_by(|&a, &b| (mesh.material[a] - at).norm().total_cmp(&(mesh.material[b] - at).norm()));
            nearest.into_iter().collect()
        }
        (None, Some(edge), None, None, None) => all(&|p| match edge {
            EdgeName::Left => p.x - low.x < reach,
            EdgeName::Right => high.x - p.x < reach,
            EdgeName::Bottom => p.y - low.y < reach,
            EdgeName::Top => high.y - p.y < reach,
        }),
        (None, None, Some(BoxFile { low_m, high_m }), None, None) => {
            let low_m = pair(file, &format!("{key}.box.low_m"), *low_m)?;
            let high_m = pair(file, &format!("{key}.box.high_m"), *high_m)?;
            all(&|p| (0..2).all(|i| low_m[i] - reach <= p[i] && p[i] <= high_m[i] + reach))
        }
        (None, None, None, Some(CircleFile { centre_m, radius_m }), None) => {
            let centre = Vector2::from(pair(file, &format!("{key}.circle.centre_m"), *centre_m)?);
            if !(*radius_m >= 0.0 && radius_m.is_finite()) {
                let key = format!("{key}.circle.radius_m");
                return Err(file.invalid(&key, radius_m.to_string(), "0 or more"));
            }
            all(&|p| (p - centre).norm() <= radius_m + reach)
        }
        (None, None, None, None, Some(nodes)) => {
            if let Some(index) = nodes.iter().position(|&node| node >= mesh.len()) {
                let key = format!("{key}.nodes[{index}]");
                let expected = format!("vertices from 0 to {}", mesh.len() - 1);
                return Err(file.invalid(&key, nodes[index].to_string(), expected));
            }
            nodes.clone()
        }
        _ => {
            let expected = "one of corner, edge, box, circle and nodes";
            return Err(file.invalid(key, "none or several places", expected));
        }
    })
}

/// Free directions of a hold's nodes; `None` for fixed nodes.
fn free(hold: &HoldFile, key: &str, file: &TomlFile) -> Result<Option<Free>> {
    match (hold.free, hold.direction) {
        (None, None) => Ok(None),
        (Some(free), Some(direction)) => {
            let key = format!("{key}.direction");
            let direction = vector(file, &key, direction)?;
            if direction.norm() == 0.0 {
                return Err(file.invalid(&key, "zero", "a direction"));
            }
            Ok(Some(match free {
                FreeName::Plane => Free::Plane(direction),
                FreeName::Line => Free::Line(direction),
            }))
        }
        _ => {
            let expected =
                "free = \"line\" with a direction, or free = \"plane\" with its normal as direction";
            Err(file.invalid(key, "one of free and direction", expected))
        }
    }
}
