//! Cases 36, 39 and 40: measurements that are wrong or that the model cannot follow.

use crate::fits::{TRIANGLES, UNIFORM, at, fit, scaled, scales, settings, up_to};
use crate::measured::{Uniform, bulging, overhangs};
use crate::property::for_all;
use crate::table::{Extent, Row};
use cloth_data::frame::{Kind, MeasurementSet, Phase};
use cloth_fit::judge::validation::validate;
use cloth_fit::stage::{Settings, Variant, Watch};
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::material::{Component, Compression, Curves, Model};
use cloth_sim::strain_measure::HINGE_STRAIN_PER_CURVATURE;
use fit_cloth::text;
use proptest::prelude::*;
use rand::{Rng, SeedableRng, rngs::StdRng};

// 36 ---------------------------------------------------------------------------------------------------------------

/// Frames of a test with an outlier.
const FRAMES: usize = 16;

pub(crate) fn case_36(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for (what, factor) in
        [("a flipped sign", -1.0), ("a force three times as large", 3.0), ("a force lost", 0.0)]
    {
        for (kind, models) in UNIFORM {
            for &model in models {
                let row = Row::new(36, format!("{what}, {kind}, {model}: that frame is flagged first"));
                let inputs = (scales(), FRAMES / 2..FRAMES, -4.0..-2.5, any::<u64>());
                rows.push(for_all(row, extent.runs(4, 300), inputs, |row, (scales, frame, noise, seed)| {
                    let (set, _) =
                        with_outlier(kind, model, scaled(scales), Some((frame, factor)), noise, seed);
                    let found =
                        fit(&set, &settings(model)).map(|(_, stage)| stage.sequences[0].outliers.clone());
                    row.holds(found.as_ref().is_ok_and(|frames| frames.first() == Some(&frame)), || {
                        format!("frame {frame}, {scales:?}, noise 1e{noise}, seed {seed}: {found:?}")
                    })
                }));
            }
        }
    }
    for model in TRIANGLES {
        let row =
            Row::new(36, format!("a shape upside down, bend-weft, {model}: that frame is flagged first"));
        rows.push(for_all(
            row,
            extent.runs(3, 100),
            (-1.0..1.0, -2.0..1.0, 0usize..15),
            |row, (stiffness, size, frame)| {
                let (stiffness, size) = scaled((stiffness, size));
                let mut set = overhangs(size, stiffness);
                // The overhangs repeated three times.
                set.sequences[0].frames = vec![set.sequences[0].frames.clone(); 3].concat();
                set.sequences[0].frames[frame].positions.iter_mut().flatten().for_each(|p| p.z = -p.z);
                let found = fit(&set, &Settings { nodes: Some([9, 9]), ..settings(model) });
                let found = found.map(|(_, stage)| stage.sequences[0].outliers.clone());
                row.holds(found.as_ref().is_ok_and(|frames| frames.first() == Some(&frame)), || {
                    format!("frame {frame}, stiffness {stiffness:e}, size {size:e}: {found:?}")
                })
            },
        ));
        let mut row = Row::new(36, format!("no outlier, bend-weft, {model}: none is flagged"));
        let found = fit(&overhangs(1.0, 1.0), &Settings { nodes: Some([9, 9]), ..settings(model) });
        let found = found.map(|(_, stage)| stage.sequences[0].outliers.clone());
        row.holds(found == Ok(Vec::new()), || format!("{found:?}"));
        rows.push(row);
    }
    for (kind, models) in UNIFORM {
        for &model in models {
            let row = Row::new(36, format!("no outlier, {kind}, {model}: none is flagged"));
            let inputs = (scales(), -4.0..-2.5, any::<u64>());
            rows.push(for_all(row, extent.runs(4, 300), inputs, |row, (scales, noise, seed)| {
                let (set, _) = with_outlier(kind, model, scaled(scales), None, noise, seed);
                let found = fit(&set, &settings(model)).map(|(_, stage)| stage.sequences[0].outliers.clone());
                row.holds(found == Ok(Vec::new()), || {
                    format!("{scales:?}, noise 1e{noise}, seed {seed}: {found:?}")
                })
            }));
            let name = format!("a flipped sign, {kind}, {model}: with --robust the curve stays");
            let row = Row::measured(36, name, "relative error", 0.05);
            let inputs = (scales(), FRAMES / 2..FRAMES, -4.0..-2.5, any::<u64>());
            rows.push(for_all(row, extent.runs(4, 300), inputs, |row, (scales, frame, noise, seed)| {
                let (set, largest) =
                    with_outlier(kind, model, scaled(scales), Some((frame, -1.0)), noise, seed);
                let robust = Settings { robust: Some(3.0), ..settings(model) };
                let error = fit(&set, &robust).map(|(_, stage)| {
                    let off =
                        |strain: &f64| (at(&stage, *strain).stress - law(*strain) * scaled(scales).0).abs();
                    up_to(0.2, FRAMES).iter().map(off).fold(0.0, f64::max) / largest
                });
                row.measure(error.clone().unwrap_or(f64::NAN), || {
                    format!("frame {frame}, {scales:?}, noise 1e{noise}, seed {seed}: {error:?}")
                })
            }));
        }
    }
    rows
}

