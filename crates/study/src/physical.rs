//! Curves in physical measures. The models' strains differ, so curves are compared by what a laboratory would measure.
//!
//! ```text
//! stretch   P(λ − 1)   force per rest width of a strip
//! shear     S(γ)       force along a bar per length, picture frame
//! bending   M(κ)       moment per width of a rolled sheet
//! ```
//!
//! See [`StrainMeasure`](cloth_sim::strain_measure::StrainMeasure); a place is a value of its physical measure.

use cloth_fit::stage::report::StageReport;
use cloth_sim::bending::{Bending, Rolled};
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::error::Result;
use cloth_sim::material::{Component, Compression, Curves, Model};
use cloth_sim::mesh::Mesh;
use cloth_sim::strain_measure::HINGE_STRAIN_PER_CURVATURE;

/// Reference curves over the strains of a triangle model.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reference {
    /// Model that defines the strains; not springs.
    pub(crate) model: Model,
    /// The curves.
    pub(crate) curves: Curves,
}

impl Reference {
    /// Force or moment per length at an extension, shear angle or curvature, N/m or N; `None` if there is no curve.
    pub(crate) fn load(&self, component: Component, place: f64) -> Option<f64> {
        let curve = self.curves.get(component)?;
        self.model.strain_measure(component).load(place, |strain| curve.stress(strain))
    }

    /// Root mean square distance of a stage's curve over its observed range, over the largest load there; `None`
    /// without a reference curve.
    pub(crate) fn distance(&self, stage: &StageReport) -> Option<f64> {
        distance(&loads(stage), |place| self.load(stage.components[0], place))
    }

    /// Converts curves to another model's strains. A bending curve becomes a single stiffness for springs, which
    /// matches the moment at half of the curve's range; matching all moments would need a curve that falls as 1/κ².
    ///
    /// # Errors
    /// Control points that do not form a valid curve.
    pub(crate) fn told_in(&self, model: Model, mesh: &Mesh) -> Result<Curves> {
        let known = self.curves.components().filter_map(|c| Some((c, self.curves.get(c)?)));
        known
            .map(|(component, curve)| Ok((component, self.curve_in(model, mesh, component, curve)?)))
            .collect()
    }

    fn curve_in(
        &self,
        model: Model,
        mesh: &Mesh,
        component: Component,
        curve: &StiffnessCurve,
    ) -> Result<StiffnessCurve> {
        let last = curve.strains()[curve.len() - 1];
        if component.is_bending() {
            if !model.is_of_springs() {
                return Ok(curve.clone());
            }
            let curvature = f64::max(0.5 * last / HINGE_STRAIN_PER_CURVATURE, 1.0);
            let moment = curve.stress(HINGE_STRAIN_PER_CURVATURE * curvature);
            let bending = Bending::new(model, mesh, &[component], &vec![false; mesh.len()], false)?;
            let rolled = bending.and_then(|bending| bending.rolled(component));
            let stiffness = rolled
                .map_or(0.0, |rolled: Rolled| moment / (rolled.lever(curvature) * rolled.strain(curvature)));
            return StiffnessCurve::constant(
                stiffness,
                model.negative_strain(component, Compression::ZeroStrain),
            );
        }
        if model == self.model {
            return Ok(curve.clone());
        }
        let [own, other] = [self.model, model].map(|model| model.strain_measure(component));
        let secant = |&strain| own.secant_in(other, strain, |strain| curve.stress(strain));
        let (strains, stiffnesses) = curve.strains().iter().filter_map(secant).map(|[e, k]| (e, k)).unzip();
        StiffnessCurve::new(strains, stiffnesses, model.negative_strain(component, Compression::ZeroStrain))
    }
}

/// Places and loads of a fitted curve over its observed range.
pub(crate) fn loads(stage: &StageReport) -> Vec<[f64; 2]> {
    let component = stage.components[0];
    let samples = stage.curve.samples.iter().filter(|sample| sample.strain >= 0.0);
    if component.is_bending() {
        return samples.map(|sample| [sample.strain, sample.stress]).collect();
    }
    let measure = stage.model.strain_measure(component);
    samples
        .filter_map(|sample| {
            let place = measure.physical(sample.strain)?;
            Some([place, measure.load(place, |strain| stage.curve.curve.stress(strain))?])
        })
        .collect()
}

/// Root mean square distance of loads from a reference at the same places, over the reference's largest load.
pub(crate) fn distance(loads: &[[f64; 2]], reference: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    let (mut sum, mut largest) = (0.0, 0.0f64);
    for &[place, load] in loads {
        let expected = reference(place)?;
        sum += (load - expected).powi(2);
        largest = largest.max(expected.abs());
    }
    (largest > 0.0).then(|| (sum / loads.len() as f64).sqrt() / largest)
}

/// Distance of one stage's curve from another's, for the same component and model.
pub(crate) fn between(stage: &StageReport, other: &StageReport) -> Option<f64> {
    let others = loads(other);
    distance(&loads(stage), |place| Some(interpolated(&others, place)))
}

/// Interpolates linearly between the neighbours of a place; extrapolates from the outermost two beyond the ends.
fn interpolated(loads: &[[f64; 2]], place: f64) -> f64 {
    let after = loads.partition_point(|[at, _]| *at < place).clamp(1, loads.len() - 1);
    let [[from, low], [to, high]] = [loads[after - 1], loads[after]];
    low + (high - low) * (place - from) / (to - from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_sim::mesh::{Diagonals, Grid};

    #[test]
    fn a_curve_told_in_another_model_makes_the_same_loads() {
        let curve = |k: f64, component| {
            let negative = Model::STVK.negative_strain(component, Compression::ZeroStrain);
            StiffnessCurve::new(vec![0.0, 0.05, 0.1], vec![k, 1.3 * k, 2.0 * k], negative).unwrap()
        };
        let pairs = [(Component::StretchWeft, 400.0), (Component::Shear, 90.0)];
        let curves = pairs.map(|(component, k)| (component, curve(k, component)));
        let reference = Reference { model: Model::STVK, curves: curves.into_iter().collect() };
        let grid = Grid { columns: 5, rows: 5, width: 0.1, height: 0.1, diagonals: Diagonals::Alternating };
        for model in [Model::SOFT_CONSTRAINT, Model::SPRINGS] {
            let told = reference.told_in(model, &grid.mesh().unwrap()).unwrap();
            for component in [Component::StretchWeft, Component::Shear] {
                let curve = told.get(component).unwrap();
                let measure = model.strain_measure(component);
                for place in [0.02, 0.06, 0.09] {
                    let load = measure.load(place, |strain| curve.stress(strain)).unwrap();
                    let expected = reference.load(component, place).unwrap();
                    assert!((load / expected - 1.0).abs() < 0.02, "{model} {component}: {load} {expected}");
                }
            }
        }
    }
}
