//! `fit-cloth simulate` on tiny scenes, run as a user does.

#![allow(clippy::unwrap_used)]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// A strip four cells high, 1 m long, held along its top.
const SCENE: &str = "\
name = \"strip\"
gravity_m_s2 = [0.0, 0.0, -10.0]
duration_s = 0.4
step_s = 0.01
frames_per_s = 10
measure = \"droop\"
[sheet]
grid = { width_m = 0.25, height_m = 1.0, nodes = [2, 5] }
warp = [0.0, 0.0, 1.0]
[[held]]
edge = \"top\"
[damping]
stiffness_s = 0.05
";

const CLOTH: &str = "\
name = \"cloth\"
areal_density_kg_m2 = 0.2
model = \"soft-constraint\"
[curves]
stretch-weft = { stiffness_n_per_m = 100.0 }
stretch-warp = { stiffness_n_per_m = 100.0 }
shear = { stiffness_n_per_m = 10.0 }
";

/// A folder with `scene.toml` and `cloth.toml`.
fn folder(scene: &str, cloth: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), scene).unwrap();
    fs::write(folder.path().join("cloth.toml"), cloth).unwrap();
    folder
}

fn simulate(folder: &Path, more: &[&str]) -> Output {
    let arguments = [&["simulate", "scene.toml", "--material", "cloth.toml", "--out", "out"], more].concat();
    Command::new(env!("CARGO_BIN_EXE_fit-cloth")).args(arguments).current_dir(folder).output().unwrap()
}

fn said(output: &Output) -> [String; 2] {
    [&output.stdout, &output.stderr].map(|bytes| String::from_utf8(bytes.clone()).unwrap())
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{:?}", said(output)))
}

