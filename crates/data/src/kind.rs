//! The kinds of test, and what the rest of the program asks of one.
//!
//! ```text
//! strip          picture frame     bars            corners          table
//! ┃──────┃──▶    ◢────◣            ▬▬▬▬▬ ──▶       ◀ ┌──┐ ▶          ▔▔▔▔▔╲
//! ┃──────┃       ◥────◤  hinged    ▬▬▬▬▬             └──┘  ▶◀             ╲
//! ```
//!
//! A kind is added here, with one description; where its mechanics need more than the ways of holding above, in
//! `rig` (to make it) and in the fit's `twin` (to simulate it).

use cloth_sim::material::Component;
use serde::{Deserialize, Serialize};

/// Which test a sequence is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Two bars pulled apart along weft.
    StretchWeft,
    /// Two bars pulled apart along warp.
    StretchWarp,
    /// Two bars pulled apart on a strip cut at 45° to the yarns.
    StretchBias,
    /// Picture frame.
    Shear,
    /// Pushed off a table edge along weft.
    BendWeft,
    /// Pushed off a table edge along warp.
    BendWarp,
    /// Pushed off a table edge at 45° to the yarns.
    BendBias,
    /// Opposite edges pulled opposite ways.
    ComplexShear,
    /// Four small clips pulled at the corners.
    CornerPull,
}

/// The way in which a specimen is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holding {
    /// Between two bars that are pulled apart.
    Strip,
    /// In four hinged bars; cords pull along each bar.
    PictureFrame,
    /// Between two bars that move along themselves.
    Bars,
    /// By small clips at the corners.
    Corners,
    /// On a table, over whose edge it hangs.
    Table,
}

/// The measure of a test's progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extension {
    /// Mean relative change of distance between the clips' centres.
    Elongation,
    /// Effective shear angle, rad.
    ShearAngle,
    /// Length beyond the table's edge, m.
    Overhang,
}

/// One number that sums up the forces of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Summary {
    /// Torque of the clips' forces about the cloth's centre, N·m.
    AggregatedTorque,
    /// Difference of the two corner-to-corner forces, N.
    StretchingForceDifference,
}

/// All that is asked of a kind.
struct Description {
    name: &'static str,
    holding: Holding,
    /// Angle of the pull or the overhang to weft, degrees; of a picture frame and of corners 0.
    degrees_from_weft: f64,
    /// None: the test serves for validation only.
    shows: &'static [Component],
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 9] = [
        Self::StretchWeft,
        Self::StretchWarp,
        Self::StretchBias,
        Self::Shear,
        Self::BendWeft,
        Self::BendWarp,
        Self::BendBias,
        Self::ComplexShear,
        Self::CornerPull,
    ];

    const fn description(self) -> Description {
        use Component::{BendDiagonal, BendWarp, BendWeft, Shear, StretchWarp, StretchWeft};
        let (name, holding, degrees_from_weft, shows): (_, _, _, &[Component]) = match self {
            Self::StretchWeft => ("stretch-weft", Holding::Strip, 0.0, &[StretchWeft]),
            Self::StretchWarp => ("stretch-warp", Holding::Strip, 90.0, &[StretchWarp]),
            Self::StretchBias => ("stretch-bias", Holding::Strip, 45.0, &[Shear]),
            Self::Shear => ("shear", Holding::PictureFrame, 0.0, &[Shear]),
            Self::BendWeft => ("bend-weft", Holding::Table, 0.0, &[BendWeft, BendDiagonal]),
            Self::BendWarp => ("bend-warp", Holding::Table, 90.0, &[BendWarp, BendDiagonal]),
            Self::BendBias => ("bend-bias", Holding::Table, 45.0, &[BendDiagonal]),
            Self::ComplexShear => ("complex-shear", Holding::Bars, 0.0, &[]),
            Self::CornerPull => ("corner-pull", Holding::Corners, 0.0, &[]),
        };
        Description { name, holding, degrees_from_weft, shows }
    }

    /// The name in files and on the command line.
    pub fn name(self) -> &'static str {
        self.description().name
    }

    /// The holding of the specimen.
    pub fn holding(self) -> Holding {
        self.description().holding
    }

    /// Angle of a strip's pull, or of what hangs off a table, to weft, degrees.
    pub fn degrees_from_weft(self) -> f64 {
        self.description().degrees_from_weft
    }

    /// The components whose curves are fitted on it; none of a test that is for validation only.
    pub fn shows(self) -> &'static [Component] {
        self.description().shows
    }

    /// The tests that show a component.
    pub fn of(component: Component) -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(move |kind| kind.shows().contains(&component))
    }

    /// True for a strip that is pulled along its yarns, in which shear and bending play no part.
    pub fn is_along_yarns(self) -> bool {
        self.holding() == Holding::Strip && self.degrees_from_weft() % 90.0 == 0.0
    }

    /// True for a strip cut across the yarns: pulled taut, it stays in its plane, and nobody saw it buckle.
    pub fn is_on_the_bias(self) -> bool {
        self.holding() == Holding::Strip && !self.is_along_yarns()
    }

    /// The measure of how far the test went.
    pub fn extension(self) -> Extension {
        match self.holding() {
            Holding::Strip | Holding::Corners => Extension::Elongation,
            Holding::PictureFrame | Holding::Bars => Extension::ShearAngle,
            Holding::Table => Extension::Overhang,
        }
    }

    /// The summary of a frame's forces; `None` where forces and shapes are compared one by one.
    pub fn summary(self) -> Option<Summary> {
        match self.holding() {
            Holding::PictureFrame | Holding::Bars => Some(Summary::AggregatedTorque),
            Holding::Corners => Some(Summary::StretchingForceDifference),
            Holding::Strip | Holding::Table => None,
        }
    }
}

impl std::fmt::Display for Kind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

impl Summary {
    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::AggregatedTorque => "N m",
            Self::StretchingForceDifference => "N",
        }
    }
}

impl std::fmt::Display for Summary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::AggregatedTorque => "aggregated torque",
            Self::StretchingForceDifference => "stretching-force difference",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_in_files() {
        for kind in Kind::ALL {
            assert_eq!(serde_json::to_string(&kind).unwrap(), format!("\"{kind}\""));
        }
    }

    #[test]
    fn every_component_is_shown_by_a_test() {
        assert!(
            cloth_sim::material::Model::STVK
                .components()
                .into_iter()
                .all(|component| Kind::of(component).next().is_some())
        );
    }
}
