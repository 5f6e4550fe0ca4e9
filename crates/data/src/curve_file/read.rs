//! Reads a curve table.

use super::{CurveFile, ENGINEERING, columns, measures};
use crate::error::Result;
use crate::io::table::Table;
use cloth_sim::strain_measure::StrainMeasure;
use std::path::Path;

impl CurveFile {
    /// Reads a table of `strain` and `stress_n_per_m`, of `curvature_per_m` and `moment_n`, or of another measure
    /// ([`columns`]), with any of the optional columns that fit-cloth writes for a curve.
    ///
    /// # Errors
    /// A table without such columns; columns that contradict each other; a field that is not a finite number (band
    /// fields may be empty); strains that do not ascend; no rows.
    pub fn read(path: &Path) -> Result<Self> {
        let table = Table::read(path)?;
        let names = |measure: &Option<StrainMeasure>| [columns(*measure)[0], columns(*measure)[2]];
        let is_of =
            |measure: &Option<StrainMeasure>| names(measure).iter().any(|name| table.has_quantity(name));
        let Some(measure) = measures().find(is_of) else {
            let expected = "a curve: curvature_per_m and moment_n, or strain and stress_n_per_m (import tables of forces and \
                            lengths first)";
            return Err(table.bad_header("header", table.names(), expected));
        };
        let [axis, stiffness, stress, low, high] = columns(measure);
        // Other measures have no second pair of columns.
        let beside = if measure == Some(StrainMeasure::Green) { ENGINEERING } else { [axis, stress] };
        let ([x, y], [k, a, b, e, p]) =
            table.require([axis, stress], [stiffness, low, high, beside[0], beside[1]])?;
        let column = |place: usize| -> Result<Vec<f64>> {
            (0..table.rows()).map(|row| table.number(row, place)).collect()
        };
        // A row not covered by data has no band on either side.
        let sides: Vec<usize> = [a, b].into_iter().flatten().collect();
        let cells = |place: usize| -> Result<Vec<f64>> {
            let empty =
                |row: usize| sides.len() == 2 && sides.iter().all(|&side| table.text(row, side).is_empty());
            (0..table.rows())
                .map(|row| if empty(row) { Ok(f64::NAN) } else { table.number(row, place) })
                .collect()
        };
        let [stiffnesses, strains, stresses] = [k, e, p].map(|place| place.map(column).transpose());
        let [low, high] = [a, b].map(|place| place.map(cells).transpose());
        let lines = (0..table.rows()).map(|row| table.line(row)).collect();
        let file = Self::new(measure, column(x)?, column(y)?, path, lines)?;
        file.check_beside([strains?, stresses?])?;
        Ok(Self { stiffnesses: stiffnesses?, band: [low?, high?], ..file })
    }
}
