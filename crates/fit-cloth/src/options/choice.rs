//! Named choices on the command line, converted to the library's types.

use clap::ValueEnum;
use clap::builder::PossibleValue;
use cloth_fit::stage::{Constraints, Variant};
use cloth_sim::material::{BendingModel, Component, Compression, Model};
use cloth_study::extent::Topic;

/// One model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ModelChoice(pub Model);

impl ModelChoice {
    const ALL: [Self; Model::ALL.len()] = {
        let mut all = [Self(Model::STVK); Model::ALL.len()];
        let mut index = 0;
        while index < all.len() {
            all[index] = Self(Model::ALL[index]);
            index += 1;
        }
        all
    };
}

impl ValueEnum for ModelChoice {
    fn value_variants<'a>() -> &'a [Self] {
        &Self::ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.0.name()).help(self.0.description()))
    }
}

/// One model, or all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModelsChoice {
    /// One model.
    One(ModelChoice),
    /// All in turn.
    All,
}

impl ModelsChoice {
    const ALL: [Self; Model::ALL.len() + 1] = {
        let mut all = [Self::All; Model::ALL.len() + 1];
        let mut index = 0;
        while index < Model::ALL.len() {
            all[index] = Self::One(ModelChoice::ALL[index]);
            index += 1;
        }
        all
    };

    /// The models chosen.
    pub fn models(self) -> Vec<Model> {
        match self {
            Self::One(ModelChoice(model)) => vec![model],
            Self::All => Model::ALL.to_vec(),
        }
    }
}

impl ValueEnum for ModelsChoice {
    fn value_variants<'a>() -> &'a [Self] {
        &Self::ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        match self {
            Self::One(model) => model.to_possible_value(),
            Self::All => Some(PossibleValue::new("all").help("All in turn")),
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

/// Bending of a material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BendingChoice {
    /// Moment against curvature, on any mesh
    Sheet,
    /// Discrete-shell hinges, whose stiffness depends on the mesh
    Hinges,
    /// Ring-2 springs, on a grid
    Springs,
}

impl From<BendingChoice> for BendingModel {
    fn from(choice: BendingChoice) -> Self {
        match choice {
            BendingChoice::Sheet => Self::Sheet,
            BendingChoice::Hinges => Self::Hinges,
            BendingChoice::Springs => Self::Springs,
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

/// A topic of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TopicChoice {
    /// Equilibria of scenes on finer and finer meshes
    Equilibria,
    /// Fits of the set
    Fits,
    /// Curve error against noise
    Noise,
    /// Savings and costs of each part; parts of fits only with topic fits
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