/// A curve that two control points represent exactly.
fn law(strain: f64) -> f64 {
    300.0 * strain + 1500.0 * strain * strain
}

/// A test with one frame's force multiplied, and its largest stress. The noise is a power of ten of the largest force.
fn with_outlier(
    kind: Kind,
    model: Model,
    (stiffness, side): (f64, f64),
    outlier: Option<(usize, f64)>,
    noise: f64,
    seed: u64,
) -> (MeasurementSet, f64) {
    let law = |strain: f64| stiffness * law(strain);
    let largest = law(0.2);
    let noise = Some((10f64.powf(noise) * largest * side, seed));
    let mut set = Uniform { kind, model, side, law: &law, strains: &up_to(0.2, FRAMES), noise }.measure();
    if let Some((frame, factor)) = outlier {
        set.sequences[0].frames[frame].cords.iter_mut().for_each(|cord| cord.force *= factor);
    }
    (set, largest)
}

// 39 ---------------------------------------------------------------------------------------------------------------

pub(crate) fn case_39(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for model in TRIANGLES {
        let row = Row::new(
            39,
            format!(
                "bars pushed together 5 to 20 times as far as buckles, {model}: flagged, or compared on the right side"
            ),
        );
        let inputs = (scales(), -4.5..-3.5, any::<u64>());
        rows.push(for_all(row, extent.runs(3, 100), inputs, |row, (scales, thin, seed): (_, f64, u64)| {
            buckled(row, model, scaled(scales), 10f64.powf(thin), seed)
        }));
    }
    rows
}

/// A sheet that buckles in every other frame, predicted with its true curves: the flat state is also an equilibrium,
/// and so is a bulge to the other side.
///
/// * `thin` — rigidity over stiffness times side squared
fn buckled(row: &mut Row, model: Model, (stiffness, side): (f64, f64), thin: f64, seed: u64) -> bool {
    let mut random = StdRng::seed_from_u64(seed);
    // Euler load of a sheet clamped at both ends, 4π² B/L², over the stiffness.
    let euler = 4.0 * std::f64::consts::PI.powi(2) * thin;
    let strains: Vec<f64> =
        (0..6).map(|i| if i % 2 == 0 { -euler * random.random_range(5.0..20.0) } else { 0.005 }).collect();
    let sides: Vec<f64> = (0..7).map(|_| if random.random_bool(0.5) { 1.0 } else { -1.0 }).collect();
    let set = bulging(side, &strains, &|index| sides[index]);
    let membrane = 500.0 * stiffness;
    let hinge = membrane * thin * side * side / HINGE_STRAIN_PER_CURVATURE.powi(2);
    let mut curves = Curves::default();
    for component in Model::STVK.components() {
        let constant = match component {
            bending if bending.is_bending() => hinge,
            Component::Shear => 0.2 * membrane,
            _ => membrane,
        };
        let negative = model.negative_strain(component, Compression::ZeroStrain);
        curves.set(component, StiffnessCurve::constant(constant, negative).unwrap());
    }
    let settings = Settings { nodes: Some([9, 9]), ..settings(model) };
    let validation =
        validate(&set, &[Kind::ComplexShear], &curves, &Default::default(), &settings, &Watch::default());
    let found = validation.map(|validation| {
        let report = &validation.sequences[0].report;
        (report.multi_stable.clone(), report.position_rms, validation.prediction.dropped.len())
    });
    // The smallest observed bulge; unflagged frames are compared and must bulge to the same side.
    let shallowest = strains.iter().filter(|strain| **strain < 0.0).map(|strain| (-strain).sqrt());
    let bulge = shallowest.fold(f64::INFINITY, f64::min) * 2.0 * side / std::f64::consts::PI;
    let holds = found.as_ref().is_ok_and(|(flagged, rms, dropped)| {
        let only = flagged.iter().all(|frame| frame % 2 == 1);
        only && *dropped == 0 && rms.is_some_and(|rms| rms < 0.5 * bulge)
    });
    row.holds(holds, || {
        format!("stiffness {stiffness:e}, side {side:e}, thin {thin:e}, seed {seed}: {found:?} {strains:?} {sides:?}")
    })
}

// 40 ---------------------------------------------------------------------------------------------------------------

pub(crate) fn case_40(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    let runs = extent.runs(4, 300);
    for (kind, models) in UNIFORM {
        for &model in models {
            for (given, name) in [(true, "given"), (false, "estimated")] {
                let row = Row::new(
                    40,
                    format!(
                        "a straight line for a curve, {kind}, {model}, noise {name}: misfit told, with its size"
                    ),
                );
                let inputs = (scales(), -4.0..-2.0, any::<u64>());
                rows.push(for_all(row, runs, inputs, |row, (scales, noise, seed)| {
                    straight(row, kind, model, scaled(scales), 10f64.powf(noise), seed, given)
                }));
            }
            let row = Row::new(
                40,
                format!(
                    "forces one and a half times as large on loading, {kind}, {model}: misfit and ratio told"
                ),
            );
            let inputs = (scales(), any::<u64>());
            rows.push(for_all(row, runs, inputs, |row, (scales, seed)| {
                hysteresis(row, kind, model, scaled(scales), seed)
            }));
            let row = Row::measured(
                40,
                format!("the right law, {kind}, {model}: share of fits that tell a misfit"),
                "share",
                0.05,
            );
            rows.push(right_law(row, kind, model, extent.runs(20, 400)));
        }
    }
    rows
}

