//! Equilibria of all frames of a stage under trial curves, with the residuals of clip forces or positions and their
//! sensitivities.
//!
//! ```text
//! equilibrium      g(x, k) = 0 at the free nodes                       g = ∇E
//! clip force       F_c = Σ g over the clip's nodes
//! sensitivity      dx/dk = −K⁻¹ ∂g/∂k        dF_c/dk = ∂F_c/∂k + (∂F_c/∂x) dx/dk
//! ```
//!
//! K is the true stiffness matrix at the equilibrium; its factorisation is reused, and all control points are solved
//! for at once. Frames are independent: they run in parallel and are collected in order.
//!
//! Source: Miguel et al. 2012, eqs. 7–9, without the μI that they keep in K, except where equilibria are found by
//! Levenberg–Marquardt (docs/model.md).

mod correction;
mod elimination;
mod frames;
mod meter;
mod observation;
mod pose_prior;
mod residual;
mod solve;
mod state;
mod task;
mod unknowns;

pub use frames::{DroppedFrame, Equilibria, Settled, States};
pub use meter::{Counters, Meter};
pub use observation::Objective;
pub(crate) use residual::without_rounding;
pub(crate) use solve::parameter_columns;
pub use task::{SolveStart, Task};
pub use unknowns::{Unknown, Unknowns};
