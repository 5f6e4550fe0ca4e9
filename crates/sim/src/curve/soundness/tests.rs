use super::*;
use crate::curve::{NegativeStrain, equidistant};
use rand::{Rng, SeedableRng, rngs::StdRng};

fn curve(strains: &[f64], stiffnesses: &[f64]) -> StiffnessCurve {
    StiffnessCurve::new(strains.to_vec(), stiffnesses.to_vec(), NegativeStrain::Odd).unwrap()
}

fn kinds(curve: &StiffnessCurve, context: &Context) -> Vec<Flaw> {
    check(curve, context).iter().map(|finding| finding.kind).collect()
}

const MEMBRANE: Context = Context { magnitude: Some(MEMBRANE_STIFFNESS), visited: None };

#[test]
fn a_sound_curve_has_no_findings() {
    for sound in [curve(&[0.0], &[100.0]), curve(&[0.0, 0.1, 0.2], &[100.0, 150.0, 300.0])] {
        assert_eq!(check(&sound, &MEMBRANE), []);
    }
    // A soft middle exactly at the limit: κ is 0.001 of the last stiffness.
    let resting = curve(&[0.0], &[1e-1]);
    assert_eq!(check(&resting, &MEMBRANE), []);
}

#[test]
fn every_defect_is_found_by_itself() {
    // Positive at the control points, negative between them: the spline overshoots.
    let dip = curve(&[0.0, 0.1, 0.2, 0.3], &[1000.0, 1.0, 1.0, 1000.0]);
    let found = check(&dip, &MEMBRANE);
    assert_eq!(found[0].kind, Flaw::NegativeStiffness);
    assert!(found[0].strains[0] > 0.1 - 1e-12 && found[0].strains[1] < 0.2 + 1e-12, "{found:?}");
    assert!(found[0].value < 0.0 && found[0].severity() == Severity::Defect);

    // Stress 10, 10.5 and then 8: it falls although k is positive.
    let kinked = curve(&[0.0, 0.1, 0.2, 0.3, 0.4], &[100.0, 100.0, 52.5, 30.0, 100.0]);
    let found = check(&kinked, &MEMBRANE);
    assert!(found.iter().all(|finding| finding.kind == Flaw::LowTangent), "{found:?}");
    assert!(found[0].value < 0.0 && found[0].consequence().contains("falls"));

    // Barely growing stress also counts: σ = 10 + 0.05 (ε − 0.1).
    let flat = curve(&[0.0, 0.1, 0.2, 0.3, 0.4], &[100.0, 100.0, 50.025, 33.366_666_666_666_67, 25.0375]);
    let found = check(&flat, &MEMBRANE);
    assert!(found.iter().any(|finding| finding.kind == Flaw::LowTangent), "{found:?}");

    let falls = curve(&[0.0, 0.1, 0.2], &[100.0, 100.0, 50.0]);
    assert!(kinds(&falls, &MEMBRANE).contains(&Flaw::EndSlope));

    let steep = curve(&[0.0, 0.1, 0.1 + 1e-6], &[1.0, 1.0, 1.1]);
    assert_eq!(kinds(&steep, &MEMBRANE), [Flaw::TangentRatio]);

    let negative = curve(&[0.0], &[-5.0]);
    assert_eq!(
        kinds(&negative, &MEMBRANE),
        [Flaw::NegativeStiffness, Flaw::LowTangent, Flaw::EndSlope, Flaw::Magnitude]
    );
}

#[test]
fn an_implausible_magnitude_and_an_unvisited_range_are_told() {
    for (k, expected) in [(0.0, vec![Flaw::Magnitude]), (0.01, vec![Flaw::Magnitude]), (0.2, vec![])] {
        assert_eq!(kinds(&curve(&[0.0], &[k]), &MEMBRANE), expected);
    }
    let stiff = curve(&[0.0, 0.1], &[1e6, 2e6]);
    assert_eq!(kinds(&stiff, &MEMBRANE), [Flaw::Magnitude]);
    assert!(check(&stiff, &MEMBRANE)[0].consequence().contains("stiff"));
    assert!(!check(&stiff, &MEMBRANE)[0].is_unstable());
    let bending = Context { magnitude: Some(BENDING_STIFFNESS), visited: None };
    assert_eq!(kinds(&curve(&[0.0], &[1e-5]), &bending), []);
    assert_eq!(kinds(&curve(&[0.0], &[1.0]), &bending), [Flaw::Magnitude]);

    let visited =
        |range| check(&curve(&[0.0, 0.1], &[1.0, 1.0]), &Context { magnitude: None, visited: Some(range) });
    assert_eq!(visited([-0.01, 0.0995]), []);
    let [first, second] = visited([0.02, 0.07])[..] else { panic!() };
    assert_eq!((first.strains, second.strains), ([0.0, 0.02], [0.07, 0.1]));
    assert!((second.value - 0.3).abs() < 1e-12 && second.severity() == Severity::Note);
}

