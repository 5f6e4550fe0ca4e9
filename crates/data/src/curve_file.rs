//! A curve as a table of stress over strain, or moment over curvature, and its conversion to a simulation curve.
//!
//! ```text
//! stretch, shear    strain, stress_n_per_m           εᵢ = strain            kᵢ = σᵢ/εᵢ     or as a fit names them
//! bending           curvature_per_m, moment_n        εᵢ = 3 × curvature     kᵢ = Mᵢ/εᵢ      hinges of a regular grid
//! ```
//!
//! Every row with ε > 0 is a control point. The stiffness at zero cannot be derived from a stress; the column
//! `stiffness_n_per_m` or `rigidity_n_m` states it. Without that column k₀ = k₁, the value of the first row above
//! zero. This equals linear interpolation from zero stress to that row, and it stays positive where a line through
//! two rows would give a negative value.

mod read;
#[cfg(test)]
mod tests;

use crate::error::{Error, Result};
use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use cloth_sim::material::{Component, Model};
use cloth_sim::strain_measure::StrainMeasure;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Allowed difference between rows below zero and the model's extension of the rows above, as a share of the largest
/// stress.
const DISAGREEMENT: f64 = 0.01;
/// Strains up to this share of the largest count as zero: 201 equidistant rows from below zero hit it only to
/// rounding.
const ZERO: f64 = 1e-9;

/// Measures a table can have, the most specific column names first; `None` = stretch or shear, in the strain of the
/// model that reads the table.
fn measures() -> impl Iterator<Item = Option<StrainMeasure>> {
    let named = StrainMeasure::ALL.into_iter().filter(|measure| *measure != StrainMeasure::RingTwo);
    named.map(Some).chain([None])
}

/// Column names: strain or curvature, secant stiffness, stress or moment, and the two sides of the band.
pub fn columns(measure: Option<StrainMeasure>) -> [&'static str; 5] {
    measure.map_or(
        ["strain", "stiffness_n_per_m", "stress_n_per_m", "stress_low_n_per_m", "stress_high_n_per_m"],
        StrainMeasure::columns,
    )
}

/// Engineering strain √(1 + 2E) − 1 and nominal stress S √(1 + 2E) of a row of Green strain and PK2 stress. `None`
/// for other measures, which have no second pair of columns, and where the length vanishes.
pub fn engineering(measure: StrainMeasure, strain: f64, stress: f64) -> Option<[f64; 2]> {
    if measure != StrainMeasure::Green {
        return None;
    }
    let extension = measure.physical(strain).filter(|extension| *extension > -1.0)?;
    Some([extension, stress * (1.0 + 2.0 * strain).sqrt()])
}

/// Column names of engineering strain and nominal stress.
pub const ENGINEERING: [&str; 2] = ["engineering_strain", "nominal_stress_n_per_m"];

/// A curve table, as in a file.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveFile {
    /// Strain measure of the rows; `None` = stretch or shear, in the strain of the model that reads the table.
    pub measure: Option<StrainMeasure>,
    /// Strains, or curvatures in 1/m; ascending.
    pub strains: Vec<f64>,
    /// Stresses in N/m, or moments per width in N; one per row.
    pub stresses: Vec<f64>,
    /// Secant stiffnesses in N/m, or flexural rigidities in N·m, if the file has the column.
    pub stiffnesses: Option<Vec<f64>>,
    /// Lower and upper side of a band on the stress, each if the file has the column; NaN in rows without a value.
    pub band: [Option<Vec<f64>>; 2],
    path: PathBuf,
    lines: Vec<usize>,
}

impl CurveFile {
    /// A table made from rows of another source, without optional columns.
    ///
    /// * `path`, `lines` — origin of each row, for messages
    ///
    /// # Errors
    /// No row; strains that do not ascend.
    pub fn new(
        measure: Option<StrainMeasure>,
        strains: Vec<f64>,
        stresses: Vec<f64>,
        path: &Path,
        lines: Vec<usize>,
    ) -> Result<Self> {
        let band = [None, None];
        let file =
            Self { measure, strains, stresses, stiffnesses: None, band, path: path.to_path_buf(), lines };
        file.check_order()?;
        Ok(file)
    }

