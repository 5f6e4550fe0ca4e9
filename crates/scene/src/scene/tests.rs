//! Every error of a scene with its full message, and the contents of valid scenes.

use super::*;
use cloth_sim::dynamics::{Damping, Integrator, LinearSolver, Newton, Wind};
use cloth_sim::load::Free;
use std::fs;

/// Three by three nodes over 0.2 m × 0.4 m, held along the top.
const SCENE: &str = "\
name = \"sheet\"
gravity_m_s2 = [0.0, 0.0, -10.0]
[sheet]
grid = { width_m = 0.2, height_m = 0.4, nodes = [3, 3] }
[[held]]
edge = \"top\"
[solver]
integrator = \"implicit-euler\"
";

const GRID: &str = "grid = { width_m = 0.2, height_m = 0.4, nodes = [3, 3] }";

/// A square of two triangles in the xz plane, with material coordinates.
const MESH: &str = "v 0 0 0\nv 0.1 0 0\nv 0.1 0 0.1\nv 0 0 0.1\nvt 0 0\nvt 0.1 0\nvt 0.1 0.1\nvt 0 0.1\n\
                    f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";

/// A square in the yz plane, without material coordinates.
const BARE: &str = "v 0 0 0\nv 0 0 0.1\nv 0 0.1 0.1\nv 0 0.1 0\nf 1 2 3\nf 1 3 4\n";

/// Reads a scene from a text, next to `sheet.obj` and `bare.obj`.
fn read(text: &str) -> Result<Scene> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("sheet.obj"), MESH).unwrap();
    fs::write(folder.path().join("bare.obj"), BARE).unwrap();
    fs::write(folder.path().join("s.toml"), text).unwrap();
    Scene::read(&folder.path().join("s.toml"))
}

fn changed(old: &str, new: &str) -> String {
    assert!(SCENE.contains(old), "{old}");
    SCENE.replacen(old, new, 1)
}

fn message(text: &str) -> String {
    let message = read(text).map_or_else(|error| error, |_| panic!("read in spite of a defect")).to_string();
    message.find("s.toml").map_or(message.clone(), |start| message[start..].into())
}

