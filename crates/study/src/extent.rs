//! How much a study runs.

use cloth_sim::material::Model;

/// A topic of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Topic {
    /// Equilibria of scenes on finer and finer meshes.
    Equilibria,
    /// Fits of the set.
    Fits,
    /// Curve error against noise.
    Noise,
    /// What parts save and cost; those of fits only with fits.
    Ablation,
}

impl Topic {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Equilibria, Self::Fits, Self::Noise, Self::Ablation];
}

/// How much a study runs. `--quick` and the full study are two values of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Extent {
    /// What is run at all.
    pub topics: Vec<Topic>,
    /// The models of equilibria and fits.
    pub models: Vec<Model>,
    /// Nodes a side of the meshes of equilibria, from coarse to fine, each with twice the cells of the one before.
    pub meshes: Vec<usize>,
    /// Nodes a side of the mesh that they are compared with.
    pub finest: usize,
    /// Nodes a side where tolerances are tried; one of the meshes.
    pub tolerances_on: usize,
    /// Nodes a side of fits.
    pub fit_nodes: Vec<usize>,
    /// Those of them on which the published method is run too: it takes ten times as long or more.
    pub published_nodes: Vec<usize>,
    /// Nodes a side of the fits with fewer control points or frames, and of the scenes that leave parts out.
    pub usual_nodes: usize,
    /// Most control points that are tried beside five.
    pub points: Vec<usize>,
    /// Every which frame is used, beside every one.
    pub every_frames: Vec<usize>,
    /// Multiples of the instruments' noise.
    pub noises: Vec<f64>,
    /// Seeds of each.
    pub seeds: u64,
    /// Nodes a side of the fits to noise.
    pub noise_nodes: usize,
    /// Nodes a side of the finer mesh that noise is added to, and of the set that is measured if none is given.
    pub rig_nodes: usize,
}

impl Extent {
    /// About a minute.
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

    /// About ten minutes.
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
