//! The mathematics of one element, and the sums over all elements of a kind.
//!
//! Every element of every model is **strain measure × law → energy**:
//!
//! ```text
//! E   = A W(ε)                                           A the area that the element stands for
//! ∇E  = A Σ_c σ_c ∇ε_c                                   σ_c = ∂W/∂ε_c, from the law
//! ∇²E = A [ Σ_cd T_cd ∇ε_c ∇ε_dᵀ + Σ_c σ_c ∇²ε_c ]       stiffness and geometric part, T_cd = ∂σ_c/∂ε_d
//! ```
//!
//! T is diagonal where every component has its own curve ([`law`](crate::law)).
//!
//! An element sees `N` coordinates per node: 3 in space, 2 in planar motion.
//!
//! Source: Miguel et al. 2012, §4.1.

use crate::law::{Law, Site, Stresses};
use crate::material::Component;
use nalgebra::{SMatrix, SVector};

/// The first `N` coordinates of a node, m.
pub type Point<const N: usize> = SVector<f64, N>;

/// A block of a Hessian between two nodes.
pub type Block<const N: usize> = SMatrix<f64, N, N>;

/// `S` strains over `K` points with `N` coordinates each: springs (2 points, 1 strain), triangles (3, 3), hinges (4, 1),
/// a sheet's triangles (7, 4).
pub trait Element<const K: usize, const N: usize, const S: usize> {
    /// Points that a displacement of the whole cloth moves, the first ones; the others are rotations.
    const TRANSLATED: usize = K;

    /// Indices of the points' coordinates among all stacked ones: of a node, 3 in a row.
    fn coordinates(&self) -> [[usize; 3]; K];

    /// The component of each strain.
    fn components(&self) -> [Component; S];

    /// Area over which the energy density is integrated, m².
    fn area(&self) -> f64;

    /// The area, or a length that it is proportional to: of elements that are alike one gets the sum.
    fn extent(&mut self) -> &mut f64;

    /// The strains (bending: 1/m).
    fn strains(&self, x: &[Point<N>; K]) -> [f64; S];

    /// Derivatives of the strains with respect to every point, 1/m.
    fn gradients(&self, x: &[Point<N>; K]) -> [[Point<N>; K]; S];

    /// Strains and gradients together, for elements where they share work.
    #[inline(always)]
    fn evaluate(&self, x: &[Point<N>; K]) -> ([f64; S], [[Point<N>; K]; S]) {
        (self.strains(x), self.gradients(x))
    }

    /// Adds the geometric part Σ_c σ_c ∇²ε_c to the blocks `[a][b]` with 1 ≤ b ≤ a; see [`complete`] for node 0.
    fn add_geometric(&self, x: &[Point<N>; K], stress: &[f64; S], blocks: &mut [[Block<N>; K]; K]);

    /// Adds the geometric part with a simple, small change that makes it positive semi-definite.
    fn add_clamped(&self, x: &[Point<N>; K], stress: &[f64; S], blocks: &mut [[Block<N>; K]; K]);
}

/// Indices of the coordinates of nodes, of which each has three in a row.
#[inline(always)]
pub fn stacked<const K: usize>(nodes: [usize; K]) -> [[usize; 3]; K] {
    nodes.map(|node| [3 * node, 3 * node + 1, 3 * node + 2])
}

/// Points from all stacked coordinates.
#[inline(always)]
pub fn gather<const K: usize, const N: usize>(coordinates: [[usize; 3]; K], x: &[f64]) -> [Point<N>; K] {
    coordinates.map(|own| Point::from_fn(|i, _| x[own[i]]))
}

/// Fills in the blocks of point 0. Moving all nodes alike changes no strain, so every row of blocks of an element's
/// Hessian sums to zero over them. Saves a third of a hinge's work.
///
/// * `translated` — [`Element::TRANSLATED`]
#[inline(always)]
pub fn complete<const K: usize, const N: usize>(blocks: &mut [[Block<N>; K]; K], translated: usize) {
    let mut corner = Block::zeros();
    for a in 1..K {
        let mut sum = Block::zeros();
        for b in 1..translated {
            sum -= if b <= a { blocks[a][b] } else { blocks[b][a].transpose() };
        }
        blocks[a][0] = sum;
        if a < translated {
            corner -= sum;
        }
    }
    blocks[0][0] = corner;
}