/// A linear fit of a nonlinear law: the expected misfit follows from a linear fit of the law itself.
fn straight(
    row: &mut Row,
    kind: Kind,
    model: Model,
    (stiffness, side): (f64, f64),
    noise: f64,
    seed: u64,
    given: bool,
) -> bool {
    let curved = |strain: f64| stiffness * (300.0 * strain + 1500.0 * strain * strain);
    let noise = noise * curved(0.2) * side;
    let strains = up_to(0.2, 30);
    let mut set =
        Uniform { kind, model, side, law: &curved, strains: &strains, noise: Some((noise, seed)) }.measure();
    if !given {
        set.sequences[0].noise = None;
    }
    let linear = Settings { variant: Variant::Linear, ..settings(model) };
    let found = fit(&set, &linear).map(|(_, stage)| {
        // Linear fit of the law at the strains of the frames, weighted as forces.
        let lever = |strain: f64| match (model, kind) {
            (Model::STVK, Kind::StretchWeft) => side * (1.0 + 2.0 * strain).sqrt(),
            _ => side,
        };
        let missed = |strain: &f64| lever(*strain) * (curved(*strain) - stage.curve.curve.stress(*strain));
        let rms =
            (strains.iter().map(|strain| missed(strain).powi(2)).sum::<f64>() / strains.len() as f64).sqrt();
        (stage.scatter.misfit / rms, text::verdict(&stage, &[]).contains("beyond"), stage.scatter.known)
    });
    // Some measured components are perpendicular to the pull and carry no information.
    let holds = matches!(found, Ok((share, true, known)) if (0.5..1.5).contains(&share) && known == given);
    row.holds(holds, || {
        format!("stiffness {stiffness:e}, side {side:e}, noise {noise:e}, seed {seed}: {found:?}")
    })
}

/// Loading above unloading: no curve fits both.
fn hysteresis(row: &mut Row, kind: Kind, model: Model, (stiffness, side): (f64, f64), seed: u64) -> bool {
    let law = |strain: f64| stiffness * law(strain);
    let up = up_to(0.2, 12);
    let strains: Vec<f64> = up.iter().chain(up.iter().rev()).copied().collect();
    let noise = Some((1e-3 * law(0.2) * side, seed));
    let mut set = Uniform { kind, model, side, law: &law, strains: &strains, noise }.measure();
    for (index, frame) in set.sequences[0].frames.iter_mut().enumerate().skip(1) {
        let (phase, factor) = if index <= 12 { (Phase::Loading, 1.2) } else { (Phase::Unloading, 0.8) };
        frame.phase = Some(phase);
        frame.cords.iter_mut().for_each(|cord| cord.force *= factor);
    }
    let found = fit(&set, &settings(model)).map(|(_, stage)| {
        let ratio = stage.sequences[0].hysteresis.map(|h| h.loading / h.unloading);
        (
            stage.scatter.misfit > 10.0 * stage.scatter.noise,
            ratio,
            text::verdict(&stage, &[]).contains("hysteresis"),
        )
    });
    let holds = matches!(found, Ok((true, Some(ratio), true)) if (ratio / 1.5 - 1.0).abs() < 0.02);
    row.holds(holds, || format!("stiffness {stiffness:e}, side {side:e}, seed {seed}: {found:?}"))
}

/// Fits of a law that the curve can represent: one in a hundred may report a misfit.
fn right_law(mut row: Row, kind: Kind, model: Model, fits: u32) -> Row {
    let mut random = StdRng::seed_from_u64(40);
    let mut told = 0;
    for seed in 0..fits {
        let (stiffness, side) = scaled((random.random_range(-3.0..9.0), random.random_range(-3.0..1.0)));
        let law = |strain: f64| stiffness * law(strain);
        let noise = 10f64.powf(random.random_range(-4.0..-2.0)) * law(0.2) * side;
        let strains = up_to(0.2, 30);
        let set =
            Uniform { kind, model, side, law: &law, strains: &strains, noise: Some((noise, seed.into())) }
                .measure();
        match fit(&set, &settings(model)) {
            Ok((_, stage)) => told += u32::from(stage.scatter.misfit > 0.0),
            Err(error) => _ = row.measure(f64::NAN, || error),
        }
    }
    // With few fits, one false alarm is allowed.
    let share = f64::from(told.saturating_sub(1)) / f64::from(fits);
    row.measure(share, || format!("{told} of {fits}"));
    row.runs += u64::from(fits) - 1;
    row.survived += u64::from(fits) - 1;
    row
}
