//! Model and curves: the complete description of a fabric, independent of any mesh.

use crate::curve::{NegativeStrain, StiffnessCurve};
use crate::strain_measure::StrainMeasure;
use serde::{Deserialize, Serialize};

/// In-plane part of a cloth model (Miguel et al. 2012, §4).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MembraneModel {
    /// Diagonalised St. Venant–Kirchhoff triangles.
    Stvk,
    /// Soft constraints of Baraff and Witkin.
    SoftConstraint,
    /// Ring-1 springs, on a regular grid.
    Springs,
}

/// Out-of-plane part of a cloth model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BendingModel {
    /// Moment against curvature, on any mesh: weft, warp and twist.
    Sheet,
    /// Discrete-shell hinges (Miguel et al. 2012, eq. 5), whose stiffness depends on the mesh.
    Hinges,
    /// Ring-2 springs, on a regular grid. A flat sheet of them has no bending stiffness.
    Springs,
}

/// A complete cloth model: a membrane and its bending.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Model {
    /// In the plane.
    pub membrane: MembraneModel,
    /// Out of it.
    pub bending: BendingModel,
}

impl Model {
    /// Diagonalised StVK and hinges.
    pub const STVK: Self = Self { membrane: MembraneModel::Stvk, bending: BendingModel::Hinges };

    /// Soft constraints and hinges.
    pub const SOFT_CONSTRAINT: Self =
        Self { membrane: MembraneModel::SoftConstraint, bending: BendingModel::Hinges };

    /// In-plane and ring-2 springs.
    pub const SPRINGS: Self = Self { membrane: MembraneModel::Springs, bending: BendingModel::Springs };

    /// The published models (Miguel et al. 2012, §6).
    pub const ALL: [Self; 3] = [Self::STVK, Self::SOFT_CONSTRAINT, Self::SPRINGS];

    /// The same membrane with other bending.
    pub const fn with(self, bending: BendingModel) -> Self {
        Self { bending, ..self }
    }

    /// True if there are springs among the elements, which need a regular grid; triangles and hinges take any mesh.
    pub fn is_of_springs(self) -> bool {
        self.membrane == MembraneModel::Springs || self.bending == BendingModel::Springs
    }

    /// The components that have a curve.
    pub fn components(self) -> [Component; 6] {
        use Component::{BendDiagonal, BendTwist, BendWarp, BendWeft, Shear, StretchWarp, StretchWeft};
        let third = if self.bending == BendingModel::Sheet { BendTwist } else { BendDiagonal };
        [StretchWeft, StretchWarp, Shear, BendWeft, BendWarp, third]
    }

    /// The strain measure of a component.
    pub fn strain_measure(self, component: Component) -> StrainMeasure {
        use Component::{BendDiagonal, BendTwist, BendWarp, BendWeft, Shear, StretchWarp, StretchWeft};
        match component {
            StretchWeft | StretchWarp if self.membrane == MembraneModel::Stvk => StrainMeasure::Green,
            StretchWeft | StretchWarp => StrainMeasure::Engineering,
            Shear if self.membrane == MembraneModel::Springs => StrainMeasure::Diagonal,
            Shear => StrainMeasure::Shear,
            BendWeft | BendWarp | BendDiagonal | BendTwist => match self.bending {
                BendingModel::Sheet => StrainMeasure::Curvature,
                BendingModel::Hinges => StrainMeasure::Hinge,
                BendingModel::Springs => StrainMeasure::RingTwo,
            },
        }
    }

    /// Rule for a component's curve at negative strain.
    pub fn negative_strain(self, component: Component, compression: Compression) -> NegativeStrain {
        match (component.is_stretch(), compression) {
            (false, _) => NegativeStrain::Odd,
            (true, Compression::None) => NegativeStrain::Slack,
            (true, Compression::ZeroStrain) => self.strain_measure(component).compression(),
        }
    }

