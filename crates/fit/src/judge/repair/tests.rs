use super::*;
use cloth_sim::curve::soundness::MEMBRANE_STIFFNESS;
use cloth_sim::curve::{NegativeStrain, equidistant};
use rand::{Rng, SeedableRng, rngs::StdRng};

const MEMBRANE: Context = Context { magnitude: Some(MEMBRANE_STIFFNESS), visited: None };

fn curve(strains: &[f64], stiffnesses: &[f64]) -> StiffnessCurve {
    StiffnessCurve::new(strains.to_vec(), stiffnesses.to_vec(), NegativeStrain::Odd).unwrap()
}

fn repaired(given: &StiffnessCurve) -> Repair {
    let repaired = repair(given, &MEMBRANE).unwrap();
    assert_eq!(check(&repaired.curve, &MEMBRANE), []);
    let again = repair(&repaired.curve, &MEMBRANE).unwrap();
    assert!(again.is_unchanged() && again.rms == 0.0 && again.curve == repaired.curve);
    repaired
}

#[test]
fn a_sound_curve_comes_back_to_the_bit() {
    let sound = curve(&[0.0, 0.1, 0.3], &[50.0, 70.0, 80.0]);
    let Repair { curve, rms, largest, .. } = repair(&sound, &MEMBRANE).unwrap();
    assert!(curve == sound && rms == 0.0 && largest == 0.0);
}

#[test]
fn every_kind_of_defect_is_repaired() {
    let given = [
        curve(&[0.0, 0.1, 0.2, 0.3], &[1000.0, 1.0, 1.0, 1000.0]),
        curve(&[0.0, 0.1, 0.2, 0.3, 0.4], &[100.0, 100.0, 52.5, 30.0, 100.0]),
        curve(&[0.0, 0.1, 0.2], &[100.0, 100.0, 50.0]),
        curve(&[0.0, 0.1, 0.1 + 1e-6], &[1.0, 1.0, 1.1]),
        curve(&[0.0, 0.1, 0.2], &[-50.0, 100.0, 200.0]),
    ];
    for given in &given {
        let Repair { rms, largest, at, .. } = repaired(given);
        assert!(0.0 < rms && rms <= largest && (0.0..=0.4).contains(&at));
    }
    // The change is local: the stress before the fall stays.
    let Repair { curve, at, .. } = repaired(&given[2]);
    assert!(at > 0.1 && (curve.stress(0.02) / given[2].stress(0.02) - 1.0).abs() < 0.2);
}

#[test]
fn the_ratio_of_tangents_is_kept_by_no_more_than_it_takes() {
    // Stress that grows by a tenth within 1e-6 of strain.
    let given = curve(&[0.0, 0.1, 0.1 + 1e-6], &[1.0, 1.0, 1.1]);
    assert_eq!(
        check(&given, &Context::default()).first().map(|finding| finding.kind),
        Some(Flaw::TangentRatio)
    );
    let found = repair(&given, &Context::default()).unwrap();
    let of = extremes(&found.curve);
    let ratio = of.largest_tangent / of.least_tangent;
    assert!(ratio > 5e3 && ratio <= TANGENT_RATIO, "{ratio}");
}

#[test]
fn the_distance_is_measured_by_simpsons_rule() {
    let given = curve(&[0.0, 0.1, 0.4], &[1.0, 1.0, 1.0]);
    let problem = Problem::new(&given);
    let cubes = problem.strains.iter().zip(&problem.weights).map(|(strain, weight)| weight * strain.powi(3));
    assert!((cubes.sum::<f64>() - 0.4f64.powi(3) / 4.0).abs() < 1e-16);
}

#[test]
fn what_cannot_be_repaired_is_said() {
    let refused = |given: &StiffnessCurve| repair(given, &MEMBRANE).unwrap_err().to_string();
    assert!(refused(&curve(&[0.0, 0.1], &[1e7, 1e7])).contains("at most 1e6"));
    assert!(refused(&curve(&[0.0, 0.1], &[-1.0, -1.0])).contains("at least 1e-1"));
    let unjudged = repair(&curve(&[0.0, 0.1], &[-1.0, -1.0]), &Context::default());
    assert_eq!(unjudged, Err(Unrepairable::NoStiffness));
}

#[test]
fn the_repair_is_the_minimum_that_a_polished_solve_finds() {
    let mut rng = StdRng::seed_from_u64(11);
    for _ in 0..40 {
        let points = rng.random_range(3..7);
        let k: Vec<f64> = (0..points).map(|_| 10f64.powf(rng.random_range(0.0..3.0))).collect();
        let given = curve(&equidistant(points, 0.3), &k);
        let found = repaired(&given);
        if found.is_unchanged() {
            continue;
        }
        // The same scale, so that both problems are the same.
        let lowest = 1e-3 * (1.0 + MARGIN) * extremes(&found.curve).largest_stiffness;
        let problem = Problem::new(&given);
        let mut jacobian = problem.stress.clone();
        jacobian.row_iter_mut().zip(&problem.weights).for_each(|(mut row, weight)| row *= weight.sqrt());
        let target = &jacobian * DVector::from_vec(k);
        let rows = stability_rows(given.strains()).unwrap();
        let bounds = DVector::from_element(rows.nrows(), lowest);
        let solution =
            LeastSquares { rows, bounds, ..LeastSquares::new(jacobian.clone(), target.clone()) }.solve();
        let polished = (&jacobian * &solution.point - target).norm();
        assert!((found.rms / polished - 1.0).abs() < 1e-3, "{} {polished}", found.rms);
    }
}

#[test]
fn a_table_of_201_rows_is_repaired_nearby() {
    let mut rng = StdRng::seed_from_u64(12);
    let strains = equidistant(201, 0.2);
    let noisy = strains.iter().map(|&strain| 100.0 + 4000.0 * strain + rng.random_range(-30.0..30.0));
    let given = curve(&strains, &noisy.collect::<Vec<_>>());
    assert!(!check(&given, &MEMBRANE).is_empty());
    assert!(repaired(&given).largest < 6.0);
}