#[test]
fn a_strip_sinks_in_time_and_every_file_is_there() {
    let folder = folder(SCENE, CLOTH);
    let output = simulate(folder.path(), &[]);
    let [words, errors] = said(&output);
    assert!(output.status.success(), "{errors}");
    assert!(words.contains("Converged") && words.trim_end().ends_with("Written to out"), "{words}");
    let out = folder.path().join("out");
    let frames = fs::read_dir(out.join("frames")).unwrap().count();
    assert_eq!(frames, 1 + 4);
    let table = fs::read_to_string(out.join("energies.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 1 + 40);
    let columns = "time_s,kinetic_j,elastic_j,weight_j,damping_j,wind_j,total_j,numerical_j,newton_iterations,linear_iterations,imbalance_n";
    assert_eq!(table.lines().next().unwrap(), columns);
    // Energy left, dissipated by damping and lost by the integrator add up to the initial energy.
    let row = |line: &str| line.split(',').map(|cell| cell.parse::<f64>().unwrap()).collect::<Vec<_>>();
    let [start, end] = [table.lines().nth(1).unwrap(), table.lines().last().unwrap()].map(row);
    assert!(
        (start[6] - end[6] - end[4] + end[5] - end[7]).abs() < 1e-9 * start[6].abs(),
        "{start:?} {end:?}"
    );
    assert!(end[1] >= 0.0 && end[3] < start[3] && end[4] > 0.0, "{end:?}");
    assert!(fs::read_to_string(out.join("plots/shapes.svg")).unwrap().contains("<polygon"));
    assert!(out.join("mesh.obj").exists());
    // A second run replaces the first and leaves only its own files.
    let output = simulate(folder.path(), &["--format", "npy", "--duration", "0.1", "--json"]);
    assert_eq!(json(&output)["motion"]["steps"], 10);
    assert!(out.join("positions.npy").exists() && !out.join("frames").exists());
}

#[test]
fn at_rest_it_is_as_long_as_its_weight_makes_it() {
    let folder = folder(SCENE, CLOTH);
    let output = simulate(folder.path(), &["--rest", "--json"]);
    let json = json(&output);
    assert!(output.status.success() && json["converged"] == true && json["rest"]["stable"] == true, "{json}");
    // Lumped masses, half a cell's weight at the end: the sink is ρ g L²/2k, as for a continuum.
    let sink = json["droop"]["bottom_edge_sinks_m"].as_f64().unwrap();
    assert!((sink / (0.2 * 10.0 / (2.0 * 100.0)) - 1.0).abs() < 0.02, "{json}");
    let force = json["hold_forces_n"][0][2].as_f64().unwrap();
    assert!((force - 0.2 * 0.25 * 10.0).abs() < 1e-6, "{json}");
    let out = folder.path().join("out");
    assert_eq!(fs::read_dir(out.join("frames")).unwrap().count(), 2);
    assert!(!out.join("energies.csv").exists());
    let output = simulate(folder.path(), &["--rest", "--format", "ply", "--compression", "none", "--json"]);
    assert_eq!(self::json(&output)["compression"], "none");
    assert!(fs::read_to_string(out.join("frames/0001.ply")).unwrap().starts_with("ply\n"));
}

#[test]
fn what_is_left_out_is_not_there_and_what_may_move_moves() {
    // Free along weft only: the top keeps its height and may contract.
    let guided =
        SCENE.replace("edge = \"top\"", "edge = \"top\"\nfree = \"line\"\ndirection = [1.0, 0.0, 0.0]");
    let fewer = format!("components = [\"stretch-warp\", \"shear\"]\n{guided}");
    let folder = folder(&fewer, CLOTH);
    let output = simulate(folder.path(), &["--json", "--duration", "0.02"]);
    let [_, errors] = said(&output);
    // Without held nodes, droop cannot be measured.
    assert_eq!(output.status.code(), Some(3), "{errors}");
    fs::write(folder.path().join("scene.toml"), fewer.replace("measure = \"droop\"\n", "")).unwrap();
    let json = json(&simulate(folder.path(), &["--json", "--duration", "0.02"]));
    assert_eq!(json["components"], serde_json::json!(["stretch-warp", "shear"]));
    let last = fs::read_to_string(folder.path().join("out/frames/0001.obj")).unwrap();
    let heights: Vec<f64> = last
        .lines()
        .filter_map(|line| line.strip_prefix("v "))
        .map(|line| line.split(' ').nth(2).unwrap().parse().unwrap())
        .collect();
    assert!(heights[8] == 1.0 && heights[9] == 1.0 && heights[0] < 0.0, "{heights:?}");
}

#[test]
fn motion_that_leads_to_nowhere_stops_at_its_last_good_state() {
    // The gust starts at zero and overflows later.
    let storm = "[wind]\nvelocity_m_s = [0, 1, 0]\ngust_m_s = [0, 1e150, 0]\ngust_period_s = 1.0\n";
    let folder = folder(&format!("{SCENE}{storm}"), CLOTH);
    let output = simulate(folder.path(), &["--json"]);
    let json = json(&output);
    assert_eq!(output.status.code(), Some(4), "{json}");
    let motion = &json["motion"];
    assert!(
        json["converged"] == false && motion["stopped_at_step"] == motion["steps"].as_u64().unwrap() + 1,
        "{json}"
    );
    let out = folder.path().join("out");
    for name in ["energies.csv", "simulation.json", "frames/0000.obj"] {
        let text = fs::read_to_string(out.join(name)).unwrap().to_lowercase();
        assert!(!["nan", "inf", "null"].iter().any(|word| text.contains(word)), "{name}: {text}");
    }
    let [words, _] = said(&simulate(folder.path(), &[]));
    assert!(words.contains("NOT converged: step") && words.contains("last good state"), "{words}");
}

/// Asserts exit code 3 and an error with place and words.
fn refused(scene: &str, cloth: &str, more: &[&str], place: &str, words: &str) {
    let folder = folder(scene, cloth);
    let output = simulate(folder.path(), more);
    let [_, errors] = said(&output);
    assert_eq!(output.status.code(), Some(3), "{errors}");
    assert!(errors.contains(place) && errors.contains(words), "{errors}");
    assert!(!folder.path().join("out").exists(), "{errors}");
}

#[test]
fn bad_scenes_are_refused_with_file_and_line() {
    let scene = |from: &str, to: &str| {
        let changed = SCENE.replace(from, to);
        assert_ne!(changed, SCENE);
        changed
    };
    let bad = |from: &str, to: &str, line: usize, words: &str| {
        refused(&scene(from, to), CLOTH, &[], &format!("scene.toml:{line} "), words);
    };
    bad("duration_s", "duration_ms", 3, "duration_s");
    bad("duration_s = 0.4", "duration_s = nan", 3, "above 0");
    bad("-10.0]", "nan]", 2, "finite");
    bad("\"top\"", "\"topp\"", 11, "top");
    bad("edge = \"top\"", "nodes = [10]", 11, "0 to 9");
    bad("edge = \"top\"", "circle = { centre_m = [5.0, 5.0], radius_m = 0.1 }", 10, "no node");
    bad("warp = [0.0", "warp = [1.0", 9, "across weft");
    bad("stiffness_s = 0.05", "stiffness_s = -1", 13, "0 or more");
    bad("\"droop\"", "\"drape-coefficient\"", 6, "circle");
    bad("name", "components = [\"bend-warp\"]\nname", 1, "cloth has no curve");
    bad("nodes = [2, 5]", "nodes = [1, 5]", 8, "2 nodes");
    bad("nodes = [2, 5]", "nodes = [4294967296, 4294967296]", 8, "at most 1000000 in all");
    let disc = "disc = { radius_m = 0.5, rings = 4294967296 }";
    bad("grid = { width_m = 0.25, height_m = 1.0, nodes = [2, 5] }", disc, 8, "at most 576");
    let single = format!("{SCENE}[solver]\nintegrator = \"runge-kutta\"\nnewton = \"single\"\n");
    refused(&single, CLOTH, &[], "scene.toml:16 ", "nothing uses");
    let explicit = format!("{SCENE}[solver]\nintegrator = \"runge-kutta\"\n");
    refused(&explicit, CLOTH, &[], "scene.toml:4 ", "at most");
    let unpinned = scene("[[held]]\nedge = \"top\"\n", "").replace("measure = \"droop\"\n", "");
    refused(&unpinned, CLOTH, &["--rest"], "scene.toml:", "6 rigid motions free");
}

#[test]
fn bad_materials_are_refused_with_file_and_line() {
    let bad = |from: &str, to: &str, place: &str, words: &str| {
        refused(SCENE, &CLOTH.replace(from, to), &[], place, words);
    };
    bad("0.2", "nan", "cloth.toml:2 ", "above 0");
    bad(
        "shear = { stiffness_n_per_m = 10.0 }",
        "shear = { stiffness_n_per_m = nan }",
        "cloth.toml:7 ",
        "finite",
    );
    bad("shear", "sheer", "cloth.toml:7 ", "sheer");
    // Stress falls as strain grows.
    let falls = CLOTH.replace(
        "shear = { stiffness_n_per_m = 10.0 }",
        "shear = { strain = [0.0, 0.1, 0.2], stiffness_n_per_m = [10.0, 9.0, 1.0] }",
    );
    refused(SCENE, &falls, &[], "cloth.toml shear", "low-tangent");
    let folder = folder(SCENE, &falls);
    assert!(simulate(folder.path(), &["--allow-unstable"]).status.success());
}

#[test]
fn springs_need_a_grid_and_other_folders_are_left_alone() {
    let disc = SCENE
        .replace(
            "grid = { width_m = 0.25, height_m = 1.0, nodes = [2, 5] }",
            "disc = { radius_m = 0.5, rings = 3 }",
        )
        .replace("edge = \"top\"", "corner = \"top-left\"");
    refused(&disc, &CLOTH.replace("soft-constraint", "springs"), &[], "scene.toml:", "grid");
    let folder = folder(SCENE, CLOTH);
    fs::create_dir(folder.path().join("out")).unwrap();
    fs::write(folder.path().join("out/notes.txt"), "mine").unwrap();
    let output = simulate(folder.path(), &[]);
    assert_eq!(output.status.code(), Some(3));
    assert!(folder.path().join("out/notes.txt").exists());
    assert_eq!(simulate(folder.path(), &["--duration", "-1"]).status.code(), Some(2));
    assert_eq!(simulate(folder.path(), &["--rest", "--duration", "1"]).status.code(), Some(2));
}

#[test]
fn a_stiffness_in_pascals_is_warned_of() {
    let folder = folder(SCENE, &CLOTH.replacen("100.0", "2.0e6", 1));
    let [_, errors] = said(&simulate(folder.path(), &["--rest"]));
    let named = "warning: cloth.toml, stretch-weft: magnitude (2.000e6, limit 1.000e6)";
    assert!(errors.contains(named) && errors.contains("pascals?"), "{errors}");
    fs::write(folder.path().join("cloth.toml"), CLOTH).unwrap();
    assert!(!said(&simulate(folder.path(), &["--rest"]))[1].contains("warning"));
}

#[test]
fn a_sheet_far_away_hangs_as_one_nearby_does() {
    let vertex =
        |line: &str| -> Vec<f64> { line.split(' ').skip(1).map(|number| number.parse().unwrap()).collect() };
    let rest = |scene: &str| {
        let folder = folder(scene, CLOTH);
        let output = simulate(folder.path(), &["--rest", "--json"]);
        assert!(output.status.success(), "{:?}", said(&output));
        let shape = fs::read_to_string(folder.path().join("out/frames/0001.obj")).unwrap();
        let vertices: Vec<_> = shape.lines().filter(|line| line.starts_with("v ")).map(vertex).collect();
        (json(&output), vertices)
    };
    let ((near, here), (far, there)) =
        (rest(SCENE), rest(&SCENE.replace("warp = ", "origin_m = [5e6, -3e6, 400.0]\nwarp = ")));
    let sink = |json: &Value| json["droop"]["bottom_edge_sinks_m"].as_f64().unwrap();
    // Coordinates are rounded to 1e-9 m there.
    assert!((sink(&near) - sink(&far)).abs() < 1e-8, "{near} {far}");
    let [imbalance, allowed] = ["imbalance_n", "tolerance_n"].map(|key| far["rest"][key].as_f64().unwrap());
    assert!(imbalance < 1e-6 && allowed < 1e-4, "{far}");
    for (here, there) in here.iter().zip(&there) {
        let moved = here.iter().zip([5e6, -3e6, 400.0]).map(|(place, by)| place + by);
        assert!(moved.zip(there).all(|(moved, there)| (moved - there).abs() < 1e-8), "{here:?} {there:?}");
    }
}

/// An overhang of 78 mm beyond a clamp, in cells of 2 mm.
const OVERHANG: &str = "\
name = \"overhang\"
gravity_m_s2 = [0.0, 0.0, -9.81]
components = [\"stretch-weft\", \"stretch-warp\", \"shear\", \"bend-weft\", \"bend-warp\", \"bend-THIRD\"]
measure = \"droop\"
[sheet]
grid = { width_m = 0.08, height_m = 0.02, nodes = [41, 11], diagonals = \"forward\" }
[[held]]
box = { low_m = [-0.001, -0.001], high_m = [0.0021, 0.1] }
";

const CRISP: &str = "\
name = \"crisp\"
areal_density_kg_m2 = 0.15
model = \"stvk\"
[curves]
stretch-weft = { stiffness_n_per_m = 2000.0 }
stretch-warp = { stiffness_n_per_m = 2000.0 }
shear = { stiffness_n_per_m = 200.0 }
bend-weft = { rigidity_n_m = 6e-5 }
bend-warp = { rigidity_n_m = 6e-5 }
bend-diagonal = { rigidity_n_m = 6e-5 }
";

/// Depth of the lowest point, m, and the messages.
fn depth(scene: &str, cloth: &str, more: &[&str]) -> (f64, String) {
    let folder = folder(scene, cloth);
    let output = simulate(folder.path(), &[&["--rest", "--json"], more].concat());
    assert!(output.status.success(), "{:?}", said(&output));
    let json = json(&output);
    assert_eq!(json["rest_shape"], "flat");
    (json["droop"]["depth_m"].as_f64().unwrap(), said(&output)[1].clone())
}

#[test]
fn a_sheet_hangs_alike_on_every_triangulation() {
    let scene = OVERHANG.replace("THIRD", "twist");
    let written = CRISP.replace("bend-diagonal", "bend-twist");
    let (expected, messages) = depth(&scene, &written, &[]);
    assert!(!messages.contains("twist"), "{messages}");
    for diagonals in ["backward", "alternating", "crossed"] {
        let (found, messages) = depth(&scene.replace("forward", diagonals), CRISP, &["--bending", "sheet"]);
        assert!((found / expected - 1.0).abs() < 2e-3, "{diagonals}: {found} {expected}");
        assert!(messages.contains("bend-twist is what bend-diagonal leaves"), "{messages}");
    }
    // Hinges of the same rigidity do not.
    let hinges = OVERHANG.replace("THIRD", "diagonal");
    let (found, _) = depth(&hinges, CRISP, &["--bending", "hinges"]);
    assert!((found / expected - 1.0).abs() > 0.05, "{found} {expected}");
}

#[test]
fn bending_that_a_material_lacks_is_refused() {
    let scene = OVERHANG.replace("\"bend-THIRD\"", "\"shear\"");
    refused(&scene, CRISP, &["--rest", "--bending", "springs"], "bending", "sheet or hinges");
    let both = format!("{CRISP}bend-twist = {{ rigidity_n_m = 6e-5 }}\n");
    refused(&scene, &both, &["--rest"], "cloth.toml:", "bend-diagonal");
    let half = CRISP.replace("bend-warp = { rigidity_n_m = 6e-5 }\n", "");
    refused(&scene, &half, &["--rest", "--bending", "sheet"], "bending", "weft and warp");
}

/// Two squares of a metre that meet at a right angle, held at one of them.
const FOLDED: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 -1\nv 1 1 -1\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 2 0\nvt 2 1\n\
    f 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 2/2 5/5 6/6\nf 2/2 6/6 3/3\n";

#[test]
fn a_folded_mesh_is_flat_at_rest_unless_the_scene_says_otherwise() {
    let scene = "name = \"fold\"\ngravity_m_s2 = [0.0, 0.0, 0.0]\n[sheet]\nmesh = { file = \"fold.obj\" }\n\
                 [[held]]\nnodes = [0, 1, 2, 3]\n";
    let stiff = CRISP.replace("6e-5", "1.0");
    let highest = |scene: &str, bending: &str| {
        let folder = folder(scene, &stiff);
        fs::write(folder.path().join("fold.obj"), FOLDED).unwrap();
        let output = simulate(folder.path(), &["--rest", "--json", "--bending", bending]);
        assert!(output.status.success(), "{:?}", said(&output));
        let last = fs::read_to_string(folder.path().join("out/frames/0001.obj")).unwrap();
        let depth = last.lines().filter_map(|line| line.strip_prefix("v ")?.split(' ').nth(2)?.parse().ok());
        depth.fold(f64::MAX, |lowest: f64, z: f64| lowest.min(z))
    };
    let laid = scene.replace("[[held]]", "rest = \"as-laid-out\"\n[[held]]");
    for bending in ["sheet", "hinges"] {
        assert!(highest(scene, bending) > -1e-6, "{bending}");
        assert!(highest(&laid, bending) < -0.999, "{bending}");
    }
    let grid =
        OVERHANG.replace("\"bend-THIRD\"", "\"shear\"").replace("[sheet]", "[sheet]\nrest = \"as-laid-out\"");
    refused(&grid, CRISP, &["--rest"], "scene.toml:6 ", "flat");
}

#[test]
fn a_sheet_is_not_moved_by_runge_kutta() {
    let scene = OVERHANG.replace("THIRD", "twist") + "[solver]\nintegrator = \"runge-kutta\"\n";
    let more = ["--bending", "sheet", "--duration", "0.1"];
    refused(&scene, CRISP, &more, "scene.toml:", "implicit-euler, as edges");
}

#[test]
fn a_sheet_bends_by_the_components_of_its_scene() {
    let all = depth(&OVERHANG.replace("THIRD", "twist"), CRISP, &["--bending", "sheet"]).0;
    let without = OVERHANG.replace(", \"bend-THIRD\"", "");
    assert!((depth(&without, CRISP, &["--bending", "sheet"]).0 / all - 1.0).abs() > 1e-9);
}
