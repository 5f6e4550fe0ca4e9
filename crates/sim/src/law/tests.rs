//! A law with coupled strains, through the same sums as the curves.
//!
//! ```text
//! W = Σ_c W_c(ε_c) + p₀ ε₀ ε₁ + ½ p₁ ε₀² ε₂²        p a pair per element, as a history would be
//! goal    gradient = dE/dx, Hessian = d(gradient)/dx, columns = d(gradient)/dp
//! passes  1e-7 relative; curves alone give what they gave
//! ```

use super::*;
use crate::curve::{NegativeStrain, StiffnessCurve};
use crate::element::{
    EnergyPass, GradientPass, HessianKind, HessianPass, ParameterPass, Pass, lower_entries,
};
use crate::finite_difference::derivative_error;
use crate::membrane::{StvkTriangle, Triangle};
use crate::mesh::{Diagonals, Grid};

struct Coupled {
    curves: Curves,
    /// Parameter pair of each element, N/m.
    p: Vec<[f64; 2]>,
}

impl Law for Coupled {
    const COUPLED: bool = true;
    type Parameters = ();

    fn has(&self, component: Component) -> bool {
        self.curves.has(component)
    }

    fn energy<const S: usize>(&self, site: &Site<S>, e: &[f64; S]) -> f64 {
        let [p, q] = self.p[site.element];
        self.curves.energy(site, e) + p * e[0] * e[1] + 0.5 * q * (e[0] * e[2]).powi(2)
    }

    fn stresses<const S: usize>(&self, site: &Site<S>, e: &[f64; S]) -> Stresses<S> {
        let [p, q] = self.p[site.element];
        let mut stresses = self.curves.stresses(site, e);
        stresses.stress[0] += p * e[1] + q * e[0] * e[2] * e[2];
        stresses.stress[1] += p * e[0];
        stresses.stress[2] += q * e[0] * e[0] * e[2];
        let tangents =
            [(0, 0, q * e[2] * e[2]), (0, 1, p), (0, 2, 2.0 * q * e[0] * e[2]), (2, 2, q * e[0] * e[0])];
        for (c, d, value) in tangents {
            stresses.tangent[c][d] += value;
            if c != d {
                stresses.tangent[d][c] += value;
            }
        }
        stresses
    }

    fn clamp<const S: usize>(_: &mut [[f64; S]; S]) {}

    fn depends<const S: usize>(&self, _: &Site<S>, _: usize, (): ()) -> bool {
        true
    }

    fn derivative<const S: usize>(
        &self,
        _: &Site<S>,
        e: &[f64; S],
        c: usize,
        (): (),
        derivative: &mut [f64],
    ) {
        derivative[0] = [e[1], e[0], 0.0][c];
        derivative[1] = [e[0] * e[2] * e[2], 0.0, e[0] * e[0] * e[2]][c];
    }
}

fn curves() -> Curves {
    let curve = |k: f64| StiffnessCurve::new(vec![0.0, 0.1], vec![k, 3.0 * k], NegativeStrain::Odd).unwrap();
    Component::ALL[..3].iter().zip([100.0, 50.0, 10.0]).map(|(&component, k)| (component, curve(k))).collect()
}

/// Two triangles, stretched, sheared and folded.
fn elements() -> (Vec<StvkTriangle>, Vec<f64>) {
    let grid = Grid { columns: 2, rows: 2, width: 0.02, height: 0.03, diagonals: Diagonals::Forward };
    let mesh = grid.mesh().unwrap();
    let elements = (0..2).map(|triangle| StvkTriangle(Triangle::new(&mesh, triangle))).collect();
    let place =
        |p: &nalgebra::Vector3<f64>| [1.06 * p.x + 0.1 * p.y, 1.04 * p.y, 4.0 * p.x * p.y + 0.02 * p.x];
    (elements, mesh.positions.iter().flat_map(place).collect())
}

fn energy(law: &impl Law, elements: &[StvkTriangle], x: &[f64]) -> f64 {
    let mut pass = EnergyPass { law, x, energy: 0.0 };
    pass.visit::<3, 3, 3, _>(0, elements);
    pass.energy
}

