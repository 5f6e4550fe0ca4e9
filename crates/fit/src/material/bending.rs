//! A material's bending in another model.
//!
//! ```text
//! hinges along a grid's lines   ε = 3κ, D = 3k: the moment of a cylinder, whatever the model
//! on the bias                   κ_u = κ_v = κ_uv = κ/2, so that   B₄₅(κ) = ¼B_weft(κ/2) + ¼B_warp(κ/2) + ½B_twist(κ/2)
//! ```
//!
//! A sheet's twist is what a bias cylinder leaves of it. Where none is left, or none was measured, it is taken as
//! √(B_weft B_warp) (Huber 1923).

use super::Material;
use cloth_data::error::{Error, Result};
use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use cloth_sim::material::{BendingModel, Component, Curves};
use cloth_sim::strain_measure::HINGE_STRAIN_PER_CURVATURE;

/// A twist below this share of √(B_weft B_warp) is none: the three curves contradict each other.
const LEAST: f64 = 0.05;

/// A material with another bending model.
#[derive(Debug, Clone, PartialEq)]
pub struct Converted {
    /// The material.
    pub material: Material,
    /// Origin of a sheet's twist, in words, if it was not the material's.
    pub twist: Option<String>,
}

impl Material {
    /// The material with a bending model: its own, or moment against curvature in place of hinges.
    ///
    /// # Errors
    /// Any other change: the moment of ring-2 springs depends on a grid, hinges have no twist; a sheet without bending along
    /// weft or warp; hinges' curves for one mesh.
    pub fn bending_as(&self, bending: BendingModel) -> Result<Converted> {
        let refused = |found: &str, expected: &str| {
            Err(Error::Setting { field: "bending", found: found.into(), expected: expected.into() })
        };
        match (self.model.bending, bending) {
            (own, other) if own == other => {
                return Ok(Converted { material: self.clone(), twist: None });
            }
            (BendingModel::Hinges, BendingModel::Sheet) if self.for_mesh.is_some() => {
                return refused(
                    "curves for one mesh's hinges",
                    "hinges, or curves fitted without --for-mesh",
                );
            }
            (BendingModel::Hinges, BendingModel::Sheet) => (),
            (BendingModel::Springs, _) => {
                return refused("curves of ring-2 springs, which belong to a grid", "springs");
            }
            (BendingModel::Hinges, _) => return refused("curves of hinges", "sheet or hinges"),
            (BendingModel::Sheet, _) => return refused("curves of a sheet", "sheet"),
        }
        let own = |component| self.curves.get(component);
        let (Some(weft), Some(warp)) = (own(Component::BendWeft), own(Component::BendWarp)) else {
            return refused("a material without bending along weft and warp", "hinges, or both curves");
        };
        let [weft, warp] = [physical(weft)?, physical(warp)?];
        let bias = own(Component::BendDiagonal).map(physical).transpose()?;
        let (twist, words) = twist(&weft, &warp, bias.as_ref())?;
        let membrane = self.curves.components().filter(|component| !component.is_bending());
        let mut curves: Curves =
            membrane.filter_map(|component| Some((component, self.curves.get(component)?.clone()))).collect();
        curves.set(Component::BendWeft, weft);
        curves.set(Component::BendWarp, warp);
        curves.set(Component::BendTwist, twist);
        let model = self.model.with(BendingModel::Sheet);
        Ok(Converted { material: Self { model, curves, ..self.clone() }, twist: Some(words) })
    }
}

/// Rigidity over curvature of a hinge's curve.
fn physical(hinge: &StiffnessCurve) -> Result<StiffnessCurve> {
    curve(
        hinge.strains().iter().map(|strain| strain / HINGE_STRAIN_PER_CURVATURE).collect(),
        hinge.stiffnesses().iter().map(|stiffness| stiffness * HINGE_STRAIN_PER_CURVATURE).collect(),
    )
}

