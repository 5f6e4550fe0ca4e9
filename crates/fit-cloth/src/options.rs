//! Flags shared by several commands.

mod choice;
mod flags;
mod reading;

pub use choice::{
    BendingChoice, ComponentChoice, CompressionChoice, ConstraintChoice, ModelChoice, ModelsChoice,
    TopicChoice, VariantChoice,
};
pub use flags::{CurveFlags, FitFlags, SetFlags, parse_kind, parse_nodes};
pub(crate) use flags::{STABLE, refuse_within, use_threads};
pub use reading::Reading;