fn gradient(law: &impl Law, elements: &[StvkTriangle], x: &[f64]) -> Vec<f64> {
    let (mut gradient, mut magnitude, mut stiffness) = (vec![0.0; x.len()], vec![0.0; 4], vec![0.0; 4]);
    let mut pass = GradientPass {
        law,
        x,
        gradient: &mut gradient,
        magnitude: &mut magnitude,
        stiffness: &mut stiffness,
        energy: 0.0,
    };
    pass.visit::<3, 3, 3, _>(0, elements);
    assert_eq!(pass.energy.to_bits(), energy(law, elements, x).to_bits());
    gradient
}

/// The full Hessian, row by row.
fn hessian(law: &impl Law, elements: &[StvkTriangle], x: &[f64]) -> Vec<f64> {
    let n = x.len();
    let entries = lower_entries(3, 3);
    let targets: Vec<u32> = (0..(entries.len() * elements.len()) as u32).collect();
    let mut values = vec![0.0; targets.len()];
    let targets = [&targets[..], &[][..]];
    HessianPass { law, x, kind: HessianKind::Full, targets, values: &mut values }
        .visit::<3, 3, 3, _>(0, elements);
    let mut hessian = vec![0.0; n * n];
    for (element, values) in elements.iter().zip(values.chunks(entries.len())) {
        let place = |(node, i): (usize, usize)| 3 * element.0.nodes[node] + i;
        for (pair, value) in entries.iter().zip(values) {
            let [row, column] = pair.map(place);
            hessian[row * n + column] += value;
            if row != column {
                hessian[column * n + row] += value;
            }
        }
    }
    hessian
}

#[test]
fn a_coupled_law_has_the_derivatives_of_its_energy() {
    let (elements, x) = elements();
    let law = Coupled { curves: curves(), p: vec![[20.0, 3e4], [-15.0, 1e4]] };
    let error = derivative_error(
        |x| vec![energy(&law, &elements, x)],
        &gradient(&law, &elements, &x),
        &x,
        1e-6,
        1e-9,
    );
    assert!(error < 1e-7, "gradient {error:.1e}");
    let error =
        derivative_error(|x| gradient(&law, &elements, x), &hessian(&law, &elements, &x), &x, 1e-6, 1e-9);
    assert!(error < 1e-7, "Hessian {error:.1e}");
    // The coupling is not negligible here.
    let alone = hessian(&law.curves, &elements, &x);
    let apart =
        hessian(&law, &elements, &x).iter().zip(&alone).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart > 0.05 * alone.iter().copied().fold(0.0, f64::max), "{apart}");
}

#[test]
fn a_law_may_have_any_parameters() {
    let (elements, x) = elements();
    let with = |p: &[f64]| Coupled { curves: curves(), p: vec![[p[0], p[1]]; 2] };
    let p = [20.0, 3e4];
    let (mut derivative, mut columns) = ([0.0; 2], vec![0.0; 2 * x.len()]);
    let law = with(&p);
    ParameterPass { law: &law, x: &x, parameters: (), derivative: &mut derivative, columns: &mut columns }
        .visit::<3, 3, 3, _>(0, &elements);
    // Row by row over the coordinates.
    let rows: Vec<f64> = (0..x.len()).flat_map(|i| [columns[i], columns[x.len() + i]]).collect();
    let error = derivative_error(|p| gradient(&with(p), &elements, &x), &rows, &p, 1e-2, 1e-12);
    assert!(error < 1e-7, "{error:.1e}");
}

#[test]
fn a_law_that_couples_nothing_is_the_curves() {
    let (elements, x) = elements();
    let law = Coupled { curves: curves(), p: vec![[0.0; 2]; 2] };
    assert_eq!(gradient(&law, &elements, &x), gradient(&law.curves, &elements, &x));
    let (full, diagonal) = (hessian(&law, &elements, &x), hessian(&law.curves, &elements, &x));
    let largest = diagonal.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
    full.iter().zip(&diagonal).for_each(|(a, b)| assert!((a - b).abs() < 1e-14 * largest));
}
