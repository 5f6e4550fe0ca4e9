//! Cases 32, 33, 37 and 38: fits to insufficient measurements, with the truth on a bound, and from other starts.

use crate::measured::{Uniform, overhangs};
use crate::property::for_all;
use crate::support::full_set;
use crate::table::{Extent, Row};
use cloth_data::frame::{Kind, MeasurementSet};
use cloth_data::io::write_set;
use cloth_fit::incremental::{self, FitReport, Stage};
use cloth_fit::material::file::MaterialFile;
use cloth_fit::optimise::uncertainty::{Covariance, Scatter};
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::report::{CurveRow, StageReport};
use cloth_fit::stage::{Constraints, Settings, Watch};
use cloth_sim::material::{Component, Model};
use fit_cloth::text;
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use rand::{Rng, SeedableRng, rngs::StdRng};
use std::process::{Command, Stdio};

pub(crate) const TRIANGLES: [Model; 2] = [Model::STVK, Model::SOFT_CONSTRAINT];
/// Tests in uniform strain, and the models in which their forces have a closed form.
pub(crate) const UNIFORM: [(Kind, &[Model]); 2] =
    [(Kind::StretchWeft, &Model::ALL), (Kind::Shear, &TRIANGLES)];

pub(crate) fn settings(model: Model) -> Settings {
    Settings { model, nodes: Some([5, 5]), ..Settings::default() }
}

/// Fits the only curve that a set observes: stretch, shear or bending.
pub(crate) fn fit(set: &MeasurementSet, settings: &Settings) -> Result<(FitReport, StageReport), String> {
    let known = Knowledge::default();
    let report = incremental::fit(set, &Stage::ALL, &known, settings, &mut Watch::default());
    let report = report.map_err(|error| error.to_string())?;
    let kind = set.sequences[0].kind;
    let component = match kind {
        Kind::StretchWeft => Component::StretchWeft,
        Kind::StretchWarp => Component::StretchWarp,
        Kind::Shear => Component::Shear,
        _ => Component::BendWeft,
    };
    let stage = report.stage(component).cloned().ok_or_else(|| format!("no stage over {component}"))?;
    Ok((report, stage))
}

/// Evenly spaced strains up to the largest, excluding zero.
pub(crate) fn up_to(largest: f64, count: usize) -> Vec<f64> {
    (1..=count).map(|i| largest * i as f64 / count as f64).collect()
}

/// The sample of a curve nearest to a strain.
pub(crate) fn at(stage: &StageReport, strain: f64) -> &CurveRow {
    let off = |sample: &&CurveRow| (sample.strain - strain).abs();
    stage.curve.samples.iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap()
}

/// Powers of ten of stiffness and size: 1e-3 … 1e9 times normal, 1 mm … 10 m.
pub(crate) fn scales() -> impl Strategy<Value = (f64, f64)> {
    (-3.0..9.0, -3.0..1.0)
}

/// Stiffness multiple and size in metres from these exponents.
pub(crate) fn scaled((stiffness, size): (f64, f64)) -> (f64, f64) {
    (10f64.powf(stiffness), 10f64.powf(size))
}

// 32 ---------------------------------------------------------------------------------------------------------------

pub(crate) fn case_32(extent: Extent) -> Vec<Row> {
    let mut rows: Vec<Row> = Model::ALL.map(|model| unseen_curves(model, extent)).into();
    for (kind, models) in UNIFORM {
        for &model in models {
            let row =
                Row::new(32, format!("a range without a frame, {kind}, {model}: no point there is made up"));
            rows.push(for_all(row, extent.runs(5, 300), (scales(), any::<u64>()), |row, (scales, seed)| {
                unseen_range(row, kind, model, scaled(scales), seed)
            }));
        }
    }
    let row = Row::new(32, "points that no row of a Jacobian sees: rank, named, no deviation, no band");
    rows.push(for_all(row, extent.runs(100, 20_000), any::<u64>(), unseen_points));
    rows
}

