//! Several unknown curves in one fit: weft and warp from both strips at once.
//!
//! ```text
//! strip along weft ──▶ forces ┐
//!                             ├──▶ (k weft, k warp) together, each strip under both
//! strip along warp ──▶ forces ┘
//! ```
//!
//! Both curves come back within 1 % without noise; the Jacobian is the derivative of the residuals, to 1e-5.

use cloth_data::frame::Kind;
use cloth_data::rig::{KnownFabric, Rig};
use cloth_fit::equilibria::{Equilibria, Objective, SolveStart, Task, Unknown, Unknowns};
use cloth_fit::optimise::gauss_newton::{Evaluation, Residuals};
use cloth_fit::stage::{Settings, Watch, grow, stretch};
use cloth_fit::twin::replica::Replica;
use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use cloth_sim::finite_difference::derivative_error;
use cloth_sim::material::{Component, Curves};
use nalgebra::DVector;
use std::sync::Arc;

const YARNS: [Component; 2] = [Component::StretchWeft, Component::StretchWarp];

fn denim() -> KnownFabric {
    KnownFabric::named("cotton-denim").unwrap()
}

fn settings() -> Settings {
    Settings { nodes: Some([9, 9]), ..Settings::default() }
}

fn replicas() -> Vec<Replica> {
    let sequences = vec![Kind::StretchWeft, Kind::StretchWarp];
    let rig = Rig { sequences, nodes: [17, 17], measured: [9, 9], frames: 6, noise: false, ..Rig::default() };
    stretch::plan(&YARNS).replicas(&rig.measure(&denim()).unwrap(), &settings()).unwrap()
}

fn simulation<'r>(replicas: &'r [Replica], points: &[f64], values: [&[f64]; 2]) -> Equilibria<'r> {
    let unknown = |(component, values): (Component, &[f64])| {
        let negative = NegativeStrain::Green;
        let curve = StiffnessCurve::new(points.to_vec(), values.to_vec(), negative).unwrap();
        Unknown { components: vec![component], curve }
    };
    let unknowns = Unknowns::new(YARNS.into_iter().zip(values).map(unknown).collect());
    let task = Task {
        objective: Objective::Forces,
        known: Curves::default(),
        settings: settings().equilibrium,
        start: SolveStart::LastEquilibrium,
        exact_clips: true,
        robust: None,
    };
    Equilibria::new(replicas, task, unknowns, Arc::default())
}

fn evaluated(simulation: &mut Equilibria<'_>, point: &[f64]) -> (DVector<f64>, nalgebra::DMatrix<f64>) {
    match simulation.evaluate(&DVector::from_column_slice(point), true).unwrap() {
        Evaluation::Values { residual, jacobian } => (residual, jacobian.unwrap()),
        Evaluation::Failed { reason } => panic!("{reason}"),
    }
}

#[test]
fn two_curves_come_back_from_one_fit() {
    let replicas = replicas();
    let mut simulation = simulation(&replicas, &[0.0], [&[500.0], &[500.0]]);
    let growth = grow(&mut simulation, &settings(), &[1.0, 1.0], &mut Watch::default()).unwrap();
    assert!(growth.outcome.status.converged() && growth.levels.len() > 1);
    let truth = denim().curves().unwrap();
    for Unknown { components, curve } in growth.unknowns.iter() {
        let truth = truth.get(components[0]).unwrap();
        let last = curve.strains()[curve.len() - 1];
        let off = (1..=20).map(|i| last * f64::from(i) / 20.0);
        let off = off.map(|strain| (curve.stress(strain) - truth.stress(strain)).abs()).fold(0.0, f64::max);
        println!("{}: {:.2} % off, {} points", components[0], 100.0 * off / truth.stress(last), curve.len());
        assert!(off < 0.01 * truth.stress(last));
    }
}

#[test]
fn the_jacobian_of_two_curves_is_the_derivative_of_the_residuals() {
    let replicas = replicas();
    let values: [&[f64]; 2] = [&[900.0, 1500.0], &[400.0, 1100.0]];
    let mut simulation = simulation(&replicas, &[0.0, 0.03], values);
    let point = values.concat();
    let (_, jacobian) = evaluated(&mut simulation, &point);
    let rows: Vec<f64> = jacobian.transpose().iter().copied().collect();
    let cell = std::cell::RefCell::new(simulation);
    // The Jacobian is that of what is simulated; residuals are measured − simulated.
    let simulated = |p: &[f64]| (-evaluated(&mut cell.borrow_mut(), p).0).iter().copied().collect();
    let error = derivative_error(simulated, &rows, &point, 0.5, 1e-9);
    assert!(error < 1e-5, "{error:.1e}");
}
