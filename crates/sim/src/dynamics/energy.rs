//! The account of energy and work.

/// Energies of a state, and the account since the start; J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energies {
    /// ½ Σ m |v|².
    pub kinetic: f64,
    /// Of all strains.
    pub elastic: f64,
    /// −Σ m g·x.
    pub weight: f64,
    /// What damping has taken since the start.
    pub damping: f64,
    /// What the air has done since the start; drag in still air takes.
    pub wind: f64,
    /// What the integrator has lost since the start; negative if it has gained.
    pub numerical: f64,
}

impl Energies {
    /// Kinetic, elastic and weight.
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.weight
    }
}

/// What air and damping did in a step, J.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Work {
    pub(super) damping: f64,
    pub(super) wind: f64,
}
