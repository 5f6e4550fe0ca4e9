//! One measured component of a clip's force, and its simulated counterpart.

use nalgebra::Vector3;

/// One measured component of the force that cords exert on a clip.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceComponent {
    /// Index of the clip.
    pub clip: usize,
    /// Number of the component on its clip; its direction may turn with the clip.
    pub number: usize,
    /// Unit direction.
    pub direction: Vector3<f64>,
    /// The simulated component is Σ force of a group of held nodes · this vector.
    pub parts: Vec<(usize, Vector3<f64>)>,
    /// The measured component less that of the clip's weight: the load that the cloth must balance, N.
    pub force: f64,
    /// The measured component, N.
    pub measured: f64,
}

impl ForceComponent {
    /// The simulated component, given the force of every group of held nodes.
    pub fn of(&self, groups: &[Vector3<f64>]) -> f64 {
        self.parts.iter().map(|(group, vector)| groups[*group].dot(vector)).sum()
    }
}
