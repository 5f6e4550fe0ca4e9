//! Hinges and bending springs: the angle, and the flexural rigidity of a sheet rolled to a cylinder.
//!
//! ```text
//!    ╭──╮     goal    angle exact at 0 and near ±π; energy per area = ½ D κ², D the effective rigidity
//!   ╱ ↑κ ╲    sheet   a grid rolled at several angles to the weft, radius 10⁴ cells, inner hinges only
//!             passes  1e-14 rad; D/k = 3, 9, 3 on '/' grids, 3, 3.75, 4.5 on alternating ones, to 0.1 %
//! ```

use cloth_sim::bending::{Bending, Hinge};
use cloth_sim::cloth::{Cloth, Problem};
use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use cloth_sim::element::{Element, Point, gather, stacked};
use cloth_sim::equilibrium::{Settings, Solver};
use cloth_sim::load::Held;
use cloth_sim::material::{Component, Compression, Curves, Model};
use cloth_sim::membrane::{Spring, ring_two};
use cloth_sim::mesh::{Diagonals, Mesh};
use cloth_sim::samples::{self, SIDE, rolled};
use cloth_sim::strain_measure::HINGE_STRAIN_PER_CURVATURE;
use nalgebra::Vector3;
use std::f64::consts::PI;

#[test]
fn the_angle_is_exact_when_flat_and_when_folded_flat() {
    let hinge = Hinge {
        nodes: [0, 1, 2, 3],
        rest_angle: 0.0,
        rest_length: 1.0,
        width: 1.0,
        component: Component::BendWeft,
    };
    let angle = |sin: f64, cos: f64| {
        let (a, b) = (3e-3, 5e-3);
        let x =
            [[0.0, 0.0, 0.0], [4e-3, 0.0, 0.0], [1e-3, a, 0.0], [2e-3, -b * cos, b * sin]].map(Point::from);
        hinge.strains(&x)[0]
    };
    assert_eq!(angle(0.0, 1.0), 0.0);
    for small in [1e-200, 1e-12, 1e-8, 1e-3] {
        for sign in [1.0, -1.0] {
            let found = angle(sign * f64::sin(small), f64::cos(small));
            assert!((found.abs() - small).abs() <= 1e-14 * small.max(1e-8), "{small:e}: {found:e}");
            let folded = angle(sign * f64::sin(small), -f64::cos(small));
            assert!((folded.abs() - (PI - small)).abs() <= 1e-14, "{small:e}: {folded}");
            // Bent up and bent down have opposite signs; folded flat, rounding decides.
            let up = angle(1.0, 0.0).signum();
            assert_eq!(found.signum(), sign * up, "{small:e}: {found:e}");
            assert!(small < 1e-15 || folded.signum() == sign * up, "{small:e}: {folded}");
        }
    }
}

#[test]
fn the_difference_to_the_rest_angle_takes_the_shorter_way_round() {
    let mut hinge = Hinge {
        nodes: [0, 1, 2, 3],
        rest_angle: 3.0,
        rest_length: 1.0,
        width: 1.0,
        component: Component::BendWeft,
    };
    let x = |angle: f64| {
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.5, -angle.cos(), angle.sin()]].map(Point::from)
    };
    let sign = hinge.strains(&x(0.1))[0] + 3.0;
    hinge.rest_angle *= sign.signum();
    let turn = hinge.strains(&x(-3.0))[0];
    assert!((turn.abs() - (2.0 * PI - 6.0)).abs() < 1e-14, "{turn}");
}

/// Effective rigidity over the stiffness of the hinges whose edges lie in the window [¼, ¾) of the sheet.
fn rigidity(mesh: &Mesh, degrees: f64) -> f64 {
    let radius = 1e4 * SIDE / 16.0;
    let x: Vec<f64> = mesh
        .material
        .iter()
        .flat_map(|&m| <[f64; 3]>::from(rolled(m, degrees.to_radians(), radius)))
        .collect();
    let inside = |c: f64| (0.2499 * SIDE..0.7499 * SIDE).contains(&c);
    let energy: f64 = Hinge::all(mesh)
        .expect("no wing has collapsed")
        .iter()
        .filter(|hinge| {
            let middle = 0.5 * (mesh.material[hinge.nodes[0]] + mesh.material[hinge.nodes[1]]);
            inside(middle.x) && inside(middle.y)
        })
        .map(|hinge| {
            let [strain] = hinge.strains(&gather(stacked(hinge.nodes), &x));
            0.5 * strain * strain * hinge.area_of()
        })
        .sum();
    2.0 * energy * radius * radius / (0.25 * SIDE * SIDE)
}

/// `Element::area` without the turbofish.
trait Area {
    fn area_of(&self) -> f64;
}

