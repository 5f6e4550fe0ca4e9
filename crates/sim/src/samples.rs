//! Small problems with known answers, for tests, examples and benchmarks.
//!
//! | Sample | Known answer |
//! |---|---|
//! | [`strip`] | the clip force |
//! | [`patch`] | every position: the affine map |
//! | [`hanging_sheet`] | the clip force: the weight |
//! | [`cantilever`] | the weight; small deflections from beam theory |
//! | [`picture_frame`] | no closed form: it buckles |

use crate::cloth::{Cloth, Problem, Rest};
use crate::curve::StiffnessCurve;
use crate::error::Result;
use crate::load::{Guided, Held};
use crate::material::{Component, Compression, Curves, Model};
use crate::mesh::{Diagonals, Grid, Mesh};
use crate::sequence::irregular;
use nalgebra::{Matrix3x2, Vector2, Vector3};

/// Side of the square samples, m.
pub const SIDE: f64 = 0.1;

/// Areal density of the samples, kg/m².
pub const AREAL_DENSITY: f64 = 0.2;

/// Standard gravity, m/s².
pub const GRAVITY: f64 = 9.80665;

/// A problem and the state from which a solve starts.
#[derive(Debug, Clone)]
pub struct Sample {
    /// The sheet at rest.
    pub mesh: Mesh,
    /// Membrane and bending model.
    pub model: Model,
    /// Curves; their components are those of the problem.
    pub curves: Curves,
    /// Areal density, kg/m².
    pub areal_density: f64,
    /// Gravity, m/s².
    pub gravity: Vector3<f64>,
    /// Nodes at prescribed positions.
    pub held: Vec<Held>,
    /// Nodes that may move in some directions only.
    pub guided: Vec<Guided>,
    /// Planar motion, z = const.
    pub planar: bool,
    /// 3 stacked coordinates per node, m; held nodes at their positions.
    pub start: Vec<f64>,
}

impl Sample {
    /// A weightless, free sheet at rest in space.
    pub fn at_rest(mesh: Mesh, model: Model, curves: Curves) -> Self {
        let start = mesh.coordinates();
        Self {
            mesh,
            model,
            curves,
            areal_density: AREAL_DENSITY,
            gravity: Vector3::zeros(),
            held: Vec::new(),
            guided: Vec::new(),
            planar: false,
            start,
        }
    }

    /// The problem.
    ///
    /// * `components` — components that store energy, usually all that have a curve
    /// * `tied` — groups of nodes that share one displacement
    pub fn problem<'a>(&'a self, components: &'a [Component], tied: &'a [Vec<usize>]) -> Problem<'a> {
        Problem {
            mesh: &self.mesh,
            model: self.model,
            components,
            areal_density: self.areal_density,
            gravity: self.gravity,
            held: &self.held,
            tied,
            guided: &self.guided,
            planar: self.planar,
            rest: Rest::Flat,
        }
    }

    /// Prepares the problem with all components that have a curve.
    ///
    /// # Errors
    /// Those of [`Cloth::new`].
    pub fn cloth(&self) -> Result<Cloth> {
        let components: Vec<Component> = self.curves.components().collect();
        Cloth::new(&self.problem(&components, &[]))
    }

    /// Holds every node to which `clip` assigns a clip.
    pub fn hold(&mut self, clip: impl Fn(Vector2<f64>) -> Option<usize>) {
        let rest = &self.mesh.positions;
        self.held = (0..rest.len())
            .filter_map(|node| Some(Held { node, clip: Some(clip(rest[node].xy())?) }))
            .collect();
    }

    /// Moves every node of the start by a map.
    pub fn place(&mut self, to: impl Fn(Vector3<f64>) -> Vector3<f64>) {
        for node in self.start.chunks_exact_mut(3) {
            node.copy_from_slice(to(Vector3::from_column_slice(node)).as_slice());
        }
    }

    /// Moves every free node of the start by an irregular vector of up to `size`, m; in the plane for planar problems.
    pub fn perturb(&mut self, size: f64) {
        let held: Vec<usize> = self.held.iter().map(|held| held.node).collect();
        for (node, x) in self.start.chunks_exact_mut(3).enumerate().filter(|(node, _)| !held.contains(node)) {
            for i in 0..if self.planar { 2 } else { 3 } {
                x[i] += size * irregular(3 * node + i);
            }
        }
    }

    /// Total weight, N.
    pub fn weight(&self) -> Vector3<f64> {
        let area: f64 =
            (0..self.mesh.triangles.len()).map(|triangle| 0.5 * self.mesh.double_area(triangle)).sum();
        self.gravity * (self.areal_density * area)
    }
}