    fn check_order(&self) -> Result<()> {
        let strains = &self.strains;
        if strains.is_empty() {
            return Err(self.refuse(None, "row", "nothing below the header", "at least one row"));
        }
        let Some(row) = (1..strains.len()).find(|&row| strains[row] <= strains[row - 1]) else {
            return Ok(());
        };
        let relation = if strains[row] == strains[row - 1] { "the same as" } else { "below" };
        let found = format!("{}, {relation} the row before", strains[row]);
        let expected = format!("above {}: rows in ascending order, each once", strains[row - 1]);
        Err(self.refuse(Some(row), columns(self.measure)[0], found, expected))
    }

    /// The curve of a component in a model, with a control point at every row at or above zero.
    ///
    /// Rows below zero are not control points; the rule `negative` determines the stress there. They must agree with
    /// it within 1 % of the table's largest stress (a two-sided shear table must be odd). If such rows exist but none
    /// lies at zero, a control point is added there.
    ///
    /// # Errors
    /// A table of another kind, or of another model's strain; bending of springs, whose tables belong to a grid; no
    /// row at zero where the table starts above it; a non-zero stress at zero; fewer than two rows at or above zero;
    /// a stiffness column that is not the stress over the strain; rows below zero that disagree.
    pub fn curve(
        &self,
        component: Component,
        model: Model,
        negative: NegativeStrain,
    ) -> Result<StiffnessCurve> {
        self.check_component(component, model)?;
        let [axis, stiffness, stress, ..] = columns(self.measure);
        let scale = self.strain_per_unit();
        let zero = ZERO * self.largest_strain();
        let first = self.strains.partition_point(|&strain| strain <= zero);
        let below = self.strains.partition_point(|&strain| strain < -zero);
        let largest = self.largest_stress();
        if self.strains.len() - first < 1 {
            return Err(self.refuse(None, axis, "no row above zero", "at least one row above zero"));
        }
        if first - below > 1 {
            let found = format!("{}, practically the same as the row before", self.strains[below + 1]);
            return Err(self.refuse(
                Some(below + 1),
                axis,
                found,
                "rows at least 1e-9 of the largest strain apart",
            ));
        }
        let at_zero = (below < first).then_some(below);
        match at_zero {
            Some(row) if self.stresses[row].abs() > ZERO * largest => {
                let found = format!("{} at zero", self.stresses[row]);
                return Err(self.refuse(
                    Some(row),
                    stress,
                    found,
                    "0 there: an unstrained cloth has no stress",
                ));
            }
            None if below == 0 => {
                let found = format!("{} in the first row", self.strains[0]);
                return Err(self.refuse(Some(0), axis, found, format!("0 there, with {stress} 0")));
            }
            _ => {}
        }
        let secants: Vec<f64> = (first..self.strains.len())
            .map(|row| match &self.stiffnesses {
                Some(stiffnesses) => self.stated(row, stiffnesses[row], largest),
                None => Ok(self.stresses[row] / self.strains[row]),
            })
            .collect::<Result<_>>()?;
        let start = match (&self.stiffnesses, at_zero) {
            (Some(stiffnesses), Some(row)) => stiffnesses[row],
            _ => secants[0],
        };
        let strains = std::iter::once(0.0).chain(self.strains[first..].iter().map(|strain| scale * strain));
        let stiffnesses = std::iter::once(start).chain(secants).map(|k| k / scale).collect();
        let curve = StiffnessCurve::new(strains.collect(), stiffnesses, negative).map_err(|error| {
            let row = match error {
                // Without a stated row, the stiffness at zero is that of the first row above.
                cloth_sim::error::Error::Curve { point, .. } => Some(first + point.saturating_sub(1)),
                _ => None,
            };
            self.refuse(row, stiffness, error.to_string(), "distinct strains and finite stiffnesses")
        })?;
        self.check_below_zero(&curve, below, largest)?;
        Ok(curve)
    }

