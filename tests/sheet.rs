//! Bending of a sheet: moment against curvature, whatever the mesh and the direction of the yarns.
//!
//! ```text
//!  goal    one law per direction, in N and 1/m, no factor that belongs to the mesh
//!  meshes  uniform, alternating and crossed diagonals, equilateral, irregular; yarns at 0°, 30°, 45°
//!
//!  ▒▒▒▒────╮      free plate off a table, one rigidity: drop of the end beside the elastica's     3 %, 1 % on twice the nodes
//!           ╲
//!   ╭──────╮      rolled about any axis, weft, warp and twist apart: moment                       0.5 %
//!  ╱        ╲
//!  ↑────────↓     twisted by its corners: force beside the orthotropic plate's                    2 %
//!  ↓────────↑
//! ```

use cloth_data::rig::KnownFabric;
use cloth_sim::bending::{Bending, SheetTriangle};
use cloth_sim::cloth::{Cloth, Problem};
use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use cloth_sim::dynamics::{self, Integrator, Motion};
use cloth_sim::element::{Element, gather};
use cloth_sim::equilibrium::{Equilibrium, Settings, Solver};
use cloth_sim::load::{Free, Guided, Held};
use cloth_sim::material::{BendingModel, Component, Curves, Model};
use cloth_sim::mesh::Mesh;
use fit_cloth_tests::elastica::Elastica;
use fit_cloth_tests::triangulation::Triangulation;
use nalgebra::{Vector2, Vector3};

const MODEL: Model = Model::STVK.with(BendingModel::Sheet);

const LENGTH: f64 = 0.1;

/// Areal density times gravity, N/m².
const WEIGHT: f64 = 0.15 * 9.81;

/// Weft, warp and twist of an orthotropic sheet, N·m.
const RIGIDITIES: [f64; 3] = [2e-6, 6e-6, 1.2e-6];

const BENDING: [Component; 3] = [Component::BendWeft, Component::BendWarp, Component::BendTwist];

/// Constant rigidities with the membrane of a fabric.
fn with_membrane(fabric: &str, rigidities: [f64; 3]) -> Curves {
    let mut curves = KnownFabric::named(fabric).unwrap().curves().unwrap();
    for (component, rigidity) in BENDING.into_iter().zip(rigidities) {
        curves.set(component, StiffnessCurve::constant(rigidity, NegativeStrain::Odd).unwrap());
    }
    curves
}

/// Drop of the free end off a table beside that of the elastica, less one.
fn droop(mesh: &Mesh, cell: f64, model: Model, curves: &Curves, gamma: f64) -> (f64, Equilibrium) {
    // A column of cells lies on the table.
    let on_table = (0..mesh.len()).filter(|&node| mesh.positions[node].x < 1.001 * cell);
    let held: Vec<Held> = on_table.map(|node| Held { node, clip: None }).collect();
    let cloth = Cloth::new(&Problem {
        areal_density: WEIGHT / 9.81,
        gravity: Vector3::new(0.0, 0.0, -9.81),
        held: &held,
        ..Problem::new(mesh, model, &Component::ALL)
    })
    .unwrap();
    let mut x = cloth.state(&mesh.coordinates());
    let found = Solver::new(&cloth).solve(curves, &mut x, &Settings::default());
    let end = (0..mesh.len()).filter(|&node| mesh.positions[node].x > LENGTH + 0.999 * cell);
    let drops: Vec<f64> = end.map(|node| -x[3 * node + 2]).collect();
    let drop = drops.iter().sum::<f64>() / drops.len() as f64;
    let rigidity = WEIGHT * LENGTH.powi(3) / gamma;
    let elastica = Elastica::solve(LENGTH, WEIGHT, &|curvature| rigidity * curvature);
    (drop / elastica.tip().below - 1.0, found)
}

/// * `nodes` — along the overhang
fn plate(triangulation: Triangulation, nodes: usize, degrees: f64) -> (Mesh, f64) {
    let cell = LENGTH / (nodes - 1) as f64;
    (triangulation.mesh([nodes, (nodes - 1) / 2], cell, degrees), cell)
}

