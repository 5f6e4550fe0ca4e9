//! Checks every curve of a material for stable simulation.

use crate::material::file::MaterialFile;
use cloth_data::error::{Error, Result};
use cloth_sim::curve::soundness::{self, Context, Finding};
use cloth_sim::material::{Component, Curves, Model};
use std::path::Path;

/// Context for the check of a component's curve in a model.
///
/// * `visited` — the strains that a measurement visited, if there was one
pub fn context(model: Model, component: Component, visited: Option<[f64; 2]>) -> Context {
    Context { magnitude: model.strain_measure(component).plausible_stiffness(), visited }
}

/// The findings on every curve of a material; also lists curves without findings.
///
/// # Errors
/// Control points that do not form a valid curve.
pub fn check_material(file: &MaterialFile) -> Result<Vec<(Component, Vec<Finding>)>> {
    let visited = |component| file.curves[&component].visited_strain;
    Ok(check_curves(file.model, &file.curves()?, visited))
}

/// The findings on every curve; also lists curves without findings.
///
/// * `visited` — the strains that a measurement of a component visited, if there was one
pub fn check_curves(
    model: Model,
    curves: &Curves,
    visited: impl Fn(Component) -> Option<[f64; 2]>,
) -> Vec<(Component, Vec<Finding>)> {
    let findings = |component| {
        let context = context(model, component, visited(component));
        curves.get(component).map(|curve| soundness::check(curve, &context))
    };
    curves.components().filter_map(|component| Some((component, findings(component)?))).collect()
}

/// Rejects curves whose shape can make a simulation fail, whatever their unit; names the first defect.
///
/// * `what` — the file that contains them
/// * `expected` — a stable curve, in words, with the caller's own way to one
///
/// # Errors
/// A curve that is not stable.
pub fn refuse_unstable(curves: &Curves, what: &Path, expected: &str) -> Result<()> {
    for component in curves.components() {
        let findings = curves.get(component).map(|curve| soundness::check(curve, &Context::default()));
        if let Some(finding) = findings.iter().flatten().find(|finding| finding.is_unstable()) {
            let found = format!("{finding}: {}", finding.consequence());
            return Err(Error::input(what, None, component.to_string(), found, expected));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_sim::curve::{NegativeStrain, StiffnessCurve};

    #[test]
    fn an_unstable_curve_is_refused_by_its_name() {
        let curve = |k| StiffnessCurve::new(vec![0.0, 0.1, 0.2], k, NegativeStrain::Odd).unwrap();
        let with = |shear| {
            let weft = (Component::StretchWeft, curve(vec![1e9; 3]));
            [weft, (Component::Shear, shear)].into_iter().collect::<Curves>()
        };
        let path = Path::new("material.json");
        // Probably another unit, but stable.
        assert!(refuse_unstable(&with(curve(vec![1.0; 3])), path, "a stable curve").is_ok());
        let error = refuse_unstable(&with(curve(vec![9.0, 9.0, 1.0])), path, "a stable curve")
            .unwrap_err()
            .to_string();
        assert!(error.contains("material.json shear: found low-tangent from 0.1"), "{error}");
        assert!(error.contains("stress falls") && error.ends_with("expected a stable curve"), "{error}");
    }
}
