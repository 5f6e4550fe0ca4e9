//! Terms that an implicit time step adds to the energy: a quadratic in the step's displacement.
//!
//! ```text
//! Φ(x) = E(x) + ½ sᵀA s − b·s      s = x − x₀
//! A = M/h² + C/h + B/h             b = M v₀/h + B w
//! ```
//!
//! M are the masses, C and B the damping and drag matrices at x₀, and w is the wind. The gradient vanishes at the
//! minimum of Φ, which is the equation of implicit Euler; a time step is therefore an equilibrium with added stiffness.
//!
//! Source: incremental potential, Kane, Marsden, Ortiz and West 2000.

use crate::cloth::{Cloth, ForceScale};

/// Terms of one step, over the unknowns.
#[derive(Debug, Clone, Default)]
pub(crate) struct Increment {
    /// x₀, 3 per node, m.
    pub(crate) origin: Vec<f64>,
    /// Diagonal part of A, N/m.
    pub(crate) diagonal: Vec<f64>,
    /// Lower entries of the rest of A, N/m; empty if there is none.
    pub(crate) matrix: Vec<f64>,
    /// b, N.
    pub(crate) push: Vec<f64>,
    displacement: Vec<f64>,
    product: Vec<f64>,
}

impl Increment {
    /// Allocates for a cloth's unknowns.
    pub(crate) fn new(cloth: &Cloth) -> Self {
        let zeros = vec![0.0; cloth.unknowns()];
        Self {
            origin: vec![0.0; 3 * cloth.points()],
            diagonal: zeros.clone(),
            matrix: Vec::new(),
            push: zeros.clone(),
            displacement: zeros.clone(),
            product: zeros,
        }
    }

    /// ½ sᵀA s − b·s, J; leaves A s − b in `product`.
    pub(crate) fn energy(&mut self, cloth: &Cloth, x: &[f64]) -> f64 {
        for (s, &coordinate) in self.displacement.iter_mut().zip(cloth.unknown_coordinates()) {
            *s = x[coordinate] - self.origin[coordinate];
        }
        if self.matrix.is_empty() {
            self.product.fill(0.0);
        } else {
            cloth.pattern().multiply(&self.matrix, &self.displacement, &mut self.product);
        }
        let mut energy = 0.0;
        for (unknown, &s) in self.displacement.iter().enumerate() {
            let force = self.product[unknown] + self.diagonal[unknown] * s;
            energy += s * (0.5 * force - self.push[unknown]);
            self.product[unknown] = force - self.push[unknown];
        }
        energy
    }

    /// Adds the gradient and the magnitudes of its forces and rounding errors; returns the energy, J.
    pub(crate) fn add_gradient(
        &mut self,
        cloth: &Cloth,
        x: &[f64],
        gradient: &mut [f64],
        scale: &mut ForceScale,
    ) -> f64 {
        let energy = self.energy(cloth, x);
        for (unknown, &coordinate) in cloth.unknown_coordinates().iter().enumerate() {
            gradient[coordinate] += self.product[unknown];
            // Inertia also converts a position error to a force error.
            let stiffness = &mut scale.stiffness[coordinate / 3];
            *stiffness = stiffness.max(self.diagonal[unknown]);
        }
        energy
    }

    /// vᵀ R v for the off-diagonal part R of A, W/s.
    pub(crate) fn quadratic(&mut self, cloth: &Cloth, velocities: &[f64]) -> f64 {
        let free = cloth.unknown_coordinates();
        let v = &mut self.displacement;
        v.iter_mut().zip(free).for_each(|(value, &coordinate)| *value = velocities[coordinate]);
        cloth.pattern().multiply(&self.matrix, v, &mut self.product);
        v.iter().zip(&self.product).map(|(v, force)| v * force).sum()
    }

    /// Adds A to the lower entries of a Hessian.
    pub(crate) fn add_hessian(&self, cloth: &Cloth, values: &mut [f64]) {
        values.iter_mut().zip(&self.matrix).for_each(|(value, added)| *value += added);
        cloth.diagonal().iter().zip(&self.diagonal).for_each(|(&place, added)| values[place] += added);
    }
}
