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
    /// The same on a strip cut at 45° to the yarns.
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

/// How far a test went.
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
    extension: Extension,
    summary: Option<Summary>,
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
        const fn strip(
            name: &'static str,
            degrees_from_weft: f64,
            shows: &'static [Component],
        ) -> Description {
            let (holding, extension) = (Holding::Strip, Extension::Elongation);
            Description { name, holding, degrees_from_weft, shows, extension, summary: None }
        }
        const fn table(
            name: &'static str,
            degrees_from_weft: f64,
            shows: &'static [Component],
        ) -> Description {
            let (holding, extension) = (Holding::Table, Extension::Overhang);
            Description { name, holding, degrees_from_weft, shows, extension, summary: None }
        }
        match self {
            Self::StretchWeft => strip("stretch-weft", 0.0, &[StretchWeft]),
            Self::StretchWarp => strip("stretch-warp", 90.0, &[StretchWarp]),
            Self::StretchBias => strip("stretch-bias", 45.0, &[Shear]),
            Self::Shear => Description {
                name: "shear",
                holding: Holding::PictureFrame,
                degrees_from_weft: 0.0,
                shows: &[Shear],
                extension: Extension::ShearAngle,
                summary: Some(Summary::AggregatedTorque),
            },
            Self::BendWeft => table("bend-weft", 0.0, &[BendWeft, BendDiagonal]),
            Self::BendWarp => table("bend-warp", 90.0, &[BendWarp, BendDiagonal]),
            Self::BendBias => table("bend-bias", 45.0, &[BendDiagonal]),
            Self::ComplexShear => Description {
                name: "complex-shear",
                holding: Holding::Bars,
                degrees_from_weft: 0.0,
                shows: &[],
                extension: Extension::ShearAngle,
                summary: Some(Summary::AggregatedTorque),
            },
            Self::CornerPull => Description {
                name: "corner-pull",
                holding: Holding::Corners,
                degrees_from_weft: 0.0,
                shows: &[],
                extension: Extension::Elongation,
                summary: Some(Summary::StretchingForceDifference),
            },
        }
    }

    /// The name in files and on the command line.
    pub fn name(self) -> &'static str {
        self.description().name
    }

    /// How the specimen is held.
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

    /// How far the test went.
    pub fn extension(self) -> Extension {
        self.description().extension
    }

    /// What the forces of a frame are summed up by; `None` where forces and shapes are compared one by one.
    pub fn summary(self) -> Option<Summary> {
        self.description().summary
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
        assert!(Component::ALL.into_iter().all(|component| Kind::of(component).next().is_some()));
    }
}