/// Sequences removed at random: the program exits with 0 and names every unobserved curve.
fn unseen_curves(model: Model, extent: Extent) -> Row {
    let row = Row::new(
        32,
        format!("whole curves that no sequence shows, {model}: exit 0, a warning, no curve, no file"),
    );
    for_all(row, extent.runs(2, 20), 1usize..31, |row, kept| {
        let folder = tempfile::tempdir().unwrap();
        let mut set = full_set();
        let kinds = [Kind::StretchWeft, Kind::StretchWarp, Kind::Shear, Kind::BendWeft, Kind::BendWarp];
        set.sequences.retain(|sequence| {
            kinds.iter().position(|kind| *kind == sequence.kind).is_some_and(|i| kept >> i & 1 == 1)
        });
        write_set(&folder.path().join("set"), &set).unwrap();
        let name = model.to_string();
        let arguments =
            ["fit", "set", "--nodes", "9x9", "--variant", "linear", "--model", &name, "--out", "out"];
        let mut command = Command::new(env!("CARGO_BIN_EXE_fit-cloth"));
        let output =
            command.args(arguments).current_dir(folder.path()).stdin(Stdio::null()).output().unwrap();
        let warnings = String::from_utf8_lossy(&output.stderr).into_owned();
        let told = String::from_utf8_lossy(&output.stdout).into_owned();
        let shown = |component: Component| {
            set.sequences.iter().any(|sequence| sequence.kind.shows().contains(&component))
        };
        let Ok(material) = MaterialFile::read(&folder.path().join("out/material.json")) else {
            return row.holds(false, || format!("{kept:05b}: {:?} {warnings}", output.status.code()));
        };
        let complaint = Model::STVK.components().into_iter().find(|&component| {
            let entry = &material.curves[&component];
            let file = folder.path().join(format!("out/curves/{component}.csv")).exists();
            // A sheet bent along weft only is a sequence that does not determine the diagonal.
            let named = |text: &str| {
                let line = text.lines().find(|line| line.contains(&format!("{component} is not observed")));
                line.is_some_and(|line| {
                    line.contains("by any sequence")
                        || shown(component) && line.contains("do not determine its scale")
                })
            };
            let honest = match entry.observed {
                true => shown(component) && file && !entry.control_points.is_empty(),
                false => named(&warnings) && named(&told) && !file && entry.control_points.is_empty(),
            };
            !honest
        });
        let holds = output.status.code() == Some(0) && complaint.is_none();
        row.holds(holds, || format!("{kept:05b}: {:?} {complaint:?} {warnings}", output.status.code()))
    })
}

/// Frames at the ends of the range only: between them the band is wider.
fn unseen_range(row: &mut Row, kind: Kind, model: Model, (stiffness, side): (f64, f64), seed: u64) -> bool {
    let law = |strain: f64| stiffness * (300.0 * strain + 4000.0 * strain * strain);
    let strains = [up_to(0.01, 6), up_to(0.01, 6).iter().map(|strain| 0.19 + strain).collect()].concat();
    let noise = Some((1e-3 * law(0.2) * side, seed));
    let set = Uniform { kind, model, side, law: &law, strains: &strains, noise }.measure();
    let most = Settings { points: 9, ..settings(model) };
    let (_, stage) = match fit(&set, &most) {
        Ok(found) => found,
        Err(error) => return row.holds(false, || error),
    };
    let curve = &stage.curve;
    let width = |strain: f64| at(&stage, strain).band.map_or(f64::NAN, |[low, high]| high - low);
    let seen = curve.rank > 0 && curve.unseen.is_empty();
    // The band of a constant stiffness depends on strain only.
    let wide = curve.curve.len() < 3 || width(0.1) > width(0.195);
    row.holds(stage.converged && curve.observed && seen && wide, || {
        format!(
            "stiffness {stiffness:e}, side {side:e}, seed {seed}: rank {} of {}, widths {:e} and {:e}, {:?}",
            curve.rank,
            curve.curve.len(),
            width(0.1),
            width(0.195),
            stage.levels.last().map(|level| &level.status)
        )
    })
}

/// A random Jacobian with zero columns.
fn unseen_points(row: &mut Row, seed: u64) -> bool {
    let mut random = StdRng::seed_from_u64(seed);
    let n = random.random_range(2..8);
    let hidden: Vec<bool> = (0..n).map(|_| random.random_bool(0.4)).collect();
    let seen = hidden.iter().filter(|hidden| !**hidden).count();
    let unit = 10f64.powf(random.random_range(-9.0..9.0));
    let jacobian = DMatrix::from_fn(3 * n, n, |_, j| match hidden[j] {
        true => 0.0,
        false => unit * random.random_range(-1.0..1.0),
    });
    let freedom = 3 * n - seen;
    let scatter = Scatter {
        noise: 1.0,
        known: true,
        residual: 1.0,
        misfit: 0.0,
        measurements: 3 * n,
        freedom,
        expected: 1.0,
        contradicted: None,
    };
    let covariance = Covariance::new(&jacobian, &scatter);
    let deviations = covariance.standard_deviations();
    // Covariance of the observed unknowns: (JᵀJ)⁻¹.
    let columns: Vec<_> = (0..n).filter(|&j| !hidden[j]).map(|j| jacobian.column(j).into_owned()).collect();
    let reduced = (!columns.is_empty()).then(|| DMatrix::from_columns(&columns));
    let inverse = reduced.and_then(|reduced| reduced.tr_mul(&reduced).try_inverse());
    let mut place = 0;
    let honest = (0..n).all(|j| {
        let mut alone = DVector::zeros(n);
        alone[j] = 1.0;
        let band = covariance.half_band(&alone);
        if hidden[j] {
            return deviations[j].is_none() && band.is_none();
        }
        let exact = inverse.as_ref().map_or(f64::NAN, |inverse| inverse[(place, place)].sqrt());
        place += 1;
        band.is_some() && deviations[j].is_some_and(|found| (found / exact - 1.0).abs() < 1e-6)
    });
    row.holds(honest && covariance.rank == seen, || {
        format!("seed {seed}: rank {} of {seen}, {deviations:?}", covariance.rank)
    })
}

