//! The state of a cloth in motion.

/// Where a cloth is and how it moves.
#[derive(Debug, Clone)]
pub(super) struct State {
    /// 3 a node, m.
    pub(super) positions: Vec<f64>,
    /// 3 a node, m/s; zero where the cloth is held.
    pub(super) velocities: Vec<f64>,
}