/// Curves of constant stiffness.
///
/// # Errors
/// A stiffness that is not finite.
pub fn linear_curves(model: Model, stiffnesses: &[(Component, f64)]) -> Result<Curves> {
    let curve = |&(component, stiffness): &(Component, f64)| {
        let negative = model.negative_strain(component, Compression::ZeroStrain);
        Ok((component, StiffnessCurve::constant(stiffness, negative)?))
    };
    stiffnesses.iter().map(curve).collect()
}

/// Constant stiffness in weft, warp and shear, N/m, and in all bending components, N·m.
///
/// # Errors
/// A stiffness that is not finite.
pub fn fabric(model: Model, [stretch, shear, bend]: [f64; 3]) -> Result<Curves> {
    use Component::*;
    linear_curves(
        model,
        &[
            (StretchWeft, stretch),
            (StretchWarp, stretch),
            (Shear, shear),
            (BendWeft, bend),
            (BendWarp, bend),
            (BendDiagonal, bend),
        ],
    )
}

/// A square grid of `nodes` × `nodes`.
///
/// # Errors
/// Fewer than two nodes per side.
pub fn square(nodes: usize, diagonals: Diagonals) -> Result<Mesh> {
    Grid { columns: nodes, rows: nodes, width: SIDE, height: SIDE, diagonals }.mesh()
}

/// Sheet cut at an angle (rad) to weft.
pub fn cut_on_the_bias(mut mesh: Mesh, angle: f64) -> Mesh {
    let rotation = nalgebra::Rotation2::new(angle);
    mesh.material.iter_mut().for_each(|m| *m = rotation * *m);
    mesh
}

/// A strip stretched along weft by two clips, and the force of the pulling clip, N.
///
/// ```text
///  clip 0 ▌▔▔▔▔▔▔▔▔▐ clip 1 →      force / width = σ(λ − 1),  StVK: λ σ((λ² − 1)/2)
/// ```
///
/// Planar; starts from uniform stretch.
///
/// * `stiffness` — of weft and warp, N/m; no shear
///
/// # Errors
/// A stiffness that is not finite.
pub fn strip(model: Model, diagonals: Diagonals, stiffness: f64, stretch: f64) -> Result<(Sample, f64)> {
    let mesh = Grid { columns: 9, rows: 6, width: SIDE, height: 0.04, diagonals }.mesh()?;
    let components = [Component::StretchWeft, Component::StretchWarp];
    let curves = linear_curves(model, &components.map(|component| (component, stiffness)))?;
    let mut sample = Sample { planar: true, ..Sample::at_rest(mesh, model, curves) };
    sample.hold(|p| if p.x == 0.0 { Some(0) } else { (p.x > 0.999 * SIDE).then_some(1) });
    sample.place(|p| Vector3::new(stretch * p.x, p.y, p.z));
    let measure = model.strain_measure(Component::StretchWeft);
    let nominal_stress = measure.load(stretch - 1.0, |strain| stiffness * strain).unwrap_or(f64::NAN);
    Ok((sample, 0.04 * nominal_stress))
}

/// An irregular mesh whose border is held on an affine map. It starts on the map everywhere, which is an exact
/// equilibrium of every triangle model.
///
/// Springs use a regular grid; their inner nodes are in equilibrium as well.
///
/// # Errors
/// A stiffness that is not finite.
pub fn patch(model: Model, map: Matrix3x2<f64>) -> Result<Sample> {
    let mut mesh = square(7, Diagonals::Alternating)?;
    if !model.is_of_springs() {
        let inside = |c: f64| c > 0.0 && c < 0.999 * SIDE;
        for node in 0..mesh.len() {
            let m = mesh.material[node];
            if inside(m.x) && inside(m.y) {
                let moved =
                    m + Vector2::new(irregular(2 * node), irregular(2 * node + 1)) * (0.2 * SIDE / 6.0);
                mesh.material[node] = moved;
                mesh.positions[node] = moved.push(0.0);
            }
        }
        mesh = Mesh::new(mesh.positions, mesh.material, mesh.triangles)?;
    }
    let [weft, warp, shear] = [300.0, 500.0, 40.0];
    let curves = linear_curves(
        model,
        &[(Component::StretchWeft, weft), (Component::StretchWarp, warp), (Component::Shear, shear)],
    )?;
    let mut sample = Sample::at_rest(mesh, model, curves);
    let border = |c: f64| c == 0.0 || c > 0.999 * SIDE;
    sample.hold(|p| (border(p.x) || border(p.y)).then_some(0));
    sample.place(|p| map * p.xy());
    Ok(sample)
}

