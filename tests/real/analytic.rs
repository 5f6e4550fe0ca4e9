//! Closed-form reference values from files.
//!
//! ```text
//!  goal    element sums agree with independent references
//!  data    analytic/: an irregular 5×5 patch under an affine map into space; strips under uniaxial tension;
//!          rolled sheets of several meshes; catenaries
//!  passes  patch: inner forces 1e-12 N, border 1e-10 N, energy 1e-12; uniaxial 1e-8; rigidity 0.1 %;
//!          catenary: sag within 0.5 %
//! ```

use cloth_sim::bending::Hinge;
use cloth_sim::cloth::ForceScale;
use cloth_sim::element::{Element, gather, stacked};
use cloth_sim::equilibrium::{Settings, Solver};
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::{Diagonals, Mesh};
use cloth_sim::samples::{self, Sample, rolled};
use fit_cloth_tests::strip::strip;
use fit_cloth_tests::{data, rows};
use nalgebra::{Matrix3x2, Vector2, Vector3};

fn number(field: &str) -> f64 {
    field.parse().unwrap_or_else(|_| panic!("{field} is no number"))
}

/// Vertices and triangles of an OBJ file whose `v` and `vt` share indices.
fn patch_mesh() -> Mesh {
    let text = std::fs::read_to_string(data("analytic/patch_mesh.obj")).expect("a text file");
    let (mut positions, mut material, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["v", x, y, z] => positions.push(Vector3::new(number(x), number(y), number(z))),
            ["vt", u, v] => material.push(Vector2::new(number(u), number(v))),
            ["f", ..] => {
                let corner = |i: usize| number(words[i].split_once('/').expect("v/vt").0) as usize - 1;
                triangles.push([corner(1), corner(2), corner(3)]);
            }
            _ => panic!("{line}"),
        }
    }
    Mesh::new(positions, material, triangles).expect("a proper mesh")
}

#[test]
fn patch_forces() {
    // patch_setup.json: the map F, the stiffnesses, and the energies.
    let map = Matrix3x2::new(1.06, 0.03, -0.02, 1.02, 0.05, -0.04);
    let stiffnesses =
        [(Component::StretchWeft, 300.0), (Component::StretchWarp, 500.0), (Component::Shear, 40.0)];
    for (model, file, energy) in [
        (Model::STVK, "patch_forces_stvk_diag.csv", 0.007_168_772_000_000_03),
        (Model::SOFT_CONSTRAINT, "patch_forces_soft_constraint.csv", 0.006_792_768_503_089_8),
    ] {
        let curves = samples::linear_curves(model, &stiffnesses).unwrap();
        let mut sample = Sample::at_rest(patch_mesh(), model, curves);
        sample.hold(|p| (p.x == 0.0).then_some(0));
        let material = sample.mesh.material.clone();
        sample.start = material.iter().flat_map(|m| <[f64; 3]>::from(map * m)).collect();
        let cloth = sample.cloth().unwrap();
        let (mut gradient, mut scale) = (vec![0.0; sample.start.len()], ForceScale::new(cloth.points()));
        let found = cloth.gradient(&sample.curves, &sample.start, &mut gradient, &mut scale);
        assert!((found / energy - 1.0).abs() < 1e-12, "{model}: {found}");
        for row in rows(&format!("analytic/{file}")) {
            let vertex: usize = row[0].parse().unwrap();
            let inside = |c: f64| c > 1e-9 && c < 0.1 - 1e-9;
            let inner = inside(material[vertex].x) && inside(material[vertex].y);
            for i in 0..3 {
                // The file contains the force on the vertex, the negative gradient.
                let error = (gradient[3 * vertex + i] + number(&row[1 + i])).abs();
                assert!(error < if inner { 1e-12 } else { 1e-10 }, "{model}, {vertex}: {error:e}");
            }
        }
    }
}

#[test]
fn uniaxial_linear() {
    let rows = rows("analytic/uniaxial_linear.csv");
    assert_eq!(rows.len(), 24);
    for row in rows {
        let model = match row[0].as_str() {
            "stvk_diag" => Model::STVK,
            "soft_constraint" => Model::SOFT_CONSTRAINT,
            "spring_continuum" => Model::SPRINGS,
            other => panic!("{other}"),
        };
        let (mut sample, _) =
            samples::strip(model, Diagonals::Alternating, number(&row[1]), number(&row[2])).unwrap();
        let cloth = sample.cloth().unwrap();
        let mut solver = Solver::new(&cloth);
        let found = solver.solve(&sample.curves, &mut sample.start, &Settings::default());
        assert!(found.converged(), "{row:?}: {found:?}");
        let per_width = solver.clip_forces()[1].x / 0.04;
        assert!((per_width / number(&row[3]) - 1.0).abs() < 1e-8, "{row:?}: {per_width}");
    }
}

