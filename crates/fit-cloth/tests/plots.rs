//! Figures of fits and validations of two fixtures: every series is present, axes have units, all coordinates are
//! numbers, and no text leaves the figure or overlaps another.

#![allow(clippy::unwrap_used)]

mod figure;

use figure::Figure;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

const FABRICS: [&str; 2] = ["cotton-denim", "rayon-spandex-knit"];
const MODEL: &str = "#0072B2";
const MEASURED: &str = "#D55E00";
const CURVES: [&str; 6] =
    ["stretch-weft", "stretch-warp", "shear", "bend-weft", "bend-warp", "bend-diagonal"];
const SEQUENCES: [&str; 6] = ["stretch-weft", "stretch-warp", "shear", "bend-weft", "bend-warp", "bend-bias"];
const VALIDATED: [&str; 2] = ["complex-shear", "corner-pull"];
/// Nodes of a fixture's grid, and faces of its picture.
const NODES: usize = 25 * 25;
const FACES: usize = 2 * 24 * 24;

/// Results of a fabric.
struct Fitted {
    fit: PathBuf,
    validation: PathBuf,
    material: Value,
    _folder: tempfile::TempDir,
}

impl Fitted {
    fn new(fabric: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let [fit, validation] = ["fit", "validation"].map(|name| folder.path().join(name));
        let set = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(fabric);
        let run = |command: &mut Command| assert!(command.arg("--quiet").status().unwrap().success());
        let program = || Command::new(env!("CARGO_BIN_EXE_fit-cloth"));
        run(program().arg("fit").arg(&set).arg("--out").arg(&fit));
        let material = fit.join("material.json");
        run(program()
            .arg("validate")
            .arg(&set)
            .arg("--material")
            .arg(&material)
            .arg("--out")
            .arg(&validation));
        let material = serde_json::from_str(&fs::read_to_string(material).unwrap()).unwrap();
        Self { fit, validation, material, _folder: folder }
    }

    fn plot(&self, name: &str) -> Figure {
        Figure::read(&self.fit.join(format!("plots/{name}.svg")))
    }

    fn validated(&self, name: &str) -> Figure {
        Figure::read(&self.validation.join(format!("plots/{name}.svg")))
    }

    /// Number of control points of a curve.
    fn points(&self, curve: &str) -> usize {
        self.material["curves"][curve]["control_points"].as_array().unwrap().len()
    }

    /// Residuals of a sequence.
    fn residual(&self, sequence: &str) -> &Value {
        let rows = self.material["residuals"].as_array().unwrap();
        rows.iter().find(|row| row["sequence"] == sequence).unwrap()
    }

    /// Number of frames used of a sequence.
    fn frames(&self, sequence: &str) -> usize {
        self.residual(sequence)["frames"].as_u64().unwrap() as usize
    }
}

/// The fits, made once.
fn fitted() -> &'static [Fitted; 2] {
    static FITTED: OnceLock<[Fitted; 2]> = OnceLock::new();
    FITTED.get_or_init(|| FABRICS.map(Fitted::new))
}

fn figures(folder: &Path) -> Vec<Figure> {
    fs::read_dir(folder.join("plots")).unwrap().map(|entry| Figure::read(&entry.unwrap().path())).collect()
}

fn names(folder: &Path) -> BTreeSet<String> {
    figures(folder).into_iter().map(|figure| figure.name).collect()
}

#[test]
fn no_figure_is_missing_and_none_is_large() {
    let mut wanted: BTreeSet<String> =
        ["convergence", "correlation", "residuals"].into_iter().map(String::from).collect();
    for curve in CURVES {
        wanted.insert(format!("{curve}-{}", if curve.starts_with("bend") { "moment" } else { "stress" }));
    }
    for sequence in SEQUENCES {
        let answer = if sequence.starts_with("bend") { "profiles" } else { "force" };
        wanted.extend([answer, "shape", "residual"].map(|what| format!("{sequence}-{what}")));
    }
    let of_validation: BTreeSet<String> = VALIDATED
        .iter()
        .flat_map(|name| ["force", "measure", "shape", "residual"].map(|what| format!("{name}-{what}")))
        .collect();
    for fitted in fitted() {
        assert_eq!(names(&fitted.fit), wanted);
        assert_eq!(names(&fitted.validation), of_validation);
        for figure in figures(&fitted.fit).iter().chain(&figures(&fitted.validation)) {
            assert!(figure.svg.len() < 300_000, "{}: {} bytes", figure.name, figure.svg.len());
        }
    }
}

