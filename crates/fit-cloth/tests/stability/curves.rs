//! Cases 1, 2 and 5: curves that are unstable or invalid.

use crate::property::for_all;
use crate::table::{Extent, Row};
use cloth_fit::judge::repair::repair;
use cloth_fit::material::check::refuse_unstable;
use cloth_sim::curve::soundness::{Context, Finding, Flaw, LEAST_TANGENT, MEMBRANE_STIFFNESS, check};
use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use cloth_sim::error::Error;
use cloth_sim::material::{Component, Curves, Model};
use proptest::prelude::*;
use std::path::Path;
use std::process::Command;

/// Unevenly spaced strains of control points up to a largest between 1e-3 and 1, and stiffnesses spread over some
/// decades around 100 N/m.
pub(crate) fn points(count: usize, decades: f64) -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
    let gaps = prop::collection::vec(0.2..1.0, count - 1);
    let stiffnesses =
        prop::collection::vec((-0.5 * decades..=0.5 * decades).prop_map(|p| 1e2 * 10f64.powf(p)), count);
    (gaps, -3.0..0.0, stiffnesses).prop_map(|(gaps, last, stiffnesses)| {
        let sum: f64 = gaps.iter().sum();
        let last = 10f64.powf(last);
        let strains = gaps.iter().scan(0.0, |strain, gap| {
            *strain += gap * last / sum;
            Some(*strain)
        });
        (std::iter::once(0.0).chain(strains).collect(), stiffnesses)
    })
}

pub(crate) fn curve((strains, stiffnesses): (Vec<f64>, Vec<f64>)) -> StiffnessCurve {
    StiffnessCurve::new(strains, stiffnesses, NegativeStrain::Odd).unwrap()
}

/// Strains between zero and the last control point.
fn samples_of(curve: &StiffnessCurve) -> impl Iterator<Item = f64> {
    let last = curve.strains()[curve.len() - 1];
    (0..=200).map(move |i| last * f64::from(i) / 200.0)
}

pub(crate) fn largest_stiffness(curve: &StiffnessCurve) -> f64 {
    samples_of(curve).map(|strain| curve.stiffness(strain)).fold(0.0, f64::max)
}

/// k < 0 between control points with k ≥ 0: the check lists the interval.
pub(crate) fn case_01(extent: Extent) -> Vec<Row> {
    let kinds = [3, 5, 8].into_iter().flat_map(|points| [1.0, 3.0, 6.0].map(|decades| (points, decades)));
    kinds
        .map(|(count, decades)| {
            let row = Row::new(1, format!("{count} points, stiffnesses over {decades} decades"));
            for_all(row, extent.runs(500, 20_000), points(count, decades), |row, points| {
                let curve = curve(points);
                let found: Vec<Finding> = check(&curve, &Context::default());
                let listed = |strain: f64| {
                    found.iter().any(|finding| {
                        finding.kind == Flaw::NegativeStiffness
                            && (finding.strains[0]..=finding.strains[1]).contains(&strain)
                    })
                };
                let rounding = 1e-9 * largest_stiffness(&curve);
                let wrong = samples_of(&curve).find(|&strain| {
                    let k = curve.stiffness(strain);
                    k < -rounding && !listed(strain) || k > rounding && listed(strain)
                });
                row.holds(wrong.is_none(), || format!("{curve:?} at {wrong:?}: {found:?}"))
            })
        })
        .collect()
}

/// σ′ < κ: refused by the simulator unless allowed; the repair that the message offers gives an accepted curve.
pub(crate) fn case_02(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for (count, decades) in [(3, 0.5), (5, 0.5), (5, 2.0), (8, 1.0)] {
        let condition = format!("{count} points, {decades} decades: refused exactly where the tangent falls");
        rows.push(for_all(
            Row::new(2, condition),
            extent.runs(300, 20_000),
            points(count, decades),
            refused_if_falling,
        ));
        let condition = format!("{count} points, {decades} decades: repaired");
        rows.push(for_all(
            Row::new(2, condition),
            extent.runs(30, 2_000),
            points(count, decades),
            |row, points| {
                let curve = curve(points);
                let context = Context { magnitude: Some(MEMBRANE_STIFFNESS), visited: None };
                let repaired = repair(&curve, &context);
                let sound = repaired
                    .as_ref()
                    .is_ok_and(|repaired| !check(&repaired.curve, &context).iter().any(Finding::is_defect));
                row.holds(sound, || format!("{curve:?}: {repaired:?}"))
            },
        ));
    }
    rows.extend(Model::ALL.map(simulated_only_if_allowed));
    rows
}

fn refused_if_falling(row: &mut Row, points: (Vec<f64>, Vec<f64>)) -> bool {
    let curve = curve(points);
    let curves: Curves = [(Component::Shear, curve.clone())].into_iter().collect();
    let refused = refuse_unstable(&curves, Path::new("material.json"), "a stable curve")
        .map_err(|error| error.to_string());
    let tangents = || samples_of(&curve).map(|strain| curve.response(strain).tangent);
    let (least, largest) = (tangents().fold(f64::MAX, f64::min), tangents().fold(f64::MIN, f64::max));
    // The largest sampled stiffness is a lower bound of the true maximum, and so is this κ.
    let kappa = LEAST_TANGENT * largest_stiffness(&curve);
    let holds = match &refused {
        Ok(()) => least >= kappa * (1.0 - 1e-5) && largest <= 1.1e4 * least,
        Err(message) => {
            let finding = check(&curve, &Context::default()).into_iter().find(Finding::is_unstable);
            let really = finding.is_some_and(|finding| {
                let middle = finding.strains[0] + 0.5 * (finding.strains[1] - finding.strains[0]).min(1.0);
                match finding.kind {
                    Flaw::NegativeStiffness => curve.stiffness(middle) < 0.0,
                    Flaw::TangentRatio => largest > 0.5e4 * least,
                    _ => curve.response(middle).tangent <= finding.limit,
                }
            });
            really && message.contains("material.json shear") && message.ends_with("expected a stable curve")
        }
    };
    row.holds(holds, || format!("{curve:?}: {refused:?}, tangents {least} to {largest}, κ = {kappa}"))
}