    /// The name in files and on the command line: the membrane's, and after a `+` its bending if that is not the published.
    pub fn name(self) -> &'static str {
        use {BendingModel as Bending, MembraneModel as Membrane};
        match (self.membrane, self.bending) {
            (Membrane::Stvk, Bending::Hinges) => "stvk",
            (Membrane::Stvk, Bending::Sheet) => "stvk+sheet",
            (Membrane::Stvk, Bending::Springs) => "stvk+springs",
            (Membrane::SoftConstraint, Bending::Hinges) => "soft-constraint",
            (Membrane::SoftConstraint, Bending::Sheet) => "soft-constraint+sheet",
            (Membrane::SoftConstraint, Bending::Springs) => "soft-constraint+springs",
            (Membrane::Springs, Bending::Hinges) => "springs+hinges",
            (Membrane::Springs, Bending::Sheet) => "springs+sheet",
            (Membrane::Springs, Bending::Springs) => "springs",
        }
    }

    /// Short description of membrane and bending.
    pub fn description(self) -> String {
        let membrane = match self.membrane {
            MembraneModel::Stvk => "Diagonalised StVK",
            MembraneModel::SoftConstraint => "Soft constraints",
            MembraneModel::Springs => "Springs",
        };
        let bending = match self.bending {
            BendingModel::Sheet => "moment against curvature",
            BendingModel::Hinges => "discrete shells",
            BendingModel::Springs => "ring-2 springs",
        };
        format!("{membrane}, {bending}")
    }
}

impl std::fmt::Display for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

impl From<Model> for String {
    fn from(model: Model) -> Self {
        model.name().into()
    }
}

impl TryFrom<String> for Model {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        let published: Vec<&str> = Self::ALL.iter().map(|model| model.name()).collect();
        let found = Self::ALL.into_iter().find(|model| model.name() == name);
        found.ok_or_else(|| format!("unknown model `{name}`, expected one of {}", published.join(", ")))
    }
}

/// Behaviour of weft and warp under compression.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Compression {
    /// Resists with the stiffness at zero strain.
    #[default]
    ZeroStrain,
    /// Tension only.
    None,
}

/// One of the strain components; a model has six of them, each with its own curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Component {
    /// Stretch along weft.
    StretchWeft,
    /// Stretch along warp.
    StretchWarp,
    /// Shear between the yarns.
    Shear,
    /// Bending along weft.
    BendWeft,
    /// Bending along warp.
    BendWarp,
    /// Bending of hinges and ring-2 springs along neither yarn.
    BendDiagonal,
    /// Twist of a sheet between the yarns.
    BendTwist,
}

impl Component {
    /// All components, in the order of their index in [`Curves`].
    pub const ALL: [Self; 7] = [
        Self::StretchWeft,
        Self::StretchWarp,
        Self::Shear,
        Self::BendWeft,
        Self::BendWarp,
        Self::BendDiagonal,
        Self::BendTwist,
    ];

    /// True for weft or warp stretch.
    pub fn is_stretch(self) -> bool {
        matches!(self, Self::StretchWeft | Self::StretchWarp)
    }

    /// True for bending and twist.
    pub fn is_bending(self) -> bool {
        matches!(self, Self::BendWeft | Self::BendWarp | Self::BendDiagonal | Self::BendTwist)
    }
}

impl std::fmt::Display for Component {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::StretchWeft => "stretch-weft",
            Self::StretchWarp => "stretch-warp",
            Self::Shear => "shear",
            Self::BendWeft => "bend-weft",
            Self::BendWarp => "bend-warp",
            Self::BendDiagonal => "bend-diagonal",
            Self::BendTwist => "bend-twist",
        })
    }
}

/// Curves, at most one per component. A component without a curve stores no energy.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Curves([Option<StiffnessCurve>; Component::ALL.len()]);

impl Curves {
    /// The curve of a component.
    pub fn get(&self, component: Component) -> Option<&StiffnessCurve> {
        self.0[component as usize].as_ref()
    }

    /// Sets the curve of a component.
    pub fn set(&mut self, component: Component, curve: StiffnessCurve) {
        self.0[component as usize] = Some(curve);
    }

    /// The curves of some components.
    pub fn only(&self, components: &[Component]) -> Self {
        components.iter().filter_map(|&component| Some((component, self.get(component)?.clone()))).collect()
    }

    /// The components that have a curve.
    pub fn components(&self) -> impl Iterator<Item = Component> + '_ {
        Component::ALL.into_iter().filter(|&component| self.get(component).is_some())
    }
}

impl FromIterator<(Component, StiffnessCurve)> for Curves {
    fn from_iter<I: IntoIterator<Item = (Component, StiffnessCurve)>>(curves: I) -> Self {
        let mut result = Self::default();
        curves.into_iter().for_each(|(component, curve)| result.set(component, curve));
        result
    }
}