/// Matrix used for a Newton step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HessianKind<'a> {
    /// The true second derivative.
    Full,
    /// Geometric part at the given strains instead of the true ones, `S` per element.
    Mixed(&'a [f64]),
    /// Geometric part clamped to be positive semi-definite, element by element.
    Clamped,
    /// Neither geometric part nor softening: the matrix of stiffness-proportional damping.
    Material,
}

/// A pass over all elements of the cloth, of any kind.
pub(crate) trait Pass {
    /// Visits the membrane's or the bending's elements; `part` is 0 or 1.
    fn visit<const K: usize, const N: usize, const S: usize, E: Element<K, N, S>>(
        &mut self,
        part: usize,
        elements: &[E],
    );
}

/// A change of the lists of elements, whatever their kind.
pub(crate) trait Change {
    /// Changes the elements of the membrane or of bending.
    fn change<const K: usize, const S: usize, E: Element<K, 3, S>>(&mut self, elements: &mut Vec<E>);
}

/// Sums energies, J.
pub(crate) struct EnergyPass<'a, L> {
    pub(crate) law: &'a L,
    pub(crate) x: &'a [f64],
    pub(crate) energy: f64,
}

impl<L: Law> Pass for EnergyPass<'_, L> {
    fn visit<const K: usize, const N: usize, const S: usize, E: Element<K, N, S>>(
        &mut self,
        part: usize,
        elements: &[E],
    ) {
        for (index, element) in elements.iter().enumerate() {
            let site = Site { part, element: index, components: element.components() };
            let strains = element.strains(&gather(element.coordinates(), self.x));
            self.energy += element.area() * self.law.energy(&site, &strains);
        }
    }
}

/// Sums gradients, N, and estimates their rounding errors, N per m of coordinate error.
pub(crate) struct GradientPass<'a, L> {
    pub(crate) law: &'a L,
    pub(crate) x: &'a [f64],
    pub(crate) gradient: &'a mut [f64],
    /// Per node: Σ over elements of the force magnitude, N.
    pub(crate) magnitude: &'a mut [f64],
    /// Per node: Σ A |T_cc| |∇ε_c|², the stiffness that converts a position error to a force error, N/m.
    pub(crate) stiffness: &'a mut [f64],
    pub(crate) energy: f64,
}

impl<L: Law> Pass for GradientPass<'_, L> {
    fn visit<const K: usize, const N: usize, const S: usize, E: Element<K, N, S>>(
        &mut self,
        part: usize,
        elements: &[E],
    ) {
        for (index, element) in elements.iter().enumerate() {
            let (coordinates, components, area) =
                (element.coordinates(), element.components(), element.area());
            let site = Site { part, element: index, components };
            let x = gather(coordinates, self.x);
            let (strains, gradients) = element.evaluate(&x);
            let Stresses { stress, tangent } = self.law.stresses(&site, &strains);
            self.energy += area * self.law.energy(&site, &strains);
            let mut force = [Point::<N>::zeros(); K];
            for c in (0..S).filter(|&c| self.law.has(components[c])) {
                for a in 0..K {
                    force[a] += area * stress[c] * gradients[c][a];
                    let stiffness = area * tangent[c][c].abs();
                    if a < E::TRANSLATED {
                        self.stiffness[coordinates[a][0] / 3] += stiffness * gradients[c][a].norm_squared();
                    } else {
                        let each = coordinates[a].iter().zip(&gradients[c][a]);
                        each.for_each(|(own, slope)| self.stiffness[own / 3] += stiffness * slope * slope);
                    }
                }
            }
            for a in 0..K {
                if a < E::TRANSLATED {
                    self.magnitude[coordinates[a][0] / 3] += force[a].norm();
                } else {
                    let each = coordinates[a].iter().zip(&force[a]);
                    each.for_each(|(own, force)| self.magnitude[own / 3] += force.abs());
                }
                for i in 0..N {
                    self.gradient[coordinates[a][i]] += force[a][i];
                }
            }
        }
    }
}

/// Sums Hessians, scattered through precomputed targets.
pub(crate) struct HessianPass<'a, L> {
    pub(crate) law: &'a L,
    pub(crate) x: &'a [f64],
    pub(crate) kind: HessianKind<'a>,
    /// Per part: destination of each lower entry of each element, in the order of [`lower_entries`].
    pub(crate) targets: [&'a [u32]; 2],
    pub(crate) values: &'a mut [f64],
}