/// A sheet hanging from one clip along its upper side; the clip force is the sheet's weight.
///
/// # Errors
/// Fewer than two nodes per side.
pub fn hanging_sheet(model: Model, nodes: usize) -> Result<Sample> {
    let mut sample =
        Sample::at_rest(square(nodes, Diagonals::Alternating)?, model, fabric(model, [300.0, 30.0, 1e-6])?);
    sample.gravity = Vector3::new(0.0, -GRAVITY, 0.0);
    sample.hold(|p| (p.y > 0.999 * SIDE).then_some(0));
    Ok(sample)
}

/// A square that juts out horizontally from a clamp along its first two columns and sags under its weight.
///
/// ```text
///  ▐▔▔▔▔╲      bending stiffness 1e-5 N·m, flexural rigidity D = 3e-5 N·m: ρgL³/D = 65
///         ╲
/// ```
///
/// * `stretch` — stiffness of weft and warp, N/m; a tenth of it in shear
///
/// # Errors
/// Fewer than two nodes per side.
pub fn cantilever(model: Model, nodes: usize, stretch: f64) -> Result<Sample> {
    let curves = fabric(model, [stretch, 0.1 * stretch, 1e-5])?;
    let mut sample = Sample::at_rest(square(nodes, Diagonals::Alternating)?, model, curves);
    sample.gravity = Vector3::new(0.0, 0.0, -GRAVITY);
    let clamped = 1.5 * SIDE / (nodes - 1) as f64;
    sample.hold(|p| (p.x < clamped).then_some(0));
    Ok(sample)
}

/// A picture frame: four bars, hinged at the corners, shear the sheet by an angle (rad), and it buckles out of its
/// plane. The start is flat except for an irregular 10 µm.
///
/// ```text
///     ╱▔▔▔▔▔▔╱     bars (clips) 0 left, 1 right, 2 below, 3 above; corners belong to 2 and 3
///    ╱______╱      all sides keep their length: both stretches are zero, the shear is sin γ
/// ```
///
/// # Errors
/// Fewer than two nodes per side.
pub fn picture_frame(model: Model, nodes: usize, angle: f64) -> Result<Sample> {
    let mut sample =
        Sample::at_rest(square(nodes, Diagonals::Alternating)?, model, fabric(model, [500.0, 20.0, 1e-6])?);
    let far = 0.999 * SIDE;
    sample.hold(|p| match (p.x, p.y) {
        (_, 0.0) => Some(2),
        (_, y) if y > far => Some(3),
        (0.0, _) => Some(0),
        (x, _) if x > far => Some(1),
        _ => None,
    });
    let (sin, cos) = (0.5 * angle).sin_cos();
    sample.place(|p| Vector3::new(cos * p.x + sin * p.y, sin * p.x + cos * p.y, p.z));
    sample.perturb(1e-5);
    Ok(sample)
}

/// Position of a point of a flat sheet after the sheet is rolled to a cylinder.
///
/// ```text
/// s along, t across the direction of the curvature:   (s, t) → R sin(s/R), t, R (1 − cos(s/R))
/// ```
///
/// * `angle` — angle between the direction of curvature and the x axis, rad
/// * `radius` — R, m
pub fn rolled(point: Vector2<f64>, angle: f64, radius: f64) -> Vector3<f64> {
    let (sin, cos) = angle.sin_cos();
    let (along, across) = (cos * point.x + sin * point.y, cos * point.y - sin * point.x);
    let (sin_half, cos_half) = (0.5 * along / radius).sin_cos();
    let bent = 2.0 * radius * sin_half * cos_half;
    Vector3::new(cos * bent - sin * across, sin * bent + cos * across, 2.0 * radius * sin_half * sin_half)
}
