//! Cloth mechanics: which shape a sheet of cloth takes, and which forces its clips feel.
//!
//! # The problem
//!
//! A sheet is a triangle mesh; its state x stacks three coordinates of every node. Every element (a triangle, spring or
//! hinge) measures strains ε_c of up to three of six components, and every component has its curve:
//!
//! ```text
//! energy        E(x) = Σₑ Aₑ Σ_c W_c(ε_c) − Σₐ mₐ g·xₐ        W_c(ε) = ∫₀^ε σ_c,   σ_c(ε) = k_c(ε) ε
//! equilibrium   ∂E/∂x = 0 at every free node; held nodes stay at their prescribed places, tied ones move alike
//! clip force    F = Σ ∂E/∂xₐ over the nodes a that the clip holds
//! sensitivity   ∂x/∂k = −K⁻¹ ∂²E/∂x∂k,   K = ∂²E/∂x²
//! motion        M ẍ = −∂E/∂x − C ẋ + drag of the air
//! ```
//!
//! k_c is a Hermite spline through control points, the stiffnesses that a fit finds; energy, stress and forces are linear
//! in them.
//!
//! An equilibrium that is balanced but not stable is left for a lower one beside it, and flagged
//! ([`Equilibrium::escaped`](equilibrium::Equilibrium::escaped)): near there another shape is as good. Where clips have moved
//! far, [`Solver::drive`](equilibrium::Solver::drive) takes the sheet along in as many load steps as that needs. Nodes may be
//! tied ([`Problem::tied`](cloth::Problem::tied)): they then share their unknowns, as the lines of a sheet do that bends as a
//! cylinder. Or guided ([`Problem::guided`](cloth::Problem::guided)): they keep to a plane or a line.
//!
//! | Type | Role |
//! |---|---|
//! | [`mesh::Grid`], [`mesh::Mesh`] | the sheet at rest, checked |
//! | [`curve::StiffnessCurve`], [`material::Curves`] | stiffness against strain, one a component |
//! | [`element::Element`] | strains of one element and their derivatives |
//! | [`law::Law`] | from the strains of one element to energy, stresses and tangent |
//! | [`membrane::Membrane`], [`bending::Bending`] | the elements of a mesh |
//! | [`load::Held`] | nodes that clips or tables hold |
//! | [`cloth::Problem`] → [`cloth::Cloth`] | all of it made ready: energy, gradient, sparse Hessian |
//! | [`equilibrium::Solver`] → [`equilibrium::Equilibrium`] | the balanced state, its clip forces, and how the solve ended |
//! | [`dynamics::Motion`] | the cloth on its way: implicit or explicit time steps, damping, wind, energies |
//! | [`descent`] | from any shape down to one at rest |
//! | [`samples::Sample`] | small problems with known answers |
//!
//! Units are SI. A mistake in the input is an [`error::Error`]; a solve that fails is a
//! [`Status`](equilibrium::Status).
//!
//! # Example
//!
//! A strip 40 mm wide is pulled by 5 %:
//!
//! ```
//! use cloth_sim::equilibrium::{Settings, Solver};
//! use cloth_sim::material::Model;
//! use cloth_sim::mesh::Diagonals;
//! use cloth_sim::samples;
//!
//! # fn main() -> cloth_sim::error::Result<()> {
//! let (sample, _) = samples::strip(Model::Stvk, Diagonals::Forward, 100.0, 1.05)?;
//! let cloth = sample.cloth()?;
//! let mut solver = Solver::new(&cloth);
//! let mut x = sample.start.clone();
//! let found = solver.solve(&sample.curves, &mut x, &Settings::default());
//! assert!(found.converged());
//!
//! // Nominal stress λ k (λ² − 1)/2 of 5.38125 N/m, over the width.
//! let force = solver.clip_forces()[1].x;
//! assert!((force - 0.04 * 5.38125).abs() < 1e-12);
//! # Ok(())
//! # }
//! ```

/// The linear algebra that vectors and states come in.
pub use nalgebra;

pub mod bending;
pub mod cloth;
pub mod curve;
pub mod descent;
pub mod disc;
pub mod dynamics;
pub mod element;
pub mod equilibrium;
pub mod error;
pub mod finite_difference;
mod increment;
pub mod law;
mod linear;
pub mod load;
pub mod material;
pub mod membrane;
pub mod mesh;
pub mod rigid;
pub mod samples;
mod sequence;

/// The example there is run, too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