#[test]
fn every_number_is_one_and_no_text_lies_over_another_or_outside() {
    let of = |fitted: &Fitted| [figures(&fitted.fit), figures(&fitted.validation)];
    let faults: Vec<String> =
        fitted().iter().flat_map(of).flatten().flat_map(|figure| figure.faults()).collect();
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn curves_have_band_points_and_the_strains_beneath() {
    for fitted in fitted() {
        for curve in CURVES {
            let (figure, axes) = match curve.starts_with("bend") {
                true => (
                    format!("{curve}-moment"),
                    ["curvature [1/m]", "moment per width [mN]", "curvatures of all frames"],
                ),
                false => {
                    let [x, y] = match curve {
                        "shear" => ["shear strain [–]", "shear stress [N/m]"],
                        _ => ["Green strain [–]", "PK2 stress [N/m]"],
                    };
                    (format!("{curve}-stress"), [x, y, "strains of all frames"])
                }
            };
            let figure = fitted.plot(&figure);
            let common = ["share of the sheet [%]", "95 % band", "fit", "control points"];
            assert_eq!(figure.missing(&[&axes[..], &common].concat()), [""; 0]);
            // One more dot and line for the legend; the band is one polygon.
            let points = figure.count("circle", &[("fill", MODEL), ("r", "8")]);
            assert_eq!(points, fitted.points(curve) + 1, "{curve}");
            assert_eq!(figure.count("polyline", &[("stroke", MODEL), ("stroke-width", "4")]), 2, "{curve}");
            assert_eq!(figure.count("polygon", &[("fill", MODEL)]), 1, "{curve}");
            let bars = figure.count("polygon", &[("fill", "#009E73")]);
            assert!((6..=40).contains(&bars), "{curve}: {bars}");
        }
        // Shear fits extend beyond the visited range.
        let shear = fitted.plot("shear-stress");
        assert_eq!(shear.missing(&["not visited", "fit, extrapolated"]), [""; 0]);
        assert_eq!(shear.count("polygon", &[("fill", "#6E6E6E")]), 2);
    }
}

#[test]
fn forces_are_a_loop_over_the_model() {
    let series = ["clip force [N]", "model", "measured, loading", "measured, unloading"];
    let check = |figure: Figure, x: &str, frames: usize| {
        assert_eq!(figure.missing(&[&[x], &series[..]].concat()), [""; 0]);
        let filled = figure.count("circle", &[("fill", MEASURED), ("r", "6")]);
        let open = figure.count("circle", &[("stroke", MEASURED), ("r", "6")]);
        assert!(filled > 3 && open > 3, "{}", figure.name);
        assert_eq!(filled + open, frames + 2, "{}", figure.name);
        let lines = |colour: &str, width: &str| {
            figure.count("polyline", &[("stroke", colour), ("stroke-width", width)])
        };
        // The model's line has a sample in the legend.
        assert_eq!(lines(MODEL, "8"), lines(MEASURED, "2") + 1, "{}", figure.name);
        assert!(lines(MEASURED, "2") > 0, "{}", figure.name);
    };
    for fitted in fitted() {
        for (kind, x) in [
            ("stretch-weft", "extension [–]"),
            ("stretch-warp", "extension [–]"),
            ("shear", "effective shear angle [rad]"),
        ] {
            check(fitted.plot(&format!("{kind}-force")), x, fitted.frames(kind));
        }
        for (kind, x) in [("complex-shear", "effective shear angle [rad]"), ("corner-pull", "extension [–]")]
        {
            let table = fs::read_to_string(fitted.validation.join("validation.csv")).unwrap();
            let row = table.lines().find(|line| line.starts_with(kind)).unwrap();
            let frames = row.split(',').nth(2).unwrap().parse().unwrap();
            check(fitted.validated(&format!("{kind}-force")), x, frames);
            let measure = fitted.validated(&format!("{kind}-measure"));
            let y = if kind == "corner-pull" {
                "stretching-force difference [N]"
            } else {
                "aggregated torque [N m]"
            };
            assert_eq!(measure.missing(&[x, y, "model", "measured"]), [""; 0]);
            let dots = ["fill", "stroke"].map(|key| measure.count("circle", &[(key, MEASURED), ("r", "6")]));
            let several = measure.missing(&["measured, several equilibria"]).is_empty();
            assert_eq!(dots[0] + dots[1], frames + 1 + usize::from(several), "{kind}");
        }
    }
}

#[test]
fn every_frame_off_a_table_has_both_profiles() {
    for fitted in fitted() {
        for sequence in ["bend-weft", "bend-warp", "bend-bias"] {
            let figure = fitted.plot(&format!("{sequence}-profiles"));
            let texts = ["beyond the edge [mm]", "above the table [mm]", "table", "model", "measured"];
            assert_eq!(figure.missing(&texts), [""; 0]);
            for (colour, width) in [(MODEL, "8"), (MEASURED, "2")] {
                let lines = figure.count("polyline", &[("stroke", colour), ("stroke-width", width)]);
                assert_eq!(lines, fitted.frames(sequence) + 1, "{sequence}");
            }
        }
    }
}

#[test]
fn shapes_stand_beside_equilibria_with_the_forces_on_their_clips() {
    let check = |figure: Figure, clips: usize| {
        assert_eq!(figure.missing(&["captured"]), [""; 0]);
        // Followed by "one of several", where a sheet buckles either way.
        assert!(figure.texts().iter().any(|text| text.content.starts_with("equilibrium")), "{}", figure.name);
        assert!(figure.texts().iter().any(|text| text.content.contains(", stvk: frame ")), "{}", figure.name);
        let tables = if clips == 0 { 2 } else { 0 };
        assert_eq!(figure.count("polygon", &[]), 2 * FACES + tables, "{}", figure.name);
        for colour in [MEASURED, MODEL] {
            let arrows = figure.count("polyline", &[("stroke", colour), ("stroke-width", "5")]);
            let dots = figure.count("circle", &[("fill", colour)]);
            assert_eq!(arrows + dots, clips, "{}", figure.name);
        }
        let scales =
            figure.texts().iter().filter(|text| text.content.starts_with("force on a clip: ")).count();
        assert_eq!(scales, usize::from(clips > 0), "{}", figure.name);
        assert!(figure.texts().iter().any(|text| text.content.ends_with(" mm")), "{}", figure.name);
    };
    for fitted in fitted() {
        for (sequence, clips) in SEQUENCES.into_iter().zip([2, 2, 4, 0, 0, 0]) {
            check(fitted.plot(&format!("{sequence}-shape")), clips);
        }
        for (sequence, clips) in VALIDATED.into_iter().zip([2, 4]) {
            check(fitted.validated(&format!("{sequence}-shape")), clips);
        }
    }
}

#[test]
fn residuals_stand_at_every_node_five_times_as_long() {
    let check = |figure: Figure| {
        let texts = figure.texts();
        let told = |part: &str| texts.iter().any(|text| text.content.contains(part));
        assert!(told("measured − simulated ×5, rms ") && told(" mm") && told(": frame "), "{texts:?}");
        assert!(told("residual: "), "{texts:?}");
        let arrows = figure.count("polyline", &[("stroke", MEASURED), ("stroke-width", "2")]);
        let dots = figure.count("circle", &[("fill", MEASURED)]);
        // One more for the scale.
        assert_eq!(arrows + dots, NODES + 1, "{}", figure.name);
        // The scale of residuals is five times as long as the other.
        let millimetres = |text: &str| -> f64 { text.split(' ').rev().nth(1).unwrap().parse().unwrap() };
        let named = |wanted: &dyn Fn(&str) -> bool| {
            millimetres(&texts.iter().find(|text| wanted(&text.content)).unwrap().content)
        };
        let of_residuals = named(&|text| text.starts_with("residual: "));
        let of_lengths = named(&|text| text.split(' ').count() == 2 && text.ends_with(" mm"));
        let length = |[from, to]: [f64; 2]| to - from;
        let bar = length(figure.spans("#282828", "3")[0]) / of_lengths;
        let arrow = length(*figure.spans(MEASURED, "2").last().unwrap()) / of_residuals;
        assert!((arrow / bar - 5.0).abs() < 0.1, "{}: {arrow} {bar}", figure.name);
    };
    for fitted in fitted() {
        SEQUENCES.into_iter().for_each(|sequence| check(fitted.plot(&format!("{sequence}-residual"))));
        VALIDATED.into_iter().for_each(|sequence| check(fitted.validated(&format!("{sequence}-residual"))));
    }
}

#[test]
fn every_curve_has_its_course() {
    for fitted in fitted() {
        let figure = fitted.plot("convergence");
        assert_eq!(figure.missing(&["step tried", "rms residual over its last [–]"]), [""; 0]);
        assert_eq!(figure.missing(&CURVES), [""; 0]);
        for colour in ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"] {
            assert_eq!(figure.count("polyline", &[("stroke", colour)]), 1, "{colour}");
            assert!(figure.count("circle", &[("fill", colour)]) > 2, "{colour}");
        }
    }
}