    /// Copies rows and columns with the stresses of another curve; a band keeps its width around the stress.
    ///
    /// * `curve` — over the model's strains, as returned by [`CurveFile::curve`]
    ///
    /// Adds a stiffness column if there is none: the stress alone does not determine the stiffness at zero, and the
    /// file would read back as a different curve.
    pub fn with_curve(&self, curve: &StiffnessCurve) -> Self {
        let scale = self.strain_per_unit();
        let stress: Vec<f64> = self.strains.iter().map(|&strain| curve.stress(scale * strain)).collect();
        let stiffness = |(&strain, stress): (&f64, &f64)| match curve
            .strains()
            .binary_search_by(|knot| knot.total_cmp(&(scale * strain)))
        {
            Ok(point) => scale * curve.stiffnesses()[point],
            Err(_) if strain == 0.0 => scale * curve.stiffnesses()[0],
            Err(_) => stress / strain,
        };
        let shift = |side: &Option<Vec<f64>>| {
            let rows = side.as_ref()?.iter().zip(&stress).zip(&self.stresses);
            Some(rows.map(|((side, new), old)| side + (new - old)).collect())
        };
        Self {
            stiffnesses: Some(self.strains.iter().zip(&stress).map(stiffness).collect()),
            band: [shift(&self.band[0]), shift(&self.band[1])],
            stresses: stress,
            ..self.clone()
        }
    }

    /// Multiplies all strains and stresses; stiffnesses and bands follow.
    pub fn scaled(&self, strain: f64, stress: f64) -> Self {
        let times = |values: &[f64], factor: f64| values.iter().map(|value| value * factor).collect();
        Self {
            strains: times(&self.strains, strain),
            stresses: times(&self.stresses, stress),
            stiffnesses: self.stiffnesses.as_ref().map(|values| times(values, stress / strain)),
            band: self.band.each_ref().map(|side| side.as_ref().map(|values| times(values, stress))),
            ..self.clone()
        }
    }

    /// One row per control point of another curve, after the rows of this table that lie below zero. The result has
    /// no band, because a band is known only at the original rows.
    pub fn with_points(&self, curve: &StiffnessCurve) -> Self {
        let scale = self.strain_per_unit();
        let zero = ZERO * self.largest_strain();
        let below = self.strains.iter().take_while(|&&strain| strain < -zero);
        let points = curve.strains().iter().map(|strain| strain / scale);
        let strains: Vec<f64> = below.copied().chain(points).collect();
        let rows = Self { stresses: vec![0.0; strains.len()], strains, band: [None, None], ..self.clone() };
        rows.with_curve(curve)
    }

    /// Ratio of the element strain to the values of the first column: 1, or 3 for curvature.
    pub fn strain_per_unit(&self) -> f64 {
        self.measure.map_or(1.0, StrainMeasure::strain_per_unit)
    }

    /// CSV text of all columns present; a table of Green strain also gets engineering strain and nominal stress.
    pub fn to_csv(&self) -> String {
        let [axis, stiffness, stress, low, high] = columns(self.measure);
        let [strains, stresses] = self.engineering();
        let columns: Vec<(&str, &[f64])> = [
            (axis, Some(&self.strains)),
            (stiffness, self.stiffnesses.as_ref()),
            (stress, Some(&self.stresses)),
            (low, self.band[0].as_ref()),
            (high, self.band[1].as_ref()),
            (ENGINEERING[0], strains.as_ref()),
            (ENGINEERING[1], stresses.as_ref()),
        ]
        .into_iter()
        .filter_map(|(name, values)| Some((name, &values?[..])))
        .collect();
        let mut text = columns.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(",") + "\n";
        for row in 0..self.strains.len() {
            for (column, (_, values)) in columns.iter().enumerate() {
                let comma = if column == 0 { "" } else { "," };
                let value = if values[row].is_nan() { String::new() } else { values[row].to_string() };
                let _ = write!(text, "{comma}{value}");
            }
            text.push('\n');
        }
        text
    }

    /// The engineering columns of a table of Green strain.
    fn engineering(&self) -> [Option<Vec<f64>>; 2] {
        let rows = self.strains.iter().zip(&self.stresses);
        let rows: Option<Vec<_>> = rows.map(|(&e, &s)| engineering(self.measure?, e, s)).collect();
        [0, 1].map(|column| rows.as_ref().map(|rows| rows.iter().map(|row| row[column]).collect()))
    }

