//! Converts the table of one pull, or of one shear test, to a stress–strain curve without a fit.
//!
//! ```text
//! green          ε = (λ² − 1)/2    σ = F/(w λ)       second Piola–Kirchhoff stress per width: model stvk
//! engineering    ε = λ − 1         σ = F/w           nominal stress per width: models soft-constraint, springs
//! shear          ε = γ             σ = F/w − T γ     shear between parallel bars: all models
//! ```
//!
//! F is the force, w the width at rest, λ the clamp distance over the gauge length. The strip is assumed to be in
//! uniform strain and free to narrow, which requires no energy in models with independent weft and warp. Between
//! parallel bars at a constant distance, γ is the shift over that distance. A shear tester pulls the sheet across the
//! shift with a tension T per width; with w_u = (1, 0), w_v = (γ, 1), a tension along warp with energy T γ²/2 adds T
//! γ to the force.
//!
//! Sources: F/(w λ) from dW = F dλ/w and dε = λ dλ; Volino et al. 2009 for shear between bars.

use super::column::{Column, Quantity, Series};
use super::rows::{SEPARATION, chosen_rows};
use super::settings::Extension;
use super::settings::LARGEST;
use crate::curve_file::CurveFile;
use crate::error::{Error, Result};
use crate::io::check_length;
use crate::io::table::Table;
use cloth_sim::strain_measure::StrainMeasure;
use std::ops::RangeInclusive;
use std::path::Path;

/// Conversion of forces and lengths to strain and stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Conversion {
    /// Green strain, second Piola–Kirchhoff stress.
    Green,
    /// Engineering strain, nominal stress.
    Engineering,
    /// Shear between parallel bars, minus the contribution of a tension across them.
    Shear {
        /// Tension per width, N/m; 0 if there is none.
        tension: f64,
    },
}

/// Settings: information missing from the table, and the part of it to use.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceTable {
    /// Width of the strip at rest, across the pull, or of a sheared sheet along the bars, m.
    pub width: f64,
    /// Clamp distance at rest, m; not needed for strains.
    pub gauge: Option<f64>,
    /// Extension of the strip, or shift of the bars.
    pub extension: Extension,
    /// Load cell reading.
    pub force: Column,
    /// Rows to use, both ends included; the first below the header is 1, `usize::MAX` the last. Default: all.
    pub rows: Option<RangeInclusive<usize>>,
    /// Strain and stress to compute.
    pub conversion: Conversion,
}

/// Reads a table of force over elongation as one of stress over strain.
///
/// If all rows lie above zero, a row with zero strain and stress is added in front: the strip is assumed free at the
/// gauge length.
///
/// # Errors
/// A setting outside its range; a file that is not a table; a missing column or unit; a number that is not finite; a
/// clamp distance below half or above ten gauge lengths; strains that do not ascend; a force at zero strain.
pub fn read_force_table(path: &Path, test: &ForceTable) -> Result<CurveFile> {
    test.validate()?;
    let table = Table::read_columns(path, &test.columns())?;
    let (column, quantity) = match &test.extension {
        Extension::Separation(column) | Extension::Displacement(column) => (column, Quantity::Length),
        Extension::Strain(column) => (column, Quantity::Strain),
    };
    let [extension, force] =
        [Series::find(&table, column, quantity)?, Series::find(&table, &test.force, Quantity::Force)?];
    let (mut strains, mut stresses, mut lines) = (Vec::new(), Vec::new(), Vec::new());
    for row in chosen_rows(&table, test.rows.as_ref())? {
        let elongation = test.elongation(extension.value(&table, row)?);
        let nominal = force.value(&table, row)? / test.width;
        let stretch = 1.0 + elongation;
        if !matches!(test.conversion, Conversion::Shear { .. }) && !SEPARATION.contains(&stretch) {
            let expected = "0.5 to 10 (another unit, or another of separation, displacement and strain?)";
            return Err(table.invalid(
                row,
                &column.name,
                format!("{stretch} times the gauge length"),
                expected,
            ));
        }
        let (strain, stress) = match test.conversion {
            // (λ² − 1)/2 without cancellation.
            Conversion::Green => (elongation * (1.0 + 0.5 * elongation), nominal / stretch),
            Conversion::Engineering => (elongation, nominal),
            Conversion::Shear { tension } => (elongation, nominal - tension * elongation),
        };
        if !stress.is_finite() {
            let found = format!("{} N on {} m", force.value(&table, row)?, test.width);
            return Err(table.invalid(row, &test.force.name, found, "a stress below 1.8e308 N/m"));
        }
        strains.push(strain);
        stresses.push(stress);
        lines.push(table.line(row));
    }
    if strains.first().is_some_and(|&first| first > 0.0) {
        strains.insert(0, 0.0);
        stresses.insert(0, 0.0);
        lines.insert(0, lines[0]);
    }
    let measure = match test.conversion {
        Conversion::Green => StrainMeasure::Green,
        Conversion::Engineering => StrainMeasure::Engineering,
        Conversion::Shear { .. } => StrainMeasure::Shear,
    };
    CurveFile::new(Some(measure), strains, stresses, path, lines)
}

