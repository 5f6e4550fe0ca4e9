//! Solver of equilibria and fits: the default, or as published.

use cloth_fit::stage::Settings;
use cloth_sim::equilibrium;

/// Method of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    /// The default settings.
    Default,
    /// The published method: [`Settings::as_published`].
    AsPublished,
}

impl Solver {
    /// Both solvers.
    pub const ALL: [Self; 2] = [Self::Default, Self::AsPublished];

    /// Settings for equilibria.
    pub fn equilibrium(self) -> equilibrium::Settings {
        self.settings(Settings::default()).equilibrium
    }

    /// Applies the method to the settings of a fit.
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
