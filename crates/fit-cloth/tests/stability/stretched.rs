//! Cases 3 and 4: curves beyond their last point, and curves of one point, zero stiffness, or six decades.

use crate::balance;
use crate::curves::{curve, largest_stiffness, points};
use crate::property::for_all;
use crate::table::{Extent, Row};
use cloth_sim::curve::soundness::check;
use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use cloth_sim::equilibrium::{Settings, Solver};
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::Diagonals;
use cloth_sim::samples::{self, SIDE, Sample};
use nalgebra::Vector3;

const RULES: [NegativeStrain; 4] =
    [NegativeStrain::Odd, NegativeStrain::Linear, NegativeStrain::Green, NegativeStrain::Slack];

/// Strain up to ten times and more past the last point: the stress is linear, and equilibria converge.
pub(crate) fn case_03(extent: Extent) -> Vec<Row> {
    let lines = [2, 3, 5].map(|count| {
        let row =
            Row::measured(3, format!("{count} points, on the line of the end"), "relative error", 1e-12);
        let inputs = (points(count, 1.0), 0.0..2.0);
        for_all(row, extent.runs(1_000, 20_000), inputs, |row, (points, times)| {
            let curve = curve(points);
            let last = curve.strains()[curve.len() - 1];
            let end = curve.response(last);
            let strain = last * 10f64.powf(times);
            let line = end.stress + end.tangent * (strain - last);
            let size = end.stress.abs() + (end.tangent * (strain - last)).abs();
            let found = curve.response(strain);
            let energy = curve.energy(last) + 0.5 * (end.stress + line) * (strain - last);
            let error = ((found.stress - line) / size)
                .abs()
                .max((found.tangent - end.tangent).abs() / largest_stiffness(&curve))
                .max((curve.energy(strain) - energy).abs() / (curve.energy(last) + size * strain));
            row.measure(error, || format!("{curve:?} at {strain}"))
        })
    });
    let pulled = Model::ALL.into_iter().flat_map(|model| [3.0, 10.0, 30.0].map(|times| (model, times)));
    let pulled = pulled.map(|(model, times)| {
        let row = balance::row(3, format!("{model}, strip pulled {times}× past the last point"));
        for_all(row, extent.runs(4, 100), (-3.0..6.0, 1.0..4.0), |row, (decade, rise): (f64, f64)| {
            pulled_past_the_end(row, model, times, 10f64.powf(decade), rise)
        })
    });
    lines.into_iter().chain(pulled).collect()
}

/// A planar strip whose curves end at a strain of 0.02; the force on its clip is known.
fn pulled_past_the_end(row: &mut Row, model: Model, times: f64, stiffness: f64, rise: f64) -> bool {
    let last = 0.02;
    let strain = times * last;
    let stretch = if model == Model::STVK { (1.0 + 2.0 * strain).sqrt() } else { 1.0 + strain };
    let (mut sample, _) = samples::strip(model, Diagonals::Alternating, stiffness, stretch).unwrap();
    let points = vec![stiffness, rise * stiffness];
    for component in [Component::StretchWeft, Component::StretchWarp] {
        let negative = model.negative_strain(component, Default::default());
        let curve = StiffnessCurve::new(vec![0.0, last], points.clone(), negative).unwrap();
        sample.curves.set(component, curve);
    }
    sample.perturb(1e-3 * SIDE);
    // σₙ + Tₙ(ε − εₙ), with the slope of the only segment.
    let [first, end] = [stiffness, rise * stiffness];
    let stress = end * last + (end + (end - first)) * (strain - last);
    let expected = 0.04 * stress * if model == Model::STVK { stretch } else { 1.0 };
    let cloth = sample.cloth().unwrap();
    let mut solver = Solver::new(&cloth);
    let mut x = sample.start.clone();
    let found = solver.solve(&sample.curves, &mut x, &Settings::default());
    let force = solver.clip_forces()[1].x;
    let also = if (force / expected - 1.0).abs() < 1e-4 {
        Ok(())
    } else {
        Err(format!("{force} N, expected {expected} N"))
    };
    let input = format!("k = {stiffness:.3e} N/m, rising {rise:.3}-fold");
    balance::judge(row, &cloth, &sample, &x, &found, also, &input)
}

