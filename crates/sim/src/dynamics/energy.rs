//! Balance of energy and work.

/// Energies of a state, and the balance since the start; J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energies {
    /// Kinetic energy, ½ Σ m |v|².
    pub kinetic: f64,
    /// Elastic energy of all strains.
    pub elastic: f64,
    /// Energy of the weight, −Σ m g·x.
    pub weight: f64,
    /// Energy dissipated by damping since the start.
    pub damping: f64,
    /// Work of the air since the start; negative for drag in still air.
    pub wind: f64,
    /// Energy lost by the integrator since the start; negative for a gain.
    pub numerical: f64,
}

impl Energies {
    /// Sum of kinetic, elastic and weight energy.
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.weight
    }
}

/// Work of air and damping in a step, J.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Work {
    pub(super) damping: f64,
    pub(super) wind: f64,
}