/// Runs the program on a weightless sheet at rest.
fn simulated_only_if_allowed(model: Model) -> Row {
    let mut row = Row::new(2, format!("{model}, the program: exit 3, with --allow-unstable 0"));
    let folder = tempfile::tempdir().unwrap();
    let curve = |name| {
        format!("[curves.{name}]\nstrain = [0.0, 0.1, 0.2]\nstiffness_n_per_m = [100.0, 100.0, 20.0]\n")
    };
    let material = format!(
        "name = \"cloth\"\nareal_density_kg_m2 = 0.2\nmodel = \"{model}\"\n{}{}{}",
        curve("stretch-weft"),
        curve("stretch-warp"),
        curve("shear")
    );
    let scene = "name = \"sheet\"\ngravity_m_s2 = [0.0, -9.8, 0.0]\nduration_s = 0.05\nstep_s = 0.01\n\
                 [sheet]\ngrid = { width_m = 0.1, height_m = 0.1, nodes = [4, 4] }\n[[held]]\nedge = \"top\"\n";
    std::fs::write(folder.path().join("cloth.toml"), material).unwrap();
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let run = |more: &[&str]| {
        let arguments =
            [&["simulate", "scene.toml", "--material", "cloth.toml", "--out", "out"], more].concat();
        Command::new(env!("CARGO_BIN_EXE_fit-cloth")).args(arguments).current_dir(&folder).output().unwrap()
    };
    let refused = run(&[]);
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    let named = message.contains("stretch-weft") && message.contains("check --repair");
    let unwritten = !folder.path().join("out").exists();
    row.holds(refused.status.code() == Some(3) && named && unwritten, || format!("{refused:?}"));
    let allowed = run(&["--allow-unstable"]);
    let written = folder.path().join("out/simulation.json").exists();
    row.holds(allowed.status.code() == Some(0) && written, || format!("{allowed:?}"));
    row
}

/// A defect of the knots, and the words that name it.
type Spoilt = (&'static str, fn(&mut Vec<f64>, &mut Vec<f64>, usize), &'static str);

/// Duplicate, unsorted and NaN knots: the message names the knot.
pub(crate) fn case_05(extent: Extent) -> Vec<Row> {
    let spoilt: [Spoilt; 7] = [
        ("duplicate strain", |strains, _, at| strains[at] = strains[at - 1], "not above the one before"),
        ("strains not sorted", |strains, _, at| strains[at] = -strains[at], "not above the one before"),
        ("strain NaN", |strains, _, at| strains[at] = f64::NAN, "strain is not finite"),
        ("strain infinite", |strains, _, at| strains[at] = f64::INFINITY, "strain is not finite"),
        ("stiffness NaN", |_, stiffnesses, at| stiffnesses[at] = f64::NAN, "stiffness is not finite"),
        (
            "stiffness infinite",
            |_, stiffnesses, at| stiffnesses[at] = -f64::INFINITY,
            "stiffness is not finite",
        ),
        ("a stiffness missing", |_, stiffnesses, _| stiffnesses.truncate(1), "stiffnesses"),
    ];
    let inputs = || (points(7, 6.0), 1..7usize);
    let mut rows: Vec<Row> = spoilt
        .into_iter()
        .map(|(condition, spoil, words)| {
            for_all(
                Row::new(5, condition),
                extent.runs(200, 10_000),
                inputs(),
                |row, ((mut e, mut k), at)| {
                    spoil(&mut e, &mut k, at);
                    let error = StiffnessCurve::new(e.clone(), k.clone(), NegativeStrain::Odd).err();
                    let message = error.as_ref().map(Error::to_string).unwrap_or_default();
                    let named = match error {
                        Some(Error::Curve { point, .. }) => {
                            point == at && message.contains(&format!("control point {at}"))
                        }
                        Some(Error::ShapeMismatch { expected: 7, found: 1, .. }) => k.len() == 1,
                        _ => false,
                    };
                    row.holds(named && message.contains(words), || format!("{e:?}, {k:?}, {at}: {message}"))
                },
            )
        })
        .collect();
    rows.push(for_all(
        Row::new(5, "first strain not zero"),
        extent.runs(200, 10_000),
        (points(5, 6.0), 1e-9..1.0),
        |row, ((strains, stiffnesses), shift)| {
            let strains: Vec<f64> = strains.iter().map(|strain| strain + shift).collect();
            let error = StiffnessCurve::new(strains, stiffnesses, NegativeStrain::Odd).err();
            let named = matches!(error, Some(Error::Curve { point: 0, .. }));
            row.holds(named, || format!("{shift}: {error:?}"))
        },
    ));
    rows
}
