//! Source: none; the defects are those of docs/model.md, "Check and repair".
//!
//! Goal: every repairable curve is repaired, and repair is idempotent.
//!
//! Parameters: 1000 random curves of two to eight control points, values over three decades, random strains. Every
//! repaired curve passes the check that found the defects, and repairing it again changes nothing, to the bit. If the
//! stress between the points is negative overall, no nearest stiffness exists, and an error says so.

use cloth_fit::judge::repair::{Unrepairable, repair};
use cloth_sim::curve::soundness::{Context, MEMBRANE_STIFFNESS, check};
use cloth_sim::curve::{NegativeStrain, StiffnessCurve};
use fit_cloth_tests::random_curve::random_curve;

fn stresses(curve: &StiffnessCurve) -> impl Iterator<Item = f64> {
    let last = curve.strains()[curve.len() - 1];
    (0..=1000).map(move |i| curve.stress(last * f64::from(i) / 1000.0))
}

#[test]
fn a_thousand_random_curves_are_repaired_once_and_for_all() {
    let context = Context { magnitude: Some(MEMBRANE_STIFFNESS), visited: None };
    let (mut sound, mut refused, mut largest) = (0, 0, 0.0f64);
    for seed in 0..1000 {
        let given = random_curve(seed, NegativeStrain::Odd);
        let repaired = match repair(&given, &context) {
            Ok(repaired) => repaired,
            Err(Unrepairable::NoStiffness) => {
                // Only where the spline between positive points is negative overall.
                assert!(stresses(&given).sum::<f64>() < 0.0, "curve {seed}");
                refused += 1;
                continue;
            }
            Err(error) => panic!("curve {seed}: {error}"),
        };
        assert_eq!(check(&repaired.curve, &context), [], "curve {seed}");
        let again = repair(&repaired.curve, &context).unwrap();
        assert!(again.curve == repaired.curve && again.is_unchanged(), "curve {seed}");
        let was_sound = check(&given, &context).is_empty();
        assert_eq!(was_sound, repaired.curve == given, "curve {seed}");
        sound += usize::from(was_sound);
        let scale = stresses(&given).fold(0.0, |largest: f64, stress| largest.max(stress.abs()));
        largest = largest.max(repaired.rms / scale);
    }
    println!(
        "{sound} of 1000 were sound, {refused} cannot be repaired; the farthest repair moved the stress by {:.0} % (rms)",
        100.0 * largest
    );
    // Two points that rise are sound; almost all other curves are not.
    assert!((20..200).contains(&sound), "{sound}");
    assert!(refused < 10 && largest < 1.0, "{refused} {largest}");
}
