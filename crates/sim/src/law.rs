//! The law of an element: strains to energy density, stresses and tangent.
//!
//! ```text
//! W(ε)   energy density          ε all strains of one element
//! σ_c    = ∂W/∂ε_c               stress
//! T_cd   = ∂σ_c/∂ε_d             tangent, symmetric
//! ∂σ_c/∂pᵢ                       for each parameter pᵢ of a block, as a curve's control values
//! ```
//!
//! The sums over elements ([`element`](crate::element)) access a law only through this trait. [`Curves`] are the
//! diagonal law, as published: every stress depends on its own strain only, W = Σ_c W_c(ε_c). A law with history reads
//! it at [`Site::element`].

use crate::material::{Component, Curves};

/// Location at which a law is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Site<const S: usize> {
    /// 0 for the membrane, 1 for bending.
    pub part: usize,
    /// Index among the elements of its part.
    pub element: usize,
    /// The component of each strain.
    pub components: [Component; S],
}

/// Stresses of one element and their derivatives with respect to its strains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stresses<const S: usize> {
    /// σ_c, N/m (bending: N).
    pub stress: [f64; S],
    /// ∂σ_c/∂ε_d, in the units of stiffness; an uncoupled law sets only the diagonal.
    pub tangent: [[f64; S]; S],
}

/// Maps strains to energy density, stresses and tangent.
pub trait Law {
    /// True if a stress depends on strains other than its own. Otherwise the off-diagonal work of the tangent is
    /// skipped.
    const COUPLED: bool;

    /// Identifies a block of parameters that a fit determines together.
    type Parameters: Copy;

    /// False if a component stores no energy.
    fn has(&self, component: Component) -> bool;

    /// Energy density, J/m².
    fn energy<const S: usize>(&self, site: &Site<S>, strains: &[f64; S]) -> f64;

    /// Stresses and tangent.
    fn stresses<const S: usize>(&self, site: &Site<S>, strains: &[f64; S]) -> Stresses<S>;

    /// Replaces a tangent by a nearby positive semi-definite one.
    fn clamp<const S: usize>(tangent: &mut [[f64; S]; S]);

    /// True if σ_c depends on a block of parameters.
    fn depends<const S: usize>(&self, site: &Site<S>, c: usize, parameters: Self::Parameters) -> bool;

    /// ∂σ_c/∂pᵢ for every parameter of a block.
    fn derivative<const S: usize>(
        &self,
        site: &Site<S>,
        strains: &[f64; S],
        c: usize,
        parameters: Self::Parameters,
        derivative: &mut [f64],
    );
}

/// The diagonal law without history. A component without a curve stores no energy.
impl Law for Curves {
    const COUPLED: bool = false;

    /// The control values of one component's curve.
    type Parameters = Component;

    #[inline(always)]
    fn has(&self, component: Component) -> bool {
        self.get(component).is_some()
    }

    #[inline(always)]
    fn energy<const S: usize>(&self, site: &Site<S>, strains: &[f64; S]) -> f64 {
        (0..S).filter_map(|c| Some(self.get(site.components[c])?.energy(strains[c]))).sum()
    }

    #[inline(always)]
    fn stresses<const S: usize>(&self, site: &Site<S>, strains: &[f64; S]) -> Stresses<S> {
        let mut stresses = Stresses { stress: [0.0; S], tangent: [[0.0; S]; S] };
        for c in 0..S {
            let Some(curve) = self.get(site.components[c]) else { continue };
            let response = curve.response(strains[c]);
            stresses.stress[c] = response.stress;
            stresses.tangent[c][c] = response.tangent;
        }
        stresses
    }

    /// A softening curve has a negative tangent.
    #[inline(always)]
    fn clamp<const S: usize>(tangent: &mut [[f64; S]; S]) {
        (0..S).for_each(|c| tangent[c][c] = tangent[c][c].max(0.0));
    }

    #[inline(always)]
    fn depends<const S: usize>(&self, site: &Site<S>, c: usize, component: Component) -> bool {
        site.components[c] == component && self.has(component)
    }

    #[inline(always)]
    fn derivative<const S: usize>(
        &self,
        _: &Site<S>,
        strains: &[f64; S],
        c: usize,
        component: Component,
        derivative: &mut [f64],
    ) {
        if let Some(curve) = self.get(component) {
            curve.weights(strains[c], derivative);
        }
    }
}

#[cfg(test)]
mod tests;
