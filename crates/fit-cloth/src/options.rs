//! The flags that commands share.

mod choice;
mod flags;

pub use choice::{CompressionChoice, ConstraintChoice, ModelChoice, TopicChoice, VariantChoice};
pub use flags::{CurveFlags, FitFlags, SetFlags, parse_kind, parse_nodes};
pub(crate) use flags::{refuse_within, use_threads};