// 33 ---------------------------------------------------------------------------------------------------------------

pub(crate) fn case_33(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for (what, copies) in [("one frame", 1), ("eight identical frames", 8)] {
        for (kind, models) in UNIFORM {
            for &model in models {
                let name = format!("{what}, {kind}, {model}: one stiffness, the exact one");
                let row = Row::measured(33, name, "relative error", 1e-6);
                let inputs = (scales(), 0.005..0.3);
                rows.push(for_all(row, extent.runs(8, 1_000), inputs, |row, (scales, strain): (_, f64)| {
                    let (stiffness, side) = scaled(scales);
                    let law = |strain: f64| 500.0 * stiffness * strain;
                    let set =
                        Uniform { kind, model, side, law: &law, strains: &vec![strain; copies], noise: None };
                    let found = fit(&set.measure(), &settings(model)).and_then(|(_, stage)| {
                        let one = stage.converged && stage.curve.observed && stage.curve.rank == 1;
                        let finite = stage.curve.samples.iter().all(|sample| sample.stress.is_finite());
                        let k = stage.curve.curve.stiffnesses();
                        let error = (k[0] / (500.0 * stiffness) - 1.0).abs();
                        if one && finite && k.len() == 1 {
                            Ok(error)
                        } else {
                            Err(format!("{:?}", stage.levels))
                        }
                    });
                    row.measure(found.clone().unwrap_or(f64::NAN), || {
                        format!("stiffness {stiffness:e}, side {side:e}, strain {strain}: {found:?}")
                    })
                }));
            }
        }
        for model in TRIANGLES {
            // A cantilever on a coarse grid differs from the elastica.
            let row = Row::measured(
                33,
                format!("{what}, bend-weft, {model}: the rigidity where it was bent"),
                "relative error",
                0.05,
            );
            rows.push(for_all(row, extent.runs(2, 100), (-2.0..1.0, -1.0..1.0), |row, (stiffness, size)| {
                let (stiffness, size) = scaled((stiffness, size));
                let mut set = overhangs(size, stiffness);
                let frame = set.sequences[0].frames[2].clone();
                set.sequences[0].frames = vec![frame; copies];
                let found =
                    fit(&set, &Settings { nodes: Some([9, 9]), ..settings(model) }).map(|(_, stage)| {
                        let rigidity = crate::support::RIGIDITY[0] * stiffness * size.powi(3);
                        let end = stage.curve.samples.last().unwrap();
                        if stage.curve.observed && stage.converged {
                            (end.stiffness / rigidity - 1.0).abs()
                        } else {
                            f64::NAN
                        }
                    });
                row.measure(found.clone().unwrap_or(f64::NAN), || {
                    format!("stiffness {stiffness:e}, size {size:e}: {found:?}")
                })
            }));
        }
    }
    rows
}

// 37 ---------------------------------------------------------------------------------------------------------------

pub(crate) fn case_37(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for (kind, models) in UNIFORM {
        for &model in models {
            for (constraints, name) in [
                (Constraints::Stable, "constraints stable: a band from 0 up, active rows told"),
                // Between non-negative control points a curve may fall, and then no frame has a stable equilibrium.
                (
                    Constraints::ControlPoints,
                    "constraints control points: no band below 0; where not converged, said so",
                ),
            ] {
                let row = Row::new(37, format!("no stress up to a strain, {kind}, {model}, {name}"));
                // Runs that do not converge are slow.
                let most = if constraints == Constraints::Stable { 300 } else { 30 };
                let runs = extent.runs(3, most);
                let inputs = (scales(), -3.0..-1.5, any::<u64>());
                rows.push(for_all(row, runs, inputs, |row, (scales, noise, seed)| {
                    on_a_bound(row, kind, model, constraints, scaled(scales), 10f64.powf(noise), seed)
                }));
            }
        }
    }
    rows
}

