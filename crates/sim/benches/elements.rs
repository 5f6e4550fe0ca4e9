//! Cost of one element: `cargo bench -p cloth-sim --bench elements`.
//!
//! Measures strains and forces, and the Jacobian blocks, of an element at a given stress and tangent: the operations
//! counted by Strohkorb 2019. The curve is measured separately. Times are in ns, the fastest of several runs over
//! 10 000 elements. `tests/operations.sh` counts the arithmetic of the compiled functions `…_force` and `…_jacobian`.
#![allow(clippy::print_stdout)]

use cloth_sim::bending::{Hinge, Sheet, SheetTriangle};
use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use cloth_sim::element::{Block, Element, Point, complete};
use cloth_sim::error::Result;
use cloth_sim::material::Component;
use cloth_sim::membrane::{SoftTriangle, Spring, StvkTriangle, Triangle};
use cloth_sim::mesh::Diagonals;
use cloth_sim::samples;
use std::hint::black_box;
use std::time::Instant;

const ELEMENTS: usize = 10_000;

/// Strains and nodal forces, N.
#[inline(always)]
fn force<const K: usize, const S: usize, E: Element<K, 3, S>>(
    element: &E,
    x: &[Point<3>; K],
    stress: &[f64; S],
) -> ([f64; S], [Point<3>; K]) {
    let (strains, gradients) = element.evaluate(x);
    let mut force = [Point::<3>::zeros(); K];
    for a in 0..K {
        force[a] = gradients[0][a] * (element.area() * stress[0]);
        for c in 1..S {
            force[a] += gradients[c][a] * (element.area() * stress[c]);
        }
    }
    (strains, force)
}

/// Jacobian blocks, N/m, without mirror images.
#[inline(always)]
fn jacobian<const K: usize, const S: usize, E: Element<K, 3, S>>(
    element: &E,
    x: &[Point<3>; K],
    stress: &[f64; S],
    tangent: &[f64; S],
    blocks: &mut [[Block<3>; K]; K],
) -> [f64; S] {
    let (strains, gradients) = element.evaluate(x);
    for a in 1..K {
        let scaled: [Point<3>; S] = std::array::from_fn(|c| gradients[c][a] * tangent[c]);
        for b in 1..=a {
            let mut block = scaled[0] * gradients[0][b].transpose();
            for c in 1..S {
                block += scaled[c] * gradients[c][b].transpose();
            }
            blocks[a][b] = block;
        }
    }
    element.add_geometric(x, stress, blocks);
    complete(blocks, E::TRANSLATED);
    strains
}

/// Functions whose arithmetic is counted, under one name each in the compiled program.
macro_rules! counted {
    ($force:ident, $jacobian:ident, $element:ty, $nodes:literal, $strains:literal) => {
        #[inline(never)]
        fn $force(
            e: &$element,
            x: &[Point<3>; $nodes],
            s: &[f64; $strains],
        ) -> ([f64; $strains], [Point<3>; $nodes]) {
            force(e, x, s)
        }
        #[inline(never)]
        fn $jacobian(
            e: &$element,
            x: &[Point<3>; $nodes],
            s: &[f64; $strains],
            t: &[f64; $strains],
            blocks: &mut [[Block<3>; $nodes]; $nodes],
        ) -> [f64; $strains] {
            jacobian(e, x, s, t, blocks)
        }
    };
}

counted!(spring_force, spring_jacobian, Spring, 2, 1);
counted!(soft_constraint_force, soft_constraint_jacobian, SoftTriangle, 3, 3);
counted!(stvk_force, stvk_jacobian, StvkTriangle, 3, 3);
counted!(hinge_force, hinge_jacobian, Hinge, 4, 1);
counted!(sheet_force, sheet_jacobian, SheetTriangle, 7, 4);

/// Nanoseconds per call, the fastest of several runs.
fn nanoseconds(mut call: impl FnMut(usize)) -> f64 {
    let run = |_| {
        let start = Instant::now();
        (0..ELEMENTS).for_each(&mut call);
        1e9 * start.elapsed().as_secs_f64() / ELEMENTS as f64
    };
    (0..200).map(run).fold(f64::MAX, f64::min)
}

/// Distinct states of an element.
fn states<const K: usize>(rest: [Point<3>; K]) -> Vec<[Point<3>; K]> {
    let moved = |index: usize| {
        let mut state = rest;
        for (node, point) in state.iter_mut().enumerate() {
            (0..3).for_each(|i| point[i] += 1e-4 * ((index * 12 + node * 3 + i) as f64 * 0.7).sin());
        }
        state
    };
    (0..ELEMENTS).map(moved).collect()
}

macro_rules! row {
    ($name:literal, $force:ident, $jacobian:ident, $element:expr, $mesh:expr, $nodes:literal, $strains:literal) => {
        let element = $element;
        let coordinates = Element::<$nodes, 3, $strains>::coordinates(&element);
        // A rotation has no place at rest.
        let place = |own: [usize; 3]| $mesh.positions.get(own[0] / 3).copied().unwrap_or_default();
        let states = states(coordinates.map(place));
        let (stress, tangent) = (black_box([3.0; $strains]), black_box([300.0; $strains]));
        let force = nanoseconds(|i| {
            black_box($force(&element, &states[i], &stress));
        });
        let mut blocks = [[Block::<3>::zeros(); $nodes]; $nodes];
        let jacobian = nanoseconds(|i| {
            $jacobian(&element, &states[i], &stress, &tangent, &mut blocks);
            black_box(&blocks);
        });
        println!("{:<18}{force:>10.1}{jacobian:>12.1}", $name);
    };
}

fn main() -> Result<()> {
    let mesh = samples::square(5, Diagonals::Alternating)?;
    let components = [Component::StretchWeft];
    println!("{:<18}{:>10}{:>12}", "element, ns", "force", "Jacobian");
    row!(
        "spring",
        spring_force,
        spring_jacobian,
        cloth_sim::membrane::ring_one(&mesh, &components)?[0],
        mesh,
        2,
        1
    );
    let triangle = Triangle::new(&mesh, 0);
    row!(
        "soft constraint",
        soft_constraint_force,
        soft_constraint_jacobian,
        SoftTriangle(triangle),
        mesh,
        3,
        3
    );
    row!("StVK", stvk_force, stvk_jacobian, StvkTriangle(triangle), mesh, 3, 3);
    row!("hinge", hinge_force, hinge_jacobian, Hinge::all(&mesh)?[7], mesh, 4, 1);
    let mesh = samples::square(5, Diagonals::Forward)?;
    let triangle = Sheet::new(&mesh, &vec![false; mesh.len()], true)?.triangles[12];
    row!("sheet", sheet_force, sheet_jacobian, triangle, mesh, 7, 4);
    println!("\n{:<18}{:>10}", "curve, ns", "stress");
    for points in [1, 5, 201] {
        let strains: Vec<f64> = (0..points).map(|i| 0.1 * i as f64 / (points - 1).max(1) as f64).collect();
        let curve = StiffnessCurve::new(strains, vec![300.0; points], NegativeStrain::Odd)?;
        let stress = nanoseconds(|i| {
            black_box(curve.response(black_box(1e-5 * i as f64)));
        });
        println!("{:<18}{stress:>10.1}", format!("{points} points"));
    }
    Ok(())
}
