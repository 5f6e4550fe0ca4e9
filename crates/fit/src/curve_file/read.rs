//! Reading a curve's table.

use super::{CurveFile, Kind};
use crate::error::Result;
use crate::io::table::Table;
use std::path::Path;

impl CurveFile {
    /// Reads a table: `strain` and `stress_n_per_m`, or `curvature_per_m` and `moment_n`; with them, if they are there,
    /// the other columns that fit-cloth writes of a curve.
    ///
    /// # Errors
    /// Not a table of such columns; a field that is no finite number; strains that do not ascend; no row.
    pub fn read(path: &Path) -> Result<Self> {
        let table = Table::read(path)?;
        let kind = match table.column(Kind::Bending.columns()[0]) {
            Some(_) => Kind::Bending,
            None => Kind::Membrane,
        };
        let [axis, stiffness, stress, low, high] = kind.columns();
        let ([x, y], optional) = table.require([axis, stress], [stiffness, low, high])?;
        let column = |place: usize| -> Result<Vec<f64>> {
            (0..table.rows()).map(|row| table.number(row, place)).collect()
        };
        let strains = column(x)?;
        if strains.is_empty() {
            return Err(table.incomplete("row", "nothing below the header", "one row at least"));
        }
        if let Some(row) = (1..strains.len()).find(|&row| strains[row] <= strains[row - 1]) {
            let relation = if strains[row] == strains[row - 1] { "the same as" } else { "below" };
            let found = format!("{}, {relation} the row before", strains[row]);
            return Err(table.invalid(
                row,
                axis,
                found,
                format!("above {}: rows in ascending order, each once", strains[row - 1]),
            ));
        }
        let [stiffnesses, low, high] = optional.map(|place| place.map(column).transpose());
        Ok(Self {
            kind,
            strains,
            stresses: column(y)?,
            stiffnesses: stiffnesses?,
            band: [low?, high?],
            path: path.to_path_buf(),
            lines: (0..table.rows()).map(|row| table.line(row)).collect(),
        })
    }
}