    /// Rejects engineering columns that contradict the Green strain and its stress.
    fn check_beside(&self, given: [Option<Vec<f64>>; 2]) -> Result<()> {
        for ((given, own), name) in given.iter().zip(self.engineering()).zip(ENGINEERING) {
            let (Some(given), Some(own)) = (given, own) else { continue };
            let largest = own.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
            let differs = |row: &usize| !((given[*row] - own[*row]).abs() <= 1e-6 * largest);
            if let Some(row) = (0..own.len()).find(differs) {
                let [axis, _, stress, ..] = columns(self.measure);
                let expected =
                    format!("{}, from {axis} and {stress} (leave the column out after an edit)", own[row]);
                return Err(self.refuse(Some(row), name, given[row].to_string(), expected));
            }
        }
        Ok(())
    }

    /// A component and a model whose tables have these columns.
    pub fn typical(&self) -> (Component, Model) {
        let pairs =
            Model::ALL.into_iter().flat_map(|model| Component::ALL.map(|component| (component, model)));
        let mut pairs = pairs.filter(|(component, model)| {
            self.measure.is_none_or(|measure| model.strain_measure(*component) == measure)
        });
        pairs.next().unwrap_or((Component::StretchWeft, Model::STVK))
    }

    /// True if a row lies below zero.
    pub fn is_two_sided(&self) -> bool {
        self.strains[0] < -ZERO * self.largest_strain()
    }

    fn largest_strain(&self) -> f64 {
        self.strains.iter().fold(0.0, |largest: f64, strain| largest.max(strain.abs()))
    }

    fn largest_stress(&self) -> f64 {
        self.stresses.iter().fold(0.0, |largest: f64, stress| largest.max(stress.abs()))
    }

    fn check_component(&self, component: Component, model: Model) -> Result<()> {
        let wanted = model.strain_measure(component);
        let agrees = match (self.measure, wanted) {
            (None, _) => !component.is_bending(),
            (Some(StrainMeasure::Hinge), StrainMeasure::RingTwo) => true,
            (Some(measure), wanted) => measure == wanted,
        };
        if !agrees {
            let [axis, _, stress, ..] = columns(Some(wanted));
            let [found, ..] = columns(self.measure);
            let expected = format!("{axis} and {stress}, the columns of {component} in {model}");
            return Err(self.refuse(None, "header", format!("a column {found}"), expected));
        }
        if wanted == StrainMeasure::RingTwo {
            return Err(self.refuse(
                None,
                "model",
                "moments over curvature for the springs of an unspecified grid",
                "a material.json, with control points over the strain of the springs, or another model",
            ));
        }
        Ok(())
    }

    /// The stiffness stated in a row, checked against the stress over the strain.
    fn stated(&self, row: usize, stiffness: f64, largest: f64) -> Result<f64> {
        let product = stiffness * self.strains[row];
        if !((product - self.stresses[row]).abs() <= 1e-6 * largest) {
            let [axis, column, stress, ..] = columns(self.measure);
            let found = format!("{stiffness}, which times {axis} is {product}");
            let expected = format!("{stress} {} (leave the column out after an edit)", self.stresses[row]);
            return Err(self.refuse(Some(row), column, found, expected));
        }
        Ok(stiffness)
    }

    fn check_below_zero(&self, curve: &StiffnessCurve, below: usize, largest: f64) -> Result<()> {
        let [_, _, stress, ..] = columns(self.measure);
        for row in 0..below {
            let expected = curve.stress(self.strain_per_unit() * self.strains[row]);
            if !((self.stresses[row] - expected).abs() <= DISAGREEMENT * largest) {
                let found = format!("{} at {}", self.stresses[row], self.strains[row]);
                let rule = match curve.negative() {
                    NegativeStrain::Odd => "an odd curve, given by the rows above zero",
                    NegativeStrain::Linear | NegativeStrain::Green => {
                        "compression with the stiffness at zero"
                    }
                    NegativeStrain::Slack => "no stress in compression",
                };
                let expected = format!(
                    "{expected:.6} within 1 % of the largest: {rule} (or leave the rows below zero out)"
                );
                return Err(self.refuse(Some(row), stress, found, expected));
            }
        }
        Ok(())
    }

    fn refuse(
        &self,
        row: Option<usize>,
        field: &str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Error {
        let line = row.and_then(|row| self.lines.get(row).copied());
        Error::input(&self.path, line, field, found, expected)
    }
}