impl Area for Hinge {
    fn area_of(&self) -> f64 {
        Element::<4, 3, 1>::area(self)
    }
}

#[test]
fn a_rolled_grid_has_its_mesh_factor() {
    for (diagonals, expected) in [
        (Diagonals::Forward, vec![(0.0, 3.0), (90.0, 3.0), (45.0, 9.0), (135.0, 3.0), (22.5, 6.6213)]),
        (Diagonals::Backward, vec![(0.0, 3.0), (90.0, 3.0), (45.0, 3.0), (135.0, 9.0)]),
        (Diagonals::Alternating, vec![(0.0, 3.0), (22.5, 3.75), (45.0, 4.5), (90.0, 3.0), (135.0, 4.5)]),
    ] {
        let mesh = samples::square(17, diagonals).unwrap();
        for (degrees, expected) in expected {
            let found = rigidity(&mesh, degrees);
            assert!((found / expected - 1.0).abs() < 1e-3, "{diagonals:?}, {degrees}°: {found}");
        }
    }
}

#[test]
fn hinges_are_classed_by_the_yarn_that_they_bend() {
    let mesh = samples::square(3, Diagonals::Forward).unwrap();
    let count = |hinges: &[Hinge], component| hinges.iter().filter(|h| h.component == component).count();
    let hinges = Hinge::all(&mesh).unwrap();
    let classes = [Component::BendWeft, Component::BendWarp, Component::BendDiagonal];
    assert_eq!(classes.map(|component| count(&hinges, component)), [2, 2, 4]);
    // An edge along warp bends weft: its wings are to the left and right.
    let weft = hinges.iter().find(|h| h.component == Component::BendWeft).unwrap();
    let [from, to] = [weft.nodes[0], weft.nodes[1]].map(|node| mesh.material[node]);
    assert!((from.x - to.x).abs() < 1e-15);
    let bias = samples::cut_on_the_bias(mesh, PI / 4.0);
    let hinges = Hinge::all(&bias).unwrap();
    // '/' rotated by 45° runs along warp, and the cell sides along neither yarn.
    assert_eq!(classes.map(|component| count(&hinges, component)), [4, 0, 4]);
}

/// Ring-2 springs shorten by κ²l²/24 over a chord l: no stiffness when flat, and energy grows with the fourth power.
#[test]
fn bending_springs_have_the_energy_of_the_chord() {
    let mesh = samples::square(9, Diagonals::Forward).unwrap();
    let springs = ring_two(&mesh, &[Component::BendWeft]).unwrap();
    assert_eq!(springs.len(), 7 * 9);
    let area: f64 = springs.iter().map(|spring| spring.area).sum();
    let chord = 2.0 * SIDE / 8.0;
    assert!((area - (SIDE - 0.5 * chord) * SIDE).abs() < 1e-15);
    let energy = |radius: f64| -> f64 {
        let x: Vec<f64> =
            mesh.material.iter().flat_map(|&m| <[f64; 3]>::from(rolled(m, 0.0, radius))).collect();
        let strain =
            |spring: &Spring| Element::<2, 3, 1>::strains(spring, &gather(stacked(spring.nodes), &x))[0];
        springs.iter().map(|spring| 0.5 * strain(spring).powi(2) * spring.area).sum()
    };
    let radius = 20.0 * chord;
    let strain = chord * chord / (24.0 * radius * radius);
    assert!((energy(radius) / (0.5 * strain * strain * area) - 1.0).abs() < 1e-3);
    assert!((energy(radius) / energy(2.0 * radius) - 16.0).abs() < 0.02);
}

