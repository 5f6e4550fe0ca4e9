//! The stages of the fit. Each fits one component on the sequences that show it, others known or left out.

pub mod stretch;