impl<L: Law> Pass for HessianPass<'_, L> {
    fn visit<const K: usize, const N: usize, const S: usize, E: Element<K, N, S>>(
        &mut self,
        part: usize,
        elements: &[E],
    ) {
        let targets = self.targets[part].chunks_exact(lower_entry_count(K, N));
        let mut blocks = [[Block::<N>::zeros(); K]; K];
        for (index, (element, targets)) in elements.iter().zip(targets).enumerate() {
            let (components, area) = (element.components(), element.area());
            let site = Site { part, element: index, components };
            let x = gather(element.coordinates(), self.x);
            let (strains, gradients) = element.evaluate(&x);
            let Stresses { mut stress, mut tangent } = self.law.stresses(&site, &strains);
            if matches!(self.kind, HessianKind::Clamped | HessianKind::Material) {
                L::clamp(&mut tangent);
            }
            // The mixed strains belong to the membrane; a hinge uses its own stress.
            if let (HessianKind::Mixed(mixed), 0) = (self.kind, part) {
                let mixed = std::array::from_fn(|c| mixed[S * index + c]);
                stress = self.law.stresses(&site, &mixed).stress;
            }
            stress.iter_mut().for_each(|stress| *stress *= area);
            tangent.iter_mut().flatten().for_each(|tangent| *tangent *= area);
            for a in 1..K {
                let scaled = scaled::<K, N, S, L>(&tangent, &gradients, a);
                for b in 1..=a {
                    let mut block = scaled[0] * gradients[0][b].transpose();
                    for c in 1..S {
                        block += scaled[c] * gradients[c][b].transpose();
                    }
                    blocks[a][b] = block;
                }
            }
            match self.kind {
                HessianKind::Clamped => element.add_clamped(&x, &stress, &mut blocks),
                HessianKind::Material => (),
                _ => element.add_geometric(&x, &stress, &mut blocks),
            }
            complete(&mut blocks, E::TRANSLATED);
            let mut targets = targets.iter();
            for a in 0..K {
                for b in 0..=a {
                    for j in 0..N {
                        for i in if a == b { j } else { 0 }..N {
                            if let Some(&target) = targets.next() {
                                self.values[target as usize] += blocks[a][b][(i, j)];
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Σ_d T_cd ∇ε_d at one node, for every strain c.
#[inline(always)]
fn scaled<const K: usize, const N: usize, const S: usize, L: Law>(
    tangent: &[[f64; S]; S],
    gradients: &[[Point<N>; K]; S],
    node: usize,
) -> [Point<N>; S] {
    std::array::from_fn(|c| match L::COUPLED {
        false => gradients[c][node] * tangent[c][c],
        true => (0..S).map(|d| gradients[d][node] * tangent[c][d]).sum(),
    })
}

/// Number of lower entries of an element.
fn lower_entry_count(nodes: usize, coordinates: usize) -> usize {
    let unknowns = nodes * coordinates;
    unknowns * (unknowns + 1) / 2
}

/// Scattered entries of an element's Hessian as (point, coordinate) pairs, in the order of the targets.
pub(crate) fn lower_entries(nodes: usize, coordinates: usize) -> Vec<[(usize, usize); 2]> {
    let mut entries = Vec::new();
    for a in 0..nodes {
        for b in 0..=a {
            for j in 0..coordinates {
                for i in if a == b { j } else { 0 }..coordinates {
                    entries.push([(a, i), (b, j)]);
                }
            }
        }
    }
    entries
}

/// Derivative of the gradient with respect to a block of law parameters: one column of 3 × nodes entries per parameter.
pub(crate) struct ParameterPass<'a, L: Law> {
    pub(crate) law: &'a L,
    pub(crate) x: &'a [f64],
    pub(crate) parameters: L::Parameters,
    /// Scratch space, one number per parameter.
    pub(crate) derivative: &'a mut [f64],
    pub(crate) columns: &'a mut [f64],
}

impl<L: Law> Pass for ParameterPass<'_, L> {
    fn visit<const K: usize, const N: usize, const S: usize, E: Element<K, N, S>>(
        &mut self,
        part: usize,
        elements: &[E],
    ) {
        for (index, element) in elements.iter().enumerate() {
            let (coordinates, components) = (element.coordinates(), element.components());
            let site = Site { part, element: index, components };
            if !(0..S).any(|c| self.law.depends(&site, c, self.parameters)) {
                continue;
            }
            let x = gather(coordinates, self.x);
            let (strains, gradients) = element.evaluate(&x);
            for c in (0..S).filter(|&c| self.law.depends(&site, c, self.parameters)) {
                self.law.derivative(&site, &strains, c, self.parameters, self.derivative);
                let columns = self.columns.chunks_exact_mut(self.x.len());
                for (derivative, column) in self.derivative.iter().zip(columns) {
                    for a in 0..K {
                        let force = element.area() * derivative * gradients[c][a];
                        for i in 0..N {
                            column[coordinates[a][i]] += force[i];
                        }
                    }
                }
            }
        }
    }
}

/// Stiffness matrix times a displacement, N: Σ (∇²E) d over the elements that it moves.
pub(crate) struct StiffnessPass<'a, L> {
    pub(crate) law: &'a L,
    pub(crate) x: &'a [f64],
    pub(crate) displacement: &'a [f64],
    pub(crate) force: &'a mut [f64],
}

impl<L: Law> Pass for StiffnessPass<'_, L> {
    fn visit<const K: usize, const N: usize, const S: usize, E: Element<K, N, S>>(
        &mut self,
        part: usize,
        elements: &[E],
    ) {
        for (index, element) in elements.iter().enumerate() {
            let (coordinates, components, area) =
                (element.coordinates(), element.components(), element.area());
            let moved = gather::<K, N>(coordinates, self.displacement);
            if moved.iter().all(|d| d.iter().all(|&d| d == 0.0)) {
                continue;
            }
            let x = gather(coordinates, self.x);
            let (strains, gradients) = element.evaluate(&x);
            let site = Site { part, element: index, components };
            let Stresses { stress, tangent } = self.law.stresses(&site, &strains);
            let change: [f64; S] =
                std::array::from_fn(|c| (0..K).map(|a| gradients[c][a].dot(&moved[a])).sum());
            let mut blocks = [[Block::<N>::zeros(); K]; K];
            element.add_geometric(&x, &stress, &mut blocks);
            complete(&mut blocks, E::TRANSLATED);
            for a in 0..K {
                let scaled = scaled::<K, N, S, L>(&tangent, &gradients, a);
                let mut force: Point<N> = (0..S).map(|c| scaled[c] * change[c]).sum();
                for b in 0..K {
                    force +=
                        if b <= a { blocks[a][b] * moved[b] } else { blocks[b][a].transpose() * moved[b] };
                }
                for i in 0..N {
                    self.force[coordinates[a][i]] += area * force[i];
                }
            }
        }
    }
}

/// First-order prediction of the membrane's strains after a step: ε(x) + ∇ε(x)·Δx, `S` per element.
pub(crate) struct PredictedStrainPass<'a> {
    pub(crate) x: &'a [f64],
    pub(crate) step: &'a [f64],
    pub(crate) strains: &'a mut Vec<f64>,
}

impl Pass for PredictedStrainPass<'_> {
    fn visit<const K: usize, const N: usize, const S: usize, E: Element<K, N, S>>(
        &mut self,
        part: usize,
        elements: &[E],
    ) {
        if part != 0 {
            return;
        }
        self.strains.clear();
        for element in elements {
            let coordinates = element.coordinates();
            let (x, step) = (gather::<K, N>(coordinates, self.x), gather::<K, N>(coordinates, self.step));
            let (strains, gradients) = element.evaluate(&x);
            self.strains.extend(
                (0..S).map(|c| strains[c] + (0..K).map(|a| gradients[c][a].dot(&step[a])).sum::<f64>()),
            );
        }
    }
}

/// Collects all strains of one component, each with the area it represents.
pub(crate) struct StrainPass<'a> {
    pub(crate) x: &'a [f64],
    pub(crate) component: Component,
    pub(crate) strains: Vec<[f64; 2]>,
}

impl Pass for StrainPass<'_> {
    fn visit<const K: usize, const N: usize, const S: usize, E: Element<K, N, S>>(
        &mut self,
        _part: usize,
        elements: &[E],
    ) {
        for element in elements {
            let components = element.components();
            if components.contains(&self.component) {
                let strains = element.strains(&gather(element.coordinates(), self.x));
                for c in (0..S).filter(|&c| components[c] == self.component) {
                    self.strains.push([strains[c], element.area()]);
                }
            }
        }
    }
}