/// Crimp: no force up to half of the range.
fn on_a_bound(
    row: &mut Row,
    kind: Kind,
    model: Model,
    constraints: Constraints,
    (stiffness, side): (f64, f64),
    noise: f64,
    seed: u64,
) -> bool {
    let law = |strain: f64| 1e4 * stiffness * (strain - 0.1).max(0.0).powi(2);
    let noise = Some((noise * law(0.2) * side, seed));
    let set = Uniform { kind, model, side, law: &law, strains: &up_to(0.2, 24), noise }.measure();
    let found = fit(&set, &Settings { constraints, points: 9, ..settings(model) });
    let found = found.map(|(report, stage)| {
        // Zero strain is known exactly.
        let slack = stage.curve.samples.iter().filter(|sample| sample.strain > 0.0 && sample.strain <= 0.05);
        let bands: Vec<[f64; 2]> = slack.map(|sample| sample.band.unwrap_or([f64::NAN; 2])).collect();
        let lowest = bands.iter().map(|band| band[0]).fold(f64::INFINITY, |a, b| if b >= a { a } else { b });
        let from_zero = bands.iter().all(|[low, high]| *low == 0.0 && *high > 0.0);
        let active = stage.curve.active_constraints;
        let holds = match constraints {
            Constraints::Stable => report.converged() && from_zero && active > 0,
            Constraints::ControlPoints => {
                let said = report.converged() || text::verdict(&stage, &[]).contains("NOT converged");
                said && lowest >= 0.0
            }
        };
        (holds, report.converged(), active, bands)
    });
    let holds = matches!(found, Ok((true, ..)));
    row.holds(holds, || format!("stiffness {stiffness:e}, side {side:e}, noise {noise:?}: {found:?}"))
}

// 38 ---------------------------------------------------------------------------------------------------------------

pub(crate) fn case_38(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    let starts = extent.runs(4, 20);
    for stiffness in [1e-3, 1.0, 1e9] {
        for (kind, models) in UNIFORM {
            for &model in models {
                let law = |strain: f64| 8.0 * stiffness * (10.0 * strain).exp_m1();
                let noise = Some((1e-3 * law(0.25) * 0.1, 5));
                let set =
                    Uniform { kind, model, side: 0.1, law: &law, strains: &up_to(0.25, 20), noise }.measure();
                let name = format!("{kind}, {model}, stiffness times {stiffness:.0e}");
                rows.push(starts_row(&name, &set, &settings(model), starts));
            }
        }
    }
    for stiffness in [0.1, 1.0, 10.0] {
        for model in TRIANGLES {
            let set = overhangs(1.0, stiffness);
            let name = format!("bend-weft, {model}, stiffness and density times {stiffness:.0e}");
            rows.push(starts_row(
                &name,
                &set,
                &Settings { nodes: Some([9, 9]), points: 3, ..settings(model) },
                starts,
            ));
        }
    }
    rows
}

/// Fits from starts over three decades, against the fit from the default start.
fn starts_row(name: &str, set: &MeasurementSet, settings: &Settings, starts: u32) -> Row {
    let mut row =
        Row::measured(38, format!("starts over three decades, {name}: one optimum"), "relative spread", 1e-3);
    let reference = match fit(set, settings) {
        Ok((_, stage)) if stage.converged => stage,
        other => {
            row.measure(f64::NAN, || format!("its own start: {:?}", other.map(|(_, stage)| stage.levels)));
            return row;
        }
    };
    let of = |stage: &StageReport| stage.curve.curve.stiffnesses().to_vec();
    let largest = of(&reference).iter().fold(0.0f64, |largest, k| largest.max(k.abs()));
    for start in 0..starts {
        let start_factor = 10f64.powf(-1.5 + 3.0 * f64::from(start) / f64::from(starts - 1));
        let found = fit(set, &Settings { start_factor, ..settings.clone() });
        let off = found.as_ref().map_or(f64::NAN, |(_, stage)| {
            let alike = stage.converged && stage.curve.curve.len() == reference.curve.curve.len();
            let apart = of(stage).iter().zip(of(&reference)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            if alike { apart / largest } else { f64::NAN }
        });
        row.iterations = row.iterations.max(found.as_ref().map_or(0, |(_, stage)| {
            stage.levels.iter().map(|level| level.iterations.len()).max().unwrap_or(0)
        }));
        row.measure(off, || {
            let minimum = |stage: &StageReport| {
                (of(stage), stage.levels.iter().map(|level| (level.points, level.rms)).collect::<Vec<_>>())
            };
            format!(
                "start times {start_factor}: {:?} beside {:?}",
                found.map(|(_, stage)| minimum(&stage)),
                minimum(&reference)
            )
        });
    }
    row
}
