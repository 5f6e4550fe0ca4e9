//! Selection of a table's columns and rows.

use clap::Args;
use cloth_data::strip::{Column, Extension};
use std::ops::RangeInclusive;

/// The column of the extension, in one of three forms.
#[derive(Debug, Clone, Args)]
#[group(required = true, multiple = false)]
pub struct ExtensionOptions {
    /// Column of the clamp distance
    #[arg(long, value_name = "COLUMN[:UNIT]", value_parser = column)]
    pub separation: Option<Column>,
    /// Column of the clamp distance minus the gauge length
    #[arg(long, value_name = "COLUMN[:UNIT]", value_parser = column)]
    pub displacement: Option<Column>,
    /// Column of the engineering strain: displacement divided by gauge length
    #[arg(long, value_name = "COLUMN[:UNIT]", value_parser = column)]
    pub strain: Option<Column>,
}

impl ExtensionOptions {
    /// The column given on the command line.
    pub(super) fn chosen(&self) -> Extension {
        let Self { separation, displacement, strain } = self.clone();
        separation
            .map(Extension::Separation)
            .or(displacement.map(Extension::Displacement))
            .or(strain.map(Extension::Strain))
            .expect("clap requires one of the group")
    }
}

/// Parses `COLUMN[:UNIT]`.
pub(super) fn column(text: &str) -> Result<Column, String> {
    let column = Column::from(text);
    if column.name.is_empty() { Err("the column name is missing".into()) } else { Ok(column) }
}

/// Parses `FIRST-LAST` or `FIRST-`.
pub(super) fn rows(text: &str) -> Result<RangeInclusive<usize>, String> {
    let (first, last) =
        text.split_once('-').ok_or("expected two row numbers joined by -, such as 3-90 or 3-")?;
    let number = |text: &str| text.trim().parse().map_err(|_| format!("{text:?} is not a row number"));
    let last = if last.trim().is_empty() { usize::MAX } else { number(last)? };
    Ok(number(first)?..=last)
}
