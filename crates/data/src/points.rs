//! Control points of a curve in a TOML file.

use crate::error::Result;
use crate::io::TomlFile;
use cloth_sim::curve::NegativeStrain;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::error::Error as Defect;

/// Control points as stored in a file.
pub struct Points<'a> {
    /// The enclosing table, e.g. `curves.shear`.
    pub table: String,
    /// Key and values of the strains or curvatures.
    pub places: (&'a str, &'a [f64]),
    /// Key and values of the stiffnesses or rigidities.
    pub values: (&'a str, &'a [f64]),
    /// Ratio of the element strain to the strain of the file.
    pub strain_per_unit: f64,
}

impl Points<'_> {
    /// Curve over the strain of the elements.
    ///
    /// # Errors
    /// Points that do not form a curve, with the line of the invalid one.
    pub fn curve(&self, negative: NegativeStrain, file: &TomlFile) -> Result<StiffnessCurve> {
        let Self { table, places, values, strain_per_unit: scale } = self;
        let refuse = |key: &str, point: usize, found: String, expected: &str| {
            let [list, element] = [format!("{table}.{key}"), format!("{table}.{key}[{point}]")];
            Err(file.invalid(if file.has(&element) { &element } else { &list }, found, expected))
        };
        if places.1.len() != values.1.len() {
            let found = format!("{} {}s for {} values", places.1.len(), places.0, values.1.len());
            return Err(file.invalid(&format!("{table}.{}", places.0), found, "one for each"));
        }
        if let Some(point) = values.1.iter().position(|value| !value.is_finite()) {
            return refuse(values.0, point, values.1[point].to_string(), "a finite number");
        }
        let scaled = |values: &[f64], by: f64| values.iter().map(|value| value * by).collect();
        match StiffnessCurve::new(scaled(places.1, *scale), scaled(values.1, 1.0 / scale), negative) {
            Ok(curve) => Ok(curve),
            Err(Defect::Curve { point, reason }) => {
                let found =
                    places.1.get(point).map_or("nothing".into(), |place| format!("{place}: {reason}"));
                refuse(places.0, point, found, "finite numbers in ascending order, the first 0")
            }
            Err(other) => refuse(values.0, 0, other.to_string(), "a stiffness for every strain"),
        }
    }
}