#[test]
fn intervals_and_extremes_are_those_of_many_samples() {
    let mut rng = StdRng::seed_from_u64(6);
    let mut defective = 0;
    for _ in 0..300 {
        let points = rng.random_range(2..7);
        let k: Vec<f64> = (0..points).map(|_| 10f64.powf(rng.random_range(0.0..3.0))).collect();
        let curve = curve(&equidistant(points, 0.3), &k);
        let found = check(&curve, &Context::default());
        defective += usize::from(!found.is_empty());
        let of = extremes(&curve);
        for i in 0..=1500 {
            let strain = (f64::from(i) * 2e-4).min(0.3);
            let (k, tangent) = (curve.stiffness(strain), curve.response(strain).tangent);
            let slack = 1e-9 * of.largest_stiffness;
            assert!(k <= of.largest_stiffness + slack);
            assert!(tangent >= of.least_tangent - slack && tangent <= of.largest_tangent + slack);
            for (kind, value, limit) in
                [(Flaw::NegativeStiffness, k, 0.0), (Flaw::LowTangent, tangent, 1e-3 * of.largest_stiffness)]
            {
                let inside = found.iter().filter(|finding| finding.kind == kind).any(|finding| {
                    finding.strains[0] <= strain
                        && strain <= finding.strains[1]
                        && finding.value <= value + slack
                });
                let near = (value - limit).abs() < 1e-6 * of.largest_stiffness;
                assert!(near || inside == (value < limit), "{kind} at {strain}: {value}");
            }
        }
    }
    assert!(defective > 200, "{defective}");
}

#[test]
fn a_finding_says_what_and_where_and_what_it_would_do() {
    let said = |kind, strains, value, limit| {
        let finding = Finding { kind, strains, value, limit };
        (format!("{}: {finding}", finding.severity()), finding.consequence())
    };
    for (kind, strains, value, limit, words, does) in [
        (
            Flaw::NegativeStiffness,
            [0.0, 0.25],
            -5.0,
            0.0,
            "defect: negative-stiffness from 0.0000 to 0.2500 (-5.000e0, limit 0.000e0)",
            "tears itself apart",
        ),
        (Flaw::LowTangent, [0.1, 0.2], -1.0, 0.5, "defect: low-tangent from 0.1000 to 0.2000 (-1", "falls"),
        (Flaw::LowTangent, [0.1, 0.2], 0.1, 0.5, "defect: low-tangent", "hardly grows"),
        (Flaw::TangentRatio, [0.0, 0.2], 2e4, 1e4, "defect: tangent-ratio", "dictates the time step"),
        (Flaw::EndSlope, [0.2, f64::INFINITY], -1.0, 0.5, "defect: end-slope from 0.2000 on (-1", "for ever"),
        (
            Flaw::EndSlope,
            [0.2, f64::INFINITY],
            0.1,
            0.5,
            "defect: end-slope from 0.2000 on",
            "hardly anything",
        ),
        (Flaw::Magnitude, [0.0, 0.2], 0.0, 0.1, "defect: magnitude", "no stiffness at all"),
        (Flaw::Magnitude, [0.0, 0.2], 0.01, 0.1, "defect: magnitude", "far too soft"),
        (Flaw::Magnitude, [0.0, 0.2], 1e7, 1e6, "defect: magnitude", "far too stiff"),
    ] {
        let (found, consequence) = said(kind, strains, value, limit);
        assert!(found.starts_with(words) && consequence.contains(does), "{found}: {consequence}");
    }
    let (found, consequence) = said(Flaw::Unvisited, [0.0, 0.02], 0.2, 0.0);
    assert_eq!(found, "note: unvisited from 0.0000 to 0.0200");
    assert!(consequence.contains("a guess"));
}
