//! Damping.

/// Damping in proportion to mass and to stiffness, known as Rayleigh damping.
///
/// ```text
/// C(x) = α M + β K(x)      K(x) = Σ A σ′(ε) ∇ε ∇εᵀ, the stiffness without its geometric part
/// ```
///
/// A mode of angular frequency ω is damped by the share ζ = (α/ω + β ω)/2 of the critical damping. K does not resist rigid
/// motion, and C never feeds energy in. A step takes it where it starts. The law that Strohkorb 2019 takes over from Kang
/// and Cho 2002 adds a force to a mass, in whatever units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Damping {
    /// α, 1/s.
    pub mass: f64,
    /// β, s.
    pub stiffness: f64,
}
