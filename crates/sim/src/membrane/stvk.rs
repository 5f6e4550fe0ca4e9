//! Diagonalised St. Venant–Kirchhoff triangles.

use super::triangle::{TRIANGLE_COMPONENTS, Triangle, add_scalar_blocks};
use crate::element::{Block, Element, Point, stacked};
use crate::material::Component;

/// A triangle with uncoupled Green strains.
///
/// ```text
/// ε_u = (w_u·w_u − 1)/2     ε_v = (w_v·w_v − 1)/2     ε_uv = w_u·w_v
/// ∂ε_u/∂x_a = r_u,a w_u     …                         ∂ε_uv/∂x_a = r_u,a w_v + r_v,a w_u
/// Σ σ ∇²ε  = (σ_u r_u,a r_u,b + σ_v r_v,a r_v,b + σ_uv (r_u,a r_v,b + r_v,a r_u,b)) I
/// ```
///
/// Source: Miguel et al. 2012, eq. 3; Volino et al. 2009. The stiffness part of the shear term is (r_u,a w_v + r_v,a
/// w_u)(r_u,b w_v + r_v,b w_u)ᵀ, from differentiation; Strohkorb 2019 prints it without two of the four products.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StvkTriangle(pub Triangle);

impl<const N: usize> Element<3, N, 3> for StvkTriangle {
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
        [0.5 * (w_u.norm_squared() - 1.0), 0.5 * (w_v.norm_squared() - 1.0), w_u.dot(&w_v)]
    }

    #[inline(always)]
    fn gradients(&self, x: &[Point<N>; 3]) -> [[Point<N>; 3]; 3] {
        let [w_u, w_v] = self.0.deformation(x);
        [
            self.0.weft.map(|r| w_u * r),
            self.0.warp.map(|r| w_v * r),
            std::array::from_fn(|a| w_v * self.0.weft[a] + w_u * self.0.warp[a]),
        ]
    }

    #[inline(always)]
    fn add_geometric(&self, _x: &[Point<N>; 3], stress: &[f64; 3], blocks: &mut [[Block<N>; 3]; 3]) {
        add_scalar_blocks(&self.0, stress, blocks);
    }

    /// Removes the negative eigenvalues of the stress tensor [σ_u σ_uv; σ_uv σ_v].
    fn add_clamped(&self, _x: &[Point<N>; 3], &[s_u, s_v, s_uv]: &[f64; 3], blocks: &mut [[Block<N>; 3]; 3]) {
        let (mean, half) = (0.5 * (s_u + s_v), 0.5 * (s_u - s_v));
        let radius = half.hypot(s_uv);
        let [low, high] = [mean - radius, mean + radius].map(|eigenvalue| eigenvalue.max(0.0));
        if radius == 0.0 {
            return add_scalar_blocks(&self.0, &[high, high, 0.0], blocks);
        }
        let (sum, difference) = (0.5 * (high + low), 0.5 * (high - low) / radius);
        let clamped = [sum + difference * half, sum - difference * half, difference * s_uv];
        add_scalar_blocks(&self.0, &clamped, blocks);
    }
}
