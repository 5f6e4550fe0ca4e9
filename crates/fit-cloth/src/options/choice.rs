//! Choices by name, and the library's types.

use clap::ValueEnum;
use cloth_fit::stage::{Constraints, Variant};
use cloth_sim::material::{Component, Compression, Model};
use cloth_study::extent::Topic;

/// One model, or all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ModelChoice {
    /// Diagonalised StVK, discrete shells
    Stvk,
    /// Soft constraints, discrete shells
    SoftConstraint,
    /// Springs
    Springs,
    /// All three in turn
    All,
}

impl ModelChoice {
    /// The models chosen.
    pub fn models(self) -> Vec<Model> {
        match self {
            Self::Stvk => vec![Model::Stvk],
            Self::SoftConstraint => vec![Model::SoftConstraint],
            Self::Springs => vec![Model::Springs],
            Self::All => Model::ALL.to_vec(),
        }
    }
}

/// Model variants.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum VariantChoice {
    /// Nonlinear curves, weft and warp separate
    Orthotropic,
    /// Constant stiffness, weft and warp separate
    Linear,
    /// Nonlinear curves, weft and warp shared
    Isotropic,
    /// Constant stiffness, weft and warp shared
    LinearIsotropic,
}

impl From<VariantChoice> for Variant {
    fn from(choice: VariantChoice) -> Self {
        match choice {
            VariantChoice::Orthotropic => Self::Orthotropic,
            VariantChoice::Linear => Self::Linear,
            VariantChoice::Isotropic => Self::Isotropic,
            VariantChoice::LinearIsotropic => Self::LinearIsotropic,
        }
    }
}

/// Constraints on a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ConstraintChoice {
    /// Stress grows with strain everywhere
    Stable,
    /// No control value is negative: the published rule
    ControlPoints,
}

impl From<ConstraintChoice> for Constraints {
    fn from(choice: ConstraintChoice) -> Self {
        match choice {
            ConstraintChoice::Stable => Self::Stable,
            ConstraintChoice::ControlPoints => Self::ControlPoints,
        }
    }
}

/// Weft and warp under compression.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum CompressionChoice {
    /// Stiffness as at zero strain
    ZeroStrain,
    /// Tension only
    None,
}

impl From<CompressionChoice> for Compression {
    fn from(choice: CompressionChoice) -> Self {
        match choice {
            CompressionChoice::ZeroStrain => Self::ZeroStrain,
            CompressionChoice::None => Self::None,
        }
    }
}

/// One of the six components.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ComponentChoice {
    /// Stretch along weft
    StretchWeft,
    /// Stretch along warp
    StretchWarp,
    /// Shear between the yarns
    Shear,
    /// Bending along weft
    BendWeft,
    /// Bending along warp
    BendWarp,
    /// Diagonal bending, along neither yarn
    BendDiagonal,
}

impl From<ComponentChoice> for Component {
    fn from(choice: ComponentChoice) -> Self {
        Self::ALL[choice as usize]
    }
}

/// One model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TableModel {
    /// Green strain, hinges
    Stvk,
    /// Engineering strain, hinges
    SoftConstraint,
    /// Engineering strain, springs
    Springs,
}

impl From<TableModel> for Model {
    fn from(choice: TableModel) -> Self {
        Self::ALL[choice as usize]
    }
}

/// A topic of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TopicChoice {
    /// Equilibria of scenes on finer and finer meshes
    Equilibria,
    /// Fits of the set
    Fits,
    /// Curve error against noise
    Noise,
    /// What each part saves and costs; parts of fits only with topic fits
    Ablation,
}

impl TopicChoice {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Equilibria, Self::Fits, Self::Noise, Self::Ablation];
}

impl From<TopicChoice> for Topic {
    fn from(choice: TopicChoice) -> Self {
        match choice {
            TopicChoice::Equilibria => Self::Equilibria,
            TopicChoice::Fits => Self::Fits,
            TopicChoice::Noise => Self::Noise,
            TopicChoice::Ablation => Self::Ablation,
        }
    }
}