#[test]
fn a_free_plate_hangs_as_the_elastica() {
    for triangulation in Triangulation::ALL {
        for (nodes, allowed) in [(17, 0.03), (33, 0.01)] {
            for (degrees, fabric) in [
                (0.0, "cotton-denim"),
                (30.0, "cotton-satin"),
                (45.0, "rayon-spandex-knit"),
                (30.0, "wool-cotton"),
            ] {
                let (mesh, cell) = plate(triangulation, nodes, degrees);
                let errors = [1.0, 10.0, 30.0].map(|gamma| {
                    let rigidity = WEIGHT * LENGTH.powi(3) / gamma;
                    let curves = with_membrane(fabric, [rigidity; 3]);
                    let (error, found) = droop(&mesh, cell, MODEL, &curves, gamma);
                    assert!(found.converged(), "{triangulation:?}, {fabric}, Γ {gamma}: {:?}", found.status);
                    error
                });
                println!("{triangulation:?}, {nodes} nodes, {fabric}, yarns at {degrees}°: {errors:+.4?}");
                assert!(errors.iter().all(|error| error.abs() <= allowed), "{triangulation:?}: {errors:?}");
            }
        }
    }
}

/// Rolls a sheet in the plane about an axis, lengths kept.
///
/// * `across` — unit vector in the plane, across the axis
fn rolled(mesh: &Mesh, across: Vector2<f64>, curvature: f64) -> Vec<f64> {
    let along = Vector2::new(-across.y, across.x);
    let place = |p: &Vector3<f64>| {
        let (s, t) = (across.dot(&p.xy()), along.dot(&p.xy()));
        let (sine, cosine) = (curvature * s).sin_cos();
        let flat = across * (sine / curvature) + along * t;
        [flat.x, flat.y, (1.0 - cosine) / curvature]
    };
    mesh.positions.iter().flat_map(place).collect()
}

/// Elastic energy per area of the triangles inside a rectangle, J/m².
fn density(triangles: &[SheetTriangle], curves: &Curves, x: &[f64], mesh: &Mesh) -> f64 {
    let (mut energy, mut area) = (0.0, 0.0);
    let far = |node: usize| {
        let p = mesh.positions[node];
        p.x.min(p.y).min(LENGTH - p.x).min(LENGTH - p.y) > 0.3 * LENGTH
    };
    for triangle in triangles.iter().filter(|triangle| (0..3).all(|i| far(triangle.coordinates[i][0] / 3))) {
        let strains = triangle.strains(&gather(triangle.coordinates, x));
        let own = triangle.components().into_iter().zip(strains);
        energy += triangle.area * own.map(|(c, strain)| curves.get(c).unwrap().energy(strain)).sum::<f64>();
        area += triangle.area;
    }
    energy / area
}

#[test]
fn a_sheet_rolled_about_any_axis_has_the_moment_of_its_law() {
    // Softer at larger curvature, along weft.
    let mut curves = with_membrane("cotton-denim", RIGIDITIES);
    let weft = StiffnessCurve::new(vec![0.0, 20.0, 40.0], vec![4e-6, 3e-6, 2.5e-6], NegativeStrain::Odd);
    curves.set(Component::BendWeft, weft.unwrap());
    for triangulation in Triangulation::ALL {
        for cells in [16, 32] {
            let mesh = triangulation.mesh([cells; 2], LENGTH / cells as f64, 0.0);
            // The nodes stay on the cylinder, and the normals at the edges settle.
            let guided: Vec<Guided> =
                (0..mesh.len()).map(|node| Guided { node, free: Free::Nowhere }).collect();
            let problem = Problem { guided: &guided, ..Problem::new(&mesh, MODEL, &Component::ALL) };
            let cloth = Cloth::new(&problem).unwrap();
            let mut worst: f64 = 0.0;
            for degrees in [0.0f64, 30.0, 45.0, 75.0, 90.0, 120.0] {
                let (sine, cosine) = degrees.to_radians().sin_cos();
                let across = Vector2::new(cosine, sine);
                let curvatures =
                    |k: f64| [k * cosine * cosine, k * sine * sine, k * sine * cosine, k * sine * cosine];
                let of_law = |k: f64| -> f64 {
                    let own = [BENDING[0], BENDING[1], BENDING[2], BENDING[2]].into_iter().zip(curvatures(k));
                    own.map(|(c, own)| curves.get(c).unwrap().energy(own)).sum()
                };
                let of_sheet = |k: f64| -> f64 {
                    let mut x = cloth.state(&rolled(&mesh, across, k));
                    let found = Solver::new(&cloth).solve(&curves, &mut x, &Settings::default());
                    assert!(found.converged(), "{triangulation:?}: {:?}", found.status);
                    match cloth.bending().unwrap() {
                        Bending::Sheet(sheet) => density(&sheet.triangles, &curves, &x, &mesh),
                        _ => unreachable!("the model bends as a sheet"),
                    }
                };
                let (k, step) = (15.0, 0.05);
                let moment =
                    |energy: &dyn Fn(f64) -> f64| (energy(k + step) - energy(k - step)) / (2.0 * step);
                worst = worst.max((moment(&of_sheet) / moment(&of_law) - 1.0).abs());
            }
            println!("{triangulation:?}, {cells} cells: moment within {:.3} %", 100.0 * worst);
            assert!(worst <= 0.005, "{triangulation:?}: {worst}");
        }
    }
}