#[test]
fn the_table_has_the_numbers_of_the_file() {
    for fitted in fitted() {
        let figure = fitted.plot("residuals");
        let heads = ["sequence", "frames", "rms force", "[N]", "[% of largest]", "rms position", "[mm]"];
        assert_eq!(figure.missing(&heads), [""; 0]);
        let mut bars = 0;
        for sequence in SEQUENCES {
            let row = fitted.residual(sequence);
            let position = 1e3 * row["rms_position_m"].as_f64().unwrap();
            let mut cells = vec![sequence.to_string(), row["frames"].to_string(), format!("{position:.3}")];
            if let Some(force) = row["rms_force_n"].as_f64() {
                let share = 100.0 * force / row["largest_force_n"].as_f64().unwrap();
                cells.extend([format!("{force:.4}"), format!("{share:.2}")]);
                bars += 1;
            }
            let cells: Vec<&str> = cells.iter().map(String::as_str).collect();
            assert_eq!(figure.missing(&cells), [""; 0]);
            bars += 1;
        }
        assert_eq!(figure.count("rect", &[("fill", MODEL)]), bars);
    }
}

#[test]
fn every_pair_of_control_points_has_its_correlation() {
    for fitted in fitted() {
        let figure = fitted.plot("correlation");
        assert_eq!(figure.missing(&CURVES), [""; 0]);
        assert_eq!(figure.missing(&["−1", "0", "1", "not seen by the data"]), [""; 0]);
        let points = CURVES.map(|curve| fitted.points(curve));
        let pairs: usize = points.iter().map(|points| points * points).sum();
        let texts = figure.texts();
        let cells = texts.iter().filter(|text| text.content.contains('.') || text.content == "–").count();
        assert_eq!(cells, pairs);
        let alone = texts.iter().filter(|text| text.content == "1.00").count();
        assert!(
            alone >= points.iter().sum::<usize>() - texts.iter().filter(|text| text.content == "–").count()
        );
        // A face and a border for each pair.
        assert_eq!(figure.count("rect", &[("stroke", "#FFFFFF")]), pairs);
    }
}

/// The tests above detect faults planted in a sound figure.
#[test]
fn faults_are_seen() {
    let whole = fitted()[0].plot("shear-force");
    assert_eq!(whole.faults(), [""; 0]);
    let changed = |from: &str, to: &str| {
        assert!(whole.svg.contains(from), "{from}");
        Figure { name: whole.name.clone(), svg: whole.svg.replacen(from, to, 1) }
    };
    let longer = "effective shear angle [rad]".repeat(6);
    for (from, to, fault) in [
        ("cx=\"", "cx=\"NaN", "is no number"),
        ("cy=\"", "cy=\"inf", "is no number"),
        ("cy=\"", "cy=\"9", "outside"),
        ("effective shear angle [rad]", &longer[..], "leaves the figure"),
        ("effective shear angle [rad]", "NaN", "NaN"),
        ("model", "model and much more of it", "over"),
        ("</svg>", "", "shear-force"),
    ] {
        let faults = changed(from, to).faults();
        assert!(faults.iter().any(|found| found.contains(fault)), "{from} {to}: {faults:?}");
    }
    assert_eq!(changed("clip force [N]", "clip force").missing(&["clip force [N]"]).len(), 1);
}