/// One point is exactly constant; all zeros are reported as no stiffness; six decades converge.
pub(crate) fn case_04(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for rule in RULES {
        let row = Row::measured(4, format!("one point, {rule:?}"), "relative error", 4.0 * f64::EPSILON);
        let inputs = (-6.0..9.0, -0.49..5.0, 0.0..1.0);
        rows.push(for_all(
            row,
            extent.runs(1_000, 20_000),
            inputs,
            |row, (decade, strain, at): (f64, f64, f64)| {
                let k = 10f64.powf(decade);
                let curve = StiffnessCurve::new(vec![at], vec![k], rule).unwrap();
                let expected = match rule {
                    NegativeStrain::Green if strain < 0.0 => k * (1.0 - 1.0 / f64::sqrt(1.0 + 2.0 * strain)),
                    NegativeStrain::Slack if strain < 0.0 => 0.0,
                    _ => k * strain,
                };
                let size = k * (strain.abs() + at).max(f64::MIN_POSITIVE);
                row.measure((curve.stress(strain) - expected).abs() / size, || format!("{k:e} at {strain}"))
            },
        ));
    }
    rows.extend(Model::ALL.map(|model| {
        let mut row = Row::new(4, format!("{model}, all zero: said, and no equilibrium claimed"));
        for zeros in 1..=5 {
            let strains = (0..zeros).map(|i| 0.1 * i as f64).collect();
            let component = Component::StretchWeft;
            let negative = model.negative_strain(component, Default::default());
            let curve = StiffnessCurve::new(strains, vec![0.0; zeros], negative).unwrap();
            let context = cloth_fit::material::check::context(model, component, None);
            let finding = check(&curve, &context).into_iter().next();
            let said = finding.is_some_and(|found| found.consequence().contains("no stiffness at all"));
            let mut sample = samples::hanging_sheet(model, 5).unwrap();
            Model::STVK
                .components()
                .into_iter()
                .for_each(|component| sample.curves.set(component, curve.clone()));
            let cloth = sample.cloth().unwrap();
            let mut x = sample.start.clone();
            let found = Solver::new(&cloth).solve(&sample.curves, &mut x, &Settings::default());
            let honest = !found.converged() && x.iter().all(|x| x.is_finite());
            row.holds(said && honest, || format!("{zeros} zeros: {finding:?}, {found:?}"));
        }
        row
    }));
    let wide = Model::ALL.into_iter().flat_map(|model| [2.0, 4.0, 6.0].map(|decades| (model, decades)));
    rows.extend(wide.map(|(model, decades)| {
        let row = balance::row(4, format!("{model}, stretched, stiffness rising over {decades} decades"));
        let inputs = (2..6usize, 1.0..3.0, 0.01..0.3, 1e-3..0.2);
        for_all(row, extent.runs(4, 200), inputs, |row, (count, power, last, pull)| {
            rising(row, model, (count, power, last), decades, pull)
        })
    }));
    rows
}

/// A sagging sheet between two clips, with curves that rise over some decades as a power of strain: other curves would
/// fall below zero between the points.
fn rising(
    row: &mut Row,
    model: Model,
    (count, power, last): (usize, f64, f64),
    decades: f64,
    pull: f64,
) -> bool {
    let curves = samples::fabric(model, [1.0, 0.1, 1e-6]).unwrap();
    let mut sample = Sample::at_rest(samples::square(6, Diagonals::Alternating).unwrap(), model, curves);
    sample.gravity = Vector3::new(0.0, 0.0, -samples::GRAVITY);
    for component in [Component::StretchWeft, Component::StretchWarp, Component::Shear] {
        let share = |i: usize| i as f64 / (count - 1) as f64;
        let strains = (0..count).map(|i| last * share(i)).collect();
        let rise = 10f64.powf(decades) - 1.0;
        let stiffnesses = (0..count).map(|i| 0.1 * (1.0 + rise * share(i).powf(power))).collect();
        let negative = model.negative_strain(component, Default::default());
        sample.curves.set(component, StiffnessCurve::new(strains, stiffnesses, negative).unwrap());
    }
    sample.hold(|p| if p.x == 0.0 { Some(0) } else { (p.x > 0.999 * SIDE).then_some(1) });
    sample.place(|p| Vector3::new((1.0 + pull) * p.x, p.y, p.z));
    sample.perturb(1e-5);
    let input = format!("{count} points to {last:.4}, power {power:.3}, pulled by {pull:.4}");
    balance::solve(row, &sample, &Settings::default(), &input).0
}
