//! Goals of `fit-cloth stretch | shear | bend | fit`, and their help examples.

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

/// The curves that a fit command asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Goal {
    /// Stretch.
    Stretch,
    /// Shear, and the stretch curves that it depends on.
    Shear,
    /// Bending, and the stretch and shear curves that it depends on.
    Bend,
    /// Every curve that is not given by --known.
    All,
}

impl Goal {
    /// Stages to fit, in order, unless their curves are given.
    pub fn stages(self) -> &'static [Stage] {
        match self {
            Self::Stretch => &Stage::ALL[..1],
            Self::Shear => &Stage::ALL[..2],
            Self::Bend | Self::All => &Stage::ALL,
        }
    }

    /// Components that are fitted even if they are given.
    pub fn anew(self) -> &'static [Component] {
        match self {
            Self::Stretch => Stage::Stretch.components(),
            Self::Shear => Stage::Shear.components(),
            Self::Bend => Stage::Bend.components(),
            Self::All => &[],
        }
    }

    /// Kinds of test of which the set must have at least one; empty if any test will do.
    pub fn tests(self) -> Vec<Kind> {
        kinds_of_all(self.anew())
    }

    /// Components to warn about if the set does not observe them. For `bend` these are the bending curves only: the
    /// others hardly affect bending.
    pub fn components(self) -> impl Iterator<Item = Component> {
        let stages = if self == Self::Bend { &[Stage::Bend][..] } else { self.stages() };
        stages.iter().flat_map(|stage| stage.components()).copied()
    }

    /// Kinds of test that observe the unknown curves.
    pub fn kinds(self, known: &Knowledge) -> Vec<Kind> {
        let fits = |stage: &&Stage| !stage.components().iter().all(|&component| known.knows(component));
        self.stages().iter().filter(fits).flat_map(|stage| stage.kinds()).collect()
    }
}
