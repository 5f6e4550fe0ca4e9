//! The state of a cloth in motion.

/// Positions and velocities of a cloth.
#[derive(Debug, Clone)]
pub(super) struct State {
    /// 3 per node, m.
    pub(super) positions: Vec<f64>,
    /// 3 per node, m/s; zero where the cloth is held.
    pub(super) velocities: Vec<f64>,
}
