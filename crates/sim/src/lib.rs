//! Cloth mechanics: the shape of a sheet of cloth and the forces on its clips.
//!
//! # The problem
//!
//! A sheet is a triangle mesh; its state x stacks three coordinates of every node. Every element (triangle, spring or
//! hinge) measures up to three strains ε_c. There are six components, each with its own curve:
//!
//! ```text
//! energy        E(x) = Σₑ Aₑ Σ_c W_c(ε_c) − Σₐ mₐ g·xₐ        W_c(ε) = ∫₀^ε σ_c,   σ_c(ε) = k_c(ε) ε
//! equilibrium   ∂E/∂x = 0 at every free node; held nodes stay at their prescribed places, tied ones move alike
//! clip force    F = Σ ∂E/∂xₐ over the nodes a that the clip holds
//! sensitivity   ∂x/∂k = −K⁻¹ ∂²E/∂x∂k,   K = ∂²E/∂x²
//! motion        M ẍ = −∂E/∂x − C ẋ + drag of the air
//! ```
//!
//! k_c is a Hermite spline through control points, whose stiffnesses a fit determines; energy, stress and forces are
//! linear in them.
//!
//! An unstable equilibrium is left for a lower one beside it, and flagged
//! ([`Equilibrium::escaped`](equilibrium::Equilibrium::escaped)): another shape nearby is equally valid. If clips move
//! far, [`Solver::load_steps`](equilibrium::Solver::load_steps) moves the sheet in as many load steps as needed. Tied nodes
//! ([`Problem::tied`](cloth::Problem::tied)) share their unknowns, like the lines of a sheet that bends as a cylinder.
//! Guided nodes ([`Problem::guided`](cloth::Problem::guided)) move in a plane or on a line.
//!
//! | Type | Role |
//! |---|---|
//! | [`mesh::Grid`], [`mesh::Mesh`] | the sheet at rest, validated |
//! | [`curve::StiffnessCurve`], [`material::Curves`] | stiffness against strain, one curve per component |
//! | [`element::Element`] | strains of one element and their derivatives |
//! | [`strain_measure::StrainMeasure`] | a model's strain of a component, and its physical measure |
//! | [`law::Law`] | strains of one element to energy, stresses and tangent |
//! | [`membrane::Membrane`], [`bending::Bending`] | the elements of a mesh |
//! | [`load::Held`] | nodes held by clips or tables |
//! | [`cloth::Problem`] → [`cloth::Cloth`] | the assembled problem: energy, gradient, sparse Hessian |
//! | [`equilibrium::Solver`] → [`equilibrium::Equilibrium`] | the equilibrium, its clip forces and the status |
//! | [`dynamics::Motion`] | cloth in motion: implicit or explicit time steps, damping, wind, energies |
//! | [`descent`] | from any shape down to a shape at rest |
//! | [`samples::Sample`] | small problems with known answers |
//!
//! Units are SI. Invalid input is an [`error::Error`]; a failed solve is a [`Status`](equilibrium::Status).
//!
//! # Example
//!
//! A strip 40 mm wide is stretched by 5 %:
//!
//! ```
//! use cloth_sim::equilibrium::{Settings, Solver};
//! use cloth_sim::material::Model;
//! use cloth_sim::mesh::Diagonals;
//! use cloth_sim::samples;
//!
//! # fn main() -> cloth_sim::error::Result<()> {
//! let (sample, _) = samples::strip(Model::STVK, Diagonals::Forward, 100.0, 1.05)?;
//! let cloth = sample.cloth()?;
//! let mut solver = Solver::new(&cloth);
//! let mut x = sample.start.clone();
//! let found = solver.solve(&sample.curves, &mut x, &Settings::default());
//! assert!(found.converged());
//!
//! // Nominal stress λ k (λ² − 1)/2 = 5.38125 N/m, times the width.
//! let force = solver.clip_forces()[1].x;
//! assert!((force - 0.04 * 5.38125).abs() < 1e-12);
//! # Ok(())
//! # }
//! ```

/// Linear algebra for vectors and states.
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
pub mod strain_measure;

/// Runs the README's example, too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
