//! Progress of a fit.

use crate::equilibria::Meter;
use crate::optimise::gauss_newton::Iteration;
use cloth_sim::material::Component;
use std::sync::Arc;

/// Receives progress from a fit.
pub struct Watch<'a> {
    /// Counts while frames are solved.
    pub meter: Arc<Meter>,
    /// Receives every level and iteration.
    pub observe: Box<dyn FnMut(Event<'_>) + 'a>,
}

impl Default for Watch<'_> {
    /// Ignores all events.
    fn default() -> Self {
        Self { meter: Arc::default(), observe: Box::new(|_| ()) }
    }
}

/// An event during a fit.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// A level of the curve's growth begins.
    Level {
        /// The component.
        component: Component,
        /// Control points.
        points: usize,
    },
    /// A step was tried.
    Iteration {
        /// The step.
        iteration: &'a Iteration,
        /// Root mean square residual.
        rms: f64,
        /// Factorisations so far.
        factorisations: usize,
        /// Seconds so far.
        seconds: f64,
    },
}