/// Segments keep their length, each rotated by κh against the previous one: the moment per width is the derivative of
/// the energy per area. This holds for hinges, where a roll bends those along it, and for ring-2 springs.
#[test]
fn a_rolled_sheet_has_the_moment_that_its_elements_say() {
    let mesh = samples::square(9, Diagonals::Forward).unwrap();
    let segment = SIDE / 8.0;
    for model in [Model::STVK, Model::SPRINGS] {
        let bending = Bending::new(model, &mesh, &[Component::BendWeft], &vec![false; mesh.len()], false)
            .unwrap()
            .unwrap();
        let way = bending.rolled(Component::BendWeft).unwrap();
        assert!(bending.rolled(Component::BendWarp).is_none());
        let curve =
            StiffnessCurve::new(vec![0.0, 1e-3, 2e-3], vec![3.0, 4.0, 6.0], NegativeStrain::Odd).unwrap();
        // Energy per bent area: a hinge represents the adjacent cells, a spring its own cloth.
        let energy = |curvature: f64| -> f64 {
            let mut line = vec![Vector3::zeros()];
            for i in 0..8 {
                let angle = curvature * segment * f64::from(i);
                line.push(line[line.len() - 1] + Vector3::new(angle.cos(), 0.0, angle.sin()) * segment);
            }
            let place = |node: usize| line[node % 9] + Vector3::new(0.0, mesh.positions[node].y, 0.0);
            let x: Vec<f64> = (0..mesh.len()).flat_map(|node| <[f64; 3]>::from(place(node))).collect();
            match &bending {
                Bending::Springs(springs) => {
                    let area: f64 = springs.iter().map(|spring| spring.area).sum();
                    let strain = |spring: &Spring| {
                        Element::<2, 3, 1>::strains(spring, &gather(stacked(spring.nodes), &x))[0]
                    };
                    springs.iter().map(|spring| curve.energy(strain(spring)) * spring.area).sum::<f64>()
                        / area
                }
                Bending::DiscreteShells(hinges) => {
                    let area = hinges.len() as f64 * segment * segment;
                    let strain = |hinge: &Hinge| hinge.strains(&gather(stacked(hinge.nodes), &x))[0];
                    hinges.iter().map(|hinge| curve.energy(strain(hinge)) * hinge.area()).sum::<f64>() / area
                }
                _ => unreachable!("neither model bends as a sheet"),
            }
        };
        // Curvatures whose strains lie within the curve.
        for strain in [4e-4, 1.5e-3] {
            let curvature = way.curvature(strain);
            assert!((way.strain(curvature) / strain - 1.0).abs() < 1e-12);
            let h = 1e-4 * curvature;
            let slope = (energy(curvature + h) - energy(curvature - h)) / (2.0 * h);
            let moment = way.lever(curvature) * curve.stress(strain);
            assert!((moment / slope - 1.0).abs() < 1e-6, "{model} {strain}: {moment:e} {slope:e}");
        }
    }
}

/// Droop of the tip's two corners, m, of a square hung off an edge, Γ = 10, on 25×25 nodes; equal bending components.
fn tips(diagonals: Diagonals, as_cylinder: bool) -> [f64; 2] {
    let (density, overhang) = (0.2, 0.085);
    let rigidity = density * samples::GRAVITY * overhang * overhang * overhang / 10.0;
    let mesh = samples::square(25, diagonals).expect("a proper square");
    let lines: Vec<Vec<usize>> =
        (0..25).map(|column| (0..25).map(|row| row * 25 + column).collect()).collect();
    // The sheet bends from the middle between its fourth and fifth lines on, 85 mm from its tip.
    let (held, free) = lines.split_at(5);
    let held: Vec<Held> = held.iter().flatten().map(|&node| Held { node, clip: None }).collect();
    let curve = |component: Component| {
        let stiffness = match component {
            Component::StretchWeft | Component::StretchWarp => 2000.0,
            Component::Shear => 200.0,
            _ => rigidity / HINGE_STRAIN_PER_CURVATURE,
        };
        let negative = Model::STVK.negative_strain(component, Compression::ZeroStrain);
        (component, StiffnessCurve::constant(stiffness, negative).expect("a proper curve"))
    };
    let curves: Curves = Component::ALL.into_iter().map(curve).collect();
    let cloth = Cloth::new(&Problem {
        areal_density: density,
        gravity: Vector3::new(0.0, 0.0, -samples::GRAVITY),
        held: &held,
        tied: if as_cylinder { free } else { &[] },
        ..Problem::new(&mesh, Model::STVK, &Component::ALL)
    })
    .expect("a sheet that is held");
    let mut x = mesh.coordinates();
    let found = Solver::new(&cloth).solve(&curves, &mut x, &Settings::default());
    assert!(found.converged(), "{}", found.status);
    [24, 624].map(|corner| -x[3 * corner + 2])
}

/// Hinges couple bending to twist: with a single diagonal direction a sheet twists; with alternating diagonals every
/// other node yields and it hangs lower. Tied lines remove both effects, and the split of the cells no longer matters.
#[test]
fn a_sheet_that_bends_as_a_cylinder_knows_no_diagonals() {
    let [forward, alternating, cylinder, other] = [
        (Diagonals::Forward, false),
        (Diagonals::Alternating, false),
        (Diagonals::Forward, true),
        (Diagonals::Alternating, true),
    ]
    .map(|(diagonals, tied)| tips(diagonals, tied));
    println!(
        "droop of the tip's corners, m: '/' {forward:.4?}, alternating {alternating:.4?}, as a cylinder {cylinder:.4?}"
    );
    assert!((forward[0] - forward[1]).abs() > 2e-3);
    assert!((alternating[0] - alternating[1]).abs() < 1e-4 && alternating[0] > cylinder[0] + 1e-3);
    assert!((0..2).all(|corner| (cylinder[corner] - other[corner]).abs() < 1e-9));
    assert!((cylinder[0] - cylinder[1]).abs() < 1e-9);
}