/// A mesh of copies of a cell, given by triangles; coincident vertices are merged.
fn tiled(cell: [f64; 2], counts: [usize; 2], triangles: &[[[f64; 2]; 3]]) -> Mesh {
    let (mut material, mut indices) = (Vec::<Vector2<f64>>::new(), Vec::new());
    for row in 0..counts[1] {
        for column in 0..counts[0] {
            for triangle in triangles {
                indices.push(triangle.map(|[x, y]| {
                    let p = Vector2::new((column as f64 + x) * cell[0], (row as f64 + y) * cell[1]);
                    let close = |q: &Vector2<f64>| (q - p).norm() < 1e-6 * cell[0];
                    material.iter().position(close).unwrap_or_else(|| {
                        material.push(p);
                        material.len() - 1
                    })
                }));
            }
        }
    }
    let positions = material.iter().map(|m| m.push(0.0)).collect();
    Mesh::new(positions, material, indices).expect("a proper mesh")
}

/// Effective rigidity over stiffness, from the hinges with edge midpoints in a window of whole cells.
fn rigidity(mesh: &Mesh, cell: [f64; 2], degrees: f64) -> f64 {
    let radius = 1e4 * cell[0];
    let place = |m: &Vector2<f64>| <[f64; 3]>::from(rolled(*m, degrees.to_radians(), radius));
    let x: Vec<f64> = mesh.material.iter().flat_map(place).collect();
    // Two cells from the border, and not along any edge.
    let inside = |c: f64, cell: f64| (1.987 * cell..5.987 * cell).contains(&c);
    let energy = |hinge: &Hinge| {
        let middle = 0.5 * (mesh.material[hinge.nodes[0]] + mesh.material[hinge.nodes[1]]);
        if !(inside(middle.x, cell[0]) && inside(middle.y, cell[1])) {
            return 0.0;
        }
        let [strain] = hinge.strains(&gather(stacked(hinge.nodes), &x));
        0.5 * strain * strain * Element::<4, 3, 1>::area(hinge)
    };
    let energy: f64 = Hinge::all(mesh).expect("no collapsed wing").iter().map(energy).sum();
    2.0 * energy * radius * radius / (16.0 * cell[0] * cell[1])
}

#[test]
fn hinge_effective_rigidity() {
    let [low, right, high, up, middle] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]];
    let cross = [[low, right, middle], [right, high, middle], [high, up, middle], [up, low, middle]];
    let grid = [[low, right, high], [low, high, up]];
    // Four cells of the grid, with diagonals like a chessboard.
    let [south, east, north, west] = [[0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5]];
    let alternating = [
        [low, south, middle],
        [low, middle, west],
        [south, right, middle],
        [right, east, middle],
        [middle, east, high],
        [middle, high, north],
        [west, middle, up],
        [middle, north, up],
    ];
    // Two rows of equilateral triangles; the cell has the width of one and the height of two.
    let beside = |[x, y]: [f64; 2]| [x + 1.0, y];
    let lattice = [
        [low, right, middle],
        [right, beside(middle), middle],
        [middle, beside(middle), high],
        [middle, high, up],
    ];
    let meshes = [
        ("diag_grid", [0.01, 0.01], &grid[..]),
        ("alternating_grid", [0.02, 0.02], &alternating[..]),
        ("cross_grid", [0.01, 0.01], &cross[..]),
        ("equilateral", [0.01, 0.01 * 3f64.sqrt()], &lattice[..]),
    ];
    let meshes = meshes.map(|(name, cell, triangles)| (name, cell, tiled(cell, [8, 8], triangles)));
    let rows = rows("analytic/hinge_effective_rigidity.csv");
    assert_eq!(rows.len(), 24);
    for row in rows {
        let (_, cell, mesh) = meshes.iter().find(|(name, ..)| *name == row[0]).unwrap();
        let (found, expected) = (rigidity(mesh, *cell, number(&row[1])), number(&row[3]));
        assert!((found / expected - 1.0).abs() < 1e-3, "{row:?}: {found}");
    }
}

#[test]
fn catenary() {
    let columns: Vec<f64> = (0..=100).map(|i| f64::from(i) / 100.0).collect();
    let weight = samples::AREAL_DENSITY * 9.8;
    for row in rows("analytic/catenary_inextensible.csv") {
        let [span, sag] = [number(&row[0]), number(&row[1])];
        let stretch = [
            (Component::StretchWeft, 1e4 * weight),
            (Component::StretchWarp, 1e3 * weight),
            (Component::Shear, 1e3 * weight),
        ];
        let curves = samples::linear_curves(Model::STVK, &stretch).unwrap();
        let mut sample = Sample::at_rest(strip(&columns, 0.02, 3), Model::STVK, curves);
        sample.gravity = Vector3::new(0.0, 0.0, -9.8);
        sample.hold(|p| if p.x == 0.0 { Some(0) } else { (p.x > 0.9999).then_some(1) });
        sample.place(|p| Vector3::new(span * p.x, p.y, -4.0 * sag * p.x * (1.0 - p.x)));
        let cloth = sample.cloth().unwrap();
        let found = Solver::new(&cloth).solve(
            &sample.curves,
            &mut sample.start,
            &Settings { max_iterations: 2000, ..Settings::default() },
        );
        assert!(found.converged(), "span {span}: {found:?}");
        let off = -sample.start[3 * (50 * 3 + 1) + 2] / sag - 1.0;
        println!("catenary, span {span}: sag {:+.3} %, {} iterations", 100.0 * off, found.iterations);
        assert!(off.abs() < 0.005, "span {span}: {off}");
    }
}
