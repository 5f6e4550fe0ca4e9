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
        let bends = Kind::Bending.columns().iter().any(|name| table.column(name).is_some());
        let kind = if bends { Kind::Bending } else { Kind::Membrane };
        let [axis, stiffness, stress, low, high] = kind.columns();
        let ([x, y], optional) = table.require([axis, stress], [stiffness, low, high])?;
        let column = |place: usize| -> Result<Vec<f64>> {
            (0..table.rows()).map(|row| table.number(row, place)).collect()
        };
        let [stiffnesses, low, high] = optional.map(|place| place.map(column).transpose());
        let lines = (0..table.rows()).map(|row| table.line(row)).collect();
        let file = Self::new(kind, column(x)?, column(y)?, path, lines)?;
        Ok(Self { stiffnesses: stiffnesses?, band: [low?, high?], ..file })
    }
}