/// Uniform twisting moment: F = 2 m at the corners, up and down in turn. In the yarns' directions, at an angle α, it is
/// m_u = −m_v = m sin 2α and m_uv = m cos 2α, and its work per area 2 m κ_xy = Σ m κ (Timoshenko and Woinowsky-Krieger 1959, §11;
/// Lekhnitskii 1968).
#[test]
fn a_plate_twisted_by_its_corners_is_as_stiff_as_the_closed_form() {
    let ([weft, warp, twist], mut sound) = (RIGIDITIES, true);
    let curves = with_membrane("cotton-denim", RIGIDITIES);
    for triangulation in Triangulation::ALL {
        for cells in [16, 32] {
            for degrees in [0.0f64, 30.0, 45.0] {
                let (mesh, side) = (triangulation.mesh([cells; 2], LENGTH / cells as f64, degrees), LENGTH);
                let lift = 1e-4 * side;
                let is_end = |place: f64| place < 1e-9 || place > side - 1e-9;
                let corners = mesh.positions.iter().enumerate().filter(|(_, p)| is_end(p.x) && is_end(p.y));
                let held: Vec<Held> =
                    corners.enumerate().map(|(clip, (node, _))| Held { node, clip: Some(clip) }).collect();
                assert_eq!(held.len(), 4);
                let problem = Problem { held: &held, ..Problem::new(&mesh, MODEL, &Component::ALL) };
                let cloth = Cloth::new(&problem).unwrap();
                let mut x = cloth.state(&mesh.coordinates());
                for held in &held {
                    let p = mesh.positions[held.node];
                    let up = if (p.x > 0.5 * side) == (p.y > 0.5 * side) { lift } else { -lift };
                    x[3 * held.node + 2] = up;
                }
                let mut solver = Solver::new(&cloth);
                let found = solver.solve(&curves, &mut x, &Settings::default());
                assert!(found.converged(), "{triangulation:?}: {:?}", found.status);
                let force = solver.clip_forces().iter().map(|force| force.z.abs()).sum::<f64>() / 4.0;
                let (sine, cosine) = (2.0 * degrees.to_radians()).sin_cos();
                let compliance = 0.5 * sine * sine * (1.0 / weft + 1.0 / warp) + cosine * cosine / twist;
                // Corners of κ_xy x y lie κ a²/4 high.
                let expected = 2.0 * 4.0 * lift / (side * side) / compliance;
                println!(
                    "{triangulation:?}, {cells} cells, yarns at {degrees}°: {:+.3} %",
                    100.0 * (force / expected - 1.0)
                );
                sound &= (force / expected - 1.0).abs() <= 0.02;
            }
        }
    }
    assert!(sound);
}

/// Newton steps beside the hinge's, on the meshes where each is at its best.
#[test]
fn a_sheet_needs_about_as_many_steps_as_hinges() {
    let mut sums = [0, 0];
    for triangulation in Triangulation::ALL {
        for gamma in [1.0, 3.0, 10.0, 30.0] {
            let (mesh, cell) = plate(triangulation, 17, 0.0);
            let rigidity = WEIGHT * LENGTH.powi(3) / gamma;
            for (sum, (model, stiffness)) in
                sums.iter_mut().zip([(MODEL, rigidity), (Model::STVK, rigidity / 3.0)])
            {
                let mut curves = with_membrane("cotton-denim", [stiffness; 3]);
                let third = StiffnessCurve::constant(stiffness, NegativeStrain::Odd).unwrap();
                curves.set(Component::BendDiagonal, third);
                let (_, found) = droop(&mesh, cell, model, &curves, gamma);
                println!(
                    "{triangulation:?}, Γ {gamma}, {model}: {} steps, {:?}",
                    found.iterations, found.status
                );
                *sum += found.iterations;
            }
        }
    }
    println!("{sums:?}");
    assert!(sums[0] as f64 <= 1.3 * sums[1] as f64, "{sums:?}");
}

