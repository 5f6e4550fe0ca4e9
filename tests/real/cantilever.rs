//! Source: the master curve of a heavy cantilever, by collocation (cantilever_master_curve/).
//!
//! Goal: the elastica used in the bending tests is exact.
//!
//! ```text
//!   ▒▒▒▒▒▒▒▒────╮        Γ = ρ g L³/D from 1e-3 to 1e4 on the curve, 0.1 to 1000 in the shapes
//!   ▒▒▒▒▒▒▒▒     ╲  H
//!             W   ╲
//! ```
//!
//! Parameters: tip and clamp within 1e-5 of their values, shapes within 1e-5 of the length. The cloth, 36 cells along
//! a strip of 90 mm × 30 mm: H/W within 2 %, at Γ = 100 within 3 %.

use cloth_sim::equilibrium::{Settings, Solver};
use cloth_sim::material::Model;
use cloth_sim::samples::{self, Sample};
use fit_cloth_tests::elastica::Elastica;
use fit_cloth_tests::rows;
use fit_cloth_tests::strip::{beam, rolled, strip};
use nalgebra::Vector3;
use std::collections::BTreeMap;

const ALLOWED: f64 = 1e-5;

fn numbers(name: &str) -> Vec<Vec<f64>> {
    let number = |field: &String| field.parse().expect("numbers, as its README describes");
    rows(name).iter().map(|row| row.iter().map(number).collect()).collect()
}

fn solve(gamma: f64) -> Elastica {
    Elastica::solve(1.0, gamma, &|curvature| curvature)
}

#[test]
fn tips_lie_on_the_master_curve() {
    let mut worst = 0.0f64;
    let rows = numbers("cantilever_master_curve/master_curve.csv");
    assert!(rows.len() > 100);
    for row in rows {
        let [gamma, height, width, ratio, angle, curvature] = row[..] else { panic!("{row:?}") };
        let shape = solve(gamma);
        let (tip, clamp) = (shape.tip(), shape.at(0.0));
        for (found, expected) in [
            (tip.below, height),
            (tip.outward, width),
            (tip.below / tip.outward, ratio),
            (tip.slope, angle),
            (clamp.curvature, curvature),
        ] {
            worst = worst.max((found / expected - 1.0).abs());
            assert!((found / expected - 1.0).abs() <= ALLOWED, "Γ = {gamma}: {found}, not {expected}");
        }
    }
    println!("master curve: within {worst:.1e}");
}

#[test]
fn shapes_are_met_all_along() {
    let mut worst = 0.0f64;
    let mut shapes: BTreeMap<u64, Elastica> = BTreeMap::new();
    for row in numbers("cantilever_master_curve/shapes.csv") {
        let [gamma, s, outward, height, slope, curvature] = row[..] else { panic!("{row:?}") };
        let place = shapes.entry(gamma.to_bits()).or_insert_with(|| solve(gamma)).at(s);
        let scale = 1.0 + gamma.sqrt();
        for off in [place.outward - outward, place.below + height, place.slope - slope] {
            worst = worst.max(off.abs());
        }
        worst = worst.max((place.curvature - curvature).abs() / scale);
        assert!(worst <= ALLOWED, "Γ = {gamma}, s = {s}: {worst:.1e}");
    }
    assert_eq!(shapes.len(), 7);
    println!("shapes: within {worst:.1e}");
}

#[test]
fn cloth_bends_along_the_master_curve() {
    let (length, density, gravity) = (0.09, 0.1, 9.8);
    let rows = numbers("cantilever_master_curve/master_curve.csv");
    for (gamma, allowed) in [(0.1, 0.02), (1.0, 0.02), (10.0, 0.02), (100.0, 0.03)] {
        let row = rows.iter().find(|row| (row[0] / gamma - 1.0).abs() < 1e-6).expect("a row of the curve");
        let weight = density * gravity * length;
        let stiffness = weight * length * length / gamma / 3.0;
        let curves = samples::fabric(Model::STVK, [1000.0 * weight, 500.0 * weight, stiffness]).unwrap();
        let mut sample = Sample::at_rest(strip(&beam(length, 36), 0.03, 13), Model::STVK, curves);
        sample.areal_density = density;
        sample.gravity = Vector3::new(0.0, 0.0, -gravity);
        sample.hold(|p| (p.x <= 0.0).then_some(0));
        let cloth = rolled(&sample, 13);
        let found = Solver::new(&cloth).solve(&sample.curves, &mut sample.start, &Settings::default());
        assert!(found.converged(), "Γ = {gamma}: {found:?}");
        // The tip: the middle of the last column.
        let tip = &sample.start[3 * (sample.mesh.len() - 7)..];
        let off = -tip[2] / tip[0] / row[3] - 1.0;
        println!("cantilever of cloth, Γ = {gamma}: H/W {:+.2} %", 100.0 * off);
        assert!(off.abs() <= allowed, "Γ = {gamma}: {off}");
    }
}
