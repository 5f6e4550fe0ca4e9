//! The published method compared with ours, one difference at a time, on a sheet of known rigidity.
//!
//! ```text
//!  ▒▒▒▒▒▒▒▒───╮        100 mm square on 25×25 nodes pushed off a table: a heavy elastica, Γ = 10, without noise
//!         ▒    ╲
//!  table  ▒     │      each row: our method with one setting changed
//! ```
//!
//! The hold on the table is decisive: held there as seen, the sheet comes out more than a quarter too stiff. Any other
//! single difference leaves the rigidity within 5 %. (Levenberg–Marquardt with K + μI does not converge on cells that are so
//! fine and nearly inextensible.)

use cloth_data::frame::Kind;
use cloth_fit::equilibria::SolveStart;
use cloth_fit::incremental::{Stage, fit};
use cloth_fit::optimise::gauss_newton::{Globalisation, Options};
use cloth_fit::stage::GrowthRule;
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::{Constraints, FirstStiffness, Settings, Variant, Watch};
use cloth_fit::twin::replica::TableHold;
use cloth_sim::equilibrium::Tolerance;
use cloth_sim::material::Component;
use fit_cloth_tests::cantilever::{Cantilever, GRAVITY, SIDE, between_rows};

const DENSITY: f64 = 0.2;

/// The fitted rigidity relative to the true one, and the number of factorisations.
fn found(name: &str, settings: Settings) -> f64 {
    let truth = DENSITY * GRAVITY * 0.085f64.powi(3) / 10.0;
    let moment = |curvature: f64| truth * curvature;
    let overhangs = between_rows(12..=20);
    let cantilever = Cantilever {
        kind: Kind::BendWeft,
        areal_density: DENSITY,
        moment: &moment,
        overhangs: &overhangs,
        size: [SIDE; 2],
        measured: [100, 100],
        noise: None,
    };
    let settings = Settings { variant: Variant::Linear, ..settings };
    let report =
        fit(&cantilever.measure(), &[Stage::Bend], &Knowledge::default(), &settings, &mut Watch::default())
            .unwrap();
    let stage = report.stage(Component::BendWeft).unwrap();
    let ratio = stage.curve.samples[100].stiffness / truth;
    println!(
        "{name:42} {:+7.2} %  {:6} factorisations  {:7.2} s  {}",
        100.0 * (ratio - 1.0),
        stage.counters.factorisations,
        stage.seconds,
        if stage.converged { "" } else { "not converged" }
    );
    ratio
}

#[test]
fn what_a_table_holds_decides_the_rigidity() {
    let ours = Settings::default();
    let mut absolute = ours.clone();
    absolute.equilibrium.tolerance = Tolerance::Absolute(1e-5);
    let search =
        Options { globalisation: Globalisation::LineSearch, gain_tolerance: 0.01, ..ours.outer.clone() };
    for (name, settings, least, most) in [
        ("ours", ours.clone(), 0.97, 1.03),
        ("10 µN", absolute, 0.97, 1.03),
        (
            "every solve from the measured shape",
            Settings { solve_start: SolveStart::Measured, ..ours.clone() },
            0.97,
            1.03,
        ),
        (
            "constant start",
            Settings { first_stiffness: FirstStiffness::Constant, ..ours.clone() },
            0.97,
            1.03,
        ),
        ("control points", Settings { constraints: Constraints::ControlPoints, ..ours.clone() }, 0.97, 1.03),
        ("growth", Settings { growth: GrowthRule::PUBLISHED, ..ours.clone() }, 0.97, 1.03),
        ("line search, 1 %", Settings { outer: search, ..ours.clone() }, 0.95, 1.05),
        ("held on the table as seen", Settings { table: TableHold::AsSeen, ..ours.clone() }, 1.25, 3.0),
    ] {
        let ratio = found(name, settings);
        assert!((least..=most).contains(&ratio), "{name}: {ratio}");
    }
}

#[test]
fn the_whole_published_method_is_too_stiff_wherever_it_starts() {
    let published = Settings::default().as_published();
    let first_stiffness = FirstStiffness::FromMeasurements;
    let elsewhere = Settings { first_stiffness, ..published.clone() };
    let [one, other] =
        [found("as published", published), found("as published, from Peirce's start", elsewhere)];
    assert!((1.4..2.2).contains(&one) && (one / other - 1.0).abs() < 0.02, "{one} {other}");
}
