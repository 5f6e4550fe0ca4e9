//! Frames that take no part, with the reason.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Reason why a frame takes no part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "reason", rename_all = "kebab-case")]
pub enum Skip {
    /// The clips deform the sheet by less than a thousandth of the largest deformation.
    AtRest,
    /// No force was measured along a direction that counts.
    NoForce,
    /// No shape was measured.
    NoShape,
    /// The sheet does not reach over the edge.
    NothingHangsOver,
    /// Too few points were seen past the edge.
    FewPoints {
        /// Their number.
        seen: usize,
    },
    /// Too few cells of the given mesh past the edge.
    FewCells {
        /// Their number.
        cells: usize,
    },
}

impl Skip {
    /// True of a frame at rest, which a test may well have.
    pub fn is_rest(self) -> bool {
        matches!(self, Self::AtRest | Self::NothingHangsOver)
    }
}

impl fmt::Display for Skip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AtRest => f.write_str("at rest"),
            Self::NoForce => f.write_str("no force"),
            Self::NoShape => f.write_str("no shape"),
            Self::NothingHangsOver => f.write_str("nothing hangs over the edge"),
            Self::FewPoints { seen } => write!(f, "only {seen} points seen past the edge"),
            Self::FewCells { cells } => {
                write!(f, "only {cells} cells of the mesh past the edge, of at least 4")
            }
        }
    }
}

/// A frame that takes no part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct SkippedFrame {
    /// Index in the sequence.
    pub frame: usize,
    /// The reason.
    #[serde(flatten)]
    pub skip: Skip,
}
