//! Extent of a study.

use cloth_sim::material::Model;

/// A topic of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Topic {
    /// Equilibria of scenes on refined meshes.
    Equilibria,
    /// Fits of the measurement set.
    Fits,
    /// Curve error against noise.
    Noise,
    /// Savings and errors of parts; parts of fits only together with fits.
    Ablation,
}

impl Topic {
    /// All topics.
    pub const ALL: [Self; 4] = [Self::Equilibria, Self::Fits, Self::Noise, Self::Ablation];
}

/// Extent of a study. `--quick` and the full study are two values of this type.
#[derive(Debug, Clone, PartialEq)]
pub struct Extent {
    /// Topics to run.
    pub topics: Vec<Topic>,
    /// Models for equilibria and fits.
    pub models: Vec<Model>,
    /// Nodes per side of the meshes for equilibria, from coarse to fine, each with twice the cells of the previous one.
    pub meshes: Vec<usize>,
    /// Nodes per side of the reference mesh for equilibria.
    pub finest: usize,
    /// Nodes per side of the mesh on which tolerances are varied; one of `meshes`.
    pub tolerances_on: usize,
    /// Nodes per side of the grids for fits.
    pub fit_nodes: Vec<usize>,
    /// Subset of these on which the published method runs too, at ten or more times the cost.
    pub published_nodes: Vec<usize>,
    /// Nodes per side of the fits with fewer control points or frames, and of the ablation scenes.
    pub usual_nodes: usize,
    /// Maximum numbers of control points tried besides five.
    pub points: Vec<usize>,
    /// Frame steps n (every n-th frame) tried besides all frames.
    pub every_frames: Vec<usize>,
    /// Multiples of the instruments' noise.
    pub noises: Vec<f64>,
    /// Seeds per noise level.
    pub seeds: u64,
    /// Nodes per side of the fits to noise.
    pub noise_nodes: usize,
    /// Nodes per side of the finer mesh for noise, and of the built-in measurement set.
    pub rig_nodes: usize,
}

impl Extent {
    /// Takes about a minute.
    pub fn quick() -> Self {
        Self {
            topics: Topic::ALL.to_vec(),
            models: Model::ALL.to_vec(),
            meshes: vec![13, 25, 49],
            finest: 97,
            tolerances_on: 25,
            fit_nodes: vec![7, 13],
            published_nodes: vec![7],
            usual_nodes: 13,
            points: vec![1, 2, 3],
            every_frames: vec![2, 3],
            noises: vec![0.3, 1.0, 3.0, 10.0, 30.0, 100.0],
            seeds: 4,
            noise_nodes: 13,
            rig_nodes: 31,
        }
    }

    /// True if a topic is run.
    pub fn has(&self, topic: Topic) -> bool {
        self.topics.contains(&topic)
    }

    /// Takes about ten minutes.
    pub fn full() -> Self {
        Self {
            meshes: vec![13, 25, 49, 97],
            finest: 193,
            fit_nodes: vec![13, 25, 49],
            published_nodes: vec![13],
            usual_nodes: 25,
            seeds: 20,
            noise_nodes: 25,
            rig_nodes: 61,
            ..Self::quick()
        }
    }
}