/// Twist rigidity over twist, and its origin.
fn twist(
    weft: &StiffnessCurve,
    warp: &StiffnessCurve,
    bias: Option<&StiffnessCurve>,
) -> Result<(StiffnessCurve, String)> {
    let of_bias = bias.iter().flat_map(|bias| bias.strains()).map(|curvature| 0.5 * curvature);
    // Between the control points of all three.
    let mut twists: Vec<f64> = weft.strains().iter().chain(warp.strains()).copied().chain(of_bias).collect();
    twists.sort_by(f64::total_cmp);
    twists.dedup_by(|next, last| *next <= *last * (1.0 + 1e-9));
    let usual: Vec<f64> =
        twists.iter().map(|&at| (weft.stiffness(at) * warp.stiffness(at)).max(0.0).sqrt()).collect();
    let Some(bias) = bias else {
        let words = "bend-twist was not measured, and is assumed as √(weft · warp)";
        return Ok((curve(twists, usual)?, words.into()));
    };
    let left = |&at: &f64| 2.0 * bias.stiffness(2.0 * at) - 0.5 * (weft.stiffness(at) + warp.stiffness(at));
    let rigidities: Vec<f64> = twists.iter().map(left).collect();
    let remains = rigidities.iter().zip(&usual).all(|(rigidity, usual)| *rigidity >= LEAST * usual);
    let (rigidities, words) = match remains {
        true => (rigidities, "bend-twist is what bend-diagonal leaves of weft and warp"),
        false => (
            usual,
            "bend-diagonal is below what weft and warp alone make a bias strip: bend-twist is assumed as √(weft · warp)",
        ),
    };
    Ok((curve(twists, rigidities)?, words.into()))
}

fn curve(curvatures: Vec<f64>, rigidities: Vec<f64>) -> Result<StiffnessCurve> {
    let context = || "bending as a sheet".to_string();
    StiffnessCurve::new(curvatures, rigidities, NegativeStrain::Odd)
        .map_err(|source| Error::Mechanics { context: context(), source })
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_sim::material::{Compression, Model};

    fn hinged(rigidities: [Option<f64>; 3]) -> Material {
        let components = [Component::BendWeft, Component::BendWarp, Component::BendDiagonal];
        let curves = components.into_iter().zip(rigidities).filter_map(|(component, rigidity)| {
            let curve = StiffnessCurve::constant(rigidity? / 3.0, NegativeStrain::Odd).unwrap();
            Some((component, curve))
        });
        Material {
            name: "cloth".into(),
            areal_density: 0.1,
            model: Model::STVK,
            compression: Compression::ZeroStrain,
            curves: curves.collect(),
            for_mesh: None,
        }
    }

    fn twist_of(rigidities: [Option<f64>; 3]) -> (f64, String) {
        let Converted { material, twist } = hinged(rigidities).bending_as(BendingModel::Sheet).unwrap();
        assert_eq!(material.model, Model::STVK.with(BendingModel::Sheet));
        assert!(material.curves.get(Component::BendDiagonal).is_none());
        (material.curves.get(Component::BendTwist).unwrap().stiffness(1.0), twist.unwrap())
    }

    #[test]
    fn one_rigidity_has_it_in_twist_too() {
        let (twist, words) = twist_of([Some(2e-5); 3]);
        assert!((twist / 2e-5 - 1.0).abs() < 1e-12 && words.contains("leaves"), "{twist} {words}");
    }

    #[test]
    fn a_bias_below_weft_and_warp_alone_is_said_and_replaced() {
        for bias in [Some(1.4e-4), None] {
            let (twist, words) = twist_of([Some(8e-4), Some(2e-5), bias]);
            assert!((twist / (8e-4f64 * 2e-5).sqrt() - 1.0).abs() < 1e-12 && words.contains("assumed"));
        }
    }

    /// Weft softens where the bias curve has no control point.
    #[test]
    fn the_moment_on_the_bias_comes_back_between_its_points() {
        let curve = |strains: Vec<f64>, stiffnesses: Vec<f64>| {
            StiffnessCurve::new(strains, stiffnesses, NegativeStrain::Odd).unwrap()
        };
        let mut material = hinged([None, Some(2.5e-5), Some(3e-4)]);
        let weft = curve(vec![0.0, 60.0, 120.0], [8.3e-4, 6.1e-4, 5.4e-4].map(|k| k / 3.0).to_vec());
        material.curves.set(Component::BendWeft, weft);
        let sheet = material.bending_as(BendingModel::Sheet).unwrap().material.curves;
        let rigidity = |component, at| sheet.get(component).unwrap().stiffness(at);
        for at in [0.0, 10.0, 20.0, 30.0, 40.0] {
            let along = rigidity(Component::BendWeft, at) + rigidity(Component::BendWarp, at);
            let bias = 0.25 * along + 0.5 * rigidity(Component::BendTwist, at);
            assert!((bias / 3e-4 - 1.0).abs() < 0.01, "{at}: {bias}");
        }
    }

    #[test]
    fn springs_and_half_a_material_are_refused() {
        let as_sheet = |material: &Material| material.bending_as(BendingModel::Sheet);
        assert!(as_sheet(&hinged([Some(1e-5), None, None])).is_err());
        let springs = Material { model: Model::SPRINGS, ..hinged([Some(1e-5); 3]) };
        assert!(as_sheet(&springs).unwrap_err().to_string().contains("springs"));
    }
}