impl ForceTable {
    /// Names of the required columns.
    pub fn columns(&self) -> [&str; 2] {
        [&self.extension.column().name, &self.force.name]
    }

    fn validate(&self) -> Result<()> {
        let refuse = |field, found: String, expected: &str| {
            Err(Error::Setting { field, found, expected: expected.into() })
        };
        for (field, value) in [("width", Some(self.width)), ("gauge", self.gauge)] {
            let Some(value) = value else { continue };
            check_length(value, LARGEST).or_else(|expected| refuse(field, value.to_string(), &expected))?;
        }
        if let Conversion::Shear { tension } = self.conversion
            && !(tension >= 0.0 && tension.is_finite())
        {
            return refuse("tension", tension.to_string(), "0 or more, in N/m");
        }
        match (&self.extension, self.gauge) {
            (Extension::Strain(_), _) | (_, Some(_)) => Ok(()),
            _ => refuse("gauge", "none".into(), "the clamps' distance at rest: lengths are divided by it"),
        }
    }

    /// λ − 1, or γ.
    fn elongation(&self, value: f64) -> f64 {
        match (&self.extension, self.gauge) {
            (Extension::Separation(_), Some(gauge)) => (value - gauge) / gauge,
            (Extension::Displacement(_), Some(gauge)) => value / gauge,
            _ => value,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn read(text: &str, test: &ForceTable) -> Result<CurveFile> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pull.csv");
        fs::write(&path, text).unwrap();
        read_force_table(&path, test)
    }

    fn test(extension: Extension, conversion: Conversion) -> ForceTable {
        ForceTable {
            width: 0.05,
            gauge: Some(0.2),
            extension,
            force: "load:N".into(),
            rows: None,
            conversion,
        }
    }

    #[test]
    fn a_table_becomes_stress_over_the_strain_asked_for() {
        let table = "travel_mm,load\n0,0\n20,10\n40,30\n";
        let green = test(Extension::Displacement("travel_mm".into()), Conversion::Green);
        let found = read(table, &green).unwrap();
        let near = |found: &[f64], expected: &[f64]| {
            found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12)
        };
        assert!(near(&found.strains, &[0.0, 0.105, 0.22]));
        assert!(near(&found.stresses, &[0.0, 200.0 / 1.1, 600.0 / 1.2]));
        let engineering =
            read(table, &ForceTable { conversion: Conversion::Engineering, ..green.clone() }).unwrap();
        assert!(
            near(&engineering.strains, &[0.0, 0.1, 0.2]) && near(&engineering.stresses, &[0.0, 200.0, 600.0])
        );
        let shear = ForceTable { conversion: Conversion::Shear { tension: 100.0 }, ..green.clone() };
        assert!(near(&read(table, &shear).unwrap().stresses, &[0.0, 190.0, 580.0]));
        // The clamp distance, without the rest state.
        let separation = test(Extension::Separation("apart:m".into()), Conversion::Green);
        let found = read("apart,load\n0.22,10\n0.24,30\n", &separation).unwrap();
        assert!(near(&found.strains, &[0.0, 0.105, 0.22]) && found.stresses[0] == 0.0);
        assert_eq!(
            found.to_csv().lines().next(),
            Some("green_strain,pk2_stress_n_per_m,engineering_strain,nominal_stress_n_per_m")
        );
        // The extra columns hold the values of clamps and load cell.
        let last =
            found.to_csv().lines().last().map(|row| row.split(',').map(|f| f.parse().unwrap()).collect());
        let last: Vec<f64> = last.unwrap();
        assert!(near(&last[2..], &[0.2, 600.0]), "{last:?}");
        let strain =
            ForceTable { gauge: None, ..test(Extension::Strain("e:%".into()), Conversion::Engineering) };
        let some = ForceTable { rows: Some(1..=2), ..strain };
        assert!(near(&read("e,load\n0,0\n10,10\n5,1\n", &some).unwrap().strains, &[0.0, 0.1]));
    }

    #[test]
    fn what_is_wrong_is_named_by_its_line() {
        let green = test(Extension::Displacement("travel_mm".into()), Conversion::Green);
        for (rows, words) in [
            ("0,0\n20,10\n10,5", ":4 green_strain: found"),
            ("0,0\n5000,10", ":3 travel_mm: found 26 times the gauge length"),
            ("0,0\n20,x", ":3 load: found x"),
            ("0,0\n20,1e308", ":3 load: found 100000"),
        ] {
            let error = read(&format!("travel_mm,load\n{rows}\n"), &green).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
        // A column name may contain anything; the message stays on one line.
        let named = test(Extension::Displacement("a\u{14}b_mm".into()), Conversion::Green);
        let error = read("a\u{14}b_mm,load\n5000,1\n", &named).unwrap_err().to_string();
        assert!(error.contains(":2 a\\u{14}b_mm: found 26 times"), "{error}");
        for wrong in [
            ForceTable { gauge: None, ..green.clone() },
            ForceTable { width: 50.0, ..green.clone() },
            ForceTable { conversion: Conversion::Shear { tension: -1.0 }, ..green.clone() },
            ForceTable { rows: Some(2..=9), ..green },
        ] {
            assert!(read("travel_mm,load\n0,0\n20,10\n", &wrong).is_err(), "{wrong:?}");
        }
    }
}
