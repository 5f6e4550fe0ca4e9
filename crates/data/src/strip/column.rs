//! A column of the machine table and its unit, which is stated but never guessed.

use crate::error::Result;
use crate::io::shown;
use crate::io::table::Table;

/// A column, and its unit if the name does not contain it.
///
/// As text: `COLUMN` or `COLUMN:UNIT`, split at the last colon. A name contains its unit as an ending such as `_mm`
/// or `_N`, or in brackets: `Load (N)`, `Strain [%]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Exact name in the header.
    pub name: String,
    /// `m`, `mm`, `cm` or `in`; `N`, `kN`, `cN`, `mN`, `gf`, `kgf` or `lbf`; `1` or `%`. `None` = contained in the
    /// name.
    pub unit: Option<String>,
}

impl From<&str> for Column {
    fn from(text: &str) -> Self {
        match text.rsplit_once(':') {
            Some((name, unit)) => Self { name: name.trim().into(), unit: Some(unit.trim().into()) },
            None => Self { name: text.trim().into(), unit: None },
        }
    }
}

/// Quantity of a column.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Length,
    Force,
    Strain,
}

#[derive(PartialEq)]
struct Unit {
    quantity: Quantity,
    /// Name in lists.
    name: &'static str,
    /// Other spellings.
    also: &'static [&'static str],
    /// Factor to SI.
    factor: f64,
}

const fn unit(quantity: Quantity, name: &'static str, also: &'static [&'static str], factor: f64) -> Unit {
    Unit { quantity, name, also, factor }
}

/// Case matters: MN is not mN. Lower-case spellings exist for tables with lower-case column names.
const UNITS: [Unit; 13] = [
    unit(Quantity::Length, "m", &[], 1.0),
    unit(Quantity::Length, "mm", &[], 1e-3),
    unit(Quantity::Length, "cm", &[], 1e-2),
    unit(Quantity::Length, "in", &[], 0.0254),
    unit(Quantity::Force, "N", &["n"], 1.0),
    unit(Quantity::Force, "kN", &["kn"], 1e3),
    unit(Quantity::Force, "cN", &["cn"], 1e-2),
    unit(Quantity::Force, "mN", &["mn"], 1e-3),
    unit(Quantity::Force, "gf", &[], 9.80665e-3),
    unit(Quantity::Force, "kgf", &[], 9.80665),
    unit(Quantity::Force, "lbf", &[], 4.448_221_615_260_5),
    unit(Quantity::Strain, "1", &["-", "m/m", "mm/mm", "in/in"], 1.0),
    unit(Quantity::Strain, "%", &["percent"], 1e-2),
];

/// A column with known position and unit.
pub(super) struct Series {
    place: usize,
    factor: f64,
}

impl Series {
    pub(super) fn find(table: &Table, column: &Column, quantity: Quantity) -> Result<Self> {
        let place = table.place(&column.name)?;
        let name = &column.name;
        let list: Vec<_> =
            UNITS.iter().filter(|unit| unit.quantity == quantity).map(|unit| unit.name).collect();
        let list = list.join(", ");
        let refuse = |found: String, expected: String| Err(table.bad_header(name, found, expected));
        let said = said(name);
        let asked = match &column.unit {
            Some(text) => match named(text) {
                Some(unit) => Some(unit),
                None => {
                    return refuse(
                        format!("the unit \"{}\" asked for", shown(text)),
                        format!("one of {list}"),
                    );
                }
            },
            None => None,
        };
        let unit = match (said, asked) {
            (Some(said), Some(asked)) if said != asked => {
                let found = format!("{} in its name and {} asked for", said.name, asked.name);
                return refuse(found, "one unit".into());
            }
            (None, None) => {
                let name = shown(name);
                let expected =
                    format!("one of {list}, in its name as {name} [UNIT] or asked for as {name}:UNIT");
                return refuse("no unit".into(), expected);
            }
            (Some(unit), _) | (None, Some(unit)) => unit,
        };
        if unit.quantity != quantity {
            return refuse(format!("the unit {}", unit.name), format!("one of {list}"));
        }
        Ok(Self { place, factor: unit.factor })
    }

    /// Value of a row in SI.
    pub(super) fn value(&self, table: &Table, row: usize) -> Result<f64> {
        let value = self.factor * table.number(row, self.place)?;
        if value.is_finite() {
            return Ok(value);
        }
        let found = shown(table.text(row, self.place));
        Err(table.invalid(row, table.name(self.place), found, "a number below 1.8e308 in SI units"))
    }
}

fn named(text: &str) -> Option<&'static Unit> {
    UNITS.iter().find(|unit| unit.name == text || unit.also.contains(&text))
}

/// The unit contained in a column name: `travel_mm`, `Travel (mm)`, `Travel [mm]`.
fn said(name: &str) -> Option<&'static Unit> {
    let in_brackets = |open: char, close: char| Some(name.strip_suffix(close)?.rsplit_once(open)?.1.trim());
    // strain_1 is the first strain gauge, not a strain in units of one.
    let ending = || name.rsplit_once('_').map(|(_, ending)| ending).filter(|ending| *ending != "1");
    in_brackets('(', ')').or_else(|| in_brackets('[', ']')).or_else(ending).and_then(named)
}
