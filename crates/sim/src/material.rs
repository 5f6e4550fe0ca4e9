//! Model and curves: the complete description of a fabric, independent of any mesh.

use crate::curve::{NegativeStrain, StiffnessCurve};
use crate::strain_measure::StrainMeasure;
use serde::{Deserialize, Serialize};

/// A complete cloth model: a membrane and its bending (Miguel et al. 2012, §6).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// Diagonalised St. Venant–Kirchhoff membrane, discrete shells.
    Stvk,
    /// Soft constraints of Baraff and Witkin, discrete shells.
    SoftConstraint,
    /// In-plane springs, and ring-2 springs for bending.
    Springs,
}

impl Model {
    /// All models.
    pub const ALL: [Self; 3] = [Self::Stvk, Self::SoftConstraint, Self::Springs];

    /// True if the elements are springs, which need a regular grid; otherwise they are triangles and hinges, for any
    /// mesh.
    pub fn is_of_springs(self) -> bool {
        match self {
            Self::Springs => true,
            Self::Stvk | Self::SoftConstraint => false,
        }
    }

    /// The strain measure of a component.
    pub fn strain_measure(self, component: Component) -> StrainMeasure {
        use Component::{BendDiagonal, BendWarp, BendWeft, Shear, StretchWarp, StretchWeft};
        match (component, self) {
            (StretchWeft | StretchWarp, Self::Stvk) => StrainMeasure::Green,
            (StretchWeft | StretchWarp, Self::SoftConstraint | Self::Springs) => StrainMeasure::Engineering,
            (Shear, Self::Stvk | Self::SoftConstraint) => StrainMeasure::Shear,
            (Shear, Self::Springs) => StrainMeasure::Diagonal,
            (BendWeft | BendWarp | BendDiagonal, Self::Stvk | Self::SoftConstraint) => StrainMeasure::Hinge,
            (BendWeft | BendWarp | BendDiagonal, Self::Springs) => StrainMeasure::RingTwo,
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

    /// The name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stvk => "stvk",
            Self::SoftConstraint => "soft-constraint",
            Self::Springs => "springs",
        }
    }

    /// Short description of membrane and bending.
    pub fn description(self) -> &'static str {
        match self {
            Self::Stvk => "Diagonalised StVK, discrete shells",
            Self::SoftConstraint => "Soft constraints, discrete shells",
            Self::Springs => "Springs",
        }
    }
}

impl std::fmt::Display for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
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

/// One of the six strain components; each has its own curve.
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
    /// Bending along neither yarn.
    BendDiagonal,
}

impl Component {
    /// All components, in the order of their index in [`Curves`].
    pub const ALL: [Self; 6] = [
        Self::StretchWeft,
        Self::StretchWarp,
        Self::Shear,
        Self::BendWeft,
        Self::BendWarp,
        Self::BendDiagonal,
    ];

    /// True for weft or warp stretch.
    pub fn is_stretch(self) -> bool {
        matches!(self, Self::StretchWeft | Self::StretchWarp)
    }

    /// True for the three bending components.
    pub fn is_bending(self) -> bool {
        matches!(self, Self::BendWeft | Self::BendWarp | Self::BendDiagonal)
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
        })
    }
}

/// Up to six curves, one per component. A component without a curve stores no energy.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Curves([Option<StiffnessCurve>; 6]);

impl Curves {
    /// The curve of a component.
    pub fn get(&self, component: Component) -> Option<&StiffnessCurve> {
        self.0[component as usize].as_ref()
    }

    /// Sets the curve of a component.
    pub fn set(&mut self, component: Component, curve: StiffnessCurve) {
        self.0[component as usize] = Some(curve);
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