/// From rest, the sheet swings down the same way whether many of its edges rotate or few.
#[test]
fn a_sheet_in_motion_moves_alike_on_every_triangulation() {
    let rigidity = WEIGHT * LENGTH.powi(3) / 5.0;
    let curves = with_membrane("cotton-satin", [rigidity; 3]);
    let ends = [Triangulation::Uniform, Triangulation::Irregular].map(|triangulation| {
        let (mesh, cell) = plate(triangulation, 13, 0.0);
        let on_table = (0..mesh.len()).filter(|&node| mesh.positions[node].x < 1.001 * cell);
        let held: Vec<Held> = on_table.map(|node| Held { node, clip: None }).collect();
        let cloth = Cloth::in_motion(&Problem {
            areal_density: WEIGHT / 9.81,
            gravity: Vector3::new(0.0, 0.0, -9.81),
            held: &held,
            ..Problem::new(&mesh, MODEL, &Component::ALL)
        })
        .unwrap();
        let settings = dynamics::Settings { step: 2e-3, ..dynamics::Settings::default() };
        let start = cloth.state(&mesh.coordinates());
        let mut motion = Motion::new(&cloth, &curves, start.clone(), &settings).unwrap();
        let explicit = dynamics::Settings { integrator: Integrator::RungeKutta, ..settings };
        assert!(Motion::new(&cloth, &curves, start, &explicit).is_err());
        for _ in 0..50 {
            assert_eq!(motion.step().status, dynamics::Status::Done, "{triangulation:?}");
        }
        // Implicit steps lose energy, and gain none.
        let energies = motion.energies();
        assert!(energies.numerical > 0.0, "{energies:?}");
        let end = (0..mesh.len()).filter(|&node| mesh.positions[node].x > LENGTH + 0.999 * cell);
        let drops: Vec<f64> = end.map(|node| -motion.positions()[3 * node + 2]).collect();
        drops.iter().sum::<f64>() / drops.len() as f64
    });
    println!("{ends:.5?}");
    assert!(ends[0] > 0.02 && (ends[1] / ends[0] - 1.0).abs() < 0.02, "{ends:?}");
}

/// Whatever the number of edges that rotate.
#[test]
fn a_sheet_stays_on_its_rails() {
    let along = Vector3::new(1.0, 0.7, 0.3).normalize();
    let curves = with_membrane("cotton-satin", [1e-5; 3]);
    for (triangulation, cells) in [
        (Triangulation::Uniform, [4, 3]),
        (Triangulation::Uniform, [5, 3]),
        (Triangulation::Alternating, [5, 4]),
        (Triangulation::Alternating, [10, 5]),
        (Triangulation::Irregular, [6, 5]),
    ] {
        let mesh = triangulation.mesh(cells, 0.01, 0.0);
        let right = mesh.positions.iter().map(|p| p.x).fold(0.0, f64::max);
        let guided: Vec<Guided> = (0..mesh.len())
            .filter(|&node| mesh.positions[node].x > 0.999 * right)
            .map(|node| Guided { node, free: Free::Line(along) })
            .collect();
        let held = [Held { node: 0, clip: None }];
        let cloth = Cloth::new(&Problem {
            areal_density: WEIGHT / 9.81,
            gravity: Vector3::new(0.0, 0.0, -9.81),
            held: &held,
            guided: &guided,
            ..Problem::new(&mesh, MODEL, &Component::ALL)
        })
        .unwrap();
        let mut x = cloth.state(&mesh.coordinates());
        let found = Solver::new(&cloth).solve(&curves, &mut x, &Settings::default());
        let off = guided.iter().map(|guided| {
            let moved = Vector3::from_column_slice(&x[3 * guided.node..3 * guided.node + 3]);
            let moved = moved - mesh.positions[guided.node];
            (moved - along * along.dot(&moved)).norm()
        });
        let off = off.fold(0.0, f64::max);
        println!("{triangulation:?}, {cells:?}: {} rotations, {off:.1e} m", cloth.points() - cloth.nodes());
        assert!(found.converged() && off < 1e-12, "{triangulation:?}, {cells:?}: {:?}, {off}", found.status);
    }
}
