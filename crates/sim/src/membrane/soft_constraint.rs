//! Soft-constraint triangles: engineering strain instead of Green strain.

use super::triangle::{TRIANGLE_COMPONENTS, Triangle, add_scalar_blocks};
use crate::element::{Block, Element, Point, stacked};
use crate::material::Component;

/// A triangle whose stretch strains are engineering strains.
///
/// ```text
/// ε_u = |w_u| − 1     ε_v = |w_v| − 1     ε_uv = w_u·w_v
/// ∂ε_u/∂x_a = r_u,a n      ∂²ε_u/∂x_a∂x_b = r_u,a r_u,b (I − n nᵀ)/|w_u|      n = w_u/|w_u|
/// ```
///
/// Source: Miguel et al. 2012, eq. 4; Baraff and Witkin 1998.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoftTriangle(pub Triangle);

/// |w| is computed as √(|w|² + δ²): bit-identical at rest, with finite derivatives at collapse.
const SMALLEST_STRETCH: f64 = 1e-8;

#[inline(always)]
fn length<const N: usize>(w: &Point<N>) -> f64 {
    (w.norm_squared() + SMALLEST_STRETCH * SMALLEST_STRETCH).sqrt()
}

impl SoftTriangle {
    #[inline(always)]
    fn add_blocks<const N: usize>(
        &self,
        x: &[Point<N>; 3],
        stretch: [f64; 2],
        shear: [f64; 3],
        blocks: &mut [[Block<N>; 3]; 3],
    ) {
        add_scalar_blocks(&self.0, &shear, blocks);
        let weights = [&self.0.weft, &self.0.warp];
        for ((w, stress), r) in self.0.deformation(x).iter().zip(stretch).zip(weights) {
            let length = length(w);
            let normal = w / length;
            let across = (Block::identity() - normal * normal.transpose()) * (stress / length);
            for a in 1..3 {
                for b in 1..=a {
                    blocks[a][b] += across * (r[a] * r[b]);
                }
            }
        }
    }
}

impl<const N: usize> Element<3, N, 3> for SoftTriangle {
    fn coordinates(&self) -> [[usize; 3]; 3] {
        stacked(self.0.nodes)
    }

    fn components(&self) -> [Component; 3] {
        TRIANGLE_COMPONENTS
    }

    fn area(&self) -> f64 {
        self.0.area
    }

    fn extent(&mut self) -> &mut f64 {
        &mut self.0.area
    }

    #[inline(always)]
    fn strains(&self, x: &[Point<N>; 3]) -> [f64; 3] {
        let [w_u, w_v] = self.0.deformation(x);
        [length(&w_u) - 1.0, length(&w_v) - 1.0, w_u.dot(&w_v)]
    }

    #[inline(always)]
    fn gradients(&self, x: &[Point<N>; 3]) -> [[Point<N>; 3]; 3] {
        let [w_u, w_v] = self.0.deformation(x);
        let [n_u, n_v] = [w_u / length(&w_u), w_v / length(&w_v)];
        [
            self.0.weft.map(|r| n_u * r),
            self.0.warp.map(|r| n_v * r),
            std::array::from_fn(|a| w_v * self.0.weft[a] + w_u * self.0.warp[a]),
        ]
    }

    #[inline(always)]
    fn add_geometric(
        &self,
        x: &[Point<N>; 3],
        &[s_u, s_v, s_uv]: &[f64; 3],
        blocks: &mut [[Block<N>; 3]; 3],
    ) {
        self.add_blocks(x, [s_u, s_v], [0.0, 0.0, s_uv], blocks);
    }

    /// Drops compression, and keeps the positive of the shear eigenvalues ±σ_uv.
    fn add_clamped(&self, x: &[Point<N>; 3], &[s_u, s_v, s_uv]: &[f64; 3], blocks: &mut [[Block<N>; 3]; 3]) {
        let half = 0.5 * s_uv.abs();
        self.add_blocks(x, [s_u.max(0.0), s_v.max(0.0)], [half, half, 0.5 * s_uv], blocks);
    }
}
