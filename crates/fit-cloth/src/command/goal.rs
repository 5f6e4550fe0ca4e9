//! What `fit-cloth stretch | shear | bend | fit` are about, and their examples.

use cloth_data::frame::Kind;
use cloth_fit::incremental::Stage;
use cloth_fit::stage::kinds_of_all;
use cloth_fit::stage::knowledge::Knowledge;
use cloth_sim::material::Component;

/// The example of `fit-cloth stretch`.
pub const STRETCH_EXAMPLE: &str = "\
Example:
  fit-cloth stretch fixtures/cotton-denim --out out/stretch
  fit-cloth stretch fixtures/cotton-denim --model all --nodes 13x13 --out out/models

Writes report.html, report.json, material.json, curves/*.csv, residuals.csv, forces.csv and plots/*.svg; with --model all,
a folder for each model.";

/// The example of `fit-cloth shear`.
pub const SHEAR_EXAMPLE: &str = "\
Example:
  fit-cloth shear fixtures/cotton-denim --out out/shear

Uses sequences of kind shear and stretch-bias; a set without either is refused.
With --known FILE, the stretch curves are taken from the material.json of a previous fit.";

/// The example of `fit-cloth bend`.
pub const BEND_EXAMPLE: &str = "\
Example:
  fit-cloth bend fixtures/cotton-denim --out out/bend

Uses sequences of kind bend-weft, bend-warp and bend-bias. A curve without its sequence is not fitted, and a warning
names it; a set without any of them is refused.
With --known FILE, the stretch and shear curves are taken from the material.json of a previous fit.";

/// The example of `fit-cloth fit`.
pub const FIT_EXAMPLE: &str = "\
Example:
  fit-cloth fit fixtures/cotton-denim --out out/fit
  fit-cloth fit fixtures/cotton-denim --variant linear --robust --verbose --out out/linear

Fits stretch, shear and bending in this order, then shear and bending once more. A curve that no sequence observes is not
fitted, and a warning names it. An interrupted run resumes after the last finished curve.";

/// What a command is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Goal {
    /// Stretch.
    Stretch,
    /// Shear, and what it builds on.
    Shear,
    /// Bending, and what it builds on.
    Bend,
    /// All that is not given.
    All,
}

impl Goal {
    /// What is fitted, in order, unless it is given.
    pub fn stages(self) -> &'static [Stage] {
        match self {
            Self::Stretch => &Stage::ALL[..1],
            Self::Shear => &Stage::ALL[..2],
            Self::Bend | Self::All => &Stage::ALL,
        }
    }

    /// What is fitted even if it is given.
    pub fn anew(self) -> &'static [Component] {
        match self {
            Self::Stretch => Stage::Stretch.components(),
            Self::Shear => Stage::Shear.components(),
            Self::Bend => Stage::Bend.components(),
            Self::All => &[],
        }
    }

    /// The tests that it is about, without which there is nothing to fit; none where it takes what a set shows.
    pub fn tests(self) -> Vec<Kind> {
        kinds_of_all(self.anew())
    }

    /// The curves that are missed where a set does not show them: bending hardly feels the others.
    pub fn components(self) -> impl Iterator<Item = Component> {
        let stages = if self == Self::Bend { &[Stage::Bend][..] } else { self.stages() };
        stages.iter().flat_map(|stage| stage.components()).copied()
    }

    /// The tests that show what is not known.
    pub fn kinds(self, known: &Knowledge) -> Vec<Kind> {
        let fits = |stage: &&Stage| !stage.components().iter().all(|&component| known.knows(component));
        self.stages().iter().filter(fits).flat_map(|stage| stage.kinds()).collect()
    }
}
