//! How equilibria and fits are solved: as they are by default, or as published.

use cloth_fit::stage::Settings;
use cloth_sim::equilibrium;

/// The method of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    /// The program's own settings.
    Default,
    /// The published method: [`Settings::as_published`].
    AsPublished,
}

impl Solver {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Default, Self::AsPublished];

    /// How it finds equilibria.
    pub fn equilibrium(self) -> equilibrium::Settings {
        self.settings(Settings::default()).equilibrium
    }

    /// The settings of a fit by it.
    pub fn settings(self, settings: Settings) -> Settings {
        match self {
            Self::Default => settings,
            Self::AsPublished => settings.as_published(),
        }
    }
}

impl std::fmt::Display for Solver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Default => "default",
            Self::AsPublished => "as-published",
        })
    }
}

/// Levenberg–Marquardt instead of mixed Newton, to the same tolerance.
pub(crate) fn damped() -> equilibrium::Settings {
    equilibrium::Settings {
        method: equilibrium::Method::LevenbergMarquardt,
        ..equilibrium::Settings::default()
    }
}
