//! Damping.

/// Rayleigh damping, proportional to mass and stiffness.
///
/// ```text
/// C(x) = α M + β K(x)      K(x) = Σ A σ′(ε) ∇ε ∇εᵀ, the stiffness without its geometric part
/// ```
///
/// A mode of angular frequency ω has the damping ratio ζ = (α/ω + β ω)/2. K does not resist rigid motion, and C never
/// adds energy. A step evaluates C at its start. The law of Strohkorb 2019, after Kang and Cho 2002, is dimensionally
/// inconsistent: it adds a force to a mass.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Damping {
    /// α, 1/s.
    pub mass: f64,
    /// β, s.
    pub stiffness: f64,
}