/// Replaces a part of the scene and compares the message.
fn check(cases: &[(&str, &str, &str)]) {
    let mut wrong = Vec::new();
    for (old, new, expected) in cases {
        let message = message(&changed(old, new));
        if message != format!("s.toml{expected}") {
            wrong.push(format!("{new}\n   found {message}\nexpected s.toml{expected}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn numbers_of_the_scene() {
    check(&[
        ("\"sheet\"", "\" \"", ":1 name: found nothing, expected the scene's name"),
        (
            "-10.0]",
            "-10.0, 0.0]",
            ":2 gravity_m_s2: found more than 3 numbers, expected an array of length 3",
        ),
        ("-10.0]", "inf]", ":2 gravity_m_s2: found [0.0, 0.0, inf], expected three finite numbers"),
        ("[sheet]", "duration_s = 0\n[sheet]", ":3 duration_s: found 0, expected a number above 0"),
        ("[sheet]", "duration_s = inf\n[sheet]", ":3 duration_s: found inf, expected a number above 0"),
        ("[sheet]", "step_s = -0.01\n[sheet]", ":3 step_s: found -0.01, expected a number above 0"),
        ("[sheet]", "frames_per_s = nan\n[sheet]", ":3 frames_per_s: found NaN, expected a number above 0"),
        (
            "[sheet]",
            "measure = \"drape-coefficient\"\n[sheet]",
            ":3 measure: found drape-coefficient, expected droop, or one [[held]] circle and nothing else: the support of the drape",
        ),
        (
            "[solver]",
            "[start]\nperturbation_m = -1e-3\n[solver]",
            ":8 start.perturbation_m: found -0.001, expected 0 or more",
        ),
        (
            "[solver]",
            "[start]\nperturbation_m = inf\n[solver]",
            ":8 start.perturbation_m: found inf, expected 0 or more",
        ),
    ]);
    let free = changed("[[held]]\nedge = \"top\"\n", "").replace("[sheet]", "measure = \"droop\"\n[sheet]");
    assert_eq!(message(&free), "s.toml:3 measure: found droop, expected a sheet with [[held]] nodes");
}

#[test]
fn sheets() {
    let disc = |more: &str| format!("disc = {{ radius_m = 0.1, rings = 4{more} }}");
    let mesh = |more: &str| format!("mesh = {{ file = \"sheet.obj\"{more} }}");
    check(&[
        (GRID, "", ":3 sheet: found none or several sheets, expected one of grid, disc and mesh"),
        (
            GRID,
            &format!("{GRID}\n{}", disc("")),
            ":3 sheet: found none or several sheets, expected one of grid, disc and mesh",
        ),
        (
            "[3, 3]",
            "[1, 3]",
            ":4 sheet.grid: found columns: found 1, expected at least 2 nodes, expected a valid sheet",
        ),
        (
            "[3, 3]",
            "[3, 3, 3]",
            ":4 sheet.grid.nodes: found more than 2 numbers, expected an array of length 2",
        ),
        (
            "0.2,",
            "nan,",
            ":4 sheet.grid: found width: found NaN, expected a positive length in metres, expected a valid sheet",
        ),
        (GRID, &disc(", kept_ring = 5"), ":4 sheet.disc.kept_ring: found 5, expected 1 to 4"),
        (GRID, &disc(", kept_ring = 0"), ":4 sheet.disc.kept_ring: found 0, expected 1 to 4"),
        (
            GRID,
            &disc("").replace("0.1", "-0.1"),
            ":4 sheet.disc: found radius: found -0.1, expected a positive length in metres, expected a valid sheet",
        ),
        (
            GRID,
            &format!("{}\norigin_m = [0, 0, 0]", mesh("")),
            ":5 sheet.origin_m: found a position, expected none: the mesh file gives the position",
        ),
        (
            GRID,
            &mesh(", weft = \"x\""),
            ":4 sheet.mesh: found one axis, expected weft and warp along two axes, or vt in the file",
        ),
        (
            GRID,
            &mesh(", weft = \"x\", warp = \"x\""),
            ":4 sheet.mesh: found one axis, expected weft and warp along two axes, or vt in the file",
        ),
        (GRID, &format!("{GRID}\nweft = [0, 0, 0]"), ":5 sheet.weft: found zero, expected a direction"),
        (
            GRID,
            &format!("{GRID}\nwarp = [0, nan, 0]"),
            ":5 sheet.warp: found [0.0, NaN, 0.0], expected three finite numbers",
        ),
        (
            GRID,
            &format!("{GRID}\nwarp = [1, 1, 0]"),
            ":5 sheet.warp: found 45.0000° from weft, expected a direction across weft, at 90°",
        ),
        (
            GRID,
            &format!("{GRID}\norigin_m = [0, 0, inf]"),
            ":5 sheet.origin_m: found [0.0, 0.0, inf], expected three finite numbers",
        ),
        (
            GRID,
            &format!("{GRID}\norigin_m = [0, 0, 0, 0]"),
            ":5 sheet.origin_m: found more than 3 numbers, expected an array of length 3",
        ),
        (
            GRID,
            &format!("{GRID}\norigin_m = [1e20, 0, 0]"),
            ":5 sheet.origin_m: found vertices 0 and 1 have the same rest position; merge them, expected a position nearer to zero",
        ),
    ]);
    let elsewhere = changed(GRID, &mesh("")).replace("sheet.obj", "nothing.obj");
    assert!(message(&elsewhere).ends_with("nothing.obj file: found nothing, expected a file"));
}

#[test]
fn holds_that_hold_nothing() {
    let edge = "edge = \"top\"";
    check(&[
        (
            edge,
            "",
            ":5 held[0]: found none or several places, expected one of corner, edge, box, circle and nodes",
        ),
        (
            edge,
            "edge = \"top\"\ncorner = \"top-left\"",
            ":5 held[0]: found none or several places, expected one of corner, edge, box, circle and nodes",
        ),
        (edge, "nodes = [0, 9]", ":6 held[0].nodes[1]: found 9, expected vertices from 0 to 8"),
        (edge, "nodes = []", ":5 held[0]: found no node there, expected a place where the sheet has nodes"),
        (
            edge,
            "box = { low_m = [1, 1], high_m = [2, 2] }",
            ":5 held[0]: found no node there, expected a place where the sheet has nodes",
        ),
        (
            edge,
            "box = { low_m = [0, 0, 0], high_m = [1, 1] }",
            ":6 held[0].box.low_m: found more than 2 numbers, expected an array of length 2",
        ),
        (
            edge,
            "box = { low_m = [0, 0], high_m = [1, 1, 0] }",
            ":6 held[0].box.high_m: found more than 2 numbers, expected an array of length 2",
        ),
        (
            edge,
            "circle = { centre_m = [0, 0, 0], radius_m = 1 }",
            ":6 held[0].circle.centre_m: found more than 2 numbers, expected an array of length 2",
        ),
        (
            edge,
            "circle = { centre_m = [0, 0], radius_m = nan }",
            ":6 held[0].circle.radius_m: found NaN, expected 0 or more",
        ),
        (
            edge,
            "edge = \"top\"\nfree = \"line\"",
            ":5 held[0]: found one of free and direction, expected free = \"line\" with a direction, or free = \"plane\" with its normal as direction",
        ),
        (
            edge,
            "edge = \"top\"\ndirection = [1, 0, 0]",
            ":5 held[0]: found one of free and direction, expected free = \"line\" with a direction, or free = \"plane\" with its normal as direction",
        ),
        (
            edge,
            "edge = \"top\"\nfree = \"plane\"\ndirection = [0, 0, 0]",
            ":8 held[0].direction: found zero, expected a direction",
        ),
        (
            edge,
            "edge = \"top\"\nfree = \"plane\"\ndirection = [0, nan, 0]",
            ":8 held[0].direction: found [0.0, NaN, 0.0], expected three finite numbers",
        ),
    ]);
}

#[test]
fn solvers_and_winds() {
    let (euler, explicit) = ("integrator = \"implicit-euler\"", "integrator = \"runge-kutta\"");
    let explicit = |more: &str| format!("{explicit}\n{more}");
    let damping = |more: &str| format!("[damping]\n{more}\n[solver]");
    let wind = |more: &str| format!("[wind]\nvelocity_m_s = [0, 3, 0]\n{more}\n[solver]");
    check(&[
        ("[solver]", &damping("mass_per_s = nan"), ":8 damping.mass_per_s: found NaN, expected 0 or more"),
        ("[solver]", &damping("stiffness_s = -1"), ":8 damping.stiffness_s: found -1, expected 0 or more"),
        (
            euler,
            &explicit("newton = \"single\""),
            ":9 solver.newton: found a value that nothing uses, expected integrator = \"implicit-euler\"",
        ),
        (
            euler,
            &explicit("tolerance = 1e-6"),
            ":9 solver.tolerance: found a value that nothing uses, expected integrator = \"implicit-euler\"",
        ),
        (
            euler,
            &explicit("linear = \"direct\""),
            ":9 solver.linear: found a value that nothing uses, expected integrator = \"implicit-euler\"",
        ),
        (
            euler,
            &explicit("linear_tolerance = 1e-6"),
            ":9 solver.linear_tolerance: found a value that nothing uses, expected integrator = \"implicit-euler\"",
        ),
        (
            euler,
            &explicit("linear_iterations = 5"),
            ":9 solver.linear_iterations: found a value that nothing uses, expected integrator = \"implicit-euler\"",
        ),
        (euler, "tolerance = 0", ":8 solver.tolerance: found 0, expected a share between 0 and 1"),
        (euler, "tolerance = 1", ":8 solver.tolerance: found 1, expected a share between 0 and 1"),
        (
            euler,
            "newton = \"single\"\ntolerance = 1e-6",
            ":9 solver.tolerance: found a value that nothing uses, expected newton = \"converged\"",
        ),
        (
            euler,
            "linear_iterations = 5",
            ":8 solver.linear_iterations: found a value that nothing uses, expected linear = \"conjugate-gradient\"",
        ),
        (
            euler,
            "linear = \"conjugate-gradient\"\nlinear_iterations = 0",
            ":9 solver.linear_iterations: found 0, expected 1 or more",
        ),
        (
            euler,
            "linear = \"conjugate-gradient\"\nlinear_tolerance = nan",
            ":9 solver.linear_tolerance: found NaN, expected a share between 0 and 1",
        ),
        (
            "[solver]",
            &wind("gust_period_s = 1"),
            ":7 wind: found one of gust_m_s and gust_period_s, expected gust_m_s and gust_period_s together",
        ),
        (
            "[solver]",
            &wind("gust_m_s = [0, 1, 0]"),
            ":7 wind: found one of gust_m_s and gust_period_s, expected gust_m_s and gust_period_s together",
        ),
        (
            "[solver]",
            &wind("gust_m_s = [0, 1, 0]\ngust_period_s = 0"),
            ":10 wind.gust_period_s: found 0, expected a number above 0",
        ),
        (
            "[solver]",
            &wind("gust_m_s = [0, inf, 0]\ngust_period_s = 1"),
            ":9 wind.gust_m_s: found [0.0, inf, 0.0], expected three finite numbers",
        ),
        (
            "[solver]",
            &wind("air_density_kg_m3 = -1"),
            ":9 wind.air_density_kg_m3: found -1, expected 0 or more",
        ),
        ("[solver]", &wind("normal_drag = inf"), ":9 wind.normal_drag: found inf, expected 0 or more"),
        (
            "[solver]",
            &wind("tangential_drag = nan"),
            ":9 wind.tangential_drag: found NaN, expected 0 or more",
        ),
        (
            "[solver]",
            &wind("").replace('3', "nan"),
            ":8 wind.velocity_m_s: found [0.0, NaN, 0.0], expected three finite numbers",
        ),
    ]);
}

/// Nodes named by a hold, each with its clip.
fn held(hold: &str) -> Vec<(usize, usize)> {
    let scene = read(&changed("edge = \"top\"", hold)).unwrap();
    scene.held.iter().map(|held| (held.node, held.clip.unwrap())).collect()
}

#[test]
fn holds_name_the_nodes_that_lie_there() {
    // Nodes are numbered along weft, from bottom to top.
    for (hold, nodes) in [
        ("corner = \"bottom-left\"", vec![0]),
        ("corner = \"bottom-right\"", vec![2]),
        ("corner = \"top-left\"", vec![6]),
        ("corner = \"top-right\"", vec![8]),
        ("edge = \"left\"", vec![0, 3, 6]),
        ("edge = \"right\"", vec![2, 5, 8]),
        ("edge = \"bottom\"", vec![0, 1, 2]),
        ("box = { low_m = [0.1, 0.0], high_m = [0.2, 0.2] }", vec![1, 2, 4, 5]),
        ("circle = { centre_m = [0.0, 0.2], radius_m = 0.1 }", vec![3, 4]),
        ("nodes = [4, 7]", vec![4, 7]),
    ] {
        let found: Vec<usize> = held(hold).into_iter().map(|(node, _)| node).collect();
        assert_eq!(found, nodes, "{hold}");
    }
    // A node in several holds belongs to the first.
    assert_eq!(held("nodes = [4, 7]\n[[held]]\nnodes = [7, 8]"), [(4, 0), (7, 0), (8, 1)]);
}

#[test]
fn a_node_that_is_held_is_not_guided_and_neither_leaves_its_place_at_the_start() {
    let more = "nodes = [6]\n[[held]]\nedge = \"top\"\nfree = \"plane\"\ndirection = [0, 0, 2]\n\
                [[held]]\ncorner = \"bottom-left\"\nfree = \"line\"\ndirection = [1, 0, 0]\n\
                [start]\nperturbation_m = 1e-3";
    let scene = read(&changed("edge = \"top\"", more)).unwrap();
    assert_eq!(scene.held.iter().map(|held| held.node).collect::<Vec<_>>(), [6]);
    let guided: Vec<_> = scene.guided.iter().map(|guided| (guided.node, guided.free)).collect();
    let plane = Free::Plane(2.0 * Vector3::z());
    assert_eq!(guided, [(0, Free::Line(Vector3::x())), (7, plane), (8, plane)]);
    for (node, place) in scene.start.chunks(3).enumerate() {
        let [along, out] = [(place[0], place[1]), (place[2], 0.0)];
        let rest = scene.mesh.positions[node];
        assert_eq!(along, (rest.x, rest.y));
        assert!(out.0.abs() <= 1e-3);
        assert_eq!(out.0 == 0.0, [0, 6, 7, 8].contains(&node), "{node}");
    }
}

#[test]
fn a_sheet_lies_where_its_axes_and_its_file_put_it() {
    let turned = changed(GRID, &format!("{GRID}\nwarp = [0, 0, 2]\norigin_m = [1, 2, 3]"));
    assert_eq!(read(&turned).unwrap().mesh.positions[8], Vector3::new(1.2, 2.0, 3.4));
    for (file, place) in [
        ("mesh = { file = \"sheet.obj\" }", Vector3::x()),
        ("mesh = { file = \"sheet.obj\", weft = \"x\", warp = \"z\" }", Vector3::x()),
        ("mesh = { file = \"bare.obj\", weft = \"z\", warp = \"y\" }", Vector3::z()),
    ] {
        let mesh = read(&changed(GRID, file)).unwrap().mesh;
        assert_eq!((mesh.positions[1], mesh.material[1]), (0.1 * place, [0.1, 0.0].into()), "{file}");
    }
}

#[test]
fn a_support_is_one_circle_and_nothing_else() {
    let circle = "circle = { centre_m = [0.1, 0.2], radius_m = 0.05 }";
    let support = |hold: &str| read(&changed("edge = \"top\"", hold)).unwrap().support;
    let expected = Circle { centre: nalgebra::Vector2::new(0.1, 0.2), radius: 0.05 };
    assert_eq!(support(circle), Some(expected));
    assert_eq!(support(&format!("{circle}\n[[held]]\nedge = \"top\"")), None);
    assert_eq!(support(&format!("{circle}\nfree = \"plane\"\ndirection = [0, 0, 1]")), None);
}

#[test]
fn what_the_file_says_of_motion_is_what_is_computed() {
    let euler = "integrator = \"implicit-euler\"";
    let settings = |solver: &str| read(&changed(euler, solver)).unwrap().dynamics;
    let still = settings(euler);
    let direct = |newton| Integrator::ImplicitEuler { newton, linear: LinearSolver::Direct };
    assert_eq!((still.step, still.integrator), (0.01, direct(Newton::default())));
    assert_eq!((still.damping, still.wind), (Damping::default(), None));
    assert_eq!(settings("integrator = \"runge-kutta\"").integrator, Integrator::RungeKutta);
    assert_eq!(settings("newton = \"single\"").integrator, direct(Newton::Single));
    assert_eq!(settings("tolerance = 1e-6").integrator, direct(Newton::Converged { tolerance: 1e-6 }));
    let gradient = |tolerance, max_iterations| {
        let linear = LinearSolver::ConjugateGradient { tolerance, max_iterations };
        Integrator::ImplicitEuler { newton: Newton::default(), linear }
    };
    assert_eq!(settings("linear = \"conjugate-gradient\"").integrator, gradient(1e-5, 1000));
    let both = "linear = \"conjugate-gradient\"\nlinear_tolerance = 1e-3\nlinear_iterations = 7";
    assert_eq!(settings(both).integrator, gradient(1e-3, 7));
    let air = "[damping]\nmass_per_s = 2\nstiffness_s = 0.5\n\
               [wind]\nvelocity_m_s = [0, 3, 0]\ngust_m_s = [1, 0, 0]\ngust_period_s = 4\n\
               air_density_kg_m3 = 1\nnormal_drag = 2\ntangential_drag = 0.1\n";
    let windy = read(&format!("{SCENE}{air}")).unwrap().dynamics;
    assert_eq!(windy.damping, Damping { mass: 2.0, stiffness: 0.5 });
    let (velocity, gust) = (3.0 * Vector3::y(), Vector3::x());
    let expected =
        Wind { velocity, gust, gust_period: 4.0, density: 1.0, normal_drag: 2.0, tangential_drag: 0.1 };
    assert_eq!(windy.wind, Some(expected));
}

#[test]
fn defects_of_the_mechanics_are_named_by_their_key() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloth.toml");
    let cloth = "name = \"cloth\"\nareal_density_kg_m2 = 0.2\nmodel = \"springs\"\n\
                 [curves]\nshear = { stiffness_n_per_m = 10 }\n";
    fs::write(&path, cloth).unwrap();
    let material = Material::read(&path).unwrap();
    let refusal = |text: &str, at_rest: bool| {
        let scene = read(text).unwrap();
        let cloth =
            scene.components(&material).and_then(|components| scene.cloth(&material, &components, at_rest));
        let message = cloth.err().unwrap().to_string();
        message[message.find("s.toml").unwrap()..].to_string()
    };
    let named = format!("components = [\"shear\", \"bend-weft\"]\n{SCENE}");
    let expected =
        "s.toml:1 components[1]: found bend-weft, which cloth has no curve for, expected some of shear";
    assert_eq!(refusal(&named, false), expected);
    let free = changed("[[held]]\nedge = \"top\"\n", "");
    let expected = "s.toml:3 sheet: found nothing holds the part of the cloth that contains vertex 0 (9 vertices): \
                    6 rigid motions free, expected [[held]] nodes in every part, for a shape at rest";
    assert_eq!(refusal(&free, true), expected);
    let expected = "s.toml:3 sheet: found a membrane of springs needs a regular grid without nodes inside its cells; \
                    this mesh is not one, expected grid, or another model";
    assert_eq!(refusal(&changed(GRID, "disc = { radius_m = 0.1, rings = 4 }"), true), expected);
    let scene = read(&format!("components = [\"shear\"]\n{SCENE}")).unwrap();
    assert_eq!(scene.components(&material).unwrap(), [Component::Shear]);
    let other = scene.explain(Defect::ZeroArea { triangle: 0 });
    assert!(matches!(&other, Error::Mechanics { context, .. } if context == "sheet"), "{other:?}");
    assert!(scene.cloth(&material, &[Component::Shear], true).is_ok());
}
